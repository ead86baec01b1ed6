"""Hostile values in attributes and methods: refused by name, never a signal, a hang or silence.

Each value goes into a fork of one scene that runs. By command line many more, at random:
    python3 tests/yade/test_hostile.py --count 10000 --seed 1
"""

import argparse
import collections
import os
import random
import re
import sys
import time

import numpy as np
import pytest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import ancf
from ancf import pulleys
import forks
from helpers import ball, bodyEngines, material, plane, steps
from yade import O, Vector3, utils, wrapper

NAN, INF, HUGE, MOST = float("nan"), float("inf"), 1e300, 2**31 - 1
BALL, CARRIED, LEADER, SHEAVE, SLIDER = range(4, 9)  # bodies; before them the elements
STEPS = 12  # after a value is in: what is not finite is told within ten


# ---- the scene -------------------------------------------------------------------------------------


def build():
    """A cable that is fixed, led, loaded, clamped and tied, carries a ball and lies on another; a
    sheave and a slider that are driven.
    """
    O.reset()
    material("cable")
    given = dict(diameter=2e-3, material="cable", damping=1e-5)
    first = ancf.Cable([(0, 0, 0), (0.5, 0, 0), (1, 0, 0)], 1, **given)
    second = ancf.Cable([(1, 0, 0), (1.5, 0, 0), (2, 0, 0)], 1, **given)
    first.append()
    second.append(engine=first.engine)
    first.fix(0)
    first.clamp(0)
    first.load(1, (0, 0, 0.01))
    over = ball((0.25, 0, 0.01095), 0.01, mass=1e-3, material="cable")
    carried = ball((1.5, 0, 0), 0.01, mass=1e-2, material="cable")
    leader = ball((2, 0, 0), 0.01, material="cable", mask=2)
    second.carry(1, carried)
    second.clamp(2, leader)
    second.tie(0, first, 2)
    sheave = pulleys.sheave((0, 0, -2), 0.05, axis=(0, 1, 0), width=0.01, material="cable")
    slider = ball((0, 1, 0), 0.01, mass=0.1, material="cable", mask=4)
    turning, guide = ancf.SheaveEngine(), ancf.GuideEngine()
    turning.add(sheave, viscous=1e-3, dry=1e-4, torque=1e-3)
    guide.add(slider, (1, 0, 0), friction=0.1, lower=-1, upper=1)
    assert (over, carried, leader, sheave, slider) == (BALL, CARRIED, LEADER, SHEAVE, SLIDER)
    line = ancf.Line(
        [(first, 0), (second, 1), (carried, (0, 0, 0.01))],
        diameter=1e-3,
        material="cable",
        friction=0.1,
        tension=0.01,
    )
    O.engines = pulleys.engines(first, second, line, turning, guide, gravity=(0, 0, -1))
    O.dt *= 0.5
    steps(3)
    engine = first.engine
    assert engine.contacts > 0 and engine.tiedNodes and engine.carryIds and engine.followIds


def the(kind):
    """The engine of a class in O.engines."""
    return next(e for e in O.engines if type(e).__name__ == kind)


def contact():
    """The interaction of a cable with the ball on it."""
    return next(i for i in O.interactions if isinstance(i.geom, wrapper.CableGeom))


def state():
    """What moves, as bytes."""
    places = [[*b.state.pos, *b.state.vel] for b in O.bodies if b and b.id >= BALL]
    engine = the("CableEngine")
    return np.concatenate([np.ravel(places), engine.position, engine.velocity])


def read():
    """Everything that reads the engines' lists."""
    engine, line = the("CableEngine"), the("LineEngine")
    turning, guide = the("SheaveEngine"), the("GuideEngine")
    for call in (
        line.ways,
        line.points,
        line.criticalTimeStep,
        lambda: line.doing(0),
        lambda: [line.elastic, line.wholeLength],
        lambda: [engine.tied(i) for i in range(6)],
        lambda: engine.elementsAt(1),
        lambda: engine.reaction(0),
        lambda: engine.point(3, 0.5),
        lambda: engine.tension(3, 0.5),
        lambda: engine.energy(0, 4),
        lambda: engine.state(0, 6, 0, 4),
        engine.momentum,
        engine.criticalTimeStep,
        lambda: engine.overlaps(0.1),
        lambda: (engine.stride, engine.asleep, engine.coupled, engine.nElements),
        lambda: [turning.number(i) for i in turning.ids],
        lambda: [guide.position(i) for i in guide.ids],
        ancf.check,
        ancf.timeStep,
    ):
        try:
            call()
        except Exception:  # refused again: all the better
            pass


