"""Cables come to rest on what they lie on: floors, balls, edges, sheaves, and each other."""

import numpy as np
import pytest
from scipy.optimize import brentq, fsolve, minimize

import ancf
from ancf import pulleys
from helpers import array, ball, hertz, material, plane, squareNet, steps
from yade import O, Vector3, utils

G = 9.81


def relaxed(*structures, tolerance=1e-8, gravity=(0, 0, -G), **options):
    O.engines = ancf.engines(*structures, gravity=gravity, **options)
    structures[0].relax(tolerance)
    return structures[0]


# ---- a rope on a floor ---------------------------------------------------------------------------

RADIUS, HEIGHT, SPAN = 2.5e-3, 0.4, 2.0


def ropeOnFloor(model="ancf", contact="curve", parts=10, floor=True, **options):
    """Between two posts, longer than their distance; its middle lies on the floor."""
    material("cable", young=1e8)
    bottom = 0.02 * HEIGHT + RADIUS
    points = [(0, HEIGHT), (0.3, 2 * bottom), (1, bottom), (1.7, 2 * bottom), (SPAN, HEIGHT)]
    division = (
        dict(midPoints=parts - 1) if model == "springs" else dict(elements=parts, bending=0.0)
    )
    c = ancf.Cable(
        [(x, 0, z + RADIUS) for x, z in points],
        diameter=2 * RADIUS,
        material="cable",
        model=model,
        contact=contact,
        **division,
        **options,
    )
    c.append()
    c.fix(0)
    c.fix(-1)
    if floor:
        plane((1, 0, -0.5), (3, 3, 0.5), material="cable")
    return c


def layingCatenary(c):
    """(hanging length at either end, horizontal pull, point(s)) of the elastic catenary that goes on
    straight along the floor."""
    w, ea, length = c.section.rhoA * G, c.section.ea, c.length

    def fall(u, pull):
        across = pull * u / ea + pull / w * np.arcsinh(w * u / pull)
        return across, w * u * u / (2 * ea) + pull / w * (np.sqrt(1 + (w * u / pull) ** 2) - 1)

    def wrong(unknown):
        u, pull = unknown
        across, up = fall(u, pull)
        return across + (length / 2 - u) * (1 + pull / ea) - SPAN / 2, up - HEIGHT

    hanging, pull = fsolve(wrong, (0.5, 0.2 * w))

    def point(s):
        from_middle = abs(s - 0.5) * length
        lying = min(from_middle, length / 2 - hanging)
        across, up = fall(from_middle - lying, pull)
        side = np.sign(s - 0.5)
        return np.array([SPAN / 2 + side * (lying * (1 + pull / ea) + across), 0, up + RADIUS])

    return hanging, pull, point


@pytest.mark.parametrize("model", ["ancf", "springs"])
@pytest.mark.parametrize("contact", ["curve", "points"])
def test_catenary_with_touchdown(scene, model, contact):
    c = relaxed(ropeOnFloor(model, contact))
    hanging, pull, point = layingCatenary(c)
    error = max(np.linalg.norm(array(c.point(s)) - point(s)) for s in np.linspace(0, 1, 101))
    assert error < 1e-3 * c.length
    assert c.tension(0.5) == pytest.approx(pull, rel=0.05)
    at = c.curve(4)
    assert at[:, 2].min() > RADIUS - 0.02 * RADIUS
    weight = c.section.rhoA * G
    carried, held, curves = [], [], []
    for _ in range(2000):
        O.step()
        carried.append(sum(i.phys.normalForce[2] for i in O.interactions if i.isReal))
        held.append(c.reaction(0)[2])
        curves.append(c.curve(4))
    assert np.mean(held) == pytest.approx(weight * hanging, rel=0.01)
    assert np.mean(carried) == pytest.approx(weight * (c.length - 2 * hanging), rel=0.005)
    steps(300)
    there = np.mean(curves, axis=0)  # it trembles about it
    assert abs(there - at).max() < (1e-8 if contact == "points" else 0.002 * RADIUS)


def test_far_from_everything_is_as_before(scene):
    """Bodies out of reach, or not to be touched, change no bit."""
    found = []
    for how in ("none", "far", "mask", "exclude"):
        O.reset()
        c = ropeOnFloor(floor=False, parts=3)
        if how == "far":
            plane((1, 0, -3), (3, 3, 0.5), material="cable")
            ball((1, 1, 0), 0.1, mass=1.0, material="cable")
        if how == "mask":
            plane((1, 0, -0.5), (3, 3, 0.5), material="cable", mask=2)
        if how == "exclude":
            floor = plane((1, 0, -0.5), (3, 3, 0.5), material="cable")
            for i in c.bodies:
                O.bodies[i].shape.exclude = [floor]
        relaxed(c)
        found.append(c.curve(4))
    assert found[0][:, 2].min() < -0.1
    for other in found[1:]:
        assert np.array_equal(other, found[0])


# ---- taut and clamped cables, that touch nothing ---------------------------------------------------


