"""Drives that lead a body, what they push with, and guides that are saved."""

import math

import numpy as np
import pytest

from ancf import pulleys
from helpers import O, Vector3, ancf, ball, bodyEngines, hertz, material, plane, steps, utils
from yade import wrapper

G = 9.81


def body(mass=2.0, at=(0, 0, 0)):
    made = utils.sphere(at, 0.01, mask=0)
    made.state.mass = mass
    return O.bodies.append(made)


def alone(engine, gravity=(0, 0, 0), dt=1e-4):
    O.engines = [
        wrapper.ForceResetter(),
        engine,
        wrapper.NewtonIntegrator(damping=0, gravity=Vector3(*gravity)),
    ]
    O.dt = dt


def cable(points=((0, 0, 0), (1, 0, 0)), young=1e8):
    material("cable", young=young, density=1000)
    return ancf.Cable(points, 4, diameter=1e-3, material="cable", contactPoints=0)


# ---- what others are told of it ------------------------------------------------------------------


def test_contact_step_knows_the_guide_at_any_time(scene):
    """A ball on a guide towards a plane, and nothing else moves: a seventh of 2.94 (1.25 m v^2/k)^0.4/v. Before the
    first step, after it, and after loading.
    """
    material("m", young=1e7, density=1000, impactDamping=0)
    mass, speed, radius = 2.0, 3.0, 0.01
    plane((0, 0, -0.1), (1, 1, 0.1), material="m")
    number = ball((0, 0, 2 * radius), radius, mass=mass, material="m")
    guide = ancf.GuideEngine()
    guide.add(number, direction=(0, 0, 1))
    O.engines = bodyEngines()
    O.engines = O.engines[:-1] + [guide] + O.engines[-1:]
    O.dt = 1e-6
    k = hertz(radius, 1e7, 0.3, 1e7, 0.3)
    exact = 2.9432 * (1.25 * speed**2 * mass / k) ** 0.4 / speed / 7

    def told():
        loop = next(e for e in O.engines if isinstance(e, wrapper.InteractionLoop))
        return loop.lawDispatcher.functors[0].contactTimeStep(speed)

    assert told() == pytest.approx(exact, rel=1e-3)
    steps(2)
    assert told() == pytest.approx(exact, rel=1e-3)
    O.saveTmp()
    O.loadTmp()
    assert told() == pytest.approx(exact, rel=1e-3)


# ---- setMotion ---------------------------------------------------------------------------------


def test_motion_set_later_leads_and_is_taken_off(scene):
    number = body()
    guide = ancf.GuideEngine()
    guide.add(number, direction=(0, 3, 4))
    alone(guide)
    steps(10)
    assert guide.position(number) == 0 and guide.driven == [0]
    start = O.time
    guide.setMotion(number, lambda t: 0.5 * (t - start))
    steps(1000)
    assert guide.driven == [1]
    assert guide.position(number) == pytest.approx(0.5 * (O.time - start), rel=1e-12)
    place = np.array(list(O.bodies[number].state.pos))
    assert place == pytest.approx(guide.position(number) * np.array([0, 0.6, 0.8]), rel=1e-12)
    guide.setMotion(number, None)
    at, then = guide.position(number), O.time
    steps(1000)  # goes on as it went
    assert guide.position(number) - at == pytest.approx(0.5 * (O.time - then), rel=1e-9)


def test_force_of_a_drive(scene):
    """m x'' + c x' less gravity along the guide; its work is what the body has."""
    mass, viscous = 2.0, 3.0
    number = body(mass)
    guide = ancf.GuideEngine()
    guide.add(number, direction=(1, 0, 0), viscous=viscous, motion=lambda t: 0.1 * t**3)
    alone(guide, gravity=(-G, 0, 0))
    for _ in range(4):
        steps(500)
        t = O.time - O.dt / 2  # in the middle of the last step
        expected = mass * 0.6 * t + viscous * 0.3 * t**2 + mass * G
        assert guide.driveForce[0] == pytest.approx(expected, rel=1e-3)
    t = O.time
    gained = mass * (0.3 * t**2) ** 2 / 2 + mass * G * 0.1 * t**3 + viscous * 0.09 * t**5 / 5
    assert guide.work[0] == pytest.approx(gained, rel=2e-3)
    assert guide.loss[0] == pytest.approx(viscous * 0.09 * t**5 / 5, rel=2e-3)


def test_drive_that_pulls_a_cable(scene):
    """Led slowly, the drive's force is the cable's pull, EA times its strain."""
    c = cable()
    c.fix(0)
    number = body(1e-3, (1, 0, 0))
    guide = ancf.GuideEngine()
    guide.add(number, direction=(1, 0, 0))
    c.carry(-1, number)
    guide.setMotion(number, pulleys.Ramp(0.01, 0.2))
    O.engines = pulleys.engines(c, guide)
    while O.time < 0.25:
        O.step()
    stretch = 1.01
    pull = 1e8 * math.pi * 1e-6 / 4 * (stretch**2 - 1) / 2 * stretch
    assert guide.position(number) == pytest.approx(0.01, rel=1e-9)
    forces = []
    for _ in range(2000):
        O.step()
        forces.append(guide.driveForce[0])
    assert np.mean(forces) == pytest.approx(pull, rel=2e-3)


