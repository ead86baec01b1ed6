"""Stress table: scenes at and beyond the edge of what a user may ask for, and what became of each.

    PYTHONPATH=build/python /usr/bin/python3 tests/yade/stress.py [--only WORD] [--short] [--jobs N] [--out FOLDER]

runs every scene in a process of its own, prints a line each and the table at the end, and writes both
to FOLDER: stress.csv, a row a subject, and stress-scenes.csv, a row a scene. Returns 1 if any scene was
silent, late, not finite, hanging or killed.
"""

import argparse
import collections
import csv
import itertools
import math
import os
import pathlib
import sys
from dataclasses import dataclass

import numpy as np

from outcomes import FAULTS, SOUND, each, outcome, run  # first: sets the number of threads
import ancf
from ancf import pulleys
from helpers import array, ball, material, momenta, plane
from yade import O, Vector3

OUT = pathlib.Path(__file__).resolve().parents[2] / "docs" / "images" / "robustness"
STEPS, SHORT = 3000, 600
SHORT_SCENES = 5  # of each row, at most
EXACT = 1e-9  # share of momenta that free motion may lose
SLOWEST = 600.0  # [s] a scene may take


@dataclass
class Row:
    """A subject: scenes of one builder, for every combination of its values.

    build(**values) sets up O and returns None, or what runs the scene in O for so many steps instead
    of outcomes.run.
    """

    subject: str
    build: object
    values: dict
    steps: int
    short: int  # steps of the short form
    meets: bool  # whether something must have touched when all steps are done

    def scenes(self, short):
        made = [dict(zip(self.values, v)) for v in itertools.product(*self.values.values())]
        if short and len(made) > SHORT_SCENES:
            picked = np.linspace(0, len(made) - 1, SHORT_SCENES)
            made = [made[round(i)] for i in picked]
        return made


ROWS = []


def row(subject, steps=STEPS, short=SHORT, meets=True, **values):
    def add(build):
        ROWS.append(Row(subject, build, values, steps, short, meets))
        return build

    return add


MODELS = {
    "consistent": dict(mass="consistent"),
    "lumped": dict(mass="lumped", elements=2),
    "springs": dict(model="springs", midPoints=2),
}


def net(model="lumped", meshes=3, **options):
    given = dict(diameter=1e-3, material="cable", normal=(0, 0, 1))
    return ancf.Net.square(meshes, 0.08, **{**given, **MODELS[model], **options})


def line(points=((-0.25, 0, 0), (0, 0, 0), (0.25, 0, 0)), elements=4, **options):
    given = dict(diameter=2e-3, material="cable")
    return ancf.Cable(points, elements, **{**given, **options})


def start(*structures, gravity=(0, 0, 0), **options):
    O.engines = ancf.engines(*structures, gravity=gravity, **options)


def thrown(number, velocity):
    O.bodies[number].state.vel = Vector3(*velocity)
    return number


def near(number, top, speed):
    """Puts a ball some steps above what it falls on from a height [m] and at a speed."""
    state, radius = O.bodies[number].state, O.bodies[number].shape.radius
    state.pos = Vector3(state.pos[0], state.pos[1], top + radius + 20.3 * speed * O.dt)
    state.vel = Vector3(0, 0, -speed)


# ---- the rows --------------------------------------------------------------------------------------


@row(
    "step from 0.5 to 3 times that of engines()",
    steps=6000,
    model=list(MODELS),
    substeps=[1, "auto"],
    factor=[0.5, 0.8, 1.0, 1.02, 1.05, 1.1, 1.2, 1.5, 2.0, 2.5, 3.0],
)
def longStep(model, substeps, factor):
    """A net with bullets flies into a free ball."""
    material("cable", impactDamping=0.2)
    ball((0.02, 0.01, 0.08), 0.04, mass=0.2, material="cable")
    flying = net(model)
    flying.addBullets(0.02, 0.008, 3, math.radians(20))
    start(flying, substeps=substeps)
    O.dt *= factor


@row(
    "bullets shot inwards, the net crumples on itself",
    steps=6000,
    meets=False,
    model=list(MODELS),
    angle=[-20, -50, -80],
    speed=[0.5, 3.0, 10.0],
)
def inwards(model, angle, speed):
    material("cable", impactDamping=0.1)
    flying = net(model, selfContact=True)
    flying.addBullets(0.02, 0.008, speed, math.radians(angle))
    start(flying)


