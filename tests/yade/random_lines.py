"""Random scenes of lines through rings: each keeps its energy and momentum, or is refused or stopped by name.

    PYTHONPATH=build/python /usr/bin/python3 tests/yade/random_lines.py [COUNT] [--first SEED] [--jobs N]

runs COUNT scenes, each in a process of its own, prints a line each and the counts at the end, and
returns 1 if any scene was silent, late, hanging or killed. --seed SEED runs one scene in this process.
"""

import math
import sys

import numpy as np

from outcomes import LATE, SOUND, command, outcome, rounding  # first: sets the number of threads
from random_scenes import pick, span, turn
import ancf
from yade import O, Vector3, utils

STEPS = 2000
STORED = ("kinetic", "cableKinetic", "cableElastic", "lineElastic")


def addBody(random, place):
    """A ball, a box or a clump, free, or held now and then; returns its id."""
    mass, kind = span(random, 0.01, 2), random.integers(3)
    if kind == 2:
        parts = [
            utils.sphere(Vector3(*(place + [0, 0, z])), 0.02, material="cord") for z in (0, 0.05)
        ]
        clump, members = O.bodies.appendClumped(parts)
        number = members[random.integers(2)]
        moved = O.bodies[clump]
    else:
        body = (
            utils.sphere(Vector3(*place), 0.02, material="cord")
            if kind
            else utils.box(Vector3(*place), (0.03, 0.02, 0.04), material="cord")
        )
        number = O.bodies.append(body)
        moved = O.bodies[number]
    moved.state.mass = mass
    moved.state.inertia = (
        mass * Vector3(1, 1, 1) * 5e-4
    )  # YADE's kinetic energy knows no other that turn
    for b in O.bodies:
        if b.id >= min(number, moved.id):
            b.groupMask = 2 ** (b.id % 30)  # nothing touches
    if random.integers(4) == 0:
        moved.state.blockedDOFs = "xyzXYZ"
    else:
        moved.state.vel = Vector3(*(span(random, 0.01, 3) * turn(random)))
        if kind != 2:
            spin = Vector3(*(span(random, 0.1, 10) * turn(random)))
            moved.state.angVel = spin
            moved.state.angMom = Vector3(*(moved.state.inertia[i] * spin[i] for i in range(3)))
    return number


def addCable(random, i):
    """A cable that touches nothing, with a body carried at a knot or fixed there now and then."""
    n = int(random.integers(2, 6))
    points = np.array([0, 0, float(i)]) + np.column_stack(
        [np.linspace(0, 1, n), 0.05 * random.normal(size=n), 0.05 * random.normal(size=n)]
    )
    common = dict(
        diameter=span(random, 1e-3, 4e-3),
        material="cord",
        damping=pick(random, 0.0, 0.0, 1e-4),
        contactPoints=0,
        label=f"cable {i}",
    )
    springs = random.integers(3) == 0
    if springs:
        cable = ancf.Cable(points, model="springs", **common)
    else:
        cable = ancf.Cable(
            points, int(random.integers(1, 3)), mass=pick(random, "consistent", "lumped"), **common
        )
    if random.integers(2):
        cable.fix(pick(random, 0, -1))
    elif random.integers(3) == 0 and not springs:
        cable.clamp(0)
    if random.integers(3) == 0:
        cable.append()
        ball = O.bodies.append(
            utils.sphere(Vector3(*points[-1 if n < 3 else 1]), 0.02, material="cord")
        )
        O.bodies[ball].state.mass = span(random, 0.01, 1)
        O.bodies[ball].groupMask = 2 ** (ball % 30)
        try:
            cable.carry(-1 if n < 3 else 1, ball)
        except ValueError:  # it is fixed there
            O.bodies.erase(ball)
    if random.integers(2):
        speed = span(random, 0.01, 3) * turn(random)
        cable.setVelocity(lambda p: speed)
    return cable


def place(random, cables, bodies):
    if bodies and random.integers(3) == 0:
        body = pick(random, *bodies)
        return pick(random, body, (body, 0.02 * random.normal(size=3)))
    cable = pick(random, *cables)
    return cable, int(random.integers(len(cable.knots)))


def winch(random, line, end):
    """One of what a winch can be told; numbers of the size of the line's own."""
    scale = 2e-3 * line.engine.ea
    force = span(random, 0.01, 1) * scale
    brake = pick(random, math.inf, span(random, 1, 5) * force)
    kind = random.integers(6)
    if line.length < 1.1 * len(line.places) * line.engine.ringRadius:
        return  # nothing to draw in
    if kind == 0:
        line.haul(span(random, 0.01, 5), force, brake=brake, end=end)
    elif kind == 1:
        rate, size = span(random, 5, 500), span(random, 0.01, 2)
        line.haul(lambda t: size * math.sin(rate * t), force, brake=brake, end=end)
    elif kind == 2:
        line.payOut(span(random, 0.01, 2), brake=brake, end=end)
    elif kind == 3:
        line.hold(brake=brake, end=end)


