"""Measures of a capture, against closed forms and against the forces that act."""

import math

import numpy as np
import pytest

from ancf.capture import (
    Capture,
    Momentum,
    enclosedShare,
    hull,
    meshes,
    pressing,
    qualityIndex,
    targetSize,
)
from helpers import O, Vector3, ancf, array, ball, material, plane, squareNet, steps
from yade import Quaternion, utils

CUBE = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
SIDES = [(a, b) for a in range(8) for b in range(a) if bin(a ^ b).count("1") == 1]
FINE = 4000  # directions; error of the lattice is about FINE^(-3/4) = 0.2 %


# ---- meshes --------------------------------------------------------------------------------------


def test_meshes_of_a_square_net(scene):
    material("cable")
    net = squareNet(3)
    pairs = [span._run.knots for span in net.edges]
    found = meshes(pairs)
    corners = {frozenset((k, k + 1, k + 4, k + 5)) for k in range(11) if k % 4 < 3}
    assert len(found) == 9 and {frozenset(m) for m in found} == corners
    sides = {frozenset(p) for p in pairs}
    for mesh in found:  # in order, each side an edge
        assert all(frozenset(p) in sides for p in zip(mesh, mesh[1:] + mesh[:1]))


def test_meshes_of_other_nets():
    triangles = [(0, 1), (1, 2), (2, 0), (1, 3), (2, 3)]
    assert {frozenset(m) for m in meshes(triangles)} == {frozenset((0, 1, 2)), frozenset((1, 2, 3))}
    hexagon = [(k, (k + 1) % 6) for k in range(6)]
    assert [len(m) for m in meshes(hexagon)] == [6]
    assert meshes([(0, 1), (1, 2)]) == []  # a string has none
    assert len(meshes(SIDES)) == 6  # a cube's
    n = 13  # knots a side of a net with a strand that hangs free
    net = [(k, k + 1) for k in range(n * n) if (k + 1) % n]
    net += [(k, k + n) for k in range(n * (n - 1))] + [(0, n * n)]
    assert [len(m) for m in meshes(net)] == [4] * (n - 1) ** 2


# ---- enclosure -----------------------------------------------------------------------------------


def dome(polar, rings=8, around=36, radii=(1.0,)):
    """Net on a sphere around the origin, from the pole on z to a polar angle [rad]; one such layer for each
    radius.
    """
    points, edges = [], []
    for radius in radii:
        first = len(points)
        points.append((0, 0, radius))
        for i in range(1, rings + 1):
            a = polar * i / rings
            for k in range(around):
                b = 2 * math.pi * k / around
                points.append(
                    (
                        radius * math.sin(a) * math.cos(b),
                        radius * math.sin(a) * math.sin(b),
                        radius * math.cos(a),
                    )
                )
                me = first + 1 + (i - 1) * around + k
                edges.append((me, me + 1 - around * (k == around - 1)))
                edges.append((first if i == 1 else me - around, me))
    material("cable")
    return ancf.Net(points, edges, diameter=1e-3, material="cable")


def test_net_on_a_hemisphere_encloses_half(scene):
    target = ball((0, 0, 0), 0.9, material=material("ball"))
    assert enclosedShare(dome(math.pi / 2), target, FINE) == pytest.approx(0.5, abs=1e-3)


@pytest.mark.parametrize("polar", [40, 90, 140, 170])
def test_sphere_with_a_hole(scene, polar):
    """All but the hole: (1 - cos polar) / 2."""
    target = ball((0, 0, 0), 0.9, material=material("ball"))
    exact = (1 - math.cos(math.radians(polar))) / 2
    share = enclosedShare(dome(math.radians(polar)), target, FINE)
    assert share == pytest.approx(exact, abs=1e-3)
    assert enclosedShare(dome(math.radians(polar)), target) == pytest.approx(exact, abs=5e-3)


def test_layers_count_once(scene):
    target = ball((0, 0, 0), 0.9, material=material("ball"))
    net = dome(math.pi / 2, radii=(1.0, 1.1, 1.3))
    assert enclosedShare(net, target, FINE) == pytest.approx(0.5, abs=1e-3)


@pytest.mark.parametrize("away", [0.02, 0.2, 1.0])
def test_flat_net_before_a_ball(scene, away):
    """Solid angle of a square plate of side a at a distance d: 4 atan(a^2 / (2 d sqrt(4 d^2 + 2 a^2)))."""
    material("cable")
    net, a = squareNet(4, 0.1), 0.4
    target = ball((away, 0, 0), 0.01, material="cable")
    solid = 4 * math.atan(a * a / (2 * away * math.sqrt(4 * away**2 + 2 * a * a)))
    assert enclosedShare(net, target, FINE) == pytest.approx(solid / (4 * math.pi), abs=2e-3)