# ---- in a fork -------------------------------------------------------------------------------------


def forked(act):
    """What `act` ends in, in a fork of this process: 'signal', 'hang', 'ran' (text: 'same' if the
    steps after it were as without), 'not finite', or the name of an exception; and its text.
    """
    return forks.forked(lambda: outcome(act))


def outcome(act):
    told = []
    for call in (act, lambda: steps(STEPS), read, lambda: steps(1)):
        try:
            call()
        except Exception as error:  # what was refused must be safe to go on with
            told.append((type(error).__name__, str(error)))
    if told:
        return told[0]
    if not np.isfinite(state()).all():
        return "not finite", ""
    return "ran", "same" if state().tobytes() == SAME else "other"


SAME = None


def ready():
    """Builds the scene, and runs a fork of it with no harm done, to compare with."""
    global SAME
    build()
    reader, writer = os.pipe()
    if os.fork() == 0:
        steps(STEPS)
        read()
        steps(1)
        os.write(writer, state().tobytes())
        os._exit(0)
    os.close(writer)
    SAME = os.read(reader, 65536)
    os.close(reader)
    os.wait()
    assert forked(lambda: None) == ("ran", "same")


@pytest.fixture(scope="module", autouse=True)
def theScene():
    ready()
    yield
    O.reset()


# ---- attributes ------------------------------------------------------------------------------------

# What an engine only tells of its last step; or what it takes to be anew.
TOLD = (
    "rejectedSteps newtonIterations stepParts contacts contactSteps sweeps normalLeft frictionLeft frictionUnsolved "
    "acceleration dead ompThreads label timingDeltas execTime execCount sleep family carryReaction record"
).split()

SCALARS = {
    "integrator": ["euler", ""],
    "normal": ["soft", "Hertz"],
    "friction": ["viscous"],
    "spectralRadius": [NAN, -0.1, 1.5, INF],
    "substeps": [-1, 1001, 10**7, MOST],
    "nNodes": [-1, 0, 5, 7, MOST],
    "lastStep": [NAN, -1.0, INF],
    "gravity": [Vector3(0, NAN, 0), Vector3(0, 0, HUGE)],
    "twistLeft": [Vector3(0, NAN, 0)],
    "maxPenetration": [NAN],
}

SPECIAL = {  # lists: one bad value in place of the last
    "kind": [32, 64, 2**30, -1, 1],
    "length": [0.0, -1.0, 1e-300],
    "ea": [0.0, -1.0],
    "ei": [-1.0],
    "rhoA": [0.0, -1.0, 1e-300],
    "kelvinVoigt": [-1.0],
    "massDamping": [-1.0],
    "radius": [0.0, -1.0, 5e-3],
    "segments": [0, 65, 1000],
    "points": [2, 7],
    "structure": [-1, 4],
    "selfContact": [-1, 2],
    "run": [-1, 4, 10**6],
    "arc": [-1.0],
    "closed": [-1.0],
    "ends": [-1, 6, 4, 3],
    "next": [0, 4, -2],
    "elementIds": [-2, 0, 4, 99],
    "fixedNodes": [-5, 6, 3],
    "clampedEnds": [8, 10**6],
    "followNodes": [0, 6],
    "followIds": [-1, 99, 0, 5],
    "followEnds": [0, 8, 10**6],
    "carryNodes": [0, 6],
    "carryIds": [-1, 99, 0],
    "loadNodes": [6, 3],
    "tiedNodes": [5, 6],
    "tiedTo": [3, 6],
    "viscous": [-1.0],
    "dry": [-1.0],
    "scripted": [-1, 3],
    "stuck": [2],
    "ids": [-1, 99],
    "friction": [-0.1],
    "lower": [0.5],
    "upper": [-0.5],
    "direction": [Vector3(0, 0, 0), Vector3(0, 0, 9)],
    "driven": [2],
    "held": [9, -1],
}
LEGAL = {
    ("lower", -INF),
    ("upper", INF),
    ("upper", HUGE),
    ("brake", INF),
    ("brake", HUGE),
    ("most", INF),
    ("most", HUGE),
    ("speed", "nan"),
    ("clampedEnds", "[]"),
    ("fixedNodes", "[]"),
}
LEADS = {  # what the text may say instead of the attribute's name
    "elementIds": "of element",
    "followIds": "follow",
    "carryIds": "carr",
    "ids": "body",
    "radius": "shape.radius",
    "family": "shape.family",
    "families": "CableEngine",
    "numbers": "place",
    "structure": "number of its",
    "driven": "motion",
    "scripted": "function of time",
}


