"""What is beside a drum while a cable is paid out or hauled in: contacts, couplings, ties, other cables, readings."""

import math

import numpy as np
import pytest

import ancf
from helpers import array, ball, momenta, steps
from tethers import cord, cordScene, runFor, tether  # noqa: F401
from yade import O, Vector3

G = 9.81


pytestmark = pytest.mark.usefixtures("cordScene")


DOWN = [(0, 0, 0), (0, 0, -5)]


def hit(speed, offset=0.0, substeps=1):
    """Two free bodies at a cable, the upper at its drum, beside which a ball hits it. Returns winch and ball."""
    cable, winch = tether(DOWN, contactPoints=2)
    chaser = ball((0, 0, 0), 0.1, mass=2, material="cord", mask=2)
    cable.carry(0, chaser)
    cable.carry(1, ball((0, 0, -5), 0.1, mass=1, material="cord", mask=2))
    hits = ball((-0.2, offset, -0.15), 0.04, mass=0.3, material="cord")
    O.bodies[hits].state.vel = Vector3(2, 0, 0)
    O.engines = ancf.engines(cable, substeps=substeps)
    if speed > 0:
        winch.payOut(speed)
    else:
        winch.haul(-speed, force=1e3)
    return winch, hits


@pytest.mark.parametrize("substeps", [1, 3])
@pytest.mark.parametrize("speed, offset", [(1.0, 0.0), (2.0, 0.03), (-0.3, 0.041)])
def test_a_contact_on_the_fed_element_keeps_momentum(speed, offset, substeps):
    """Its mass changes in each step: an impulse must move it by that mass."""
    winch, hits = hit(speed, offset, substeps)
    engine = winch.cable.engine
    before = momenta(engine, {hits: False})[0]
    touched, came = 0, engine.winchElements[0]
    while O.time < 0.6:
        O.step()
        touched += engine.contacts > 0
    assert touched > 1 and engine.winchElements[0] != came
    assert np.abs(momenta(engine, {hits: False})[0] - before).max() < 1e-11 * 0.6


def test_a_cable_bent_around_a_ball_is_not_wound():
    """The chord that is left would be through the ball."""
    winch, hits = hit(-0.5)
    O.bodies[hits].state.mass = 30
    with pytest.raises(RuntimeError, match="comes to the drum of winch 0 and is bent around what"):
        runFor(0.6)
    assert winch.length > 4.7


def test_hauled_in_to_a_body_off_its_centre():
    """The last element joins the drum and a coupling: momentum in all that time."""
    cable, winch = tether([(0, 0, 0), (0, 0, -2)], stored=1, parts=8)
    cable.carry(0, ball((0, 0, 0), 0.1, mass=2, material="cord", mask=2))
    target = ball((0, 0.05, -2.1), 0.12, mass=1, material="cord", mask=2)
    cable.carry(1, target, at=(0, -0.05, 0.1))
    O.engines = ancf.engines(cable)
    cable.setVelocity(lambda p: Vector3(0.1, 0, -0.2 * p[2]))
    start = momenta(cable.engine, {target: False})
    winch.haul(1.5, force=1e3, to=0.2)
    runFor(1.3)
    winch.hold()
    runFor(0.3)
    assert winch.length == pytest.approx(0.2, abs=1e-9)
    assert cable.engine.winchElements[0] == cable.engine.winchRows[1]  # the last one
    now = momenta(cable.engine, {target: False})
    assert np.abs(now[0] - start[0]).max() < 1e-11


def test_readings_while_nodes_come():
    """A node that comes to one cable changes nothing that is read of another, nor of a contact."""
    cable, winch = tether(DOWN)
    cable.fix(0)
    cable.carry(1, ball((0, 0, -5), 0.05, mass=0.5, material="cord", mask=2))
    other = cord([(1, -0.5, 0), (1, 0.5, 0)], 10, damping=0)
    other.fix(0)
    other.fix(1)
    ball((1, 0, -0.1), 0.0985, material="cord")
    O.engines = ancf.engines(cable, other, gravity=(0, 0, -G))
    winch.payOut(2)
    runFor(0.05)
    came, rows, nodes = 0, [], cable.engine.winchElements[0]
    while O.time < 0.6:
        O.step()
        came += cable.engine.winchElements[0] != nodes
        nodes = cable.engine.winchElements[0]
        rows.append([*other.reaction(0), *other.reaction(1), other.tension(0.5)])
        assert cable.engine.contacts > 0
    rows = np.array(rows)
    jumps = np.abs(np.diff(rows, axis=0)).max(axis=0)
    assert came == 5 and np.abs(rows[:, 2]).min() > 1e-3
    assert (jumps < 0.05 * np.ptp(rows, axis=0) + 1e-9).all()


