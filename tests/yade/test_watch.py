"""What the engine watches: numbers that are none, steps that strain or O.dt make too long, bodies that move too far."""

import math
import re

import numpy as np
import pytest

from helpers import O, ancf, array, ball, material, steps
from yade import Vector3, utils

NAN = float("nan")
G = 9.81


def rope(elements=10, young=1e8, length=1.0, **options):
    """A cable along x from the origin."""
    material("cable", young=young)
    given = dict(diameter=4e-3, material="cable", contactPoints=0)
    c = ancf.Cable([(0, 0, 0), (length, 0, 0)], elements, **{**given, **options})
    c.append()
    return c


def refused(action, text):
    """The O.dt that the refusal tells."""
    with pytest.raises(RuntimeError, match=text) as caught:
        action()
    return float(re.search(r"use O\.dt <= (\S+)", str(caught.value))[1])


def waveSpeed(c):
    return math.sqrt(c.engine.ea[0] / c.engine.rhoA[0])


# ---- not a number --------------------------------------------------------------------------------


def netAndBodies():
    """A net with bullets, a target beneath, a grain aside; returns (net, target, grain)."""
    material("cable")
    net = ancf.Net.square(4, 0.25, normal=(0, 0, 1), diameter=2e-3, material="cable")
    net.addBullets(mass=0.05, radius=0.02, speed=0.0, angle=0.0)
    target = ball((0, 0, -0.5), 0.2, mass=1.0, material="cable")
    net.append()
    grain = ball((0, 0, 5), 0.01, mass=1e-3, material="cable")
    O.engines = ancf.engines(net, gravity=(0, 0, -G))
    O.dt = 0.5 * ancf.timeStep()
    steps(3)
    return net, target, grain


def spoil(what, net, target, grain):
    state = lambda i: O.bodies[i].state  # noqa: E731
    if what == "force on a bullet":
        O.forces.setPermF(net.bullets[0], (NAN, 0, 0))
    elif what == "torque on a bullet":
        O.forces.setPermT(net.bullets[0], (0, NAN, 0))
    elif what == "spin of a bullet":
        state(net.bullets[1]).angVel = (0, 0, NAN)
    elif what == "velocity of the target":
        state(target).vel = (0, NAN, 0)
    elif what == "place of a grain":
        state(grain).pos = (0, 0, float("inf"))
    elif what == "force on a grain":
        O.forces.setPermF(grain, (0, NAN, 0))
    elif what == "gravity":
        O.engines[-1].gravity = (0, 0, NAN)


@pytest.mark.parametrize(
    "what, named",
    [
        ("force on a bullet", lambda net, target, grain: f"body {net.bullets[0]} has a force"),
        ("torque on a bullet", lambda net, target, grain: f"body {net.bullets[0]} has a torque"),
        ("spin of a bullet", lambda net, target, grain: f"body {net.bullets[1]} has state.angVel"),
        ("velocity of the target", lambda net, target, grain: f"body {target} has state."),
        ("place of a grain", lambda net, target, grain: f"body {grain} has state.pos"),
        ("force on a grain", lambda net, target, grain: f"body {grain} has a force"),
        ("gravity", lambda net, target, grain: "gravity"),
    ],
)
@pytest.mark.parametrize("reset", [False, True])
def test_what_is_not_finite_is_named_within_ten_steps(scene, what, named, reset):
    things = netAndBodies()
    if reset:
        O.resetTime()
    spoil(what, *things)
    with pytest.raises(RuntimeError, match=re.escape(named(*things))):
        steps(11)


@pytest.mark.parametrize("name", ["position", "velocity"])
def test_state_that_is_set_must_be_finite(scene, name):
    engine = netAndBodies()[0].engine
    before = list(getattr(engine, name))
    with pytest.raises(ValueError, match=rf"{name}\[7\] = nan"):
        setattr(engine, name, [*before[:7], NAN, *before[8:]])
    assert list(getattr(engine, name)) == before
    steps(2)


def test_relax_knows_what_is_not_finite(scene):
    c = rope()
    c.fix(0)
    c.fix(-1)
    O.engines = ancf.engines(c)
    O.engines[-1].gravity = (0, 0, NAN)
    with pytest.raises(RuntimeError, match="gravity = .*nan"):
        c.relax()


def test_refused_relax_moves_nothing(scene):
    c = rope()
    c.fix(0)
    c.load(-1, (1e90, 0, 0))
    O.engines = ancf.engines(c, gravity=(0, 0, -G))
    before = list(c.engine.position)
    with pytest.raises(RuntimeError):
        c.relax(iterations=30)
    assert list(c.engine.position) == before


# ---- steps of the cable --------------------------------------------------------------------------


def pull(c, speed):
    """Moves the end along the cable at a speed; returns a function that steps and adds up its work."""
    hand = ball((c.length, 0, 0), 0.01, material="cable")
    O.bodies[hand].state.vel = (speed, 0, 0)
    c.fix(0)
    c.follow(-1, hand)
    done = [0.0]

    def go(n):
        for _ in range(n):
            O.step()
            done[0] += O.dt * speed * c.reaction(-1)[0]
        return done[0]

    return go


def energyOf(c):
    e = c.engine.energy(0, c.engine.nElements)
    return e["kinetic"] + e["axial"] + e["bending"]