@row(
    "a net falls on a floor edge first, and crumples",
    steps=12000,
    model=list(MODELS),
    diameter=[5e-4, 2e-3],
    damping=[0.0, 1e-4],
)
def heap(model, diameter, damping):
    material("cable", impactDamping=0.1)
    plane((0, 0, -0.17), (1, 1, 0.02), material="cable")
    falling = net(model, normal=(1, 0, 0.02), diameter=diameter, damping=damping, selfContact=True)
    falling.setVelocity(lambda p: (0, 0, -3))
    start(falling, gravity=(0, 0, -9.81))


@row(
    "EI = 0",
    meets=False,
    made=["net", "cable", "loop"],
    mass=["consistent", "lumped"],
    curvature=["fast", "exact"],
    integrator=["leapfrog", "implicit"],
)
def noBending(made, mass, curvature, integrator):
    """Hit by a ball where something may touch; waves of any length besides."""
    material("cable", impactDamping=0.1)
    free = integrator == "leapfrog"
    options = dict(bending=0, mass=mass, curvature=curvature, contactPoints=3 if free else 0)
    if made == "net":
        cable = net("consistent", elements=3, **options)
    elif made == "cable":
        cable = line(**options)
    else:
        turn = 2 * math.pi * np.arange(12) / 12
        cable = line(
            0.1 * np.column_stack([np.cos(turn), np.sin(turn), 0 * turn]), 2, closed=True, **options
        )
    if free:
        target = cable.knots[0]
        ball(target + [0, 0, 0.03], 0.02, mass=0.01, material="cable")
    cable.setVelocity(lambda p: (0, math.sin(40 * p[0]), 1 + math.sin(90 * p[1])))
    start(cable, integrator=integrator)


@row(
    "EA/EI from 1 to 1e12 /m2",
    ratio=[10.0**k for k in range(13)],
    mass=["consistent", "lumped"],
    curvature=["fast", "exact"],
)
def ratios(ratio, mass, curvature):
    """EA = 350 N. A ball hits the cable, which bends and stretches."""
    material("cable", impactDamping=0.1)
    cable = line(area=math.pi * 2.5e-7, bending=350 / ratio, mass=mass, curvature=curvature)
    cable.setVelocity(lambda p: (0.3 * math.sin(12 * p[0]), 0.5 * math.cos(12 * p[0]), 0))
    ball((0.03, 0, 0.03), 0.02, mass=0.01, material="cable")
    start(cable)
    near(0, cable.radius, 3.0)


@row(
    "bullets as heavy as the net to 1e4 times heavier",
    steps=6000,
    model=list(MODELS),
    ratio=[1.0, 1e2, 1e4],
    angle=[-30, 30],
)
def heavyBullets(model, ratio, angle):
    """In all; on a free ball in the way."""
    material("cable", impactDamping=0.1)
    ball((0.02, 0.01, 0.06), 0.03, mass=0.1, material="cable")
    flying = net(model)
    flying.addBullets(ratio * flying.mass / 4, 0.008, 3, math.radians(angle))
    start(flying)


@row(
    "grains as heavy as an element to 1e4 times lighter",
    model=list(MODELS),
    ratio=[1.0, 1e2, 1e4],
    speed=[0.1, 3.0],
    damping=[0.0, 0.3],
)
def lightGrains(model, ratio, speed, damping):
    """Four grains hit a net at rest: all energy is theirs."""
    material("cable", impactDamping=damping)
    hit = net(model, diameter=4e-3)
    mass = hit.mass / hit.elementCount / ratio
    for x, y in ((0.04, 0.001), (-0.04, 0.04), (0.0405, 0.0405), (0.0001, 0.12)):
        ball((x, y, 0.1), 0.005, mass=mass, material="cable")
    thrown(0, (0, 0, -speed))  # by which the step is found
    start(hit)
    for number in range(4):
        near(number, hit.radius, speed)


@row(
    "springs against a ball of 1e9 to 1e15 Pa",
    midPoints=[0, 3],
    young=[1e9, 1e12, 1e15],
    spring=[1e5, 1e8],
    speed=[0.5, 5.0],
)
def stiffBall(midPoints, young, spring, speed):
    material("cable", young=spring, impactDamping=0.1)
    material("ball", young=young, density=8000)
    ball((0.01, 0.02, 0.05), 0.04, material="ball")
    flying = net("springs", midPoints=midPoints)
    flying.setVelocity(lambda p: (0, 0, speed))
    start(flying)