def test_a_wound_knot_is_free_again_when_it_is_out(tmp_path):
    """Also over a save: nothing says 'tied' of it."""
    cable = cord([(0, 0, 0), (0, 0, -2), (0, 0, -5)], 10)
    winch = ancf.Winch(cable, 5)
    cable.fix(0)
    O.engines = ancf.engines(cable, gravity=(0, 0, -G))
    winch.haul(3, force=1e3, to=2)
    runFor(1.2)
    assert cable.engine.wound(cable.engine.winchNodes[0])
    with pytest.raises(ValueError, match="is wound on the drum of a winch"):
        cable.load(1, (0, 0, 1))
    O.save(str(tmp_path / "scene.yade"))
    O.load(str(tmp_path / "scene.yade"))
    winch = ancf.winches()[0]
    cable = winch.cable
    with pytest.raises(ValueError, match="is wound on the drum of a winch"):
        cable.load(1, (0, 0, 1))
    winch.payOut(3, to=6)
    runFor(1.5)
    cable.load(1, (0, 0, 1))
    cable.fix(1)
    runFor(0.1)


def test_uneven_elements_stay_stable():
    """The step is that of the shortest that will be at the drum, as short as it becomes there."""
    cable = cord([(0, 0, 0), (0, 0, -2), (0, 0, -2.2), (0, 0, -4)], 5)
    winch = ancf.Winch(cable, 2)
    cable.fix(0)
    cable.carry(3, ball((0, 0, -4), 0.05, mass=0.5, material="cord", mask=2))
    O.engines = ancf.engines(cable, gravity=(0, 0, -G))
    shortest = 0.2 / 5
    alone = shortest / math.sqrt(2e9 / 1000)
    assert cable.criticalTimeStep() < 0.75 * alone
    O.trackEnergy = True
    winch.haul(1, force=1e3, to=0.3)
    runFor(3.8)
    assert winch.length == pytest.approx(0.3, abs=1e-9)


@pytest.mark.parametrize("first", [True, False])
def test_what_is_tied_is_not_wound(first):
    """Whichever of the two stands for the other."""
    cable = cord([(0, 0, 0), (0, 0, -1), (0, 0, -2)], 4, damping=0)
    winch = ancf.Winch(cable, 1)
    cable.fix(0)
    side = cord([(0, 0, -1), (1, 0, -1)], 4, damping=0)
    if first:
        side.tie(0, cable, 1)
    else:
        cable.tie(1, side, 0)
    O.engines = ancf.engines(side, cable, gravity=(0, 0, -G))
    winch.haul(2, force=1e3)
    with pytest.raises(RuntimeError, match="comes to the drum of winch 0 and is tied to another"):
        runFor(1)
    assert 0.9 < winch.length < 1.13  # 1 and half an element


def test_hauled_in_to_a_body_that_can_be_touched():
    """The cable never touches the body at its drum: nothing jams, and momentum is kept."""
    cable, winch = tether([(0, 0, 0), (0, 0, -2)], stored=1, parts=8, contactPoints=2)
    chaser = ball((0, 0, 0), 0.1, mass=20, material="cord")
    cable.carry(0, chaser)
    cable.carry(1, ball((0, 0, -2), 0.05, mass=1, material="cord"))
    O.engines = ancf.engines(cable)
    cable.setVelocity(lambda p: Vector3(-0.5 * p[2], 0, 0))  # circling, so that it stays taut
    start = array(cable.engine.momentum()[0])
    winch.haul(1, force=1e3, to=0.4)
    while O.time < 1.6:
        O.step()
        assert cable.engine.contacts == 0
    assert winch.length == pytest.approx(0.4, abs=1e-9)
    assert np.abs(array(cable.engine.momentum()[0]) - start).max() < 1e-11


def test_relax_while_it_is_paid_out():
    """A winch that runs stands still for it: the tension is the weight of what hangs."""
    cable, winch = tether(DOWN, damping=2e-4)
    cable.fix(0)
    cable.carry(1, ball((0, 0, -5), 0.05, mass=0.5, material="cord", mask=2))
    O.engines = ancf.engines(cable, gravity=(0, 0, -G))
    winch.payOut(1)
    runFor(0.5)
    cable.relax()
    weight = (0.5 + cable.section.rhoA * winch.length) * G
    assert winch.length == pytest.approx(5.5, abs=1e-3)
    assert cable.tension(winch.stored / 10 + 1e-6) == pytest.approx(weight, rel=0.02)
    runFor(0.2)
    assert winch.length == pytest.approx(5.7, abs=2e-3)