def test_center_in_the_plane_of_the_net_is_not_enclosed(scene):
    material("cable")
    net = squareNet(4, 0.1)
    assert enclosedShare(net, ball((0, 1, 0), 0.01, material="cable")) == 0


def test_nodes_inside_edges_count(scene):
    """One mesh whose edges have four elements is the same as four times as many straight pieces."""
    material("cable")
    net = squareNet(1, 0.4, elements=4)
    target = ball((0.2, 0, 0), 0.01, material="cable")
    solid = 4 * math.atan(0.16 / (0.4 * math.sqrt(0.16 + 0.32)))
    assert enclosedShare(net, target, FINE) == pytest.approx(solid / (4 * math.pi), abs=2e-3)


# ---- hulls and the quality index -----------------------------------------------------------------


def test_hulls():
    made = hull(CUBE + [(0.1, 0.1, 0.1)] * 20)  # what is inside does not count
    assert (made.volume, made.surface) == pytest.approx((1, 6))
    assert made.center == pytest.approx((0.5, 0.5, 0.5))
    corners = np.array([(0, 0, 0), (3, 0, 0), (0, 2, 0), (0, 0, 1)])
    made = hull(corners)
    assert made.volume == pytest.approx(1)
    assert made.center == pytest.approx(corners.mean(axis=0))
    pyramid = hull([(1, 1, 0), (1, -1, 0), (-1, 1, 0), (-1, -1, 0), (0, 0, 4)])
    assert pyramid.center == pytest.approx((0, 0, 1)) and pyramid.volume == pytest.approx(16 / 3)
    turn = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    triangle = np.array([(0, 0, 0), (3, 0, 0), (0, 2, 0), (0.1, 0.1, 0)]) @ turn.T + (5, 6, 7)
    flat = hull(triangle)
    assert (flat.volume, flat.surface) == pytest.approx((0, 6))
    assert flat.center == pytest.approx(triangle[:3].mean(axis=0))
    line = hull([(0, 0, 0), (1, 1, 1), (2, 2, 2)])
    assert (line.volume, line.surface) == (0, 0) and line.center == pytest.approx((1, 1, 1))


def test_sizes_of_targets(scene):
    material("m")
    r = 0.3
    number = ball((1, 2, 3), r, material="m")
    sphere = (4 / 3 * math.pi * r**3, 4 * math.pi * r**2, 0.6)
    assert targetSize(number) == pytest.approx(sphere)
    box = utils.box((1, 0, 0), (0.1, 0.2, 0.3), material="m", fixed=True)
    box.state.ori = Quaternion((1, 2, 3), 0.7)
    number = O.bodies.append(box)
    assert targetSize(number) == pytest.approx((0.048, 0.88, 0.4))
    far = [utils.sphere((x, 0, 0), 0.1, material="m") for x in (0, 1)]
    clump, _ = O.bodies.appendClumped(far)
    capsule = math.pi * 0.01 * (1 + 0.4 / 3), math.pi * 0.2 * (1 + 0.2), (1.2 + 0.2 + 0.2) / 3
    assert targetSize(clump) == pytest.approx(capsule, rel=0.02)


@pytest.mark.parametrize("larger, aside", [(1, 0), (1, 0.3), (2, 0), (1.5, 0.1)])
def test_quality_index_of_cubes(scene, larger, aside):
    material("cable")
    points = larger * (np.array(CUBE) - 0.5) + (0, 0, aside)
    net = ancf.Net(points, SIDES, diameter=1e-3, material="cable")
    target = O.bodies.append(utils.box((0, 0, 0), (0.5,) * 3, material="cable", fixed=True))
    exact = 0.1 * (larger**3 - 1) + 0.1 * (larger**2 - 1) + 0.8 * aside
    assert qualityIndex(net, target) == pytest.approx(exact, abs=1e-12)


# ---- contact and momentum ------------------------------------------------------------------------


def meeting(free=False, gravity=0.0, **options):
    """A flat net that flies against a ball. Returns the net and the ball's id."""
    material("cable", impactDamping=0.2)
    number = ball((0.03, 0.01, 0.005), 0.02, mass=0.2 if free else None, material="cable")
    net = squareNet(2, 0.06, damping=5e-5, mass="lumped", **options)
    net.addBullets(0.05, 0.008, 1.5, math.radians(5))
    O.engines = ancf.engines(net, gravity=(0, 0, -gravity))
    return net, number