def hostile(name, good):
    """Values that must be refused in place of a good one."""
    if not isinstance(good, list):
        return SCALARS.get(name, [])
    lists = [good + good[-1:]] if good else []
    if good and (name, "[]") not in LEGAL:
        lists.append([])
    if len(good) > 1:
        lists.append(good[:-1])
    bad = list(SPECIAL.get(name, []))
    if good and isinstance(good[0], float):
        bad += [NAN, INF, -INF, HUGE]
    if good and isinstance(good[0], int) and not isinstance(good[0], bool):
        bad += [-7, MOST]
    if good and isinstance(good[0], Vector3):
        bad += [Vector3(0, NAN, 0), Vector3(INF, 0, 0), Vector3(0, 0, HUGE)]
    bad = [b for b in bad if (name, "nan" if b != b else b) not in LEGAL] if good else []
    return lists + [good[:-1] + [b] for b in bad]


def attributes(kind):
    """(name, hostile value) of an engine's attributes, hidden ones with them."""
    given = the(kind).dict()
    found = [
        (name, value)
        for name, good in sorted(given.items())
        if name not in TOLD
        for value in hostile(name, good)
        if not (kind == "LineEngine" and name == "length" and 1e-300 in value)  # more slides there
    ]
    if kind == "CableEngine":
        found += [
            ("crossPairs", [0, 1]),
            ("crossValues", [NAN] * 9),
            ("openAccounts", [NAN] * 8),
            ("crossPairs", [0, 1, 0]),
            ("watched", [NAN] * 6),
        ]
    return found


def byKeywords(kind, name, value):
    def act():
        old = the(kind)
        new = type(old)(**{**old.dict(), name: value})
        O.engines = [new if e is old or type(e) is type(old) else e for e in O.engines]

    return act


def byUpdate(kind, name, value):
    return lambda: the(kind).updateAttrs({name: value})


def bySetting(kind, name, value):
    return lambda: setattr(the(kind), name, value)


def isNamed(kind, name, how, text):
    """Whether a refusal names object and attribute."""
    told = name in text or (name in LEADS and LEADS[name] in text)
    return how in ("ValueError", "RuntimeError", "IndexError") and kind in text and told


def short(value):
    text = repr(value)
    return text if len(text) < 70 else text[:30] + " ... " + text[-30:]


@pytest.mark.parametrize("kind", ["CableEngine", "LineEngine", "SheaveEngine", "GuideEngine"])
@pytest.mark.parametrize("way", [byKeywords, byUpdate])
def test_attributes(kind, way):
    bad, count = [], 0
    for name, value in attributes(kind):
        how, text = forked(way(kind, name, value))
        count += 1
        if not isNamed(kind, name, how, text):
            bad.append(f"{name} = {short(value)}: {how}: {text}")
    print(f"{kind}, {way.__name__}: {count} values")
    assert count > 40
    assert not bad, "\n" + "\n".join(bad)


def allRefused(calls, words):
    """An act: calls them all, each of which has to be refused with a text that holds the words."""

    def act():
        bad = []
        for number, call in enumerate(calls):
            try:
                call()
                bad.append(f"{number} was taken")
            except (ValueError, IndexError, RuntimeError) as error:
                if any(word not in str(error) for word in words):
                    bad.append(f"{number}: {error}")
            except AttributeError:  # cannot be set at all
                pass
        if bad:
            raise AssertionError("; ".join(bad))

    return act


def test_attributes_set(theScene):
    """By themselves; the old value stays, and the scene goes on as if nothing had been."""
    bad = []
    for kind in ("CableEngine", "LineEngine", "SheaveEngine", "GuideEngine"):
        values = collections.defaultdict(list)
        for name, value in attributes(kind):
            later = isinstance(value, list) and 1e-300 in value  # with the whole element
            if not later and name in dir(the(kind)):
                values[name].append(bySetting(kind, name, value))
        for name in values:
            how, text = forked(allRefused(values[name], (kind, name)))
            if (how, text) != ("ran", "same"):
                bad.append(f"{kind}.{name}: {how}: {text}")
    assert not bad, "\n" + "\n".join(bad)


def test_what_is_told_only_changes_nothing(theScene):
    for name, value in (("contacts", -5), ("sweeps", MOST), ("normalLeft", NAN), ("stepParts", -1)):
        assert forked(byUpdate("CableEngine", name, value)) == ("ran", "same")


# ---- methods ---------------------------------------------------------------------------------------