@row(
    "transitionVelocity from 1 to 1e-9 m/s",
    steps=6000,
    transition=[10.0**-k for k in range(10)],
    friction=["hollars", "coulomb"],
    model=list(MODELS),
)
def creeping(transition, friction, model):
    """A net falls askew over a ball and slides off it."""
    material("cable", impactDamping=0.2, transitionVelocity=transition)
    ball((0.02, 0.01, -0.045), 0.04, material="cable")
    falling = net(model, damping=1e-5)
    falling.setVelocity(lambda p: (0.3, 0, -1))
    start(falling, gravity=(2, 0, -9.81), contact=dict(friction=friction))


@row(
    "overlap at the start, 0.01 to 1.9 of the smaller radius",
    meets=False,
    what=["ball", "grain", "cable", "floor"],
    held=[False, True],
    depth=[0.01, 0.05, 0.2, 0.4, 0.49, 0.51, 1.0, 1.9],
)
def overlap(what, held, depth):
    """What the overlap has stored is free to fly apart."""
    material("cable", impactDamping=0.1)
    cable, r = line(diameter=4e-3), 2e-3
    parts = [cable]
    if what == "floor":
        plane((0, 0, -0.05 - r + depth * r), (1, 1, 0.05), material="cable")
    elif what == "cable":
        parts.append(
            line([(0.01, -0.1, r * (2 - depth)), (0.01, 0.1, r * (2 - depth))], diameter=4e-3)
        )
        if held:
            parts[1].fix(0)
            parts[1].fix(-1)
    else:
        radius = {"ball": 0.03, "grain": 1e-3}[what]
        place = (0.03, 0, r + radius - depth * min(r, radius))
        ball(place, radius, mass=None if held else 2e3 * radius**3, material="cable")
    start(*parts)


@row(
    "debris that moves 0.1 to 100 of its radii in a step",
    steps=400,
    radius=[2e-3, 2e-2],
    model=["cable", "springs", "net"],
    ratio=[0.1, 0.5, 1.0, 2.0, 10.0, 100.0],
)
def fastDebris(radius, model, ratio):
    """Aimed at the cable, which it must not pass through unseen."""
    material("cable", impactDamping=0.1)
    if model == "net":
        cable, place = net("lumped", diameter=2e-3), (0.04, 0.043)
    else:
        options = MODELS["springs"] if model == "springs" else {}
        cable, place = line(elements=1 if options else 4, **options), (0.03, 0.0003)
    cable.append()
    number = ball((*place, 0.1), radius, mass=4e3 * radius**3, material="cable")
    start(cable)
    speed = ratio * radius / O.dt
    O.bodies[number].state.pos = Vector3(*place, radius + 3.3 * speed * O.dt + 1e-3)
    thrown(number, (0, 0, -speed))

    def ride(steps):
        end, share, told = run(steps, first=2)
        state = O.bodies[number].state
        if end == "sound" and state.pos[2] < 0 and state.vel[2] == -speed:
            return "silent", share, "passed through the cable"
        return end, share, told

    return ride


@row(
    "knots of 2 to 12 cables",
    count=list(range(2, 13)),
    model=list(MODELS),
    joined=["net", "tied"],
)
def knots(count, model, joined):
    """A star that a ball hits in its knot; the cables' ends fly free."""
    material("cable", impactDamping=0.1)
    turn = 2 * math.pi * np.arange(count) / count
    tips = 0.1 * np.column_stack([np.cos(turn), np.sin(turn), 0.1 * np.sin(3 * turn)])
    given = dict(diameter=1e-3, material="cable", **MODELS[model])
    if joined == "net":
        parts = [ancf.Net([(0, 0, 0), *tips], [(0, k + 1) for k in range(count)], **given)]
    else:
        parts = [ancf.Cable([(0, 0, 0), tip], **given) for tip in tips]
        for other in parts[1:]:
            other.tie(0, parts[0], 0)
    for part in parts:
        part.setVelocity(lambda p: (0, 10 * p[0], -3 + 10 * p[1]))
    ball((0.001, 0.002, -0.03), 0.02, mass=0.02, material="cable")
    start(*parts)


@row(
    "elements of 1:1 to 1:1000 length in one structure",
    made=["net", "chain"],
    model=list(MODELS),
    ratio=[1.0, 10.0, 100.0, 1000.0],
)
def lengths(made, model, ratio):
    material("cable", impactDamping=0.1)
    if made == "chain":
        steps = np.geomspace(0.2 / ratio, 0.2, 4)
        points = np.column_stack([np.cumsum([0, *steps, *steps[::-1]]), np.zeros(9), np.zeros(9)])
        cable = ancf.Cable(points, diameter=5e-4, material="cable", **MODELS[model])
    else:
        short = 0.2 / ratio
        points = [(0, 0, 0), (short, 0, 0), (0.2, 0.01, 0), (0, 0.2, 0), (short, 0.2, 0)]
        edges = [(0, 1), (1, 2), (0, 3), (3, 4), (1, 4)]
        cable = ancf.Net(points, edges, diameter=5e-4, material="cable", **MODELS[model])
    cable.append()
    number = ball(cable.knots[1] + [0, 0, 0.1], 0.01, mass=0.005, material="cable")
    cable.setVelocity(lambda p: (0, 3 * p[0], 0))
    start(cable)
    near(number, cable.radius, 2.0)