@pytest.mark.parametrize("free", [False, True])
@pytest.mark.parametrize("gravity", [0.0, 9.81])
def test_momentum_is_the_sum_of_forces_on_the_target(scene, free, gravity):
    net, target = meeting(free, gravity)
    given, pushed, seen = Momentum(net, target), np.zeros(3), 0
    while O.time < 0.08:
        O.step()
        force = array(O.forces.f(target))
        pushed += force * O.dt
        presses = pressing(net, target)
        assert (presses > 0) == (np.abs(force).max() > 0)
        seen += presses > 0
        assert np.abs(array(given.given()) - pushed).max() < 1e-11
    assert seen > 50 and np.linalg.norm(pushed) > 0.01


def test_only_the_net_presses(scene):
    """A ball that lies on a floor is pressed by it all the time."""
    net, target = meeting(free=True)
    center, radius = O.bodies[target].state.pos, O.bodies[target].shape.radius
    low = center[2] - radius - 0.001 + 1e-6
    plane((0.03, 0.01, low), (0.015, 0.015, 0.001), material="cable")
    O.engines = ancf.engines(net, gravity=(0, 0, -9.81))
    steps(100)
    assert O.forces.f(target).norm() > 1 and pressing(net, target) == 0


def test_momentum_of_what_is_held_is_not_known(scene):
    net, target = meeting()
    net.fix(4)
    steps(3)
    assert all(math.isnan(x) for x in Momentum(net, target).given())


def test_folded_net_that_touches_itself_has_not_met_its_target(scene):
    material("cable")
    target = ball((1, 0, 0), 0.05, material="cable")
    net = squareNet(4, 0.08, fold=0.1, damping=5e-5, mass="lumped", selfContact=True)
    net.addBullets(0.05, 0.01, 0.5, math.radians(-20))  # inwards, against its own folds
    O.engines = ancf.engines(net)
    capture, touched = Capture(net, target), 0
    while O.time < 0.15:
        steps(20)
        capture.sample()
        touched += net.engine.contacts > 0
    assert touched > 0
    assert capture.contact is None and capture.contacts == [0] * len(capture.time)
    assert max(capture.momentum) < 1e-12


def test_short_contacts_are_not_missed(scene):
    """A graze between two samples is told from the momentum."""
    net, target = meeting()
    capture, exact = Capture(net, target), None
    while O.time < 0.05:
        steps(1)
        if exact is None and O.forces.f(target).norm() > 0:
            exact = O.time
        if O.iter % 200 == 0:
            capture.sample()
    assert 0 <= capture.contact - exact < 201 * O.dt


# ---- stages --------------------------------------------------------------------------------------


def story(mouth, beyond, momentum=None, **options):
    """A Capture with these values at 0, 0.1, 0.2 ... s."""
    net, target = meeting()
    capture = Capture(net, target, **options)
    count = len(mouth)
    capture.time = [round(0.1 * k, 1) for k in range(count)]
    capture.mouth, capture.beyond = list(mouth), list(beyond)
    capture.contacts = [0] * count
    capture.momentum = list(momentum or [0.0] * count)
    return capture


MOUTH = [0.1, 0.8, 1.0, 0.9, 0.2, 0.1, 0.05, 0.2, 0.2, 0.5]
BEYOND = [0, 0, 0, 0.5, 1, 1, 1, 1, 0.75, 0.5]
PUSHED = [0, 0, 0, 0.1, 0.1, 0.2, 0.2, 0.2, 0.2, 0.2]


def test_stages(scene):
    capture = story(MOUTH, BEYOND, PUSHED)
    assert (capture.open, capture.contact) == (0.2, 0.3)
    assert capture.embraced == (0.4, 0.7)
    assert (capture.tightest, capture.recoil, capture.lock) == (0.6, 0.8, None)


def test_stages_of_a_net_that_holds(scene):
    capture = story(MOUTH[:8], BEYOND[:8], PUSHED[:8])
    assert capture.embraced == (0.4, 0.7)
    assert (capture.recoil, capture.lock) == (None, 0.4)


def test_stages_that_it_does_not_come_to(scene):
    capture = story(MOUTH[:4], BEYOND[:4])
    assert (capture.open, capture.contact, capture.embraced) == (0.2, None, None)
    assert capture.tightest is capture.recoil is capture.lock is None
    assert story(MOUTH, BEYOND, hold=0.35).embraced is None  # it lasts for 0.3
    assert story(MOUTH, BEYOND, hold=0.25).embraced == (0.4, 0.7)
    assert story(MOUTH, BEYOND, closed=0.15, hold=0.1).embraced == (0.5, 0.6)