def array(values, kind=float):
    return np.array(values, dtype=np.float64 if kind is float else np.int32)


def added(engine, **options):
    good = dict(
        nodes=array([[0, 0, 5], [1, 0, 5]]),
        slopes=array([[1, 0, 0], [1, 0, 0]]),
        ends=array([[0, 1]], int),
        next=array([-1], int),
        kind=0,
        length=array([1.0]),
        ea=100.0,
        ei=1e-3,
        rhoA=1e-3,
        damping=1e-5,
    )
    return engine.add(**{**good, **options})


def covered(engine, **options):
    _, first = added(engine)
    good = dict(
        first=first,
        radius=1e-3,
        segments=3,
        points=False,
        selfContact=False,
        run=array([0], int),
        arc=array([0.0]),
        closed=array([0.0]),
    )
    return engine.cover(**{**good, **options})


BAD_NODES = (-1, 6, MOST, -MOST)
BAD_IDS = (-1, 99, MOST)

METHODS = (
    [
        ("CableEngine", lambda e, m=m, n=n: getattr(e, m)(n))
        for m in ("fix", "release", "tied", "elementsAt", "reaction", "moment")
        for n in BAD_NODES
    ]
    + [
        ("CableEngine", lambda e, m=m, n=n, x=x: getattr(e, m)(n, x))
        for m in ("point", "pointVelocity", "tension", "strain")
        for n, x in ((-1, 0.5), (4, 0.5), (MOST, 0.5), (0, NAN), (0, 1.5), (0, -1), (0, INF))
    ]
    + [("CableEngine", lambda e, n=n: e.tie(*n)) for n in ((0, 0), (3, 9), (-1, 0), (0, 3), (1, 4))]
    + [("CableEngine", lambda e, n=n: e.clamp(*n)) for n in ((4, 0), (-1, 0), (0, 2), (MOST, 1))]
    + [
        ("CableEngine", lambda e, n=n: e.followSlope(*n))
        for n in ((4, 0), (-1, 0), (0, 2), (MOST, 1), (0, 1))
    ]
    + [
        ("CableEngine", lambda e, r=r: e.maxTension(*r))
        for r in ((-1, 2, 8), (0, 5, 8), (3, 3, 8), (0, 4, 0))
    ]
    + [("CableEngine", lambda e, i=i: e.follow(1, i)) for i in (*BAD_IDS, 0, BALL)]
    + [
        ("CableEngine", lambda e, i=i: e.carry(1, i, (0, 0, 0)))
        for i in (*BAD_IDS, 0, BALL, LEADER)
    ]
    + [
        ("CableEngine", lambda e, at=at: e.carry(1, SHEAVE, at))
        for at in ((NAN, 0, 0), (INF, 0, 0), (HUGE, 0, 0))
    ]
    + [
        ("CableEngine", lambda e, f=f: e.load(1, f))
        for f in ((NAN, 0, 0), (0, INF, 0), (0, 0, HUGE))
    ]
    + [
        ("CableEngine", lambda e, o=o: added(e, **o))
        for o in (
            dict(kind=32),
            dict(kind=-1),
            dict(kind=2**30),
            dict(length=array([0.0])),
            dict(length=array([])),
            dict(length=array([HUGE])),
            dict(ea=NAN),
            dict(ea=HUGE),
            dict(ei=-1.0),
            dict(rhoA=0.0),
            dict(damping=INF),
            dict(massDamping=-1.0),
            dict(massDamping=NAN),
            dict(ends=array([[0, 2]], int)),
            dict(ends=array([[0, 0]], int)),
            dict(ends=array([0], int)),
            dict(next=array([0], int)),
            dict(nodes=array([[0, 0, NAN], [1, 0, 0]])),
            dict(nodes=array([[0, 0, 0]])),
            dict(slopes=array([[INF, 0, 0], [1, 0, 0]])),
        )
    ]
    + [
        ("CableEngine", lambda e, o=o: covered(e, **o))
        for o in (
            dict(first=0),
            dict(first=-1),
            dict(radius=NAN),
            dict(radius=0.0),
            dict(segments=0),
            dict(segments=65),
            dict(run=array([1], int)),
            dict(run=array([-1], int)),
            dict(run=array([], int)),
            dict(arc=array([NAN])),
            dict(arc=array([-1.0])),
            dict(closed=array([INF])),
        )
    ]
    + [
        ("CableEngine", lambda e, f=f: e.addBodies(f, O.materials["cable"], 1))
        for f in (-1, 0, 2, -MOST)
    ]
    + [
        ("CableEngine", lambda e, r=r: e.state(*r))
        for r in ((-1, 1, 0, 1), (0, 7, 0, 0), (0, 0, 0, 5), (MOST, MOST, 0, 0), (0, -1, 0, 0))
    ]
    + [
        ("CableEngine", lambda e, a=a: e.setVelocities(*a))
        for a in (
            (0, array([NAN, 0, 0]), 0, array([])),
            (9, array([0, 0, 0]), 0, array([])),
            (0, array([0, 0]), 0, array([])),
            (0, array([]), 0, array([HUGE] * 6)),
        )
    ]
    + [("CableEngine", lambda e, r=r: e.energy(*r)) for r in ((-1, 2), (0, 5), (3, 1), (0, MOST))]
    + [
        ("CableEngine", lambda e, r=r: e.relax(*r))
        for r in ((NAN, 10), (0.0, 10), (1e-8, 0), (-1.0, -1))
    ]
    + [("CableEngine", lambda e, p=p: e.overlaps(p)) for p in (NAN, -1.0, INF)]
    + [("SheaveEngine", lambda e, i=i: e.add(i)) for i in (*BAD_IDS, 0, SHEAVE)]
    + [
        ("SheaveEngine", lambda e, o=o: e.add(SLIDER, **o))
        for o in (dict(viscous=NAN), dict(dry=-1.0), dict(torque=HUGE), dict(speed=INF))
    ]
    + [("SheaveEngine", lambda e, v=v: e.setTorque(SHEAVE, v)) for v in (NAN, HUGE, -INF)]
    + [("SheaveEngine", lambda e, v=v: e.setSpeed(SHEAVE, v)) for v in (NAN, HUGE, -INF)]
    + [("SheaveEngine", lambda e, i=i: e.number(i)) for i in BAD_IDS]
    + [("GuideEngine", lambda e, i=i: e.add(i, (1, 0, 0))) for i in (*BAD_IDS, 0, SLIDER)]
    + [
        ("GuideEngine", lambda e, d=d: e.add(SHEAVE, d))
        for d in ((0, 0, 0), (NAN, 0, 0), (HUGE, 0, 0), (0, INF, 0))
    ]
    + [
        ("GuideEngine", lambda e, o=o: e.add(SHEAVE, (1, 0, 0), **o))
        for o in (dict(friction=NAN), dict(viscous=-1.0), dict(lower=NAN), dict(upper=-1.0))
    ]
    + [("GuideEngine", lambda e, m=m: e.setMotion(SLIDER, m)) for m in (3, "x")]
    + [("GuideEngine", lambda e, i=i: e.position(i)) for i in BAD_IDS]
)


