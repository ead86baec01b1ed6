"""Flat and vee sheaves, both ways round, and axles that hang, are carried or slide, against statics."""

import math

import numpy as np
import pytest

from ancf import pulleys
from helpers import O, Vector3, ancf, steps, utils
from test_pulley import D, LINEAR, R, cableMaterial, capstan

G = 9.81


def bight(sheave, height, tension):
    """A cable half round a sheave, its ends at a height above the axle: below it, or over it where they
    are lower.
    """
    radius = O.bodies[sheave].shape.radius + D / 2
    path = pulleys.Path(
        [(sheave, -1 if height > 0 else 1)],
        diameter=D,
        start=(-radius, 0, height),
        end=(radius, 0, height),
    )
    elements = round(path.length / (radius * math.radians(15)))
    return pulleys.lay(
        path,
        elements,
        diameter=D,
        material="cable",
        bending=0.0,
        contactPoints=2,
        damping=2e-6,
        mass="lumped",
        tension=tension,
    )


def frictionless(**values):
    given = dict(normalStiffness=1e5, dashpot=3.0, staticFriction=0.0, kineticFriction=0.0)
    cableMaterial("cable", 2e4, 0.1, D, **{**given, **values})


def over(sheave, tension):
    """A cable half round a sheave from above, both ends pulled down."""
    cable = bight(sheave, -0.1, tension)
    for knot in (0, -1):
        cable.load(knot, (0, 0, -tension))
    return cable


# ---- profiles ----------------------------------------------------------------------------------


@pytest.mark.parametrize("profile", ["round", "flat", "vee"])
def test_cable_rests_on_the_bottom_of_each_profile(scene, profile):
    """The sheave takes 2 T of a cable that goes round half of it, at the radius of the bottom."""
    frictionless()
    sheave = pulleys.sheave((0, 0, 0), R - D / 2, width=12 * D, material="cable", profile=profile)
    if profile == "vee":
        O.bodies[sheave].shape.grooveRadius = 1.5 * D  # wide enough for the cable
    tension = 1.0
    cable = over(sheave, tension)
    engine = ancf.SheaveEngine()
    engine.add(sheave, speed=0)
    O.engines = pulleys.engines(cable, engine, contact=LINEAR, substeps=1)
    pulleys.settle(cable, 0.06)
    loads = []
    for _ in range(400):
        O.step()
        loads.append(engine.load[0])
    load = np.mean([list(v) for v in loads], axis=0)
    assert load == pytest.approx([0, 0, -2 * tension], abs=4e-3)
    curve = cable.curve(4)
    on = curve[curve[:, 2] > 0.2 * R]
    assert len(on) > 20
    assert np.linalg.norm(on[:, [0, 2]], axis=1) == pytest.approx(R, abs=0.01 * R)
    assert np.abs(curve[:, 1]).max() < 1e-12  # in the middle of the groove
    wrap = pulleys.wrap(cable, sheave)
    assert wrap.normal.sum() == pytest.approx(math.pi * tension, rel=0.02)  # N' = T/R, over pi R


def test_wrap_angle(scene):
    """A cable laid over 200 degrees of a sheave and relaxed."""
    frictionless()
    sheave = pulleys.sheave((0, 0, 0), R - D / 2, width=12 * D, material="cable")
    a = math.radians(100)  # to either side of the top
    start, end = (
        (side * (R * math.sin(a) + 2 * R * math.cos(a)), 0, R * math.cos(a) - 2 * R * math.sin(a))
        for side in (-1, 1)
    )
    path = pulleys.Path([(sheave, 1)], diameter=D, start=start, end=end)
    assert math.degrees(path.angles[0]) == pytest.approx(200, abs=1e-9)
    given = dict(diameter=D, material="cable", bending=0.0, contactPoints=3, tension=1.0)
    cable = pulleys.lay(path, 60, **given)
    cable.fix(0)
    cable.fix(-1)
    engine = ancf.SheaveEngine()
    engine.add(sheave, speed=0)
    O.engines = pulleys.engines(cable, engine, contact=LINEAR, substeps=1)
    cable.relax(1e-8)
    steps(2)
    assert math.degrees(pulleys.wrap(cable, sheave).wrapAngle) == pytest.approx(200, rel=5e-3)


# ---- direction -1 ------------------------------------------------------------------------------


def test_path_the_other_way_is_the_mirrored_one(scene):
    cableMaterial("cable", 2e4, 0.1, D)
    places = [(0, 0, 0), (0.3, 0, 0.02)]
    ids = [pulleys.sheave(p, R - D / 2, width=6 * D, material="cable") for p in places]
    mirrored = [
        pulleys.sheave((x, 0, -z), R - D / 2, width=6 * D, material="cable") for x, _, z in places
    ]
    ends = [(-0.4, 0, -0.1), (0.7, 0, 0.1)]
    for signs in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        one = pulleys.Path(list(zip(ids, signs)), diameter=D, start=ends[0], end=ends[1])
        other = pulleys.Path(
            [(i, -s) for i, s in zip(mirrored, signs)],
            diameter=D,
            start=(ends[0][0], 0, -ends[0][2]),
            end=(ends[1][0], 0, -ends[1][2]),
        )
        assert other.length == pytest.approx(one.length, rel=1e-12)
        assert other.angles == pytest.approx(one.angles, rel=1e-12)
        for s in np.linspace(0, one.length, 50):
            (p, t), (q, u) = one.at(s), other.at(s)
            assert q == pytest.approx(p * [1, 1, -1], abs=1e-12)
            assert u == pytest.approx(t * [1, 1, -1], abs=1e-12)