# A cable of Green's law drawn to twice its length, far beyond the strain that the first step has room for: the work of
# the hand is in the cable.
def test_growing_strain_shortens_the_step(scene):
    c = rope()
    go = pull(c, 0.02 * waveSpeed(c))
    O.engines = ancf.engines(c)
    O.dt = c.criticalTimeStep()
    work = go(round(1 / (0.02 * waveSpeed(c) * O.dt)))
    assert c.strain(0.5) > 1.3
    assert c.criticalTimeStep() < 0.6 * O.dt
    assert energyOf(c) == pytest.approx(work, rel=2e-3)


def test_growing_strain_stops_a_step_that_cannot_be_divided(scene):
    c = rope()
    go = pull(c, 0.02 * waveSpeed(c))
    O.engines = ancf.engines(c, substeps=1)
    O.dt = c.criticalTimeStep()
    told = refused(lambda: go(10000), "above the stable one")
    assert told == pytest.approx(c.criticalTimeStep(), rel=1e-5)
    strains = [c.engine.strain(e, xi) for e in range(c.engine.nElements) for xi in (0, 0.5, 1)]
    assert max(strains) == pytest.approx(0.1, abs=0.01)


# Faster than its waves: the end is torn off at once, in front of everything else.
def test_supersonic_pull(scene):
    c = rope(elements=40)
    go = pull(c, 1.5 * waveSpeed(c))
    O.engines = ancf.engines(c)
    O.dt = c.criticalTimeStep()
    work = go(100)
    assert energyOf(c) == pytest.approx(work, rel=0.02)


def test_one_limit_for_all(scene):
    c = rope()
    O.engines = ancf.engines(c, substeps=1)
    limit = c.criticalTimeStep()
    O.dt = limit
    O.step()
    O.dt = 1.001 * limit
    assert refused(O.step, "above the stable one") == pytest.approx(limit, rel=1e-5)


def test_more_steps_than_a_step_should_take(scene):
    c = rope()
    O.engines = ancf.engines(c)
    O.dt = 1.0
    with pytest.raises(RuntimeError, match="O.dt = 1 s would take more than 1000 steps"):
        O.step()


def waving(c):
    """Waves of all lengths along the cable."""
    k = math.pi * np.arange(1, c.engine.nElements + 1)
    c.setVelocity(lambda p: Vector3(*(1e-3 * np.cos(k * p[0]).sum() * np.array([3, 2, 1]))))


# Runge-Kutta of order 4 is stable to w dt = 2.83, leapfrog to 2, of which the engine takes 0.9.
def test_rk4_has_its_own_limit(scene):
    c = rope(elements=20)
    waving(c)
    O.engines = ancf.engines(c, integrator="rk4")
    O.dt = 1.38 * c.criticalTimeStep()
    O.step()
    start = energyOf(c)
    steps(2000)
    assert energyOf(c) < 1.001 * start
    O.dt = 1.4 * c.criticalTimeStep()
    with pytest.raises(RuntimeError, match="above the stable one"):
        O.step()


def test_rk4_counts_its_damping(scene):
    c = rope(damping=1e-4)
    waving(c)
    O.trackEnergy = True
    O.engines = ancf.engines(c, integrator="rk4")
    O.dt = 0.3 * c.criticalTimeStep()
    O.step()
    start = O.energy.total()
    steps(300)
    assert O.energy["cableDamping"] > 0.3 * start
    assert O.energy.total() == pytest.approx(start, rel=1e-4)


# ---- bodies --------------------------------------------------------------------------------------


def test_step_of_contacts_between_bodies(scene):
    c = rope(length=10.0)
    for x, v in ((0, 3), (0.5, -3)):
        O.bodies[ball((x, 3, 0), 0.1, mass=1.0, material="cable")].state.vel = (v, 0, 0)
    O.engines = ancf.engines(c, substeps=40)
    good = ancf.timeStep(speed=3)
    O.dt = 20 * good
    told = refused(O.step, "too long for contacts between bodies of HollarsMat that meet at 3 m/s")
    assert told == pytest.approx(good, rel=1e-5)


# From anywhere, by more than it is thick in a step: it is met in the step in which it would pass.
@pytest.mark.parametrize("steps_ahead", [0.6, 1.7, 8.2, 20.51])
@pytest.mark.parametrize("ratio", [1.1, 1.5, 1.99])
def test_nothing_passes_in_a_step(scene, ratio, steps_ahead):
    c = rope(elements=4, length=0.32, contactPoints=2)
    c.fix(0)
    c.fix(-1)
    radius = 2.5e-3
    O.engines = ancf.engines(c)
    O.dt = c.criticalTimeStep()
    way = ratio * (radius + c.radius)
    shot = ball(
        (0.13, 0, radius + c.radius + steps_ahead * way), radius, mass=1e-5, material="cable"
    )
    O.bodies[shot].state.vel = (0, 0, -way / O.dt)
    for _ in range(math.ceil(steps_ahead) + 3):
        O.step()
        if c.engine.contacts:
            break
    assert c.engine.contacts > 0
    assert O.bodies[shot].state.pos[2] > 0


def test_body_too_fast_to_be_met(scene):
    c = rope(contactPoints=2)
    shot = ball((0.5, 0, 3), 0.02, mass=0.01, material="cable")
    O.engines = ancf.engines(c)
    O.dt = c.criticalTimeStep()
    O.bodies[shot].state.vel = (0, 0, -2.4 * (0.02 + c.radius) / O.dt)
    assert refused(O.step, f"body {shot} moves") == pytest.approx(O.dt / 1.2, rel=1e-5)