def isCovered(call):
    return "covered" in call.__code__.co_names


def test_methods(theScene):
    """Refused by name, and the scene goes on as if nothing had been."""
    bad = []
    for kind in ("CableEngine", "LineEngine", "SheaveEngine", "GuideEngine"):
        calls = [
            lambda call=call: call(the(kind))
            for of, call in METHODS
            if of == kind and not isCovered(call)
        ]
        for first in range(0, len(calls), 10):
            how, text = forked(allRefused(calls[first : first + 10], (kind,)))
            if (how, text) != ("ran", "same"):
                bad.append(f"{kind}, from {first} on: {how}: {text}")
    for kind, call in METHODS:  # the cable that was added before stays, and touches nothing
        if isCovered(call):
            how, text = forked(allRefused([lambda: call(the(kind))], (kind,)))
            if how != "ran":
                bad.append(f"cover{call.__defaults__}: {how}: {text}")
    assert len(METHODS) > 100
    assert not bad, "\n" + "\n".join(bad)


HALF = [
    (lambda: wrapper.CableEngine(nNodes=5).follow(3, 5), "nNodes"),
    (lambda: wrapper.CableEngine(nNodes=5).tie(3, 4), "nNodes"),
    (lambda: wrapper.CableEngine(nNodes=-1), "nNodes = -1"),
    (lambda: wrapper.CableEngine(nNodes=MOST), "nNodes"),
    (lambda: wrapper.CableEngine(length=[1, 1]).clamp(1, 0), "length"),
    (lambda: wrapper.CableEngine(nNodes=5, position=[1.0]), "position"),
    (lambda: wrapper.CableEngine(loads=[Vector3(1, 1, 1)]), "loads"),
    (lambda: wrapper.CableEngine().fix(0), "node 0"),
    (lambda: wrapper.CableEngine().build(), "at least one node"),
    (lambda: wrapper.SheaveEngine(ids=[5]), "SheaveEngine: viscous"),
    (lambda: wrapper.GuideEngine(ids=[5]), "GuideEngine: friction"),
]


