"""Random scenes: each ends within its energy balance, or is refused or stopped by name before much is lost or gained.

    PYTHONPATH=build/python /usr/bin/python3 tests/yade/random_scenes.py [COUNT] [--first SEED] [--jobs N]

runs COUNT scenes, each in a process of its own, prints a line each and the counts at the end, and
returns 1 if any scene was silent, late, hanging or killed. --seed SEED runs one scene in this process.
"""

import math
import sys

import numpy as np

from outcomes import command, outcome, run  # first: sets the number of threads
import ancf
from yade import O, Vector3, utils

STEPS = 3000
TOLERANCE = dict(type=float, help="of the energy watch; inf: without it")


def pick(random, *choices):
    return choices[random.integers(len(choices))]


def span(random, low, high):
    """Evenly by its logarithm."""
    return float(math.exp(random.uniform(math.log(low), math.log(high))))


def turn(random):
    v = random.normal(size=3)
    return v / np.linalg.norm(v)


def addMaterial(random, label):
    O.materials.append(
        ancf.HollarsMat(
            label=label,
            young=span(random, 1e7, 1e10),
            poisson=0.3,
            density=span(random, 300, 5000),
            impactDamping=pick(random, 0.0, 0.1, 0.5),
            staticFriction=0.4,
            kineticFriction=0.3,
            transitionVelocity=span(random, 1e-4, 1e-1),
        )
    )


def addCable(random):
    """A net with bullets or a cable, half a metre wide, around the origin. Returns it."""
    common = dict(
        diameter=span(random, 5e-4, 5e-3),
        material="cable",
        damping=pick(random, 0.0, 0.0, 5e-5, 1e-3),
        mass=pick(random, "consistent", "lumped"),
        selfContact=bool(random.integers(2)),
        contact=pick(random, "curve", "points"),
    )
    if random.integers(4) == 0:
        common.update(model="springs", midPoints=int(random.integers(0, 4)))
    else:
        common.update(
            elements=int(random.integers(1, 4)),
            curvature=pick(random, "fast", "exact"),
            axialRule=pick(random, "exact", "reduced"),
        )
    if common.get("model") == "springs":
        common["mass"] = "consistent"
    if random.integers(2):
        net = ancf.Net.square(
            int(random.integers(2, 5)),
            0.12,
            normal=(0, 0, 1),
            fold=pick(random, None, 0.7),
            **common,
        )
        if random.integers(2):
            speed, angle = span(random, 0.1, 10), random.uniform(-0.5, 0.6)
            net.addBullets(span(random, 5e-3, 0.5), 0.01, speed, angle)
        return net
    n = int(random.integers(3, 9))
    points = np.column_stack(
        [np.linspace(-0.25, 0.25, n), 0.02 * random.normal(size=n), 0.02 * random.normal(size=n)]
    )
    cable = ancf.Cable(points, **common)
    return cable


def hold(random, cable):
    ends = getattr(cable, "corners", None) or [0, -1]
    for knot in ends:
        if getattr(cable, "_bulletsLater", None) is None and random.integers(2):
            cable.fix(knot)
    if random.integers(2):
        speed = span(random, 0.1, 10) * turn(random)
        cable.setVelocity(lambda p: speed)


def addBalls(random):
    """Balls and grains above the cable that fly towards it."""
    for _ in range(int(random.integers(1, 4))):
        small = random.integers(2)
        radius = span(random, 3e-3, 1e-2) if small else span(random, 0.02, 0.08)
        place = np.array([*random.uniform(-0.15, 0.15, 2), random.uniform(0.12, 0.3)])
        if any(
            np.linalg.norm(place - np.array(list(b.state.pos))) < 1.05 * (radius + b.shape.radius)
            for b in O.bodies
        ):
            continue
        body = utils.sphere(
            Vector3(*place), radius, material="ball", fixed=bool(random.integers(6) == 0)
        )
        aim = np.array([*random.uniform(-0.1, 0.1, 2), 0]) - place
        speed = span(random, 0.1, 20)
        if body.dynamic:
            body.state.vel = Vector3(*(speed * aim / np.linalg.norm(aim)))
            factor = span(random, 0.1, 10)
            body.state.mass *= factor
            body.state.inertia *= factor
        O.bodies.append(body)


def build(seed, tolerance=None):
    """The scene of a seed, in an empty O; tolerance: of the energy watch, None: as it is by default."""
    random = np.random.default_rng(seed)
    addMaterial(random, "cable")
    addMaterial(random, "ball")
    addBalls(random)
    if random.integers(2):
        O.bodies.append(utils.box((0, 0, -0.35), (1, 1, 0.05), fixed=True, material="ball"))
    cable = addCable(random)
    hold(random, cable)
    contact = dict(
        normal=pick(random, "nonlinear", "hertz"),
        friction=pick(random, "hollars", "coulomb", "none"),
    )
    gravity = pick(random, (0, 0, 0), (0, 0, -9.81))
    steps = pick(random, "auto", "auto", 2, 3)
    O.engines = ancf.engines(cable, gravity=gravity, contact=contact, substeps=steps)
    O.dt *= pick(random, 1, 0.5)
    if tolerance is not None:
        cable.engine.energyTolerance = tolerance


def scene(seed, steps=STEPS, tolerance=None):
    """One scene: (what became of it, worst share, what was told)."""
    return outcome(lambda: build(seed, tolerance), lambda _: run(steps))


if __name__ == "__main__":
    sys.exit(command(__doc__, scene, STEPS, tolerance=TOLERANCE))
