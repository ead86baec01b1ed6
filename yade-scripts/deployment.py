"""How a net opens: mouth area over time, deployment time and way, and when it captures a ball.

Bullet mass, shooting speed and angle are varied one by one around the net of ball_capture, then speed
and angle together with a ball in the way. Run it by `/usr/bin/python3 deployment.py`; results go to
out/deployment/.
"""

import argparse
import csv
import pathlib

from jobs import addOption, insist, runAll  # first: see there

import ancf
import ball_capture as given
import numpy as np
from ancf.capture import HOLD, Capture
from yade import O, Vector3, utils

# ---- parameters, SI units; the rest is ball_capture's --------------------------------------------
MASSES = (0.005, 0.01, 0.02, 0.05, 0.1, 0.2)  # of a bullet [kg]
SPEEDS = (0.5, 1.0, 1.5, 2.0, 3.0, 5.0)  # [m/s]
ANGLES = (5, 10, 15, 20, 25, 30, 40, 50)  # [deg]
MAP_SPEEDS = (1.0, 1.5, 2.0, 3.0)
MAP_ANGLES = (5, 15, 20, 25, 30, 35, 45)
OPEN = 0.8  # of the flat net's area: the net counts as deployed
WAY = 1.8  # bullets fly for this way [m] over their speed
SAMPLE = 0.005  # way between two samples [m]


def scene(mass, speed, angle, target):
    """The net and its bullets; and the id of a fixed ball if there is a target, else None."""
    a, ball = given.ASSUMED, None
    O.reset()
    given.appendMaterials()
    if target:
        center = Vector3(given.TARGET_DISTANCE, 1e-6, 2e-6)  # symmetry would be an accident
        body = utils.sphere(center, given.BALL_RADIUS, material="ball", fixed=True)
        ball = O.bodies.append(body)
    net = ancf.Net.square(
        given.MESHES,
        given.MESH_LENGTH,
        diameter=a["diameter"],
        material="cable",
        contactPoints=given.CONTACT_POINTS if target else 0,
        damping=a["damping"],
        mass="lumped",
        normal=(1, 0, 0),
        fold=a["fold"],
    )
    net.addBullets(mass, a["bulletRadius"], speed, np.radians(angle))
    O.engines = ancf.engines(net)
    O.dt = 0.8 * net.criticalTimeStep()
    return net, ball


class Flight:
    """Mouth area and way of the bullets over time."""

    def __init__(self, mass, speed, angle, target=False, smaller=1.0):
        net, ball = scene(mass, speed, angle, target)
        capture = Capture(net, ball, hold=HOLD * given.BULLET_SPEED / speed) if target else None
        O.dt *= smaller
        self.mass, self.speed, self.angle = mass, speed, angle
        duration = (WAY if not target else given.DURATION * given.BULLET_SPEED) / speed
        every = max(1, round(SAMPLE / speed / O.dt))
        time, area, way = [], [], []
        while O.time < duration:
            time.append(O.time)
            area.append(net.mouthArea())
            x = np.array([O.bodies[i].state.pos[0] for i in net.bullets])
            way.append(x.mean())
            if capture:
                capture.sample()
            for _ in range(every):
                O.step()
        self.time, self.way = np.array(time), np.array(way)
        self.area = np.array(area) / (given.MESHES * given.MESH_LENGTH) ** 2
        self.captured = self._captured(capture) if target else None

    @property
    def open(self):
        """(from, to): indices between which the net is deployed; None if it never is."""
        wide = np.flatnonzero(self.area >= OPEN)
        if not len(wide):
            return None
        gap = np.flatnonzero(np.diff(wide) > 1)
        return wide[0], wide[gap[0]] if len(gap) else wide[-1]

    @property
    def deployment(self):
        """Time until it is deployed [s], way until then and way while it is [m]; nan if never."""
        if self.open is None:
            return np.nan, np.nan, np.nan
        first, last = self.open
        return self.time[first], self.way[first], self.way[last] - self.way[first]

    @staticmethod
    def _captured(capture):
        """Whether the net embraced the ball: 2 for HOLD at 1.5 m/s, and as much of the way at other speeds; 1 for
        less; 0 never.
        """
        return 2 if capture.embraced else int(capture.embracing.any())


def fly(job):
    return insist(Flight, job)


def largestArea(flight):
    """Of the mouth on the way to the target, as part of the flat net's."""
    return flight.area[flight.way < given.TARGET_DISTANCE].max()


