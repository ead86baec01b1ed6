"""Strain, rims, release: what a cable or net tells and lets go, against closed forms."""

import math

import numpy as np
import pytest

from helpers import O, Vector3, ancf, ball, material, steps, utils

G = 9.81
AREA = math.pi * 1e-3**2 / 4


@pytest.fixture
def soft(scene):
    material("soft", young=1e7, density=1000)
    return 1e7 * AREA  # EA [N]


def line(n=4, **options):
    given = dict(diameter=1e-3, material="soft", contactPoints=0)
    return ancf.Cable([(0, 0, 0), (1, 0, 0)], n, **{**given, **options})


# ---- strain ------------------------------------------------------------------------------------


def test_strain_of_a_pulled_cable(soft):
    """Green's: EA (l^2 - 1)/2 l = T at stretch l."""
    c = line()
    c.fix(0)
    c.load(-1, (2.0, 0, 0))
    c.append()
    c.relax(tolerance=1e-12)
    stretch = float(np.real(max(np.roots([soft / 2, 0, -soft / 2, -2.0]), key=np.real)))
    assert c.knots[-1][0] == pytest.approx(stretch, rel=1e-9)
    for s in (0, 0.3, 0.5, 1):
        assert c.strain(s) == pytest.approx((stretch**2 - 1) / 2, rel=1e-9)
        assert c.tension(s) == pytest.approx(2.0, rel=1e-9)


def test_strain_of_pulled_springs(soft):
    """Engineering strain T/EA."""
    c = line(1, model="springs", midPoints=3)
    c.fix(0)
    c.load(-1, (2.0, 0, 0))
    c.append()
    c.relax(tolerance=1e-12)
    for s in (0, 0.3, 1):
        assert c.strain(s) == pytest.approx(2.0 / soft, rel=1e-9)
        assert c.tension(s) == pytest.approx(2.0, rel=1e-9)


def test_strain_of_a_hanging_cable(soft):
    """Under its weight: that of the part below, T = rhoA g (L - s)."""
    c = ancf.Cable([(0, 0, 0), (0, 0, -1)], 8, diameter=1e-3, material="soft", contactPoints=0)
    c.fix(0)
    O.engines = ancf.engines(c, gravity=(0, 0, -G))
    c.relax(tolerance=1e-12)
    weight = 1000 * AREA * G
    assert c.strain(0.5) == pytest.approx(weight * 0.5 / soft, rel=2e-3)
    assert c.strain(0.25) / c.strain(0.75) == pytest.approx(3, rel=2e-3)


# ---- release -----------------------------------------------------------------------------------


def centre(c):
    """Velocity of the centre of mass, from the engine's momentum."""
    return np.array(c.engine.momentum()[0]) / c.mass


def fallsFrom(c, n=50):
    """Steps on; what the centre of mass gained beside g t, in parts of g t."""
    before = centre(c)
    steps(n)
    gained = centre(c) - before - np.array([0, 0, -G]) * n * O.dt
    return np.abs(gained).max() / (G * n * O.dt)


def test_release_of_fixed_knots(soft):
    c = line()
    c.fix(0)
    c.fix(-1)
    O.engines = ancf.engines(c, gravity=(0, 0, -G))
    steps(20)
    assert c.knots[0] == pytest.approx([0, 0, 0], abs=0)
    assert fallsFrom(c) > 0.01  # held
    for knot in (0, -1):
        c.release(knot)
    c.setVelocity(lambda p: Vector3.Zero)
    steps(1)
    assert fallsFrom(c) < 1e-9
    assert c.knots[0][2] < 0


def test_release_of_a_following_knot(soft):
    lead = O.bodies.append(utils.sphere((0, 0, 0), 0.01, material="soft", fixed=True, mask=2))
    O.bodies[lead].state.vel = Vector3(0, 1, 0)
    c = line()
    c.follow(0, lead)
    O.engines = ancf.engines(c)
    steps(50)
    assert c.knots[0][1] == pytest.approx(O.time, rel=1e-9)
    c.release(0)
    momentum = np.array(c.engine.momentum()[0])
    steps(50)
    assert np.array(c.engine.momentum()[0]) == pytest.approx(momentum, rel=1e-9)
    assert abs(c.knots[0][1] - O.time) > 1e-9


