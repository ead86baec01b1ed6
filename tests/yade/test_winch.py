"""Cables that are paid out from a drum and hauled in with their mass: tension, momentum, energy, saves."""

import math

import numpy as np
import pytest

import ancf
from helpers import array, ball, material, steps
from tethers import cord, cordScene, runFor, tether  # noqa: F401
from yade import O, Vector3

G = 9.81


pytestmark = pytest.mark.usefixtures("cordScene")


def hanging(mass=0.5, **options):
    """5 m with a weight below, on a winch that stands; at rest."""
    cable, winch = tether([(0, 0, 0), (0, 0, -5)], **options)
    cable.fix(0)
    cable.carry(1, ball((0, 0, -5), 0.05, mass=mass, material="cord"))
    O.engines = ancf.engines(cable, gravity=(0, 0, -G))
    cable.relax()
    return cable, winch


def test_tension_while_it_is_paid_out_and_hauled_in():
    """T = (M + rho A s)(g + a), whatever the speed is."""
    O.materials["cord"].young = 2e10  # so that what starts to move does not swing
    cable, winch = hanging()
    rhoA = cable.section.rhoA

    def acceleration(t):
        return -2.4 * math.pi * math.sin(math.pi * t) ** 2 * math.cos(math.pi * t)

    winch.haul(lambda t: -0.8 * math.sin(math.pi * t) ** 3, force=1e3)
    longest = 0
    while O.time < 2:
        O.step()
        expected = (0.5 + rhoA * winch.length) * (G + acceleration(O.time - O.dt))
        assert winch.tension == pytest.approx(expected, rel=4e-3)
        assert winch.rate == pytest.approx(
            0.8 * math.sin(math.pi * (O.time - O.dt / 2)) ** 3, abs=1e-9
        )
        longest = max(longest, winch.length)
    assert longest == pytest.approx(5 + 3.2 / (3 * math.pi), abs=1e-4)
    assert winch.length == pytest.approx(5, abs=1e-4)
    assert winch.length + winch.stored == pytest.approx(10, abs=1e-12)
    assert cable.length == pytest.approx(10)


def test_what_holds_the_drum():
    """Weight of all, the drum's too, less rho A u^2 that what leaves takes along; and what the tension is off."""
    cable, winch = hanging(damping=2e-4)
    rhoA, weight = cable.section.rhoA, (0.5 + cable.mass) * G
    assert cable.reaction(0)[2] == pytest.approx(weight, rel=1e-6)
    winch.payOut(lambda t: 2 * math.sin(math.pi / 2 * min(1, t)) ** 3, to=9.5)
    runFor(1.2)
    for _ in range(1000):
        O.step()
        more = winch.tension - (0.5 + rhoA * winch.length) * G
        assert cable.reaction(0)[2] - weight - more == pytest.approx(-rhoA * 2**2, rel=0.01)
    assert cable.tension(0) == cable.strain(0) == 0  # on the drum


def test_stops_where_it_is_told():
    cable, winch = hanging()
    assert winch.state() == "holds" and winch.length == pytest.approx(5)
    winch.payOut(2, to=6)
    runFor(0.7)
    assert winch.state() == "stopped" and winch.length == pytest.approx(6, abs=1e-12)
    winch.haul(2, force=100, to=4)
    runFor(0.5)
    assert winch.state() == "draws"
    runFor(0.8)
    assert winch.state() == "stopped" and winch.length == pytest.approx(4, abs=1e-12)
    winch.payOut(4)
    runFor(1.6)
    assert winch.length == pytest.approx(10 - 0.125, abs=1e-12)  # half an element


def test_force_and_brake():
    """A motor that is too weak strains; a brake that is too weak slips, and takes no more impulse than it has."""
    cable, winch = hanging()
    weight = (0.5 + cable.section.rhoA * 5) * G
    winch.haul(1, force=0.9 * weight, brake=2 * weight)
    runFor(0.2)
    assert winch.state() == "strains" and winch.length == 5
    winch.hold(brake=0.9 * weight)
    impulse, slipped, began = 0, 0, O.time
    for _ in range(5000):
        O.step()
        now = (0.5 + cable.section.rhoA * winch.length) * G
        impulse += O.dt * (now - winch.tension)
        if winch.state() == "slips":  # else waves let it hold, at less
            slipped += 1
            assert winch.tension == pytest.approx(0.9 * weight, rel=0.03)
    assert slipped > 3000
    assert -cable.engine.momentum()[0][2] == pytest.approx(impulse, rel=2e-3)
    fallen = 0.1 * G * (O.time - began) ** 2 / 2
    assert fallen * 0.98 < winch.length - 5