def test_which_side_a_direction_goes(scene):
    """1 goes round as a positive speed turns: about y, over the top from -x to +x."""
    cableMaterial("cable", 2e4, 0.1, D)
    sheave = pulleys.sheave((0, 0, 0), R - D / 2, width=6 * D, material="cable")
    for sign in (1, -1):
        path = pulleys.Path(
            [(sheave, sign)], diameter=D, start=(-R, 0, -sign * 0.1), end=(R, 0, -sign * 0.1)
        )
        assert path.angles == pytest.approx([math.pi], rel=1e-12)
        top, way = path.at(path.length / 2)
        assert top == pytest.approx([0, 0, sign * R], abs=1e-12)
        assert way == pytest.approx([1, 0, 0], abs=1e-12)
        spin = np.cross([0, sign, 0], top)  # velocity of a sheave that turns that way
        assert spin @ way > 0


def test_capstan_the_other_way(scene):
    """A drum that turns the other way under a cable laid the other way: the same ratio."""
    one, other = (capstan(90, 0.5, 0.02, sign=sign)[0] for sign in (1, -1))
    assert other == pytest.approx(one, rel=1e-6)
    assert other == pytest.approx(math.exp(0.25 * math.pi), rel=1e-3)


# ---- axles -------------------------------------------------------------------------------------


def weighed(cable, sheave, engines, mass, time=0.1):
    """Tensions at both ends once it rests, and how far the axle still goes up and down [m]."""
    O.engines = engines
    pulleys.settle(cable, time)
    forces, heights = [], []
    for _ in range(2000):
        O.step()
        forces.append([cable.reaction(k)[2] for k in (0, -1)])
        heights.append(O.bodies[sheave].state.pos[2])
    return np.mean(forces, axis=0), np.ptp(heights)


@pytest.mark.parametrize("how", ["free", "guide"])
def test_a_block_hangs_in_a_bight(scene, how):
    """A sheave of mass M that hangs in the bight of a cable held at both ends: M g/2 in each part."""
    frictionless()
    mass = 0.2
    sheave = pulleys.sheave(
        (0, 0, 0),
        R - D / 2,
        width=6 * D,
        material="cable",
        mass=mass,
        inertia=1e-4,
        fixed=how != "free",
    )
    weight = mass * G
    cable = bight(sheave, 0.15, weight / 2)
    cable.fix(0)
    cable.fix(-1)
    turns = ancf.SheaveEngine()
    turns.add(sheave)
    parts = [cable, turns]
    if how == "guide":
        guide = ancf.GuideEngine()
        guide.add(sheave, direction=(0, 0, 1), viscous=2.0)
        parts.append(guide)
    engines = pulleys.engines(*parts, gravity=(0, 0, -G), contact=LINEAR, substeps=1)
    forces, swing = weighed(cable, sheave, engines, mass)
    own = cable.mass * G / 2
    assert forces == pytest.approx([weight / 2 + own] * 2, rel=0.01)
    assert turns.angle[0] == pytest.approx(0, abs=1e-6)
    assert O.bodies[sheave].state.pos[0] == pytest.approx(0, abs=1e-6)
    if how == "guide":
        assert swing < 1e-5


def test_axle_carried_by_a_knot(scene):
    """A block that another cable holds from above: that one takes 2 T and the block's weight."""
    frictionless()
    mass, tension = 0.1, 1.0
    sheave = pulleys.sheave(
        (0, 0, 0), R - D / 2, width=6 * D, material="cable", mass=mass, inertia=1e-4, fixed=False
    )
    cable = over(sheave, tension)
    above = ancf.Cable(
        [(0, 0, 0), (0, 0, 0.2)],
        2,
        diameter=D,
        material="cable",
        bending=0.0,
        contactPoints=0,
        damping=2e-6,
        mass="lumped",
    )
    above.fix(-1)
    above.carry(0, sheave)
    turns = ancf.SheaveEngine()
    turns.add(sheave)
    O.engines = pulleys.engines(cable, above, turns, gravity=(0, 0, -G), contact=LINEAR, substeps=1)
    pulleys.settle(cable, 0.1)
    forces = []
    for _ in range(2000):
        O.step()
        forces.append(above.reaction(-1)[2])
    expected = 2 * tension + (mass + cable.mass + above.mass) * G
    assert np.mean(forces) == pytest.approx(expected, rel=0.01)
    assert turns.angle[0] == pytest.approx(0, abs=1e-6)


def test_settle_brings_to_rest_and_starts_the_time_anew(scene):
    """A weight on a cable: the extension of statics, T L/EA, nothing moves, O.time = 0."""
    cableMaterial("cable", 1e3, 0.01, D)
    cable = ancf.Cable(
        [(0, 0, 0), (0, 0, -0.5)], 4, diameter=D, material="cable", bending=0.0, contactPoints=0
    )
    cable.fix(0)
    weight = utils.sphere((0, 0, -0.5), 0.01, mask=0)
    weight.state.mass, mass = 0.5, 0.5
    number = O.bodies.append(weight)
    cable.carry(-1, number)
    O.engines = pulleys.engines(cable, gravity=(0, 0, -G))
    pulleys.settle(cable, 0.5, every=2e-4)
    assert O.time == O.iter == 0
    stretch = (-O.bodies[number].state.pos[2] - 0.5) / 0.5
    pull = mass * G + 0.01 * 0.5 * G / 2  # in the middle
    green = pull / 1e3  # EA (l^2 - 1)/2 l = T: l = 1 + T/EA - 3/2 (T/EA)^2
    assert stretch == pytest.approx(green - 1.5 * green**2, rel=2e-3)
    before = O.bodies[number].state.pos[2]
    steps(200)
    assert abs(O.bodies[number].state.pos[2] - before) < 1e-3 * 0.5 * stretch