@pytest.mark.parametrize("number", range(len(HALF)))
def test_half_an_engine(number):
    call, word = HALF[number]
    how, text = forked(call)
    assert how in ("ValueError", "IndexError", "RuntimeError") and word in text, (how, text)


# ---- bodies and contacts ---------------------------------------------------------------------------


def edited(**values):
    def act():
        for name, value in values.items():
            setattr(contact().phys, name, value)

    return act


def replaced(part, kind):
    def act():
        setattr(contact(), part, getattr(wrapper, kind)())

    return act


def geomList(name, value):
    def act():
        contact().geom.updateAttrs({name: value})

    return act


def sphereOfNoStiffness():
    O.materials.append(wrapper.FrictMat(label="bad"))
    body = utils.sphere((0.75, 0, 0.0109), 0.01, material="bad")
    body.state.vel = (0, 0, -1)
    O.bodies.append(body)
    steps(1)
    O.materials["bad"].young = NAN


PAIR = r"the contact of bodies \d+ and \d+: "
WORLD = [
    (edited(normalStiffness=NAN), PAIR + "normalStiffness = nan"),
    (edited(normalStiffness=0.0), PAIR + "normalStiffness = 0"),
    (edited(normalStiffness=-1.0), PAIR + "normalStiffness = -1"),
    (edited(normalExponent=-3.0), PAIR + ".*normalExponent = -3"),
    (edited(transitionVelocity=NAN), PAIR + ".*transitionVelocity = nan"),
    (edited(transitionVelocity=0.0), PAIR + ".*transitionVelocity = 0"),
    (edited(staticFriction=NAN), PAIR + ".*staticFriction = nan"),
    (edited(kineticFriction=-1.0), PAIR + ".*kineticFriction = -1"),
    (edited(impactDamping=INF), PAIR + ".*impactDamping = inf"),
    (replaced("phys", "NormPhys"), PAIR + "phys is a NormPhys"),
    (replaced("phys", "FrictPhys"), PAIR + "phys is a FrictPhys"),
    (replaced("geom", "ScGeom"), PAIR + "geom"),
    *(
        (geomList(name, []), PAIR + "geom was edited")
        for name in ("segment", "gap", "point", "normals", "force", "friction", "xi")
    ),
    (sphereOfNoStiffness, "young = nan"),
    (
        lambda: O.bodies[0].shape.updateAttrs({"element": 99}),
        r"elementIds\[0\].*shape.element = 99",
    ),
    (
        lambda: O.bodies[0].shape.updateAttrs({"element": -1}),
        r"elementIds\[0\].*shape.element = -1",
    ),
    (lambda: O.bodies[0].shape.updateAttrs({"family": 7}), r"elementIds\[0\].*shape.family = 7"),
    (lambda: O.bodies[0].shape.updateAttrs({"radius": NAN}), r"shape.radius = nan"),
    (lambda: O.bodies.append(stray(99)), "none of its elementIds"),
    (lambda: O.bodies.append(stray(0)), "none of its elementIds"),
    (lambda: O.bodies.append(stray(-1)), "none of its elementIds"),
    (
        lambda: setattr(O.bodies[SHEAVE].state, "angVel", Vector3(0, NAN, 0)),
        "SheaveEngine: body 7.*angVel",
    ),
    (
        lambda: setattr(O.bodies[SLIDER].state, "pos", Vector3(0, 1, 1)),
        "GuideEngine: body 8.*off its guide",
    ),
    (
        lambda: the("GuideEngine").setMotion(SLIDER, lambda t: HUGE),
        "GuideEngine: body 8: motion = 1e",
    ),
    (
        lambda: O.bodies.erase(SLIDER) and the("GuideEngine").position(SLIDER),
        "GuideEngine.* body 8.* was erased",
    ),
    (
        lambda: setattr(the("CableNewton"), "gravity", Vector3(0, NAN, 0)),
        r"NewtonIntegrator.gravity = \(0, nan, 0\)",
    ),
    (lambda: setattr(O, "dt", 1e5), r"use O.dt <="),
]


def stray(element):
    body = wrapper.Body()
    body.shape = wrapper.CableElement(
        element=element, family=the("CableEngine").family, radius=1e-3
    )
    body.material = O.materials["cable"]
    body.state.blockedDOFs = "xyzXYZ"
    return body