def test_release_takes_a_load_off(soft):
    c = line()
    c.load(-1, (0, 0, 0.01))
    O.engines = ancf.engines(c)
    steps(20)
    impulse = 0.01 * (20 - 0.5) * O.dt  # the first kick is half a step's
    assert c.mass * centre(c)[2] == pytest.approx(impulse, rel=1e-9)
    c.release(-1)
    before = centre(c)[2]
    steps(20)
    assert centre(c)[2] == pytest.approx(before, rel=1e-12)


def test_what_is_released_can_be_held_again(soft):
    c = line().append()
    c.fix(0)
    c.release(0)
    c.clamp(0)
    c.release(0)
    c.carry(0, ball((0, 0, 0), 0.01, mass=0.1, material="soft", mask=2))
    with pytest.raises(ValueError, match="for good"):
        c.release(0)


# ---- rims --------------------------------------------------------------------------------------

PENTAGON = [(math.cos(2 * math.pi * k / 5), math.sin(2 * math.pi * k / 5), 0.3) for k in range(5)]


def star(**options):
    """A hub and five knots around it."""
    edges = [(0, k) for k in range(1, 6)] + [(k, k % 5 + 1) for k in range(1, 6)]
    return ancf.Net([(0, 0, 0), *PENTAGON], edges, diameter=1e-3, material="soft", **options)


def test_rim_of_ones_own(soft):
    """A regular pentagon: 5/2 R^2 sin(72 deg)."""
    area = 2.5 * math.sin(math.radians(72))
    net = star(rim=range(1, 6))
    assert net.mouthArea() == pytest.approx(area, rel=1e-12)
    net.rim = [5, 4, 3, 2, 1]
    assert net.mouthArea() == pytest.approx(area, rel=1e-12)
    net.rim = [1, 2, 3]  # two sides and a diagonal: sin(72) - sin(144)/2
    part = math.sin(math.radians(72)) - math.sin(math.radians(144)) / 2
    assert net.mouthArea() == pytest.approx(part, rel=1e-12)
    assert star(rim=[-1, -2, -3, -4, -5]).mouthArea() == pytest.approx(area, rel=1e-12)


@pytest.mark.parametrize("angle", [0, 30, 60, 90])
def test_area_seen_along_an_axis(soft, angle):
    turn = math.radians(angle)
    seen = star(rim=range(1, 6)).mouthArea(axis=(0, 3 * math.sin(turn), 3 * math.cos(turn)))
    assert seen == pytest.approx(2.5 * math.sin(math.radians(72)) * math.cos(turn), abs=1e-12)


def test_area_of_a_rim_that_is_not_plane(soft):
    """The largest of the projected areas: no axis sees more, and the sum of squares along three is its own."""
    net = ancf.Net.square(3, 0.06, fold=0.7, diameter=1e-3, material="soft")
    net.rim = net.rim[:7]
    along = [net.mouthArea(axis=axis) for axis in np.eye(3)]
    assert net.mouthArea() == pytest.approx(math.hypot(*along), rel=1e-12)


def test_area_follows_the_net(soft):
    net = star(rim=range(1, 6))
    net.setVelocity(lambda p: Vector3(p[0], p[1], 0))
    O.engines = ancf.engines(net)
    O.dt = 1e-7
    steps(10)
    p = net.knots[1:6, :2]
    x, y = p.T
    shoelace = 0.5 * abs((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())
    assert net.mouthArea() == pytest.approx(shoelace, rel=1e-12)
    assert shoelace > 2.5 * math.sin(math.radians(72))


@pytest.mark.parametrize("mass", ["consistent", "lumped"])
def test_reactions_while_something_is_hit(soft, mass):
    """What holds a cable is the change of momentum of it and of the ball that flies into it."""
    c = ancf.Cable([(0, 0, 0), (0.2, 0, 0)], 2, diameter=1e-3, material="soft", mass=mass)
    c.fix(0)
    c.fix(-1)
    number = ball((0.07, 0, 0.0106), 0.01, mass=1e-3, material="soft")
    state = O.bodies[number].state
    state.vel = Vector3(0.3, 0, -1)
    O.engines = ancf.engines(c)
    steps(1)

    def momentum():
        return np.array(c.engine.momentum()[0]) + 1e-3 * np.array(list(state.vel))

    before, forces, changes, touched = momentum(), [], [], 0
    for _ in range(400):
        O.step()
        after = momentum()
        forces.append(np.array(list(c.reaction(0) + c.reaction(-1))))
        changes.append((after - before) / O.dt)
        before, touched = after, touched + c.engine.contacts
    assert touched > 20
    largest = np.abs(forces).max()
    assert largest > 1e-3
    assert np.abs(np.array(forces) - changes).max() < 1e-6 * largest
