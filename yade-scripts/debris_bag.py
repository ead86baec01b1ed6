"""A cargo net full of stones: it holds them, drags them over the ground, and pours them out.

A square net hangs by its corners from a crane, and a few hundred stones and clumps of stones fall into it. At
rest the corners bear the weight of all. The crane lowers the net until it lies on the ground, drags it, and at
last lets two corners go and lifts the others. Run it by `/usr/bin/python3 debris_bag.py`; --help tells the
options. Results go to out/.
"""

import argparse
import sys

import numpy as np

import ancf
import grains
from yade import O, utils

# ---- parameters, SI units ----------------------------------------------------------------------
GRAVITY = 9.81
STONES = ("#8d8371", "#a79b85", "#746b5d")
MESHES, MESH = 22, 0.07  # a side; length of an edge [m]
SLACK = 0.6  # the corners are as far apart as 1/(1 + SLACK) of the net's side
CORD = 8e-3  # diameter [m]
CORD_YOUNG = 3e8  # braided polyamide [Pa]
CORD_DAMPING = 1e-5  # Kelvin-Voigt time [s]
HEIGHT = 1.5  # of the corners [m]
COUNT, RADIUS = 200, 0.05  # stones; [m]: a mesh of 70 mm passes a ball of 45 mm radius at most
STONE_YOUNG = 1e7  # far below that of rock, so that steps are long: they give way by 1 % [Pa]
STONE_DENSITY = 2600  # [kg/m3]
ALPHA = 0.5  # damping of impacts: half the speed is left at 1 m/s [s/m]
FRICTION, GROUND_FRICTION = 0.5, 0.3  # between stones and cords; of all on the ground
TRANSITION = 1e-3  # v_t0 [m/s]

SETTLING = 0.4  # NewtonIntegrator.damping while the net is filled, 0 afterwards
FILL, REST, HOLD = 1.8, 0.1, 0.3  # time damped, undamped, and measured at rest [s]
LOWER, DRAG, LIFT = 0.8, 0.75, 1.2  # speeds of the crane [m/s]
ON_GROUND = 0.1  # the crane goes on down for so far once the net touches the ground [m]
DRAG_TIME, LIFT_TIME = 0.8, 1.2  # [s]
QUICK_HEIGHT, QUICK_TIME = 0.8, 0.5  # of the small net; part of DRAG_TIME and LIFT_TIME


def build(quick=False):
    """The scene at its start: (net, crane, stones, ground)."""
    O.reset()
    for label, young, density, friction in (
        ("cord", CORD_YOUNG, 1140, FRICTION),
        ("stone", STONE_YOUNG, STONE_DENSITY, FRICTION),
        ("ground", STONE_YOUNG, STONE_DENSITY, GROUND_FRICTION),
    ):
        O.materials.append(
            ancf.HollarsMat(
                label=label,
                young=young,
                poisson=0.25,
                density=density,
                staticFriction=friction,
                kineticFriction=friction,
                transitionVelocity=TRANSITION,
                impactDamping=ALPHA,
            )
        )
    meshes, height = (12, QUICK_HEIGHT) if quick else (MESHES, HEIGHT)
    net = ancf.Net.square(
        meshes,
        MESH / (1 + SLACK),
        slack=SLACK,
        diameter=CORD,
        material="cord",
        model="springs",  # edges are short against what they would bend to
        damping=CORD_DAMPING,
        center=(0, 0, height),
        normal=(0, 0, 1),
    )
    crane = grains.Crane(net, net.corners)
    ground = utils.box((1, 0, -0.05), (4, 2, 0.05), material="ground", fixed=True)
    ground = O.bodies.append(ground)
    O.engines = ancf.engines(net, gravity=(0, 0, -GRAVITY))
    net.relax(1e-4)
    count, side = (24, 2) if quick else (COUNT, 5)
    half = 1.3 * RADIUS * side
    below = net.knots[(np.abs(net.knots[:, :2]) < half + MESH).all(axis=1), 2].max()
    stones = grains.pile(count, RADIUS, below, side, "stone")
    O.dt = ancf.timeStep(speed=2.0)
    ancf.check()
    return net, crane, stones, ground