@pytest.mark.parametrize("number", range(len(WORLD)))
def test_bodies_and_contacts(number):
    act, word = WORLD[number]

    def and_check():
        act()
        steps(2)
        ancf.check()

    how, text = forked(and_check)
    assert how in ("RuntimeError", "ValueError") and re.search(word, text), (how, text)


@pytest.mark.parametrize("name", ["element", "family", "radius"])
def test_an_element_says_what_it_is_and_cannot_be_told(name):
    with pytest.raises(AttributeError):
        setattr(O.bodies[0].shape, name, 1)


def grains(change):
    """Two grains of which one's material is changed before they touch; no cable."""

    def act():
        O.reset()
        material("m")
        O.materials.append(wrapper.FrictMat(label="other"))
        ball((0, 0, 0), 0.1, material="m")
        above = ball((0, 0, 0.19999), 0.1, mass=1.0, material="other")
        O.bodies[above].state.vel = (0.1, 0, 0)
        O.engines = [*bodyEngines()[:-1], wrapper.CableNewton(damping=0)]
        O.engines[2].physDispatcher.functors = [wrapper.Ip2_FrictMat_HollarsMat_HollarsPhys()]
        O.dt = 1e-6
        change()
        steps(3)

    return act


def laterPhys(value):
    def change():
        steps(2)
        next(iter(O.interactions)).phys = value

    return change


@pytest.mark.parametrize(
    "change, word",
    [
        (lambda: setattr(O.materials["other"], "young", NAN), "bodies 0 and 1: .*young = nan"),
        (laterPhys(wrapper.NormPhys()), "bodies 0 and 1: phys is a NormPhys"),
        (
            lambda: (steps(2), setattr(next(iter(O.interactions)).phys, "normalStiffness", NAN)),
            "bodies 0 and 1: normalStiffness = nan",
        ),
        (
            lambda: (steps(2), setattr(next(iter(O.interactions)).phys, "kineticFriction", NAN)),
            "bodies 0 and 1: .*kineticFriction = nan",
        ),
    ],
)
def test_grains(change, word):
    how, text = forked(grains(change))
    assert how == "RuntimeError" and re.search(word, text), (how, text)


def test_a_sheave_that_is_touched_keeps_its_groove():
    def act():
        O.reset()
        material("m")
        sheave = pulleys.sheave((0, 0, 0), 0.05, width=0.03, material="m")
        ball((0, 0, 0.05999), 0.01, mass=0.1, material="m")
        O.engines = bodyEngines()
        O.engines[1].boundDispatcher.functors += [wrapper.Bo1_Sheave_Aabb()]
        O.engines[2].geomDispatcher.functors += [wrapper.Ig2_Sheave_Sphere_ScGeom()]
        O.dt = 1e-6
        shape = O.bodies[sheave].shape
        shape.radius = 0.05001
        shape.radius = 0.05
        steps(2)
        for name, value, told in (("radius", 0.2, "radius = 0.2"), ("width", 0.04, "sizes")):
            with pytest.raises(ValueError, match=f"Sheave.*{told}.*body 0 .*with body 1"):
                setattr(shape, name, value)
        assert (shape.radius, shape.width) == (0.05, 0.03)
        raise RuntimeError("all told")

    assert forked(act) == ("RuntimeError", "all told")


# ---- what is right goes on -------------------------------------------------------------------------


def test_positions_set_while_it_runs(theScene):
    """The same ones change nothing; others are where the next step starts."""

    def same():
        engine = the("CableEngine")
        engine.position = list(engine.position)
        engine.velocity = list(engine.velocity)

    def moved():
        engine = the("CableEngine")
        x = np.array(engine.position)
        x[2 * engine.stride + 1] -= 1e-5
        engine.position = x.tolist()
        engine.velocity = [0.0] * len(x)
        assert engine.point(0, 1)[2] == x[2 * engine.stride + 1]
        steps(1)
        after = np.array(engine.position)
        assert 0 < abs(after - x).max() < 1e-5

    assert forked(same) == ("ran", "same")
    assert forked(moved) == ("ran", "other")


def test_a_saved_scene_with_a_list_cut_short(theScene, tmp_path):
    path = str(tmp_path / "scene.xml")
    O.save(path)
    text = open(path).read()
    for name in ("ends", "tiedTo", "radius", "followAt", "arc"):
        block = re.search(rf"<{name}[^>]*>\s*<count>\d+</count>.*?</{name}>", text, re.S).group()
        count = int(re.search(r"<count>(\d+)", block).group(1))
        less = block.replace(f"<count>{count}</count>", f"<count>{count - 1}</count>", 1)
        last = less.rindex("<item")
        less = less[:last] + less[less.index("</item>", last) + len("</item>") :]
        other = str(tmp_path / f"{name}.xml")
        with open(other, "w") as file:
            file.write(text.replace(block, less, 1))
        how, told = forked(lambda: O.load(other))
        assert how in ("RuntimeError", "ValueError") and name in told, (name, how, told)
    assert forked(lambda: O.load(path))[0] == "ran"