@pytest.mark.parametrize("end", [0, -1])
@pytest.mark.parametrize("substeps", [1, 3])
def test_chaser_and_target_keep_momentum_and_energy(end, substeps):
    """Both free, turning: momentum to rounding, and energy with the work of the winch."""
    points = [(0, 0, 0), (5, 0, 0)]
    cable, winch = tether(points if end == 0 else points[::-1], end=end, damping=0)
    chaser = ball((0, 0, 0), 0.1, mass=2, material="cord", mask=2)
    target = ball((5, 0, 0), 0.1, mass=1, material="cord", mask=2)
    cable.carry(end, chaser)
    cable.carry(-1 if end == 0 else 0, target)
    cable.setVelocity(lambda p: Vector3(0.3, 0.8 * p[0], 0.2))
    O.engines = ancf.engines(cable, substeps=substeps)
    O.trackEnergy = True
    engine = cable.engine
    P = array(engine.momentum()[0])
    mass = cable.mass + 3
    assert P == pytest.approx(
        [0.3 * mass, 0.8 * 5 + 0.8 * 5 * 2.5 * cable.section.rhoA, 0.2 * mass], rel=1e-6
    )
    winch.payOut(lambda t: 0.5 * (1 - math.cos(math.pi * t / 0.6)), to=7)
    steps(2)
    start = O.energy.total()
    runFor(1.2)
    winch.haul(lambda t: 1 - math.cos(math.pi * (t / 1.2 - 1)), force=1e3, to=4)
    runFor(1.2)
    momentum = array(engine.momentum()[0])  # with what is carried
    assert np.abs(momentum - P).max() < 1e-10 * np.abs(P).max()
    assert engine.winchElements[0] == (22 if end == 0 else 17)  # 2 came, 4 went
    assert abs(winch.energy()["work"]) > 0.5
    assert O.energy.total() == pytest.approx(start, abs=1e-5 * engine.energyScale)
    assert abs(engine.energyOff) < 1e-5 * engine.energyScale
    assert abs(winch.energy()["nodes"]) < 1e-4 * engine.energyScale


def test_the_watch_takes_the_winch_for_no_error():
    """Work many times what was there at the start, with damping, and the default watch."""
    cable, winch = hanging()
    winch.payOut(lambda t: min(3, 10 * t), to=9)
    runFor(1.5)
    winch.haul(lambda t: min(3, 10 * (t - 1.5)), force=1e3, to=2)
    runFor(2)
    assert winch.energy()["work"] > 0 and winch.length < 5.5


def test_exit_on_a_body_that_is_led():
    """A hoist on a trolley: the drum's place follows it, the cable comes out there."""
    trolley = ball((0, 0, 0), 0.05, material="cord")
    cable, winch = tether([(0, 0, 0), (0, 0, -5)])
    cable.follow(0, trolley)
    cable.carry(1, ball((0, 0, -5), 0.05, mass=0.5, material="cord"))
    O.engines = ancf.engines(cable, gravity=(0, 0, -G))
    cable.relax()
    O.bodies[trolley].state.vel = Vector3(0.5, 0, 0)
    winch.payOut(1)
    runFor(1)
    assert array(winch.point) == pytest.approx([0.5, 0, 0], abs=1e-3)
    assert array(cable.point(winch.stored / 10)) == pytest.approx(array(winch.point), abs=1e-9)
    assert len(cable.curve(1)) == 41


def test_a_knot_that_holds_something_is_not_wound():
    cable, winch = tether([(0, 0, 0), (0, 0, -2.5), (0, 0, -5)], parts=10)
    cable.fix(0)
    cable.carry(1, ball((0, 0, -2.5), 0.05, mass=0.5, material="cord"))
    cable.carry(2, ball((0, 0, -5), 0.05, mass=0.5, material="cord"))
    O.engines = ancf.engines(cable, gravity=(0, 0, -G))
    winch.haul(3, force=1e3)
    with pytest.raises(
        RuntimeError, match=r"node 1 comes to the drum of winch 0 and carries a body: haul"
    ):
        runFor(2)
    assert winch.length > 2.4


