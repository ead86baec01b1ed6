"""Curves over time, by matplotlib without a screen; and films, which ancf.render draws."""

import numpy as np
from yade import O

from .needs import needed
from .render import Film

with needed("python3-matplotlib"):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

__all__ = ["Film", "History", "plt"]


class History:
    """Displacement and velocity of bodies and the mouth area of a net over time: sample() each
    time, then save() and plot().
    """

    def __init__(self, net, bodies=None):
        self.net = net
        self.bodies = list(net.bullets if bodies is None else bodies)
        self.start = [np.array(list(O.bodies[i].state.pos)) for i in self.bodies]
        self.time, self.position, self.velocity, self.area = [], [], [], []

    def sample(self):
        """Keeps the present state."""
        states = [O.bodies[i].state for i in self.bodies]
        self.time.append(O.time)
        self.position.append([list(s.pos) for s in states])
        self.velocity.append([list(s.vel) for s in states])
        self.area.append(self.net.mouthArea())

    @property
    def displacement(self):
        """Distance from the start, (times, bodies) [m]."""
        return np.linalg.norm(np.array(self.position) - np.array(self.start), axis=2)

    @property
    def speed(self):
        """(times, bodies) [m/s]."""
        return np.linalg.norm(np.array(self.velocity), axis=2)

    def save(self, path):
        """Writes a CSV: time [s], mouth area [m2], then position, velocity, displacement and speed
        of every body.
        """
        head = ["time_s", "mouth_area_m2"]
        for k in range(len(self.bodies)):
            head += [f"{q}{k + 1}_{u}" for q, u in zip(("x", "y", "z"), "mmm")]
            head += [f"v{q}{k + 1}_m_s" for q in "xyz"]
            head += [f"displacement{k + 1}_m", f"speed{k + 1}_m_s"]
        position, velocity = np.array(self.position), np.array(self.velocity)
        displacement, speed = self.displacement, self.speed
        columns = [self.time, self.area]
        for k in range(len(self.bodies)):
            columns += [*position[:, k].T, *velocity[:, k].T, displacement[:, k], speed[:, k]]
        rows = np.column_stack(columns)
        np.savetxt(path, rows, fmt="%.9g", delimiter=",", header=",".join(head), comments="")

    def plot(self, path, events=None):
        """Displacement, velocity and mouth area over time, like Figs. 16-17 of Shan, Guo, Gill
        2019.

        events: {label: time [s]} to be marked.
        """
        figure, axes = plt.subplots(1, 3, figsize=(15, 4.4))
        curves = (
            (self.displacement, "displacement of bullets [m]"),
            (self.speed, "speed of bullets [m/s]"),
            (np.array(self.area)[:, None], "mouth area [m²]"),
        )
        for ax, (data, title) in zip(axes, curves):
            for k in range(data.shape[1]):
                label = f"bullet {k + 1}" if data.shape[1] > 1 else None
                ax.plot(
                    self.time, data[:, k], lw=1.4, ls=("-", "--", "-.", ":")[k % 4], label=label
                )
            for i, (label, time) in enumerate((events or {}).items()):
                ax.axvline(time, color="0.5", lw=0.8, ls=":")
                at = (time, 0.02 + 0.06 * i)
                ax.annotate(
                    f" {label}", at, xycoords=("data", "axes fraction"), fontsize=8, color="0.35"
                )
            ax.set_xlabel("time [s]")
            ax.set_ylabel(title)
            ax.set_ylim(bottom=0)
            ax.grid(alpha=0.3)
            if data.shape[1] > 1:
                ax.legend(fontsize=9)
        figure.tight_layout()
        figure.savefig(path, dpi=130)
        plt.close(figure)