def test_a_speed_that_is_refused_leaves_all_as_it_was():
    cable, winch = tether(DOWN)
    cable.fix(0)
    cable.carry(1, ball((0, 0, -5), 0.05, mass=0.5, material="cord"))
    O.engines = ancf.engines(cable, gravity=(0, 0, -G))
    cable.relax()
    winch.payOut(lambda t: 1 if t < 0.01 else 1e4)
    engine = cable.engine
    with pytest.raises(RuntimeError, match="more than a quarter of an element: use O.dt <= "):
        for _ in range(10**6):
            before = list(engine.position), list(engine.velocity), winch.length
            O.step()
    assert (list(engine.position), list(engine.velocity), winch.length) == before
    winch.payOut(1)
    steps(10)
    assert winch.state() == "lets out"


def test_a_node_belongs_to_one_drum():
    cable, winch = tether([(0, 0, 0), (0, 0, -0.25)], parts=1, stored=1)
    second = cord([(0, 0, 0), (0, 0, 1)], 4, damping=0)
    ancf.Winch(second, 1)
    cable.tie(0, second, 0)
    with pytest.raises(ValueError, match="is beside the drums of winches 0 and 1"):
        ancf.engines(cable, second)


def test_a_body_is_carried_at_its_centre_once():
    """Two cables at the centre of one body are tied, else each would be its mass."""
    first, _ = tether(DOWN)
    second = cord([(0, 0, 0), (1, 0, 0)], 4, damping=0)
    chaser = ball((0, 0, 0), 0.1, mass=2, material="cord", mask=2)
    first.carry(0, chaser)
    with pytest.raises(ValueError, match="is carried at its centre"):
        second.carry(0, chaser)
        ancf.engines(first, second)


@pytest.mark.parametrize("inertia", [0.02, 0.5])
def test_a_drum_with_inertia(inertia):
    """A brake that is too weak: a = (M g - F)/(M + J/r2), with the cable's own mass."""
    radius, force, mass = 0.2, 20.0, 5.0
    O.materials["cord"].young = 2e11  # the weight swings 40 times a second
    cable, winch = tether(DOWN, drum=dict(inertia=inertia, radius=radius))
    cable.fix(0)
    cable.carry(1, ball((0, 0, -5), 0.05, mass=mass, material="cord", mask=2))
    O.engines = ancf.engines(cable, gravity=(0, 0, -G))
    cable.relax()
    winch.hold(brake=force)
    rates = []
    while O.time < 0.5:
        O.step()
        rates.append((O.time, winch.rate))
    start = 5.0
    heavy = mass + cable.section.rhoA * 0.5 * (start + winch.length)
    expected = (heavy * G - force) / (heavy + inertia / radius**2)
    assert np.polyfit(*np.transpose(rates), 1)[0] == pytest.approx(expected, rel=5e-3)
    assert winch.state() == "slips"


def test_tension_at_an_exit_that_is_led():
    """A hoist that accelerates upwards while it pays out: T = (M + rho A s)(g + a)."""
    O.materials["cord"].young = 2e10
    trolley = ball((0, 0, 0), 0.05, material="cord")
    cable, winch = tether(DOWN)
    cable.follow(0, trolley)
    cable.carry(1, ball((0, 0, -5), 0.05, mass=0.5, material="cord"))
    O.engines = ancf.engines(cable, gravity=(0, 0, -G))
    cable.relax()
    winch.payOut(lambda t: 0.5 * math.sin(math.pi * t / 2) ** 3)
    worst = 0
    while O.time < 1:
        t = O.time
        O.bodies[trolley].state.vel = Vector3(
            0, 0, 1.5 * (t - math.sin(2 * math.pi * t) / 2 / math.pi)
        )
        O.step()
        led = 1.5 * (1 - math.cos(2 * math.pi * t))
        out = 0.75 * math.pi * math.sin(math.pi * t / 2) ** 2 * math.cos(math.pi * t / 2)
        expected = (0.5 + cable.section.rhoA * winch.length) * (G + led - out)
        worst = max(worst, abs(winch.tension / expected - 1))
    assert worst < 4e-3


def test_wound_elements_have_no_bounds():
    """And those that come have them."""
    cable, winch = tether([(0, 0, 0), (0, 0, -1)], stored=100, parts=20, contactPoints=2)
    cable.fix(0)
    O.engines = ancf.engines(cable, gravity=(0, 0, -G))
    winch.payOut(2)
    steps(2)
    bounded = [O.bodies[b].bound is not None for b in cable.bodies]
    assert sum(bounded) == cable.elementCount - cable.engine.winchElements[0]
    runFor(0.2)
    assert sum(O.bodies[b].bound is not None for b in cable.bodies) > sum(bounded)