def test_torque_of_a_sheave_that_is_led(scene):
    """J w' + c w."""
    material("steel", young=1e8, density=1000)
    sheave = pulleys.sheave((0, 0, 0), 0.05, width=0.01, material="steel", inertia=1e-3)
    engine = ancf.SheaveEngine()
    engine.add(sheave, viscous=2e-3, speed=lambda t: 5 * t)
    alone(engine)
    steps(2000)
    t = O.time - O.dt / 2
    assert engine.driveTorque[0] == pytest.approx(1e-3 * 5 + 2e-3 * 5 * t, rel=1e-3)
    assert engine.angle[0] == pytest.approx(2.5 * O.time**2, rel=1e-3)


# ---- the laws of motion ------------------------------------------------------------------------


@pytest.mark.parametrize("period", [1.0, 0.3])
def test_back_and_forth(period):
    """0 to the distance and back in every period, without a jump of acceleration."""
    x = pulleys.BackAndForth(2.0, period)
    for n in range(4):
        assert x(n * period) == pytest.approx(0, abs=1e-12)
        assert x((n + 0.5) * period) == pytest.approx(2, rel=1e-12)
    t = np.linspace(period / 4, 3 * period, 200)
    assert [x(s) for s in t] == pytest.approx(1 - np.cos(2 * math.pi * t / period), abs=1e-12)
    t = np.linspace(0, 1.2 * period, 24001)
    h = t[1]
    way, speed = (np.array([f(s) for s in t]) for f in (x, x.speed))
    assert np.gradient(way, h)[1:-1] == pytest.approx(speed[1:-1], abs=1e-6 * 2 / period * 10)
    acceleration = np.diff(speed) / h
    assert abs(acceleration[0]) < 1e-3 * np.abs(acceleration).max()
    assert np.abs(np.diff(acceleration)).max() < 5e-3 * np.abs(acceleration).max()
    assert x(-1) == x.speed(-1) == 0


def test_ramp_and_speed_up():
    """From rest to rest, and from rest to an even run; speed is the slope of the way."""
    ramp, up = pulleys.Ramp(0.3, 0.2, start=0.1), pulleys.SpeedUp(3.0, 0.2, start=0.1)
    assert ramp(0) == ramp(0.1) == up(0.1) == 0
    assert ramp(0.31) == ramp(9) == 0.3 and ramp(0.2) == pytest.approx(0.15)
    assert up.speed(0.31) == up.speed(9) == 3.0
    assert up(1.3) == pytest.approx(3 * 1.0 + 3 * 0.2 / 2)
    for motion in (ramp, up):
        for t in (0.12, 0.2, 0.27, 0.5):
            slope = (motion(t + 1e-6) - motion(t - 1e-6)) / 2e-6
            assert slope == pytest.approx(motion.speed(t), abs=1e-8)


# ---- saved -------------------------------------------------------------------------------------


def hung():
    """Guided weights on a cable over nothing: one rubs, one has a stop; nothing is a function."""
    c = cable(young=1e9)
    guide = ancf.GuideEngine()
    ids = [body(0.01, (x, 0, 0)) for x in (0, 1)]
    guide.add(ids[0], direction=(1, 0, 0.5), friction=0.1, viscous=0.2, upper=0.01)
    guide.add(ids[1], direction=(1, 0, 0), friction=0.05)
    for knot, number in zip((0, -1), ids):
        c.carry(knot, number)
    O.engines = pulleys.engines(c, guide, gravity=(0, 0, -G))
    guide.push = [0.02, 0.3]
    return c, guide, ids


def motionOf(ids):
    guide = next(e for e in O.engines if isinstance(e, ancf.GuideEngine))
    c = next(e for e in O.engines if isinstance(e, ancf.CableEngine))
    states = [[list(O.bodies[i].state.pos), list(O.bodies[i].state.vel)] for i in ids]
    lists = [list(getattr(guide, n)) for n in ("held", "rubbing", "lastSpeed", "work", "loss")]
    return repr((list(c.position), list(c.velocity), states, lists))


@pytest.mark.parametrize("name", ["scene.xml", "scene.yade.bz2"])
@pytest.mark.parametrize("at", [1, 50, 400])
def test_saved_guides_go_on_bit_for_bit(scene, tmp_path, name, at):
    _, guide, ids = hung()
    steps(at)
    O.save(str(tmp_path / name))
    steps(300)
    there = motionOf(ids)
    O.load(str(tmp_path / name))
    steps(300)
    assert motionOf(ids) == there


def test_function_of_time_is_told_after_loading(scene, tmp_path):
    """It is lost: the next step says so, and takes it when it is set again."""
    number = body()
    guide = ancf.GuideEngine()
    guide.add(number, direction=(1, 0, 0), motion=lambda t: t)
    alone(guide)
    steps(10)
    O.save(str(tmp_path / "s.xml"))
    O.load(str(tmp_path / "s.xml"))
    with pytest.raises(RuntimeError, match="setMotion|motion"):
        O.step()
    guide = next(e for e in O.engines if isinstance(e, ancf.GuideEngine))
    guide.setMotion(number, lambda t: t)
    O.step()
    assert guide.position(number) == pytest.approx(O.time, rel=1e-9)
