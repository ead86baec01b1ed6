"""Mass-proportional damping, and bringing a scene to rest."""

import math

import numpy as np
import pytest
from helpers import array, ball, material, plane, steps

import ancf
from yade import O, Vector3, utils

G, ALPHA = 9.81, 4.0


@pytest.fixture
def soft(scene):
    return material("soft", young=1e8, density=1000)


def cable(points=((0, 0, 0), (1, 0, 0)), elements=6, **options):
    given = dict(diameter=5e-3, material="soft", contactPoints=0, massDamping=ALPHA)
    return ancf.Cable(points, elements, **{**given, **options})


@pytest.mark.parametrize("mass", ["consistent", "lumped"])
@pytest.mark.parametrize("integrator", ["leapfrog", "implicit", "rk4"])
def test_free_cable_slows_down(soft, mass, integrator):
    c = cable(mass=mass)
    c.setVelocity(lambda p: Vector3(1, 2 - p[0], 3))
    O.engines = ancf.engines(c, integrator=integrator)
    start = array(c.engine.momentum()[0])
    steps(round(0.3 / O.dt))
    left = array(c.engine.momentum()[0]) / start
    late = O.dt / 2 if integrator == "leapfrog" else 0
    assert left == pytest.approx(math.exp(-ALPHA * (O.time - late)) * np.ones(3), rel=1e-3)


@pytest.mark.parametrize("model", ["ancf", "springs"])
def test_free_chains_slow_down(soft, model):
    c = cable(elements=1, model=model)
    c.setVelocity(lambda p: Vector3(0, 0, 1))
    O.engines = ancf.engines(c)
    steps(round(0.3 / O.dt))
    exact = math.exp(-ALPHA * (O.time - O.dt / 2))
    assert c.velocity(0.3)[2] == pytest.approx(exact, rel=ALPHA**2 * O.dt * O.time)


def test_swing_dies_away(soft):
    """A taut string: amplitude exp(-alpha t/2), frequency sqrt(w^2 - alpha^2/4)."""
    c = cable(elements=20, bending=0, tension=20)
    c.fix(0)
    c.fix(-1)
    w = math.pi / 1 * math.sqrt(20 / (c.section.rhoA * c.length))
    c.setVelocity(lambda p: Vector3(0, 0, 1e-3 * w * math.sin(math.pi * p[0])))
    O.engines = ancf.engines(c)
    turned = math.sqrt(w**2 - ALPHA**2 / 4)
    for periods in (1, 2, 4):
        steps(round((2 * math.pi * (periods - 0.75) / turned - O.time) / O.dt))
        t = O.time
        exact = 1e-3 * w / turned * math.exp(-ALPHA * t / 2) * math.sin(turned * t)
        assert c.point(0.5)[2] == pytest.approx(exact, rel=2e-2)


@pytest.mark.parametrize("mass", ["consistent", "lumped"])
@pytest.mark.parametrize("integrator", ["leapfrog", "implicit"])
def test_energy_is_accounted_for(soft, mass, integrator):
    c = cable(mass=mass, damping=1e-5)
    c.fix(0)
    O.engines = ancf.engines(c, gravity=(0, 0, -G), integrator=integrator)
    O.dt = min(O.dt, 5e-4)
    O.trackEnergy = True
    steps(2)
    total = lambda: sum(O.energy[k] for k in O.energy.keys())
    before = total()
    steps(round(0.4 / O.dt))
    assert O.energy["cableDamping"] > 0.01
    assert abs(total() - before) < 1e-3 * O.energy["cableDamping"]
    assert c.engine.energyOff < 1e-4 * c.engine.energyScale


def test_none_takes_the_fast_way(soft):
    """To the last bit what the way with damping gives where that is too weak to be seen."""
    ends = []
    for options in ({}, dict(massDamping=1e-300), dict(massDamping=ALPHA)):
        O.reset()
        material("soft", young=1e8, density=1000)
        given = dict(diameter=5e-3, material="soft", contactPoints=0)
        c = ancf.Cable([(0, 0, 0), (1, 0, 0)], 6, **given, **options)
        c.fix(0)
        O.engines = ancf.engines(c, gravity=(0, 0, -G))
        steps(3000)
        ends.append(list(c.engine.position))
    assert ends[0] == ends[1] != ends[2]


def test_bad_values(soft):
    with pytest.raises(ValueError, match="Cable.massDamping = -1: must be finite and not below"):
        cable(massDamping=-1)
    c = cable().append()
    with pytest.raises(ValueError, match="massDamping = -1.* 1/s: mass-proportional damping must"):
        c.engine.massDamping = [-1.0] * 6


# ---- settle ----------------------------------------------------------------------------------------


def test_settle_brings_a_mixed_scene_to_rest(soft):
    """A ball that hangs on a slack line, and a stack on the floor: what holds them is their weight."""
    plane((0, 0, -1.1), (1, 1, 0.1), material="soft")
    hammock = cable(((-0.3, 0, 0.01), (0, 0, 0), (0.3, 0, 0.01)), 4, massDamping=0, contactPoints=3)
    hammock.fix(0)
    hammock.fix(-1)
    hung = ball((0, 0, -0.5), 0.03, mass=0.1, material="soft")
    line = cable(((0, 0, 0), (0, 0, -0.5)), 3, massDamping=0, contactPoints=0, label="line")
    line.tie(0, hammock, 1)
    line.carry(-1, hung)
    low = ball((0.5, 0, -0.97), 0.03, mass=0.1, material="soft")
    high = ball((0.5, 0, -0.9), 0.03, mass=0.1, material="soft")
    O.bodies[high].state.blockedDOFs = "xyXYZ"
    led = ball((2, 0, 0), 0.01, material="soft", mask=2)
    O.bodies[led].state.vel = Vector3(0, 0, 0.1)
    O.engines = ancf.engines(hammock, line, gravity=(0, 0, -G))
    took = ancf.settle()
    assert 0.01 < took < 10
    mass = lambda i: O.bodies[i].state.mass
    weight = (hammock.mass + line.mass + mass(hung)) * G
    held, floor = [], []
    for _ in range(round(0.05 / O.dt)):  # what still rings in the contacts has no mean
        O.step()
        held.append(hammock.anchorForce()[2])
        touching = [i for i in O.bodies[0].intrs() if i.isReal]
        floor.append(sum(i.phys.normalForce.norm() for i in touching))
    assert np.mean(held) == pytest.approx(weight, rel=1e-2)
    assert np.mean(floor) == pytest.approx((mass(low) + mass(high)) * G, rel=1e-2)
    assert O.bodies[hung].state.vel.norm() < 5e-3
    assert O.bodies[led].state.vel == Vector3(0, 0, 0.1)


def test_settle_tells_what_does_not_come_to_rest(soft):
    c = cable(massDamping=0)
    O.engines = ancf.engines(c, gravity=(0, 0, -G))
    with pytest.raises(RuntimeError, match="settle: after 0.05 s the scene still comes up to"):
        ancf.settle(limit=0.05)


def test_stop_leaves_what_is_led(soft):
    c = cable(massDamping=0)
    c.setVelocity(lambda p: Vector3(1, 1, 1))
    free = ball((0, 1, 0), 0.01, mass=0.01, material="soft")
    state = O.bodies[free].state
    state.blockedDOFs = "xZ"
    state.vel, state.angVel = Vector3(1, 2, 3), Vector3(4, 5, 6)
    O.engines = ancf.engines(c)
    ancf.stop()
    assert not any(c.engine.velocity)
    assert state.vel == Vector3(1, 0, 0) and state.angVel == Vector3(0, 0, 6)