class Bag:
    """One run and what is measured in it."""

    def __init__(self, quick=False, pictures=False):
        self.net, self.crane, self.stones, self.ground = build(quick)
        self.mass = grains.mass(self.stones) + self.net.mass
        self.weight = GRAVITY * self.mass
        self.part = QUICK_TIME if quick else 1.0
        self.time, self.forces, self.frames = [], [], {}
        self.pictures = pictures

    def phase(self, name, duration, until=lambda: False):
        """Runs for a time [s], or until something has happened; keeps the forces of each step."""
        for _ in ancf.progress(duration, O.dt, name):
            self.crane.count()
            self.time.append(O.time)
            self.forces.append([*self.crane.force(), *grains.force(self.ground)])
            if until():
                break
        if self.pictures:
            from ancf.render import Frame

            colors = {i: STONES[k % len(STONES)] for k, i in enumerate(self.stones)}
            self.frames[name] = Frame([self.net], colors)

    def mean(self, since):
        """Mean force of the crane (3) and on the ground (3) since a time [s], [N]."""
        some = np.array(self.forces)[np.array(self.time) > since + 0.5 * O.dt]
        return some[:, :3].mean(axis=0), some[:, 3:].mean(axis=0)

    def momentum(self):
        """Of stones and net (3) [kg m/s]."""
        states = [O.bodies[i].state for i in self.stones]
        moved = sum(s.mass * np.array(list(s.vel)) for s in states)
        return moved + np.array(list(self.net.engine.momentum()[0]))

    def inside(self):
        """Stones within the box that the net fills, wider by a radius."""
        p, knots = grains.places(self.stones), self.net.knots
        low, high = knots.min(axis=0) - RADIUS, knots.max(axis=0) + RADIUS
        return int(((p > low) & (p < high)).all(axis=1).sum())

    def touches(self):
        """Whether the net has come down to the ground."""
        return self.net.knots[:, 2].min() < CORD

    def hold(self):
        """Fills the net. Returns the mean force of the crane at rest (3) [N]."""
        with grains.damped(SETTLING):
            self.phase("fill", FILL)
        O.trackEnergy = True
        O.step()
        self.energy = O.energy.total()
        self.phase("rest", REST)
        since = O.time
        self.phase("hold", HOLD)
        return self.mean(since)[0]

    def drag(self):
        """Lowers and drags the net. Returns the mean force on the ground (3) [N], and what the impulse of
        all forces is off by (3) [N s].
        """
        self.crane.move((0, 0, -LOWER))
        self.phase("lower", 2.0, self.touches)
        self.phase("sink", ON_GROUND / LOWER)
        self.crane.move((DRAG, 0, 0))
        since, before = O.time, self.momentum()
        self.phase("drag", self.part * DRAG_TIME)
        crane, ground = self.mean(since)
        force = crane - ground - [0, 0, self.weight]
        return ground, force * (O.time - since) - (self.momentum() - before)

    def pour(self):
        """Lets the front corners go and lifts the others."""
        x = self.net.knots[self.net.corners, 0]
        self.crane.letGo([k for k, ahead in zip(self.net.corners, x > x.mean()) if ahead])
        self.crane.move((0, 0, LIFT))
        self.phase("pour", self.part * LIFT_TIME)

    def closing(self):
        """What energy is off by, as part of all that gravity and the crane have done."""
        gained = O.energy.total() - self.energy
        return (gained - self.crane.work) / (abs(O.energy["gravWork"]) + abs(self.crane.work))


def picture(bag, path):
    from ancf.render import View, sheet

    shown = [name for name in ("hold", "drag", "pour") if name in bag.frames]
    sheet(path, [[bag.frames[name] for name in shown]], View((-0.5, 0.8, -0.25)), shown)


def plot(bag, path):
    from ancf.plots import plt

    figure, ax = plt.subplots(figsize=(8, 3.6), constrained_layout=True)
    force, every = np.array(bag.forces), max(1, round(5e-3 / O.dt))
    kernel = np.ones(every) / every  # means of 5 ms
    for column, sign, label in ((2, 1, "crane, up"), (5, -1, "ground, up"), (0, 1, "crane, along")):
        ax.plot(bag.time, sign * np.convolve(force[:, column], kernel, "same"), lw=1, label=label)
    ax.axhline(bag.weight, color="k", lw=0.8, ls=":", label="weight of net and stones")
    ax.set_xlabel("time [s]")
    ax.set_ylabel("force [N]")
    ax.set_ylim(-0.3 * bag.weight, 2 * bag.weight)
    ax.legend(fontsize=8)
    ax.grid(alpha=0.3)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def study(quick=False, pictures=False):
    """Runs all; returns the Bag and its Summary."""
    bag, out = Bag(quick, pictures), grains.Summary()
    cost, count = grains.Cost(), len(bag.stones)
    up = bag.hold()
    print(
        f"{count} stones of {bag.mass - bag.net.mass:.0f} kg in a net of {bag.net.elementCount} cords"
    )
    out.tell("crane at rest, over the weight", up[2] / bag.weight, least=0.995, most=1.005)
    out.tell("crane at rest, aside, over the weight", np.hypot(*up[:2]) / bag.weight, most=0.01)
    out.tell("stones in the net at rest", bag.inside(), least=count)
    ground, off = bag.drag()
    impulse = bag.weight * bag.part * DRAG_TIME
    out.tell("stones in the net after dragging", bag.inside(), least=count)
    out.tell("ground, mean friction over pressure", -ground[0] / ground[2], most=GROUND_FRICTION)
    out.tell("impulse against momentum, off by", np.abs(off).max() / impulse, most=0.01)
    bag.pour()
    out.tell("stones in the net after pouring", bag.inside(), most=0.1 * count)
    out.tell("energy, off by", bag.closing(), least=-0.01, most=0.01)
    cost.stop().report()
    return bag, out


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="smaller and shorter")
    args = grains.options(parser)
    bag, out = study(args.quick, not args.no_pictures)
    if not args.no_pictures:
        picture(bag, args.out / "debris_bag.png")
        plot(bag, args.out / "debris_bag_forces.png")
    return out.code


if __name__ == "__main__":
    sys.exit(main())