@row(
    "an end pulled at 0.1 to 5 times the speed of waves",
    meets=False,
    mass=["consistent", "lumped", "springs"],
    direction=["along", "across"],
    ratio=[0.1, 0.3, 0.6, 1.0, 2.0, 5.0],
    factor=[1.0, 0.1],
)
def supersonic(mass, direction, ratio, factor):
    """By a body that it follows; the other end is held. One step of the cable in O.dt, so that the
    force of each is read.
    """
    material("cable")
    given = MODELS[mass]
    cable = ancf.Cable(
        [(0.1 * k, 0, 0) for k in range(6)],
        diameter=1e-3,
        material="cable",
        contactPoints=0,
        **given,
    )
    cable.append()
    cable.fix(0)
    leader = ball((0.5, 0, 0), 1e-3, material="cable")
    cable.follow(-1, leader)
    speed = ratio * math.sqrt(cable.section.ea / cable.section.rhoA)
    way = Vector3(speed, 0, 0) if direction == "along" else Vector3(0, speed, 0)
    O.bodies[leader].state.vel = way
    start(cable, substeps=1)
    O.dt *= factor
    done, last = 0.0, None

    def work():
        """Of the body that leads: force times way, by the trapezoidal rule."""
        nonlocal done, last
        force = cable.reaction(-1)
        done += 0.0 if last is None else O.dt * way.dot(force + last) / 2
        last = force
        return done

    return lambda steps: run(steps, work, first=2)


DRIFT = "1e6 steps of free motion"


