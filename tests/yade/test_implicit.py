"""Implicit steps in YADE: cables with bodies at their knots and moved ends, energies, resuming, refusals."""

import math

import numpy as np
import pytest

from helpers import O, ancf, array, ball, material, steps
from yade import Vector3, utils

G = 9.81


def rope(elements=12, points=((0, 0, 0), (1, 0, 0)), **options):
    """A smooth cable that touches nothing."""
    material("cable", young=1e8)
    given = dict(diameter=4e-3, material="cable", contactPoints=0, curvature="exact")
    c = ancf.Cable(points, elements=elements, **{**given, **options})
    c.append()
    return c


def pendulum(weight=0.2, at=(1, 0, 0), **options):
    """Falls from the horizontal, with a ball at its end."""
    c = rope(**options)
    c.fix(0)
    end = ball(at, 0.02, mass=weight)
    c.carry(-1, end)
    return c, end


def start(c, dt, integrator="implicit", gravity=(0, 0, -G)):
    O.engines = ancf.engines(c, gravity=gravity, integrator=integrator)
    if dt:
        O.dt = dt


# The tip at 1 s of the flexible pendulum of 64 elements, undamped, and of DOP853 on 8; orders 2.
def test_flexible_pendulum(scene):
    def error(dt):
        O.reset()
        O.materials.append(ancf.HollarsMat(young=1.6e6, density=320, label="soft"))
        c = ancf.Cable(
            [(0, 0, 0), (1, 0, 0)],
            elements=16,
            diameter=2 * math.sqrt(25e-6 / math.pi),
            material="soft",
            contactPoints=0,
            axialRule="reduced",
        )
        c.append()
        c.fix(0)
        c.setVelocity(lambda p: Vector3(0, 0, -4 * p[0]))
        start(c, dt, gravity=(0, -9.8, 0))
        steps(round(1 / dt))
        return np.linalg.norm(array(c.point(1)) - [0.652800, 0.046069, 0.660242])

    fine = error(2.5e-4)
    assert fine < 5e-5
    assert error(1e-3) > 4 * fine


def test_step_is_a_matter_of_accuracy(scene):
    c = rope()
    c.fix(0)
    start(c, None)
    assert O.dt == 1e-3 > 20 * c.criticalTimeStep()
    steps(10)
    assert c.engine.newtonIterations >= 1 and c.engine.stepParts == 1


# One end goes with a body that is moved; leapfrog's steps are a hundredth as long.
def test_moved_end(scene):
    def shape(integrator, dt):
        O.reset()
        arc = [(0.4 + 0.4 * math.cos(u), 0, 0.4 * math.sin(u)) for u in np.linspace(-math.pi, 0, 9)]
        c = rope(points=arc, elements=1, bending=0.02)
        c.fix(0)
        grip = utils.sphere((0.8, 0, 0), 0.01, fixed=True)
        grip.shape.color = (1, 0, 0)
        body = O.bodies.append(grip)
        grip.bounded = False
        c.follow(-1, body)
        start(c, dt, integrator)
        c.relax(1e-9)
        while O.time < 0.5 - dt / 2:
            ways = [0.05 * (1 - math.cos(6 * t)) for t in (O.time, O.time + O.dt)]
            grip.state.vel = Vector3(0.5, 0.3, 1) * (ways[1] - ways[0]) / O.dt
            O.step()
        assert np.abs(c.knots[-1] - array(grip.state.pos)).max() < 1e-12
        return c.curve(5)

    fine = shape("leapfrog", 1e-5)
    error = [np.abs(shape("implicit", dt) - fine).max() for dt in (8e-3, 2e-3)]
    assert error[0] < 1e-3
    assert error[0] / error[1] > 9  # 16 by second order, 4 by first


# A ball at the end: where the knot is, pulled by its own forces, its energy in the sum.
@pytest.mark.parametrize("damping", [0.0, 1e-3])
@pytest.mark.parametrize("mass", ["consistent", "lumped"])
def test_ball_at_a_knot(scene, damping, mass):
    O.trackEnergy = True
    c, end = pendulum(damping=damping, mass=mass)
    start(c, 1e-3)
    steps(2)
    whole = O.energy.total()
    height = 0.2 * G
    for _ in range(60):
        steps(10)
        assert np.abs(c.knots[-1] - array(O.bodies[end].state.pos)).max() < 1e-14
        assert O.energy.total() == pytest.approx(whole, abs=1e-6 * height)
    assert dict(O.energy.items())["cableKinetic"] > 0
    assert (O.energy["cableDamping"] > 0) == (damping > 0)
    assert 0 < abs(O.energy["cableNumerical"]) < 1e-3 * height
    O.trackEnergy = False


# A wave that steps cannot resolve: what it loses stands in the account.
def test_numerical_losses_are_booked(scene):
    O.trackEnergy = True
    c = rope(elements=8)
    c.setVelocity(lambda p: Vector3((-1) ** round(p[0] * 8), 0, 0))
    start(c, 1e-2, gravity=(0, 0, 0))
    c.engine.spectralRadius = 0.5
    steps(1)
    whole = O.energy.total()
    steps(30)
    assert O.energy["cableNumerical"] > 0.9 * whole
    assert O.energy.total() == pytest.approx(whole, rel=1e-5)
    O.trackEnergy = False


