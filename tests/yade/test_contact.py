"""Contact and friction in YADE against closed forms."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from helpers import (
    O,
    Vector3,
    ancf,
    array,
    ball,
    bodyEngines,
    hertz,
    material,
    plane,
    runTo,
    squareNet,
    steps,
)
from yade import Quaternion

GRAVITY = 9.81


def restitution(speed, alpha):
    """Hunt-Crossley: g(v) = g(-e v), g(u) = a u - ln(1 + a u), a = 1.5 alpha; whatever mass, k and
    n.
    """
    a = 1.5 * alpha

    def g(u):
        return a * u - math.log1p(a * u)

    return brentq(lambda e: g(speed) - g(-e * speed), 1e-6, 1)


def hollars(speed, mu_s, mu_k, v0):
    """Eq. 11 per unit of normal force."""
    u = speed / v0
    return min(u, 1) * (mu_k + 2 * (mu_s - mu_k) / (1 + min(u, u) ** 2))


@pytest.mark.parametrize("alpha", [0.08, 0.2, 0.32])
@pytest.mark.parametrize("target", ["sphere", "box"])
def test_restitution(scene, alpha, target):
    material("m", young=1e7, density=1000, impactDamping=alpha)
    if target == "sphere":
        ball((0, 0, -0.1), 0.1, material="m")
        effective = 0.05
    else:
        plane((0, 0, -0.1), (0.5, 0.5, 0.1), material="m")
        effective = 0.1
    moving = ball((0, 0, 0.1001), 0.1, mass=4.0, material="m")
    state = O.bodies[moving].state
    state.vel = Vector3(0, 0, -1.5)
    O.engines = bodyEngines()
    k = hertz(effective, 1e7, 0.3, 1e7, 0.3)
    duration = 2.94 * (5 * 4.0 / (4 * k)) ** 0.4 / 1.5**0.2
    O.dt = duration / 20000
    steps(30000)
    assert state.vel[2] / 1.5 == pytest.approx(restitution(1.5, alpha), abs=1e-4)


def test_sliding_sphere_comes_to_rest(scene):
    mu, speed, mass, radius = 0.25, 0.5, 1.0, 0.1
    material(
        "m", young=1e8, staticFriction=mu, kineticFriction=mu, transitionVelocity=1e-4, density=1000
    )
    plane((0.5, 0, -0.1), (2, 1, 0.1), material="m")
    depth = (mass * GRAVITY / hertz(radius, 1e8, 0.3, 1e8, 0.3)) ** (2 / 3)
    number = ball((0, 0, radius - depth), radius, mass=mass, material="m")
    state = O.bodies[number].state
    state.vel, state.blockedDOFs = Vector3(speed, 0, 0), "XYZ"
    O.engines = bodyEngines(Vector3(0, 0, -GRAVITY), friction="coulomb")
    O.dt = 2e-5
    stop = speed / (mu * GRAVITY)
    runTo(stop / 2)
    assert state.vel[0] == pytest.approx(speed / 2, rel=1e-3)
    runTo(1.2 * stop)
    assert state.pos[0] == pytest.approx(speed**2 / (2 * mu * GRAVITY), rel=1e-3)
    assert abs(state.vel[0]) < 1e-6


def pressedCable(force=(0, 0, 0), model="ancf", **values):
    """A short straight cable on a fixed box, pressed by 0.5 N on its two knots."""
    mat = dict(impactDamping=0.5, staticFriction=0.3, kineticFriction=0.2)
    material("cable", **{**mat, **values})
    soft = material("soft", **{**mat, **values, "young": 5e6})  # so that dt = 2e-5 is stable
    plane((0, 0, -0.1), (1, 1, 0.1), material=soft)
    k = hertz(5e-4, 4.456e8, 0.3, 5e6, 0.3)
    depth = (0.1 / k) ** (2 / 3)
    z = 5e-4 - depth
    cable = ancf.Cable(
        [(0, 0, z), (0.04, 0, z)], diameter=1e-3, material="cable", model=model, mass="lumped"
    )
    for knot in (0, 1):
        cable.load(knot, (force[0] / 2, force[1] / 2, -0.25))
    O.engines = ancf.engines(cable)
    return cable


@pytest.mark.parametrize("model, along", [("ancf", (0.05, 0, 0)), ("springs", (0, 0.05, 0))])
def test_cable_point_creeps_as_hollars_says(scene, model, along):
    """All points creep alike: along an ANCF cable, or across the two points of a spring."""
    v0 = 1e-3
    cable = pressedCable(along, model, transitionVelocity=v0)
    O.dt = 2e-5
    exact = brentq(lambda v: 0.5 * hollars(v, 0.3, 0.2, v0) - 0.05, 0, v0)
    assert exact == pytest.approx(2.58e-4, rel=2e-2)  # REFERENCE of a prototype, only to be sure
    steps(2000)
    start, time = array(cable.point(0.5)), O.time
    steps(5000)
    creep = np.linalg.norm((array(cable.point(0.5)) - start)[:2]) / (O.time - time)
    assert creep == pytest.approx(exact, rel=1e-2)


def test_ball_creeps_down_a_cable_as_its_weight_says(scene):
    """On a straight held cable on a slope: mu v/v0 = tan(slope), whatever the step is."""
    mu, v0, slope, dt = 0.3, 2e-4, 0.1, 5e-5
    friction = dict(staticFriction=mu, kineticFriction=mu, transitionVelocity=v0)
    material("cable", impactDamping=100.0, **friction)
    cable = ancf.Cable([(-0.2, 0, 0), (0.2, 0, 0)], 1, diameter=2e-3, material="cable")
    cable.clamp(0)
    cable.clamp(-1)
    state = O.bodies[ball((0, 0, 0.011), 0.01, mass=0.004, material="cable")].state
    state.blockedDOFs = "yXYZ"
    O.engines = ancf.engines(cable, gravity=(GRAVITY * slope, 0, -GRAVITY))
    O.dt = dt
    cable.engine.energyTolerance = (
        math.inf
    )  # what the ball is slowed by here is on nobody's account
    for _ in range(2000):
        O.step()
        state.vel = (state.vel[0], 0, 0.99 * state.vel[2])
    start, time = state.pos[0], O.time
    steps(1000)
    creep = (state.pos[0] - start) / (O.time - time)
    assert creep == pytest.approx(v0 * slope / mu, rel=5e-3)


def test_cable_holds_the_axis_of_a_body_out_of_balance(scene):
    """A ball that spins about a fixed centre, w about z, its axis of inertia tilted: w^2 Ixz has to come from friction at
    its pole, F on an arm that goes round with it. The pole slips at v0 F/(mu N).
    """
    mu, v0, w, tilt, radius, thick, depth = 0.3, 1e-3, 50.0, 0.3, 0.01, 1e-3, 1e-5
    friction = dict(staticFriction=mu, kineticFriction=mu, transitionVelocity=v0)
    material("cable", **friction)
    arm = radius + thick - depth  # forces act at the centreline
    cable = ancf.Cable([(-0.2, 0, arm), (0.2, 0, arm)], 1, diameter=2 * thick, material="cable")
    cable.clamp(0)
    cable.clamp(-1)
    body = O.bodies[ball((0, 0, 0), radius, mass=0.004, material="cable")]
    body.aspherical, state = True, body.state
    state.blockedDOFs = "xyz"
    inertia = np.array([1e-6, 1e-6, 1.5e-6])
    state.inertia = Vector3(*inertia)
    state.ori, state.angVel = Quaternion((0, 1, 0), tilt), (0, 0, w)
    axes = np.array(
        [[math.cos(tilt), 0, math.sin(tilt)], [0, 1, 0], [-math.sin(tilt), 0, math.cos(tilt)]]
    )
    tensor = axes @ np.diag(inertia) @ axes.T
    state.angMom = Vector3(*(w * tensor[:, 2]))
    O.engines = ancf.engines(cable)
    O.dt = 2e-5
    steps(1000)
    pressed = -(cable.reaction(0)[2] + cable.reaction(-1)[2])
    slip = v0 * w**2 * abs(tensor[0, 2]) / arm / (mu * pressed)
    assert 0.1 * v0 < slip < 0.5 * v0
    assert math.hypot(*array(state.angVel)[:2]) * arm == pytest.approx(slip, rel=5e-3)


def test_held_cable_point_does_not_chatter(scene):
    cable = pressedCable(force=(0.05, 0, 0), transitionVelocity=1e-3)
    O.dt = 2e-5
    steps(2000)
    speeds = []
    for _ in range(200):
        O.step()
        speeds.append(cable.velocity(0)[0])
    assert max(speeds) < 4e-4 and min(speeds) > 1e-4


def test_halving_the_step_keeps_the_tangential_impulse(scene):
    def impulse(dt):
        O.reset()
        material("cable", impactDamping=20.0)
        plane((0, 0, -0.1), (1, 1, 0.1), material="cable")
        net = squareNet(2, 0.04, center=(0, 0, 4.99e-4), normal=(0, 0, 1), damping=2e-5)
        net.setVelocity(lambda p: Vector3(0.05, 0, 0))
        O.engines = ancf.engines(net, gravity=(0, 0, -GRAVITY))
        O.dt = dt
        before = net.engine.momentum()[0][0]
        runTo(0.01)
        return before - net.engine.momentum()[0][0], before

    coarse, all_ = impulse(2e-5)
    fine, _ = impulse(1e-5)
    assert 0.1 * all_ < fine < 0.95 * all_
    assert coarse == pytest.approx(fine, rel=2e-2)


def test_spinning_box_drags_a_cable(scene):
    material("cable", impactDamping=100.0)
    box = plane((0, 0, -0.1), (1, 1, 0.1), material="cable")
    O.bodies[box].state.angVel = Vector3(0, 0, 1.0)
    cable = ancf.Cable(
        [(0.09, 0, 4.99e-4), (0.11, 0, 4.99e-4)], diameter=1e-3, material="cable", damping=2e-5
    )
    O.engines = ancf.engines(cable, gravity=(0, 0, -GRAVITY))
    runTo(0.03)
    early = array(cable.velocity(0.5))
    assert early[1] == pytest.approx(0.2 * GRAVITY * 0.03, rel=0.1)  # slipping: mu_k g t
    runTo(0.2)
    p, v = array(cable.point(0.5)), array(cable.velocity(0.5))
    assert np.linalg.norm(v) == pytest.approx(np.hypot(p[0], p[1]) * 1.0, rel=5e-3)
    assert v @ np.array([p[0], p[1], 0]) == pytest.approx(0, abs=1e-2 * np.linalg.norm(v) * 0.1)


def test_cable_over_two_spheres_rests(scene):
    friction = dict(staticFriction=0.5, kineticFriction=0.5)
    material("m", young=1e7, density=1000, impactDamping=1.0, **friction)
    spheres = [ball((x, 0, 0), 0.04, material="m") for x in (-0.12, 0.12)]
    ends = [(-0.3, 0, 0.041), (0.3, 0, 0.041)]
    cable = ancf.Cable(ends, 20, diameter=2e-3, material="m", mass="lumped", damping=2e-5)
    O.engines = ancf.engines(cable, gravity=(0, 0, -GRAVITY))
    engine = cable.engine
    for _ in range(60):  # takes the swing out
        runTo(O.time + 0.08)
        engine.velocity = [0.0] * len(engine.velocity)
    runTo(O.time + 0.1)
    weight = cable.mass * GRAVITY
    speeds = [cable.velocity(s).norm() for s in np.linspace(0, 1, 21)]
    force = sum((array(O.forces.f(i)) for i in spheres), np.zeros(3))
    assert max(speeds) < 0.02
    assert max(cable.point(0)[2], cable.point(1)[2]) < -0.02  # the ends hang
    assert cable.point(0.5)[2] < 0.03  # and the middle sags
    assert force[2] == pytest.approx(-weight, rel=1e-2)
    assert np.abs(force[:2]).max() < 1e-2 * weight