@row(
    DRIFT,
    steps=10**6,
    short=10**4,
    meets=False,
    what=["net", "net with bullets", "cable", "springs"],
)
def freeMotion(what):
    """What flies, turns and swings: no damping, nothing in the way."""
    material("cable")
    if what == "cable":
        flying = line(elements=8)
    else:
        flying = net("springs" if what == "springs" else "lumped")
    if what == "net with bullets":
        flying.addBullets(0.02, 0.008, 1, 0.3)
    else:
        flying.setVelocity(lambda p: (1 + 3 * p[1], 2 + math.sin(9 * p[0]), 3 * math.cos(7 * p[0])))
    start(flying)
    carried = {number: True for number in getattr(flying, "bullets", ())}

    def measured():
        return O.energy.total(), *(array(v) for v in momenta(flying.engine, carried))

    def ride(steps):
        O.step()
        energy, linear, angular = measured()
        mass = flying.mass + sum(O.bodies[number].state.mass for number in carried)
        momentum = math.sqrt(2 * energy * mass)  # at this energy, at the most
        spin = momentum * 0.2  # [m] from the middle to what is farthest, about
        worst, moved, turned = 0.0, 0.0, 0.0
        try:
            while O.iter < steps:
                O.run(steps // 100, True)
                e, p, h = measured()
                worst = max(worst, abs(e / energy - 1))
                moved = max(moved, np.linalg.norm(p - linear) / momentum)
                turned = max(turned, np.linalg.norm(h - angular) / spin)
        except RuntimeError as error:
            return "stopped by name", worst, " ".join(str(error).split())
        told = f"momentum {moved:.1e}; angular momentum {turned:.1e}"
        return ("sound" if worst < SOUND and moved + turned < EXACT else "silent"), worst, told

    return ride


@row(
    "sheaves of 1 to 1e-10 of a disc's inertia",
    short=200,
    factor=[10.0**-k for k in range(11)],
    transition=[1e-3, 1e-5],
)
def lightSheave(factor, transition):
    """Two weights on a cable over a sheave that they turn."""
    diameter, radius, span, weights = 2e-3, 0.05, 0.1, (1.0, 1.2)
    material(
        "cable",
        young=6e9,
        density=320,
        transitionVelocity=transition,
        normalStiffness=1e5,
        normalExponent=1.0,
        dashpot=0.3,
    )
    sheave = pulleys.sheave((0, 0, 0), radius, width=6 * diameter, material="cable")
    O.bodies[sheave].state.inertia *= factor
    at = radius + diameter / 2
    path = pulleys.Path([(sheave, 1)], diameter=diameter, start=(-at, 0, -span), end=(at, 0, -span))
    cable = pulleys.lay(
        path,
        20,
        diameter=diameter,
        material="cable",
        bending=0.0,
        mass="lumped",
        damping=1e-6,
        tension=9.81 * min(weights),
    )
    for knot, mass in zip((0, -1), weights):
        cable.carry(knot, ball(cable.knots[knot], 0.02, mass=mass, mask=2))
    turning = ancf.SheaveEngine()
    turning.add(sheave)
    O.engines = pulleys.engines(
        cable, turning, gravity=(0, 0, -9.81), contact=dict(normal="linear")
    )


# ---- the table -------------------------------------------------------------------------------------

ENDS = ("sound", "refused", "stopped by name", "stopped by the watch", *FAULTS)


def result(case):
    """(what became of a scene, worst share, what was told)."""
    one, values, steps = case
    end, share, told = outcome(
        lambda: one.build(**values), lambda ride: ride(steps) if ride else run(steps, first=2)
    )
    if end == "stopped by name" and O.iter == 0:
        end = "refused"
    if end == "sound" and one.meets and steps == one.steps and untouched():
        return "silent", share, "nothing touched"
    return end, share, told


def untouched():
    return all(e.maxPenetration == 0 for e in O.engines if isinstance(e, ancf.CableEngine))


def cases(short=False, only=""):
    return [
        (one, values, one.short if short else one.steps)
        for one in ROWS
        if only in one.subject
        for values in one.scenes(short)
    ]


def named(values):
    return ", ".join(
        f"{k} = {v:g}" if isinstance(v, float) else f"{k} = {v}" for k, v in values.items()
    )


def summary(done):
    """Rows of the table from (subject, scene, end, share, told)."""
    table = []
    for one in ROWS:
        mine = [d for d in done if d[0] == one.subject]
        if not mine:
            continue
        counts = collections.Counter(d[2] for d in mine)
        shares = {kind: [d[3] for d in mine if d[2] == kind] for kind in ENDS}
        stopped = shares["stopped by name"] + shares["stopped by the watch"]
        table.append(
            {
                "subject": one.subject,
                "scenes": len(mine),
                **{kind: counts[kind] for kind in ENDS},
                "worst of the sound": f"{max(shares['sound'], default=0):.1e}",
                "worst of the stopped": f"{max(stopped, default=0):.1e}",
            }
        )
    return table


def write(path, table):
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, table[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)


NAMES = ("subject", "scene", "end", "out of balance", "told")


def kept(path, subjects):
    """What was written before, but for these subjects."""
    if not path.exists():
        return []
    with open(path, newline="") as file:
        rows = [[row[name] for name in NAMES] for row in csv.DictReader(file)]
    return [(*row[:3], float(row[3]), row[4]) for row in rows if row[0] not in subjects]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument(
        "--only", default="", help="rows whose subject has this in it; others stay as they are"
    )
    parser.add_argument("--short", action="store_true", help="a few short scenes of each row")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--out", default=OUT, help="folder of the CSV files")
    args = parser.parse_args()
    done = []
    for (one, values, _), end, share, told in each(
        result, cases(args.short, args.only), args.jobs, SLOWEST
    ):
        done.append((one.subject, named(values), end, share, told))
        print(*done[-1][:3], f"{share:.1e}", told, sep=" | ", flush=True)
    folder = pathlib.Path(args.out)
    folder.mkdir(parents=True, exist_ok=True)
    if args.only:
        done += kept(folder / "stress-scenes.csv", {d[0] for d in done})
    done.sort(key=lambda d: [one.subject for one in ROWS].index(d[0]))
    table = summary(done)
    write(folder / "stress.csv", table)
    write(
        folder / "stress-scenes.csv",
        [dict(zip(NAMES, (*d[:3], f"{d[3]:.1e}", d[4]))) for d in done],
    )
    drift = [d for d in done if d[0] == DRIFT]
    if drift:
        rows = [(what, end, f"{share:.1e}", told) for _, what, end, share, told in drift]
        names = ("scene", "end", "energy", "momenta, or what was told")
        write(folder / "stress-drift.csv", [dict(zip(names, r)) for r in rows])
    for one in table:
        print(", ".join(f"{k} {v}" if i else v for i, (k, v) in enumerate(one.items()) if v))
    return int(any(d[2] in FAULTS for d in done))


if __name__ == "__main__":
    sys.exit(main())
