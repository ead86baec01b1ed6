"""A ball walks over a hanging bridge of ropes: what either end bears, against the lever rule.

The bridge is a net between two rows of fixed knots, and the ball turns at a constant speed, as a driven wheel:
friction on the ropes takes it along. Run it by `/usr/bin/python3 bridge.py`; --help tells the options. Results go
to out/.
"""

import argparse
import sys

import numpy as np

import ancf
import grains
from yade import O, utils

# ---- parameters, SI units ----------------------------------------------------------------------
GRAVITY = 9.81
LONG, WIDE, MESH = 30, 4, 0.1  # meshes along and across, [m]
SLACK = 0.01  # of the ropes along at either side; those between hang lower, and keep the ball
TROUGH, ACROSS = 0.03, 0.08  # more slack between, slack of ropes across
ROPE = 6e-3  # diameter [m]
ROPE_YOUNG, ROPE_DENSITY = 1e9, 1100  # polyamide [Pa], [kg/m3]
ROPE_DAMPING = 1e-5  # Kelvin-Voigt time [s]
RADIUS = 0.12  # of the ball [m]
STATIC, KINETIC = 0.6, 0.5
START, SPEED = 0.5, 0.8  # of the ball along, [m] and [m/s]
REST = 1.0  # time that it takes to come to rest, damped [s]
SETTLING = 0.4  # NewtonIntegrator.damping meanwhile
END, QUICK_END = 2.4, 1.1  # the run ends when the ball is there [m]
MEAN = 0.1  # time over which forces are averaged: ropes ring meanwhile [s]


def build():
    """The scene at its start: (bridge, ball)."""
    O.reset()
    rope = ancf.HollarsMat(
        label="rope",
        young=ROPE_YOUNG,
        density=ROPE_DENSITY,
        staticFriction=STATIC,
        kineticFriction=KINETIC,
    )
    O.materials.append(rope)
    n, w = LONG + 1, WIDE + 1
    points = [(MESH * i, MESH * (j - WIDE / 2), 0) for i in range(n) for j in range(w)]
    along = [(w * i + j, w * i + j + w) for i in range(LONG) for j in range(w)]
    across = [(w * i + j, w * i + j + 1) for i in range(n) for j in range(WIDE)]
    slack = [SLACK + TROUGH * (0 < a % w < WIDE) for a, _ in along] + [ACROSS] * len(across)
    bridge = ancf.Net(
        points,
        along + across,
        slack=slack,
        diameter=ROPE,
        material="rope",
        damping=ROPE_DAMPING,
        mass="lumped",
    )
    for knot in range(w):
        bridge.fix(knot)
        bridge.fix(-1 - knot)
    O.engines = ancf.engines(bridge, gravity=(0, 0, -GRAVITY))
    bridge.relax(1e-5)
    near = bridge.knots[np.abs(bridge.knots[:, 0] - START) < RADIUS]
    ball = utils.sphere((START, 0, near[:, 2].max() + RADIUS + ROPE), RADIUS, material="rope")
    ball.state.blockedDOFs = "XYZ"  # it turns as it is told
    ball = O.bodies.append(ball)
    O.dt = ancf.timeStep()
    ancf.check()
    return bridge, ball


class Walk:
    """One run and what is measured in it; forces are means over MEAN."""

    def __init__(self, pictures=False):
        self.bridge, self.ball = build()
        self.state = O.bodies[self.ball].state
        self.place, self.ends, self.work, self.film = [], [], 0.0, None
        self.motor = 0.0
        if pictures:
            from ancf.render import Film

            self.film = Film([self.bridge], {self.ball: "#c9a227"})

    def held(self):
        """What either end bears (2, 3) [N]."""
        rows = range(WIDE + 1)
        near, far = rows, [-1 - k for k in rows]
        return np.array([grains.held(self.bridge, near), grains.held(self.bridge, far)])

    def run(self, end):
        with grains.damped(SETTLING):
            for _ in ancf.progress(REST, REST, "rest"):
                pass
        self.state.angVel = (0, SPEED / RADIUS, 0)
        O.trackEnergy = True
        O.step()
        self.energy = O.energy.total()
        every = round(MEAN / O.dt)
        while self.state.pos[0] < end and O.time < REST + 3 * end / SPEED:
            places, ends = [], []
            for _ in range(every):
                O.step()
                self.motor -= O.dt * O.forces.t(self.ball)[1] * SPEED / RADIUS
                places.append(list(self.state.pos))
                ends.append(self.held())
            self.place.append(np.mean(places, axis=0))
            self.ends.append(np.mean(ends, axis=0))
            if self.film:
                self.film.take()
        return self

    def lever(self):
        """What the far end bears by the lever rule, from the ball's places (n) [N]."""
        x, length = np.array(self.place)[:, 0], LONG * MESH
        return GRAVITY * (self.bridge.mass / 2 + self.state.mass * x / length)


def study(quick=False, pictures=False):
    """Runs it; returns Walk and its Summary."""
    walk, out = Walk(pictures), grains.Summary()
    cost = grains.Cost()
    end = QUICK_END if quick else END
    walk.run(end)
    cost.stop()
    weight = GRAVITY * (walk.bridge.mass + walk.state.mass)
    up = np.array(walk.ends)[:, :, 2]
    both = up.sum(axis=1)
    out.tell("the ball is at", walk.state.pos[0], "m", least=end)
    out.tell("both ends, mean over the weight", both.mean() / weight, least=0.97, most=1.03)
    off = (up[:, 1] - walk.lever()) / weight
    out.tell("far end against the lever rule, mean", off.mean(), least=-0.03, most=0.03)
    gained = O.energy.total() - walk.energy
    out.tell("work of the ball's drive", walk.motor, "J")
    out.tell("energy, off by", (gained - walk.motor) / walk.motor, least=-0.02, most=0.02)
    cost.report()
    return walk, out


def plot(walk, path):
    from ancf.plots import plt

    x, ends = np.array(walk.place)[:, 0], np.array(walk.ends)[:, :, 2]
    weight = GRAVITY * (walk.bridge.mass + walk.state.mass)
    figure, ax = plt.subplots(figsize=(6, 3.6), constrained_layout=True)
    ax.plot(x, ends[:, 0], "o", ms=3, label="near end")
    ax.plot(x, ends[:, 1], "o", ms=3, label="far end")
    ax.plot(x, walk.lever(), "k", lw=0.8, label="lever rule")
    ax.plot(x, weight - walk.lever(), "k", lw=0.8)
    ax.set_xlabel("place of the ball [m]")
    ax.set_ylabel("held up by [N]")
    ax.legend(fontsize=8)
    ax.grid(alpha=0.3)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="smaller and shorter")
    args = grains.options(parser)
    walk, out = study(args.quick, not args.no_pictures)
    if walk.film:
        from ancf.render import View

        frames = walk.film.frames
        times = [frames[k * (len(frames) - 1) // 2].time for k in range(3)]
        walk.film.strip(args.out / "bridge.png", times, View((-0.35, 0.85, -0.4)))
        plot(walk, args.out / "bridge_ends.png")
    return out.code


if __name__ == "__main__":
    sys.exit(main())