# ---- at random, by command line --------------------------------------------------------------------

POOL_INT = [0, 1, 2, 3, 4, 5, 7, 8, 63, 64, 65, -1, -2, -7, 10**6, MOST, -MOST - 1]
POOL_REAL = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    1e-3,
    0.5,
    1e-300,
    1e-100,
    1e99,
    1e150,
    HUGE,
    -HUGE,
    NAN,
    INF,
    -INF,
]


def anyLike(good, chance):
    """A value of the type of a good one."""
    if isinstance(good, bool):
        return chance.random() < 0.5
    if isinstance(good, int):
        return chance.choice(POOL_INT)
    if isinstance(good, float):
        return chance.choice(POOL_REAL)
    if isinstance(good, str):
        return chance.choice(["", "leapfrog", "rk4", "implicit", "hertz", "none", "x" * 1000, "é"])
    if isinstance(good, Vector3):
        return Vector3(*(chance.choice(POOL_REAL) for _ in range(3)))
    if isinstance(good, list):
        sample = good[0] if good else chance.choice([0, 0.0, Vector3(0, 0, 0)])
        what = chance.randrange(5)
        if what == 0:
            return [anyLike(sample, chance) for _ in range(chance.choice([0, 1, 2, 5, 100]))]
        if what == 1:
            return good[: chance.randrange(len(good) + 1)]
        if what == 2:
            return good + [anyLike(sample, chance) for _ in range(chance.choice([1, 7]))]
        some = list(good)
        for _ in range(chance.choice([1, 1, 2, 5])):
            if some:
                some[chance.randrange(len(some))] = anyLike(sample, chance)
        return some
    return good


def randomCase(chance):
    """(what it is, act): hostile values in one to three attributes, or a method's arguments."""
    kind = chance.choice(["CableEngine"] * 4 + ["SheaveEngine", "GuideEngine", "HollarsPhys"])
    if kind == "HollarsPhys":
        names = [n for n, v in contact().phys.dict().items() if isinstance(v, float)]
        values = {chance.choice(names): chance.choice(POOL_REAL)}
        return f"phys {values}", kind, lambda: contact().phys.updateAttrs(values)
    if chance.random() < 0.2:
        number = chance.randrange(len(METHODS))
        kind, call = METHODS[number]
        return f"method {number}", kind, lambda: call(the(kind))
    given = {n: v for n, v in the(kind).dict().items() if n not in ("label", "ompThreads", "dead")}
    names = chance.sample(sorted(given), chance.choice([1, 1, 1, 2, 3]))
    values = {name: anyLike(given[name], chance) for name in names}
    way = chance.choice(["keywords", "updateAttrs", "set"])

    def act():
        if way == "set":
            for name, value in values.items():
                setattr(the(kind), name, value)
        elif way == "updateAttrs":
            the(kind).updateAttrs(values)
        else:
            old = the(kind)
            new = type(old)(**{**old.dict(), **values})
            O.engines = [new if type(e) is type(old) else e for e in O.engines]

    return f"{kind} by {way}: {short(values)}", kind, act


def long(count, seed):
    """Random cases; prints how they ended and what should not have been. Returns the latter's number."""
    ready()
    ends, bad, start = collections.Counter(), 0, time.time()
    for number in range(count):
        chance = random.Random(f"{seed}/{number}")
        what, kind, act = randomCase(chance)
        how, text = forked(act)
        ends[how if how != "ran" else f"ran, {text}"] += 1
        good = how in (
            "ran",
            "ValueError",
            "RuntimeError",
            "IndexError",
            "AttributeError",
            "TypeError",
        )
        if how in ("ValueError", "RuntimeError") and kind not in ("HollarsPhys",):
            good = any(word in text for word in ("Engine", "contact of bodies", "O.dt", "body "))
        if not good:
            bad += 1
            print(f"seed {seed}, case {number}: {what}: {how}: {text}", flush=True)
    print(f"seed {seed}: {count} cases in {time.time() - start:.0f} s: {dict(ends)}; {bad} bad")
    return bad


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--count", type=int, default=10000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    sys.stdout.flush()
    os._exit(1 if long(options.count, options.seed) else 0)