def build(seed):
    """The scene of a seed, in an empty O. Returns its lines and what changes their winches later."""
    random = np.random.default_rng(seed)
    O.materials.append(
        ancf.HollarsMat(label="cord", young=span(random, 1e8, 3e9), poisson=0.3, density=1100)
    )
    bodies = [
        addBody(random, np.array([2.0 + i, 1, 0]) + 0.1 * random.normal(size=3))
        for i in range(random.integers(4))
    ]
    cables = [addCable(random, i) for i in range(random.integers(1, 4))]
    steps = pick(random, "auto", "auto", 1, 2, 3)
    for cable in cables:
        if not cable.appended:
            if random.integers(2) and cable is not cables[0] and cables[0].appended:
                cable.append(engine=cables[0].engine)
            else:
                cable.append()
    lines = []
    for i in range(random.integers(1, 4)):
        places = [place(random, cables, bodies)]
        more = random.integers(1, 8)
        while len(places) < 1 + more:
            another = place(random, cables, bodies)
            if str(another) != str(places[-1]):
                places.append(another)
        n = len(places) - 2
        lines.append(
            ancf.Line(
                places,
                diameter=span(random, 5e-4, 3e-3),
                material="cord",
                friction=pick(random, 0.0, random.uniform(0, 0.6), list(random.uniform(0, 1, n))),
                ringRadius=span(random, 5e-3, 0.1),
                label=f"line {i}",
                **pick(random, {}, {"slack": 0.05}, {"tension": span(random, 0.1, 20)}),
            )
        )
    gravity = pick(random, (0, 0, 0), (0, 0, -9.81))
    O.engines = ancf.engines(*cables, *lines, gravity=gravity, substeps=steps)
    O.dt *= pick(random, 1, 0.5)
    for line in lines:
        for end in (0, -1):
            winch(random, line, end)
    return lines, random, gravity


def momentum():
    """Linear and angular about the origin, of cables, bodies that they carry, and others."""
    carried = set()
    sums = np.zeros((2, 3))
    for engine in ancf.structure.cableEngines():
        linear, angular = engine.momentum()
        sums += [list(linear), list(angular)]
        carried |= {i for i in engine.carryIds}
    for b in O.bodies:
        if b.isClumpMember or b.id in carried or not b.state.mass:
            continue
        s = b.state
        turning = s.ori.conjugate() * s.angVel
        spin = s.ori * Vector3(*(s.inertia[i] * turning[i] for i in range(3)))
        sums += [list(s.mass * s.vel), list(spin + s.mass * s.pos.cross(s.vel))]
    return sums


def held():
    """Whether anything is held, so that momentum is not kept."""
    engines = ancf.structure.cableEngines()
    return any(e.fixedNodes or e.clampedEnds for e in engines) or any(
        b.state.blockedDOFs == "xyzXYZ" for b in O.bodies if not b.isClumpMember
    )


def drift():
    """As driftOfYade, of clumps too."""
    mass = sum(b.state.mass for b in O.bodies if not b.isClumpMember and b.state.blockedDOFs == "")
    carried = sum(O.bodies[i].state.mass for e in ancf.structure.cableEngines() for i in e.carryIds)
    return (mass - carried) * O.engines[-1].gravity.squaredNorm() * O.dt**2 / 2


def ride(built, steps):
    lines, random, gravity = built
    start, most, share, worst = None, rounding(), 0.0, 0.0
    free = gravity == (0, 0, 0) and not held()
    before, large = None, 0.0
    rest = drift()
    try:
        while O.iter < steps:
            if O.iter in (steps // 3, 2 * steps // 3):
                winch(random, pick(random, *lines), pick(random, 0, -1))
            O.step()
            if O.iter % 10 and start is not None:
                continue
            items = dict(O.energy.items())
            now = sum(items.values()) + O.iter * rest
            known = sum(items.get(name, 0.0) for name in STORED)
            most = max(
                most, known + abs(items.get("winchWork", 0.0)) + items.get("lineFriction", 0.0)
            )
            start = now if start is None else start
            if not math.isfinite(now):
                return "not finite", math.inf, f"iteration {O.iter}"
            share = abs(now - start) / most
            worst = max(worst, share)
            if free:
                sums = momentum()
                before = sums if before is None else before
                large = max(large, math.sqrt(most))
                if np.abs(sums - before)[0].max() > 1e-9 * large:
                    return "silent", worst, f"momentum {sums[0] - before[0]} at {O.iter}"
    except (RuntimeError, ValueError) as error:
        told = " ".join(str(error).split())
        kind = "stopped by the watch" if "out of balance" in told else "stopped by name"
        return (kind if share < LATE else "late"), worst, told
    unsettled = sum(line.engine.unsettled for line in lines)
    return (
        ("sound" if share < SOUND else "silent"),
        worst,
        f"unsettled {unsettled}" * bool(unsettled),
    )


def scene(seed, steps=STEPS):
    """One scene: (what became of it, worst share, what was told)."""
    return outcome(lambda: build(seed), lambda built: ride(built, steps))


if __name__ == "__main__":
    sys.exit(command(__doc__, scene, STEPS))
