"""Cables round sheaves against closed forms; R is the radius of the centreline."""

import builtins
import math

import numpy as np
import pytest

import ancf
from ancf import pulleys
from helpers import array
from yade import O, Vector3, utils, wrapper

G = 9.81


def cableMaterial(label, ea, rhoA, diameter, **values):
    area = math.pi * diameter**2 / 4
    given = dict(poisson=0.3, staticFriction=0.3, kineticFriction=0.3, normalExponent=1.0)
    made = {**given, **values}
    O.materials.append(ancf.HollarsMat(label=label, young=ea / area, density=rhoA / area, **made))


def record(every, read):
    """Rows of read(), one every so many steps."""
    rows = builtins._pulleyRows = []
    builtins._pulleyRead = read
    command = "import builtins; builtins._pulleyRows.append(builtins._pulleyRead())"
    runner = wrapper.PyRunner(command=command, iterPeriod=every, initRun=False)
    O.engines = O.engines + [runner]
    return rows


def run(time):
    O.run(round(time / O.dt), True)


LINEAR = dict(normal="linear")
D, R = 2e-3, 0.05  # of the cable, of its centreline on the sheave [m]


def onSheave(
    theta, mu, axis=(0, 1, 0), elementAngle=15.0, points=2, load=1.0, profile=None, span=3, **more
):
    """A cable that wraps a sheave by theta [deg], knot 0 pulled by `load`; (cable, sheave, span)."""
    O.reset()
    friction = dict(staticFriction=mu, kineticFriction=mu)
    values = dict(normalStiffness=1e6, dashpot=20.0)
    cableMaterial("cable", 2e4, 0.1, D, **{**friction, **values, **more})
    sheave = pulleys.sheave((0, 0, 0), R - D / 2, axis=axis, width=6 * D, material="cable")
    a = pulleys.axisOf(sheave)
    k = int(np.argmax(abs(a)))
    e1 = np.zeros(3)
    e1[(k + 1) % 3] = 1
    e2 = np.cross(a, e1)
    angle, length = math.radians(theta), span * R * math.radians(elementAngle)
    u = -math.sin(angle) * e1 + math.cos(angle) * e2
    end = R * (math.cos(angle) * e1 + math.sin(angle) * e2) + length * u
    stop = (sheave, 1, int(theta // 360))
    path = pulleys.Path([stop], diameter=D, start=R * e1 - length * e2, end=end)
    assert path.angles[0] == pytest.approx(angle, rel=1e-9)
    pull = profile or (lambda phi: load * math.exp(0.8 * mu * phi))
    cable = pulleys.lay(
        path,
        round(path.length / (R * math.radians(elementAngle))),
        diameter=D,
        material="cable",
        bending=0.0,
        contactPoints=points,
        damping=2e-5,
        mass="lumped",
        tension=lambda s: pull(min(max(s - length, 0) / R, angle)),
    )
    cable.load(0, load * -e2)
    return cable, sheave, path, u


def turned(cable, sheave, speed):
    engine = ancf.SheaveEngine()
    engine.add(sheave, speed=speed)
    O.engines = pulleys.engines(cable, engine, contact=LINEAR, substeps=1)
    O.dt = 0.8 * cable.criticalTimeStep()
    return engine


def capstan(theta, mu, time, slip=0.1, **more):
    """T2/T1 on a drum that turns under a held cable; the cable, the sheave."""
    cable, sheave, _, _ = onSheave(theta, mu, **more)
    cable.fix(-1)
    turned(cable, sheave, -slip / R)
    rows = record(20, lambda: cable.reaction(-1).norm())
    run(time)
    return np.mean(rows[len(rows) // 2 :]), cable, sheave


CAPSTANS = [
    (90, 0.1, 0.02),
    (90, 0.5, 0.02),
    (180, 0.3, 0.04),
    (270, 0.5, 0.1),
    (540, 0.1, 0.1),
    (540, 0.3, 0.2),
]


@pytest.mark.parametrize("theta, mu, time", CAPSTANS)
def test_capstan(scene, theta, mu, time):
    ratio, _, _ = capstan(theta, mu, time)
    assert ratio == pytest.approx(math.exp(mu * math.radians(theta)), rel=0.01)


def test_normal_force_follows_tension(scene):
    ratio, cable, sheave = capstan(180, 0.3, 0.04, profile=lambda phi: math.exp(0.3 * phi))
    wrap = pulleys.wrap(cable, sheave)
    assert math.degrees(wrap.wrapAngle) == pytest.approx(180, abs=2.5)
    # N' = T/R, as a sum over the wrap: single contacts share the force of an element unevenly.
    got = np.cumsum(wrap.normal) - wrap.normal / 2
    assert got == pytest.approx((np.exp(0.3 * wrap.angle) - 1) / 0.3, abs=0.03 * got[-1])
    assert got[-1] == pytest.approx((ratio - 1) / 0.3, rel=0.03)
    assert wrap.frictionSum == pytest.approx(1 - ratio, rel=0.02)
    assert not wrap.sticks.any()
    assert wrap.exit == pytest.approx(ratio, rel=0.02)
    assert wrap.slipPower == pytest.approx((ratio - 1) * 0.1, rel=0.02)


def test_static_above_kinetic_friction(scene):
    """Eq. 11 at the slip speed."""
    mu = 0.2 + 2 * 0.1 / (1 + 100)
    ratio, _, _ = capstan(
        180, mu, 0.05, slip=0.1, staticFriction=0.3, kineticFriction=0.2, transitionVelocity=0.01
    )
    assert ratio == pytest.approx(math.exp(mu * math.pi), rel=0.01)


def test_moving_cable(scene):
    """T - rhoA v^2 in place of T."""
    speed, mu, load, rhoA = 2.0, 0.3, 2.0, 0.1
    hoop = rhoA * speed**2
    cable, sheave, path, u = onSheave(
        90, mu, load=load, span=16, profile=lambda phi: hoop + (load - hoop) * math.exp(mu * phi)
    )
    cable.setVelocity(path.flow(speed))
    hand = utils.sphere(Vector3(*cable.knots[-1]), 0.01, mask=0)
    hand.state.mass = 1
    hand = O.bodies.append(hand)
    guide = ancf.GuideEngine()
    guide.add(hand, direction=Vector3(*u), motion=lambda t: speed * t)
    cable.follow(-1, hand)
    engine = ancf.SheaveEngine()
    engine.add(sheave, speed=0)
    O.engines = pulleys.engines(cable, engine, guide, contact=LINEAR, substeps=1)
    O.dt = 0.8 * cable.criticalTimeStep()
    rows = record(20, lambda: cable.reaction(-1).norm())
    run(0.06)
    ratio = (np.mean(rows[len(rows) // 3 :]) - hoop) / (load - hoop)
    assert ratio == pytest.approx(math.exp(mu * math.pi / 2), rel=0.01)


def test_stiction_creeps_as_hollars_does(scene):
    """Below the limit the cable stays, but for v = v0 s with mu(s) = ln(T2/T1)/theta."""
    mu = 0.15  # of 0.3
    cable, sheave, _, u = onSheave(180, 0.3, profile=lambda phi: math.exp(mu * phi))
    cable.load(-1, math.exp(mu * math.pi) * u)
    turned(cable, sheave, 0.0)
    ends = record(20, lambda: (cable.velocity(0.0).norm(), *array(cable.knots[-1])))
    run(0.04)
    path = np.array(ends)[:, 1:]
    half = len(path) // 2
    moved = np.linalg.norm(path[-1] - path[half]) / ((len(path) - 1 - half) * 20 * O.dt)
    assert moved == pytest.approx(1e-3 * mu / 0.3, rel=0.02)


def test_atwood(scene):
    """A heavy sheave that the cable does not slip on."""
    m1, m2, inertia, radius = 1.0, 1.2, 0.02, 0.1
    a = (m2 - m1) * G / (m1 + m2 + inertia / radius**2)
    t1, t2 = m1 * (G + a), m2 * (G - a)
    cableMaterial(
        "cable",
        2e4,
        1e-3,
        D,
        staticFriction=0.5,
        kineticFriction=0.5,
        normalStiffness=1e5,
        dashpot=0.3,
    )
    sheave = pulleys.sheave(
        (0, 0, 0), radius - D / 2, width=6 * D, material="cable", inertia=inertia
    )
    span = 0.2
    path = pulleys.Path(
        [(sheave, 1)], diameter=D, start=(-radius, 0, -span), end=(radius, 0, -span)
    )
    cable = pulleys.lay(
        path,
        round(path.length / (radius * math.radians(22.5))),
        diameter=D,
        material="cable",
        bending=0.0,
        contactPoints=1,
        damping=2e-6,
        mass="lumped",
        tension=lambda s: t1 + (t2 - t1) * min(max((s - span) / (math.pi * radius), 0), 1),
    )
    weights = []
    for knot, mass in ((0, m1), (-1, m2)):
        ball = utils.sphere(Vector3(*cable.knots[knot]), 0.02, mask=0)
        ball.state.mass, ball.state.inertia = mass, 0.4 * mass * 0.02**2 * Vector3(1, 1, 1)
        weights.append(O.bodies.append(ball))
        cable.carry(knot, weights[-1])
    engine = ancf.SheaveEngine()
    engine.add(sheave)
    O.engines = pulleys.engines(cable, engine, gravity=(0, 0, -G), contact=LINEAR, substeps=1)
    O.dt = 0.8 * cable.criticalTimeStep()

    def read():
        one, two = (O.bodies[i].state for i in weights)
        spin = O.bodies[sheave].state.angVel[1]
        momentum = cable.engine.momentum()[1][1] + inertia * spin
        return (
            O.time,
            one.vel[2],
            -two.vel[2],
            radius * spin,
            momentum,
            G * (m1 * one.pos[0] + m2 * two.pos[0]),
        )

    rows = record(10, read)
    run(0.12)
    t, *speeds, momentum, torque = np.array(rows).T
    assert [np.polyfit(t, v, 1)[0] for v in speeds] == pytest.approx([a] * 3, rel=5e-3)
    rate = np.diff(momentum) / np.diff(t)
    assert rate == pytest.approx((torque[1:] + torque[:-1]) / 2, rel=1e-3)


def belt(
    ea, v0, driver, driven, pretension=20.0, rhoA=0.02, elementAngle=15.0, speed=2.0, distance=0.16
):
    """A belt on two equal sheaves, laid under its pretension and running; driver, driven: how the
    engine adds them.
    """
    cableMaterial(
        "cable",
        ea,
        rhoA,
        D,
        normalStiffness=3e5,
        dashpot=3.0,
        staticFriction=0.3,
        kineticFriction=0.3,
        transitionVelocity=v0,
    )
    ids = [
        pulleys.sheave((x, 0, 0), R - D / 2, width=6 * D, material="cable", inertia=2e-4)
        for x in (0, distance)
    ]
    path = pulleys.Path([(i, 1) for i in ids], diameter=D)
    cable = pulleys.lay(
        path,
        round(path.length / (R * math.radians(elementAngle))),
        diameter=D,
        material="cable",
        bending=0.0,
        contactPoints=2,
        damping=5e-5,
        mass="lumped",
        tension=pretension,
    )
    cable.setVelocity(path.flow(speed))
    engine = ancf.SheaveEngine()
    for i, how in zip(ids, (driver, driven)):
        O.bodies[i].state.angVel = Vector3(0, speed / R, 0)
        engine.add(i, **how)
    O.engines = pulleys.engines(cable, engine, contact=LINEAR, substeps=1)
    O.dt = 0.8 * cable.criticalTimeStep()
    # Straight spans: the upper one leaves the driver (axis y: x to z is ... ) - tension of each.
    return cable, ids, engine, path


def spanTensions(cable):
    """Mean tensions of the free spans above and below, (upper, lower)."""
    found = []
    for side in (1, -1):
        values = [
            t
            for p, t in zip(cable.curve(2), cable.tensions(2))
            if side * p[2] > 0.6 * R and 0.25 * 0.16 < p[0] < 0.75 * 0.16
        ]
        found.append(np.mean(values))
    return found


def test_belt_slips_by_eytelwein(scene):
    cable, ids, engine, _ = belt(5e3, 1e-3, dict(speed=2.0 / R), dict(speed=1.6 / R))
    rows = record(25, lambda: (*spanTensions(cable), engine.contactTorque[1]))
    run(0.2)
    upper, lower, torque = np.mean(rows[len(rows) // 2 :], axis=0)
    tight = max(upper, lower) - 0.02 * 2.0**2
    assert abs(torque) / R == pytest.approx(tight * (1 - math.exp(-0.3 * math.pi)), rel=0.02)


def test_belt_creep(scene):
    """Total creep tends to v (T1 - T2)/EA as v_t0 falls."""
    errors = []
    for v0 in (1e-3, 1e-4):
        O.reset()
        cable, ids, engine, _ = belt(5e3, v0, dict(speed=2.0 / R), dict(torque=-0.3))
        rows = record(25, lambda: (*spanTensions(cable), *engine.angle, O.time))
        run(0.3)
        half = np.array(rows[len(rows) // 2 :])
        upper, lower = half[:, 0].mean(), half[:, 1].mean()
        first, second = (np.polyfit(half[:, 4], half[:, k], 1)[0] * R for k in (2, 3))
        errors.append((first - second) / (2.0 * abs(upper - lower) / 5e3) - 1)
    assert abs(errors[1]) < 0.05 and abs(errors[1]) < abs(errors[0])