# A steel bar of 2 m and 0.1 x 0.1 m under 3 EI/L^2 at its end: (u, w) of REFERENCE's sources, a
# Reissner beam by shooting, -0.508537304 and -1.207239855.
def test_cantilever_of_many_elements(scene):
    material("steel", young=2.07e11)
    ei = 2.07e11 * 0.1**4 / 12
    c = ancf.Cable(
        [(0, 0, 0), (2, 0, 0)],
        elements=40,
        diameter=0.1,
        area=0.01,
        bending=ei,
        material="steel",
        axialRule="reduced",
        curvature="exact",
    )
    c.append()
    c.clamp(0)
    c.load(-1, (0, 0, -3 * ei / 2**2))
    relaxed(c, tolerance=1e-9, gravity=(0, 0, 0))
    end = array(c.point(1)) - (2, 0, 0)
    assert end == pytest.approx([-0.508537304, 0, -1.207239855], abs=2e-6)


# 10 m of EA = 2e7 N over 8 m: both ends carry half of it, whatever rounding does to its tension.
@pytest.mark.parametrize("elements", [16, 64])
def test_cable_that_hardly_stretches(scene, elements):
    material("wire", young=2e9, density=120)
    a = brentq(lambda a: 2 * a * np.sinh(4 / a) - 10, 0.5, 100)
    u = np.linspace(-5, 5, elements + 1)
    points = [(4 + a * np.arcsinh(v / a), 0, np.hypot(a, v) - np.hypot(a, 5)) for v in u]
    c = ancf.Cable(points, diameter=0.05, area=0.01, bending=20.0, material="wire")
    c.append()
    c.fix(0)
    c.fix(-1)
    relaxed(c, tolerance=1e-9)
    O.dt = c.criticalTimeStep()
    O.step()  # which finds the reactions
    for knot in (0, -1):
        assert c.reaction(knot)[2] == pytest.approx(0.5 * 1.2 * c.length * G, rel=1e-5)


# ---- single contacts, energies -------------------------------------------------------------------


def test_depth_of_a_carried_ball(scene):
    """A heavy ball on the end of a thread lies on the floor as deep as Hertz says."""
    material("cable", young=1e8)
    radius, mass = 0.02, 1.0
    c = ancf.Cable(
        [(0, 0, radius), (0.3, 0, 0.05)], 3, diameter=1e-4, material="cable", bending=0.0
    )
    c.append()
    plane((0, 0, -0.5), (3, 3, 0.5), material="cable")
    weight = ball((0, 0, radius), radius, mass=mass, material="cable")
    c.carry(0, weight)
    c.fix(-1)
    relaxed(c)
    k = hertz(radius, 1e8, 0.3, 1e8, 0.3)
    depth = (mass * G / k) ** (2 / 3)
    assert radius - O.bodies[weight].state.pos[2] == pytest.approx(depth, rel=1e-3)


def test_crossing_ropes(scene):
    """Laid into each other, they come to rest hooked: each is straight but for a point load, the same on
    both; where they touch, Hertz."""
    material("cable", young=1e9)
    r, half, overlap = 2e-3, 0.1, 3e-3
    options = dict(diameter=2 * r, material="cable", model="springs", midPoints=9)
    low = ancf.Cable([(-half, 0, 0), (half, 0, 0)], **options)
    high = ancf.Cable([(0, -half, 2 * r - overlap), (0, half, 2 * r - overlap)], **options)
    low.append()
    high.append(engine=low.engine)
    for c in (low, high):
        c.fix(0)
        c.fix(-1)
    relaxed(low, high, gravity=(0, 0, 0))
    ea, k = low.section.ea, 4 * hertz(r / 2, 1e9, 0.3, 1e9, 0.3)  # two springs of either meet there

    def missing(y):
        length = np.hypot(half, y)
        load = 2 * ea * (length / half - 1) * y / length
        return 2 * y + (load / k) ** (2 / 3) - overlap

    sag = brentq(missing, 0, overlap)
    assert low.point(0.5)[2] == pytest.approx(-sag, rel=1e-3)
    assert high.point(0.5)[2] - high.point(0)[2] == pytest.approx(sag, rel=1e-3)
    assert abs(low.point(0.5)[1]) < 1e-9 and abs(high.point(0.5)[0]) < 1e-9