def test_a_knot_on_the_drum_is_told():
    cable, winch = tether([(0, 0, 0), (0, 0, -2.5), (0, 0, -5)], parts=10)
    cable.fix(0)
    O.engines = ancf.engines(cable, gravity=(0, 0, -G))
    winch.haul(3, force=1e3)
    runFor(1)
    for act in (
        lambda: cable.fix(1),
        lambda: cable.load(1, (1, 0, 0)),
        lambda: cable.carry(1, ball((0, 0, 0), 0.05, mass=0.5, material="cord")),
    ):
        with pytest.raises(ValueError, match="is wound on the drum of a winch: pay it out first"):
            act()


@pytest.mark.parametrize("speed", [2.0, -2.0])
def test_saved_to_the_last_bit(tmp_path, speed):
    """While nodes come and go."""
    cable, winch = hanging()
    O.trackEnergy = True
    if speed > 0:
        winch.payOut(speed)
    else:
        winch.haul(-speed, force=1e3)
    elements = winch.cable.engine.winchElements[0]
    runFor(0.1)
    O.save(str(tmp_path / "scene.yade"))
    runFor(0.7)

    def now():
        engine = ancf.winches()[0].cable.engine
        state = list(engine.position), list(engine.velocity)
        return repr(
            (
                state,
                sorted(engine.winch(0).items()),
                list(engine.ends),
                list(engine.length),
                sorted(O.energy.items()),
            )
        )

    there = now()
    assert cable.engine.winchElements[0] != elements
    O.load(str(tmp_path / "scene.yade"))
    again = ancf.winches()[0]
    assert again.state() == ("lets out" if speed > 0 else "draws")
    assert len(again.cable.curve(1)) == 41 and again.cable.length == pytest.approx(10)
    runFor(0.7)
    assert now() == there


def test_several_in_one_engine():
    """Each does its own, one at a first and one at a last knot, one appended while the others run."""

    def hoist(x, end):
        points = [(x, 0, 0), (x, 0, -3)]
        cable, winch = tether(points if end == 0 else points[::-1], 4, end, parts=12, label=f"{x}")
        cable.fix(end)
        cable.carry(-1 - end, ball((x, 0, -3), 0.05, mass=0.3, material="cord", mask=2))
        return cable, winch

    (first, down), (second, up) = hoist(0, 0), hoist(1, -1)
    O.engines = ancf.engines(first, second, gravity=(0, 0, -G))
    down.payOut(1)
    up.haul(1, force=100)
    runFor(0.2)
    third, late = hoist(2, 0)
    third.append(engine=first.engine)
    late.payOut(0.5)
    runFor(0.5)
    assert [w.cable.name for w in ancf.winches()] == ["0", "1", "2"]
    for winch, length in ((down, 3.7), (up, 2.3), (late, 3.25)):
        assert winch.length == pytest.approx(length, abs=1e-3)
        assert winch.length + winch.stored == pytest.approx(7, abs=1e-12)


def test_a_speed_of_time_is_not_saved(tmp_path):
    cable, winch = hanging()
    winch.payOut(lambda t: 1)
    steps(3)
    O.save(str(tmp_path / "scene.yade"))
    O.load(str(tmp_path / "scene.yade"))
    with pytest.raises(RuntimeError, match="is not saved with a scene: haul"):
        O.step()
    ancf.winches()[0].payOut(1)
    steps(3)


def test_what_is_outside_touches():
    """The end comes down on a ball; what is wound lies within another and meets nothing."""
    cable = cord([(0, 0, 0), (0, 0, -1)], 10)
    winch = ancf.Winch(cable, 2)
    ball((0, 0, 0.02), 0.04, material="cord", mask=2)  # around the drum, but in the way of nothing
    cable.fix(0)
    floor = ball((0.02, 0, -2), 0.5, material="cord")
    O.engines = ancf.engines(cable, gravity=(0, 0, -G))
    winch.payOut(1)
    touched = 0
    while O.time < 1.2:
        O.step()
        touched += cable.engine.contacts > 0
    assert touched > 100
    assert np.abs(array(cable.knots[1]) - array(O.bodies[floor].state.pos)).max() < 0.6
    assert all(not O.bodies[b].intrs() for b in cable.bodies[: winch.cable.engine.winchElements[0]])