def test_mouth_counts_as_part_of_its_largest_so_far(scene):
    mouth, beyond = [0.1, 1, 0.3, 0.3, 0.3, 0.3, 2.0], [0] * 2 + [1] * 5
    assert story(mouth, beyond).embraced is None
    assert story([0.1, 1, 0.2, 0.2, 0.2, 0.2, 2.0], beyond).embraced == (0.2, 0.5)


def test_net_without_bullets(scene):
    """Its corners count instead."""
    material("cable")
    target = ball((0.05, 0, 0), 0.02, material="cable")
    net = squareNet(2, 0.06, mass="lumped", damping=5e-5)
    net.setVelocity(lambda p: Vector3(1.5, 0, 0))
    O.engines = ancf.engines(net)
    capture = Capture(net, target)
    while O.time < 0.06:
        steps(50)
        capture.sample()
    assert 0.015 < capture.contact < 0.025  # 0.03 m away
    assert capture.beyond[0] == 0 and capture.beyond[-1] == 1


def test_largest_mouth_after_contact_is_not_when_it_opened(scene):
    assert story([0.1, 0.5, 0.4, 0.9], [0] * 4, [0, 0, 0.1, 0.1]).open == 0.1


def test_row_has_one_value_a_measure(scene):
    net, target = meeting()
    left = iter(np.linspace(1, 0, 100))
    capture = Capture(net, target, every=3, also={"line_left_m": lambda: next(left)})
    while O.time < 0.05:
        steps(50)
        capture.sample()
    row = capture.row()
    assert capture.looked == [*range(0, len(capture.time) - 1, 3), len(capture.time) - 1]
    assert row["enclosed_end"] == enclosedShare(net, target)
    assert row["quality_end"] == qualityIndex(net, target)
    assert row["line_left_m"] == capture.more["line_left_m"][-1]
    assert row["mouth_open_m2"] in capture.mouth and capture.mouth[-1] == net.mouthArea()
    assert 0 < row["enclosed_most"] <= 1 and row["tension_most_N"] > 0
    assert row["momentum_end_Ns"] == capture.momentum[-1] > 0
    assert row["beyond_end"] == 1 and row["embraced_from_s"] is None
    assert all(v is None or np.isscalar(v) for v in row.values())


TEXTS = [
    (lambda n, t: Capture(n, 999), IndexError, "Capture: target = 999: there is no such body"),
    (lambda n, t: Capture(n, n.bodies[0]), ValueError, "Capture: target = .*element of a cable"),
    (lambda n, t: Capture(n, t, closed=2), ValueError, "Capture: closed = 2: must be at most 1"),
    (lambda n, t: Capture(n, t, hold=-1), ValueError, "Capture: hold = -1: .*not below zero"),
    (lambda n, t: Capture(n, t, every=0), ValueError, "Capture: every = 0: must be at least 1"),
    (lambda n, t: Capture(n, t, directions=0), ValueError, "Capture: directions = 0: must be at"),
    (lambda n, t: Capture(squareNet(2), t), RuntimeError, "Capture: append Net first"),
    (lambda n, t: Capture(n, t).row(), RuntimeError, "Capture.row: there are no samples yet"),
    (lambda n, t: named(n, t, "open_s"), ValueError, "Capture: also = 'open_s': is a measure"),
    (lambda n, t: enclosedShare(n, -1), IndexError, "enclosedShare: target = -1: there is no"),
    (lambda n, t: pressing(n, 999), IndexError, "pressing: target = 999: there is no"),
    (lambda n, t: Momentum(n, 999), IndexError, "Momentum: target = 999: there is no"),
    (lambda n, t: targetSize(flatBody()), ValueError, "targetSize: target = .*flat"),
    (lambda n, t: Capture(bare(), t), ValueError, r"Net.rim = \[\]: name the knots"),
    (lambda n, t: Capture(bare(SQUARE), t), ValueError, r"Net.corners = \[\]: .* addBullets"),
]


def named(net, target, name):
    capture = Capture(net, target, also={name: lambda: 0.0})
    capture.sample()
    return capture.row()


def flatBody():
    corners = [Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(0, 1, 0)]
    return O.bodies.append(utils.facet(corners, material="cable"))


SQUARE = [0, 1, 3, 2]  # of the CUBE's knots


def bare(rim=()):
    """A net without corners."""
    net = ancf.Net(CUBE, SIDES, diameter=1e-3, material="cable", rim=rim)
    net.append()
    return net


@pytest.mark.parametrize("call, error, text", TEXTS)
def test_refusals_name_what_is_wrong(scene, call, error, text):
    net, target = meeting()
    with pytest.raises(error, match=text):
        call(net, target)