def test_least_energy(scene):
    """Springs over a fixed ball, found again as the minimum of an energy that stands here."""
    material("cable", young=1e7)
    r, radius, n = 5e-3, 0.1, 6
    c = ancf.Cable(
        [(-0.3, 0, 0.12), (0.3, 0.02, 0.12)],
        model="springs",
        midPoints=n - 1,
        diameter=2 * r,
        material="cable",
        contact="points",
    )
    c.append()
    ball((0.01, 0, 0), radius, material="cable")
    c.fix(0)
    c.fix(-1)
    start = c.curve(1)
    relaxed(c, tolerance=1e-10)
    length, ea, weight = c.length / n, c.section.ea, c.section.rhoA * c.length / n * G
    k = hertz(r * radius / (r + radius), 1e7, 0.3, 1e7, 0.3)

    def energy(inner):
        p = np.vstack([start[0], inner.reshape(-1, 3), start[-1]])
        stretch = np.maximum(np.linalg.norm(np.diff(p, axis=0), axis=1) / length - 1, 0)
        depth = np.maximum(r + radius - np.linalg.norm(p - [0.01, 0, 0], axis=1), 0)
        up = weight * p[1:-1, 2].sum()
        return ea * length * (stretch**2).sum() / 2 + up + 0.4 * k * (depth**2.5).sum()

    best = c.curve(1)[1:-1].ravel()
    found = minimize(energy, best + 1e-6, method="BFGS", options=dict(gtol=1e-10, maxiter=2000))
    assert energy(best) <= found.fun + 1e-9 * abs(found.fun)
    assert abs(found.x - best).max() < 1e-5


# ---- edges, sheaves, nets ------------------------------------------------------------------------


def test_over_an_edge(scene):
    """Without friction and bending, the pull at the upper end is the weight per length times the
    height from the free end to it, whatever lies between."""
    material("cable", young=1e8)
    r = 2.5e-3
    points = [(-0.5, 0, r), (-0.02, 0, r + 1e-4), (0.004, 0, -0.01), (0.006, 0, -0.6)]
    c = ancf.Cable(points, 20, diameter=2 * r, material="cable", bending=0.0)
    c.append()
    plane((-1, 0, -1), (1, 1, 1), material="cable")
    c.fix(0)
    relaxed(c)
    height = c.point(0)[2] - c.point(1)[2]
    assert np.mean(c.tensions(8)[8:120]) == pytest.approx(c.section.rhoA * G * height, rel=0.02)
    curve = c.curve(8)
    x, z = curve[:, 0], curve[:, 2]
    inside = np.hypot(np.maximum(x, 0), np.maximum(z, 0)) - r
    assert inside[(x < 0) | (z < 0) | (x > 0)].min() > -0.05 * 2 * r
    steps(200)
    assert abs(c.curve(8) - curve).max() < 0.02 * r


def test_in_the_groove_of_a_sheave(scene):
    """A load on one end is held by the other, less the weight of what hangs lower."""
    material("cable", young=1e9)
    r, radius = 2e-3, 0.1
    at = radius + r
    arc = [(at * np.cos(a), 0, at * np.sin(a)) for a in np.linspace(np.pi, 0, 7)]
    points = [(-at, 0, -0.4), *arc, (at, 0, -0.2)]
    c = ancf.Cable(points, 6, diameter=2 * r, material="cable", bending=0.0)
    pulleys.sheave((0, 0, 0), radius, axis=(0, 1, 0), width=0.01, material="cable")
    c.append()
    c.fix(0)
    c.load(-1, (0, 0, -5))
    relaxed(c)
    higher = c.point(1)[2] - c.point(0)[2]
    assert c.tension(0) == pytest.approx(5 - c.section.rhoA * G * higher, rel=3e-3)
    assert abs(c.curve(4)[:, 1]).max() < 1e-6
    assert c.curve(4)[:, 2].max() == pytest.approx(at, rel=1e-4)


def netOnBall(mass=None):
    material("cable")
    net = squareNet(meshes=6, normal=(0, 0, 1), center=(0, 0, 0.1515), elements=2)
    target = ball((0, 0, 0), 0.15, mass=mass, material="cable")
    net.append()
    for corner in net.corners:
        net.load(corner, (0, 0, -2.0))
    return net, target


def test_net_on_a_ball(scene):
    net, _ = netOnBall()
    relaxed(net)
    curve = np.vstack([s.curve(8) for s in net.spans])
    assert np.linalg.norm(curve, axis=1).min() > 0.15 + 0.95 * net.radius
    assert (net.knots[net.corners, 2] < 0.1).all()
    carried = []
    for _ in range(60):
        O.step()
        carried.append(abs(sum(i.phys.normalForce[2] for i in O.interactions if i.isReal)))
    assert np.mean(carried) == pytest.approx(8 + net.mass * G, rel=0.02)


# ---- refused -------------------------------------------------------------------------------------


def test_what_may_move_is_named(scene):
    net, target = netOnBall(mass=1.0)
    before = net.knots
    with pytest.raises(RuntimeError, match=f"press on body {target}, which may move: fix it"):
        relaxed(net)
    assert np.array_equal(net.knots, before)


def test_what_slides_away_has_no_equilibrium(scene):
    material("cable", young=1e8)
    c = ancf.Cable([(-0.1, 0, 0.1), (0.1, 0, 0.1)], 4, diameter=5e-3, material="cable")
    c.append()
    slope = plane((0, 0, 0), (3, 3, 0.05), material="cable")
    O.bodies[slope].state.ori = utils.Quaternion((0, 1, 0), 0.3)
    O.engines = ancf.engines(c, gravity=(0, 0, -G))
    with pytest.raises(RuntimeError, match="no static equilibrium"):
        c.engine.relax(1e-8, 3000)