def test_texts():
    """What cannot be is told, with what would be right."""
    cable, winch = hanging()
    for bad, text in (
        (lambda: winch.payOut(1, to=5), r"there are 5 m outside already"),
        (lambda: winch.payOut(1, to=11), r"to = 11.0: must be 0\.125 to 9\.875 m"),
        (lambda: winch.payOut(math.nan), r"payOut: speed"),
        (lambda: winch.haul(1, 5, to=6), r"there is nothing to draw in"),
        (lambda: winch.haul(-1, 5), r"haul: speed"),
        (lambda: winch.haul(1, 0), r"haul: force"),
        (lambda: winch.haul(1, 5, brake=4), r"must be at least force = 5 N"),
        (lambda: winch.hold(-1), r"hold: brake"),
        (lambda: ancf.Winch(cable, 5), r"has a winch already"),
    ):
        with pytest.raises(ValueError, match=text):
            bad()
    assert winch.state() == "holds"

    def made(**options):
        given = dict(diameter=3e-3, material="cord", model="springs", contactPoints=0)
        return ancf.Cable([(0, 0, 0), (1, 0, 0), (1, 1, 0)], **{**given, **options})

    for bad, text in (
        (lambda: ancf.Winch(made(model="ancf"), 5), r"use model='springs'"),
        (lambda: ancf.Winch(made(closed=True), 5), r"a closed cable has no end"),
        (lambda: ancf.Winch(made(massDamping=1), 5), r"massDamping = 1.*: must be 0"),
        (lambda: ancf.Winch(made(), -5), r"stored = -5"),
        (lambda: ancf.Winch(made(), 5, 1), r"end = 1: must be 0"),
        (lambda: ancf.Winch(made(), 5, inertia=1), r"needs the drum's radius"),
    ):
        with pytest.raises(ValueError, match=text):
            bad()
    with pytest.raises(TypeError, match="must be a Cable"):
        ancf.Winch(ancf.Net.square(2, 0.1, diameter=1e-3, material="cord"), 5)
    late = made()
    late.append()
    with pytest.raises(RuntimeError, match="make it before the cable is appended"):
        ancf.Winch(late, 5)
    early = ancf.Winch(made(), 5)
    with pytest.raises(RuntimeError, match="append the cable first"):
        early.haul(1, 1)


def test_integrators_and_bodies_off_their_centre():
    cable, winch = tether([(0, 0, 0), (0, 0, -5)])
    cable.fix(0)
    with pytest.raises(ValueError, match="does not know winches: use integrator = 'leapfrog'"):
        ancf.engines(cable, integrator="implicit")
    O.reset()
    material("cord", young=2e9, density=1000)
    cable, winch = tether([(0, 0, 0), (0, 0, -5)])
    cable.carry(0, ball((0, 0, 0.1), 0.1, mass=2, material="cord", mask=2), at=(0, 0, -0.1))
    with pytest.raises(ValueError, match=r"carry it at \(0, 0, 0\)"):
        ancf.engines(cable)


@pytest.mark.parametrize("knot", [0, 1])
def test_ends_that_slide_are_refused(knot):
    cable, winch = tether([(0, 0, 0), (0, 0, -5)])
    cable.fix(1 - knot)
    cable.slide(knot, (1, 0, 0))
    with pytest.raises(ValueError, match="of a cable on winch 0 slides along a line: fix it"):
        ancf.engines(cable)


def test_too_fast_for_its_elements():
    cable, winch = hanging()
    winch.payOut(3000)
    with pytest.raises(RuntimeError, match="more than a quarter of an element"):
        steps(20)


def test_edited_lengths_are_told():
    cable, winch = hanging()
    engine = cable.engine
    first = engine.winchElements[0]
    with pytest.raises(ValueError, match=r"payOut\(\) and haul\(\) change them"):
        lengths = list(engine.length)
        lengths[first] *= 1.2
        engine.length = lengths


@pytest.mark.parametrize("name", ["winchExits", "winchRows", "winchElements", "winchNodes"])
def test_damaged_lists_are_told(name):
    """As a damaged save would bring them."""
    cable, winch = hanging()
    winch.payOut(1)
    steps(3)
    engine = cable.engine
    good = list(getattr(engine, name))
    for bad in (
        [],
        good[:-1],
        [*good, 0],
        *[
            [*good[:i], value, *good[i + 1 :]]
            for i in {0, len(good) - 1}
            for value in (-5, 3, 10**6)
        ],
    ):
        with pytest.raises(ValueError, match="CableEngine .*winch|CableEngine .*wound"):
            engine.updateAttrs({name: bad})
        engine.updateAttrs({name: good})
    steps(3)
    assert winch.state() == "lets out"