def test_reaction_and_force_on_a_carried_body(scene):
    c, end = pendulum(points=((0, 0, 0), (0, 0, -1)), at=(0, 0, -1), damping=5e-2, bending=0.0)
    O.forces.setPermF(end, (0, 0, -3))
    start(c, 2e-3)
    steps(2000)
    weight = c.section.rhoA * c.length * G
    assert c.reaction(0)[2] == pytest.approx(weight + 0.2 * G + 3, rel=1e-6)
    assert c.reaction(-1)[2] == pytest.approx(-0.2 * G - 3, rel=1e-6)


@pytest.mark.parametrize("name", ["scene.xml", "scene.yade.bz2"])
def test_resumes_bit_for_bit(scene, tmp_path, name):
    def state():
        return repr((list(c.engine.position), list(c.engine.velocity), list(c.engine.acceleration)))

    c, end = pendulum(damping=1e-4)
    start(c, 1e-3)
    steps(150)
    O.save(str(tmp_path / name))
    steps(150)
    there = state(), list(O.bodies[end].state.pos)
    O.load(str(tmp_path / name))
    steps(150)
    assert (state(), list(O.bodies[end].state.pos)) == there


# Leapfrog takes over from implicit steps and back: velocities are not taken for those of half steps.
def test_change_of_integrator(scene):
    def end(change):
        O.reset()
        c, _ = pendulum(elements=4)
        start(c, 1e-3)
        steps(150)
        if change:
            c.engine.integrator = "leapfrog"
            O.dt = 1e-3 / 80
            steps(80 * 50)
            c.engine.integrator = "implicit"
            O.dt = 1e-3
        else:
            steps(50)
        steps(50)
        return array(c.point(1))

    assert np.abs(end(True) - end(False)).max() < 3e-4


# ---- refusals -------------------------------------------------------------------------------------


def test_contact_is_refused(scene):
    c = rope(contactPoints=3)
    with pytest.raises(ValueError, match="implicit.*contact.*contactPoints=0"):
        ancf.engines(c, integrator="implicit")


def test_body_off_its_centre_is_refused(scene):
    c = rope()
    c.carry(-1, ball((1.05, 0, 0), 0.02, mass=0.1), at=(-0.05, 0, 0))
    with pytest.raises(ValueError, match="implicit.*centre"):
        ancf.engines(c, integrator="implicit")


def test_carried_ball_that_may_touch_is_refused(scene):
    c, _ = pendulum()
    other = ball((1, 0, -1), 0.1)
    with pytest.raises(ValueError, match=f"implicit.*contact.*body {other} "):
        ancf.engines(c, integrator="implicit")
    O.bodies[other].groupMask = 2
    ancf.engines(c, integrator="implicit")


def test_refused_when_it_is_chosen_or_comes_later(scene):
    c = rope(contactPoints=3)
    O.engines = ancf.engines(c)
    O.step()
    c.engine.integrator = "implicit"
    with pytest.raises((ValueError, RuntimeError), match="contactPoints=0"):
        O.step()
    O.reset()
    c, _ = pendulum()
    start(c, 1e-3)
    O.step()
    ball((1, 0, -1), 0.1)
    with pytest.raises((ValueError, RuntimeError), match="groupMask"):
        O.step()


@pytest.mark.parametrize("value", [-0.1, 1.1, math.nan])
def test_spectral_radius(scene, value):
    c = rope()
    start(c, 1e-3)
    with pytest.raises(ValueError, match="spectralRadius"):
        c.engine.spectralRadius = value
    O.step()


def test_step_that_does_not_converge_is_named(scene):
    c, _ = pendulum()
    start(c, 1e-3)
    steps(3)
    before = list(c.engine.position)
    c.load(-1, (0, 0, 1e90))
    with pytest.raises(RuntimeError, match="O.dt = 0.001 s does not converge.*element 11"):
        O.step()
    assert list(c.engine.position) == before and c.engine.rejectedSteps == 11


def looseLoop(spectralRadius):
    """A loop without bending stiffness that is given waves which its step does not resolve."""
    material("cable")
    turn = 2 * math.pi * np.arange(12) / 12
    corners = 0.1 * np.column_stack([np.cos(turn), np.sin(turn), 0 * turn])
    loop = ancf.Cable(
        corners,
        2,
        diameter=2e-3,
        material="cable",
        bending=0,
        mass="consistent",
        closed=True,
        contactPoints=0,
    )
    loop.setVelocity(lambda p: (0, math.sin(40 * p[0]), 1 + math.sin(90 * p[1])))
    O.engines = ancf.engines(loop, integrator="implicit")
    O.dt = 1e-3
    loop.engine.spectralRadius = spectralRadius
    return loop


def test_waves_that_are_not_resolved_are_told_with_what_helps(scene):
    """Generalised-alpha may gain energy where strains are large; it does not at half the step or with more loss."""
    looseLoop(0.9)
    with pytest.raises(
        RuntimeError, match="gained.* use O.dt = 0.0005 s, a spectralRadius below 0.9, or damping"
    ):
        steps(150)
    for radius, dt in ((0.8, 1e-3), (0.9, 5e-4)):
        O.reset()
        loop = looseLoop(radius)
        O.dt = dt
        start = sum(loop.energy().values())
        steps(round(0.15 / dt))
        assert sum(loop.energy().values()) < start