def plot(series, grid, file):
    """series: {parameter: [Flight, ...]}; grid: [Flight, ...] with the ball."""
    from ancf.plots import plt

    figure, axes = plt.subplots(2, 3, figsize=(15, 8.6))
    labels = {"mass": "bullet mass [kg]", "speed": "speed [m/s]", "angle": "angle [deg]"}
    shown = plt.get_cmap("viridis")
    flights = series["angle"]
    for k, f in enumerate(flights):
        axes[0, 0].plot(f.way, f.area, color=shown(k / len(flights)), lw=1.2, label=f"{f.angle}°")
    axes[0, 0].axhline(OPEN, color="k", lw=0.8, ls=":")
    axes[0, 0].set_xlabel("way of the bullets along x [m]")
    axes[0, 0].set_ylabel("mouth area / flat net")
    axes[0, 0].legend(fontsize=8, title="angle", ncol=2)
    for ax, (name, flights) in zip((axes[0, 1], axes[0, 2], axes[1, 0]), series.items()):
        x = [getattr(f, name) for f in flights]
        values = np.array([f.deployment for f in flights])
        largest = [f.area.max() for f in flights]
        ax.plot(x, values[:, 0], "o-", color="#1f6fb2", label="deployment time [s]")
        ax.plot(x, values[:, 1], "s-", color="#c0392b", label="way until then [m]")
        ax.plot(x, values[:, 2], "^-", color="#2e8b57", label="way while deployed [m]")
        ax.plot(x, largest, ":", color="0.4", label="largest area / flat net")
        ax.set_xlabel(labels[name])
        ax.set_ylim(0, 1.25)
        ax.legend(fontsize=8)
    axes[0, 1].set_xscale("log")
    for ax in axes.flat[:4]:
        ax.grid(alpha=0.3)
    speeds = sorted({f.speed for f in grid})
    angles = sorted({f.angle for f in grid})
    at = {(f.speed, f.angle): f for f in grid}
    for ax, what in ((axes[1, 1], "area"), (axes[1, 2], "captured")):
        of = largestArea if what == "area" else lambda flight: flight.captured
        value = np.array([[of(at[s, a]) for a in angles] for s in speeds])
        image = ax.imshow(value, origin="lower", aspect="auto", cmap="YlGnBu", vmin=0)
        for i in range(len(speeds)):
            for j in range(len(angles)):
                text = f"{value[i, j]:.2f}" if what == "area" else "-+●"[int(value[i, j])]
                dark = value[i, j] > 0.6 * value.max()
                ax.text(
                    j, i, text, ha="center", va="center", color="w" if dark else "k", fontsize=9
                )
        ax.set_xticks(range(len(angles)), [str(a) for a in angles])
        ax.set_yticks(range(len(speeds)), [str(s) for s in speeds])
        ax.set_xlabel("angle [deg]")
        ax.set_ylabel("speed [m/s]")
        if what == "area":
            figure.colorbar(image, ax=ax)
    axes[1, 1].set_title("largest mouth area / flat net before the ball", fontsize=10)
    axes[1, 2].set_title("ball at 1 m: ● embraced, + only for a while, - never", fontsize=10)
    figure.tight_layout()
    figure.savefig(file, dpi=90)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="short form")
    addOption(parser)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/deployment"))
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    thin = slice(None, None, 3) if args.quick else slice(None)
    m, v, a = given.BULLET_MASS, given.BULLET_SPEED, given.BULLET_ANGLE
    series = {
        "mass": [(x, v, a) for x in MASSES[thin]],
        "speed": [(m, x, a) for x in SPEEDS[thin]],
        "angle": [(m, v, x) for x in ANGLES[thin]],
    }
    series = {k: runAll(fly, jobs, args.workers, f"varied {k}") for k, jobs in series.items()}
    speeds, angles = (MAP_SPEEDS[2:3], MAP_ANGLES[4:5]) if args.quick else (MAP_SPEEDS, MAP_ANGLES)
    grid = runAll(fly, [(m, s, x, True) for s in speeds for x in angles], args.workers, "map")
    with open(args.out / "deployment.csv", "w", newline="", encoding="utf-8") as file:
        out = csv.writer(file)
        out.writerow(
            "varied,mass_kg,speed_m_s,angle_deg,deployment_s,way_until_m,way_while_m,largest_area,captured".split(
                ","
            )
        )
        for name, flights in [*series.items(), ("map", grid)]:
            for f in flights:
                row = [f.mass, f.speed, f.angle, *f.deployment, f.area.max()]
                caught = f.captured if name == "map" else ""
                out.writerow([name, *(f"{x:.4g}" for x in row), caught])
    plot(series, grid, args.out / "deployment.png")
    for name, flights in series.items():
        for f in flights:
            t, until, while_ = f.deployment
            print(
                f"  {name} {getattr(f, name):g}: deployed after {t:.3f} s and {until:.2f} m, for {while_:.2f} m; "
                f"largest area {f.area.max():.2f} of the flat net"
            )
    caught = [f.captured for f in grid]
    print(
        f"  map: {caught.count(2)} of {len(grid)} embrace the ball, {caught.count(1)} for a while"
    )
    print(f"figures: {args.out}/deployment.png")


if __name__ == "__main__":
    main()
