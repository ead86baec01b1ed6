"""Ends that slide along a line: closed forms, conserved quantities, saves, and what is refused."""

import math

import numpy as np
import pytest
from helpers import array, material, momenta, plane, runTo, steps

import ancf
from yade import O, Vector3, utils

YOUNG, DIAMETER = 1e9, 2e-2
EI = YOUNG * math.pi * DIAMETER**4 / 64
DIRECTION = (2.0, -1.0, 0.5)


@pytest.fixture
def stiff(scene):
    return material("stiff", young=YOUNG, density=1000)


def cable(points=((0, 0, 0), (0.5, 0, 0)), elements=8, **options):
    given = dict(diameter=DIAMETER, material="stiff", contactPoints=0)
    return ancf.Cable(points, elements, **{**given, **options})


def offLine(at, start, direction):
    way, unit = array(at) - array(start), array(direction) / np.linalg.norm(direction)
    return np.linalg.norm(way - (way @ unit) * unit)


# ---- statics ---------------------------------------------------------------------------------------


def test_guided_beam(stiff):
    """Clamped at one end, at the other a clamp that slides across it: F L^3/12 EI, and half of F L at
    either clamp."""
    b, force = cable(), 1e-3
    b.clamp(0)
    b.slide(-1, (0, 0, 7), clamped=True)
    b.load(-1, (0, 0, force))
    b.append()
    b.relax(1e-12)
    length = b.length
    assert b.point(1)[2] == pytest.approx(force * length**3 / (12 * EI), rel=1e-5)
    assert array(b.moment(0)) == pytest.approx([0, force * length / 2, 0], rel=1e-5, abs=1e-12)
    assert array(b.moment(-1)) == pytest.approx([0, force * length / 2, 0], rel=1e-5, abs=1e-12)
    assert array(b.anchorForce()) == pytest.approx([0, 0, -force], rel=1e-6, abs=1e-6 * force)


@pytest.mark.parametrize("model", ["ancf", "springs"])
def test_half_a_catenary(stiff, model):
    """Hung between a fixed point and a slider on an upright rail, which takes no force along it, a
    cable ends level there: as long as a half catenary y = a cosh(x/a) over its span, and the rail takes
    its horizontal tension a q."""
    span, a = 1.0, 0.8
    length = a * math.sinh(span / a)
    number = dict(elements=24) if model == "ancf" else dict(elements=1, midPoints=59, model=model)
    c = ancf.Cable(
        [(span, 0, 0), (0, 0, -0.4)],
        diameter=2e-3,
        material="stiff",
        contactPoints=0,
        length=length,
        **({"bending": 0.0} if model == "ancf" else {}),
        **number,
    )
    c.fix(0)
    c.slide(1, (0, 0, -1))
    O.engines = ancf.engines(c, gravity=(0, 0, -9.81))
    c.relax(1e-9 if model == "ancf" else 1e-6)
    weight = c.section.rhoA * 9.81
    sag = a * (math.cosh(span / a) - 1)
    close = 2e-4  # it stretches, and springs are polygons
    assert -c.point(1)[2] == pytest.approx(sag, rel=close)
    assert c.reaction(1)[0] == pytest.approx(-a * weight, rel=close)
    assert abs(c.reaction(1)[2]) < 1e-12 * weight
    assert c.point(1)[0] == 0 and c.point(1)[1] == 0


def test_tension_ends_at_a_rail(stiff):
    """A rail across a cable takes a pull along it as a fixed knot does, and tensions are told as there."""
    told = []
    for slides in (True, False):
        c = cable(((0, 0, 0), (0.2, 0, 0), (0.5, 0, 0)), 2, bending=0)
        c.fix(0)
        if slides:
            c.slide(1, (0, 1, 1))
        else:
            c.fix(1)
        c.load(2, (30, 0, 0))
        c.append()
        c.relax(1e-10)
        told.append([*c.reaction(0), *c.reaction(1), *c.tensions(8)])
    assert told[0] == pytest.approx(told[1], abs=1e-6)
    assert max(told[1]) > 29 and abs(told[1][6]) < 3


def test_it_slides_until_what_it_lies_on_carries_it(stiff):
    """By relaxation, as it comes near a floor: the rail takes none of the weight."""
    plane((0, 0, -0.45), (2, 2, 0.05), material="stiff")
    c = cable(((0, 0, 0), (1, 0, 0)), 6, diameter=1e-2, contactPoints=3)
    c.slide(0, (0, 0, 1))
    c.slide(-1, (0, 0, 1))
    O.engines = ancf.engines(c, gravity=(0, 0, -9.81))
    c.relax(1e-6)
    for s in (0, 0.3, 1):
        assert c.point(s)[2] == pytest.approx(-0.4 + c.radius, abs=1e-4)
    assert c.point(0)[0] == 0 and c.point(1)[0] == 1


# ---- dynamics --------------------------------------------------------------------------------------


@pytest.mark.parametrize("integrator", ["leapfrog", "implicit", "rk4"])
@pytest.mark.parametrize("mass", ["consistent", "lumped"])
def test_pendulum_on_a_slider(stiff, mass, integrator):
    """A stiff rod hangs from a slider, a ball at its end: w^2 = W h/I about the common centre, which
    only goes up and down, with h from the slider to it."""
    ball = O.bodies.append(utils.sphere((0, 0, -0.5), 0.02, material="stiff", mask=2))
    rod = cable(((0, 0, 0), (0, 0, -0.5)), 2, diameter=4e-2, mass=mass)
    weight = O.bodies[ball].state
    weight.mass, weight.inertia = 0.2, Vector3(1, 1, 1) * 1e-9
    rod.slide(0, (1, 0, 0))
    rod.carry(1, ball)
    swing = 1e-3
    O.engines = ancf.engines(rod, gravity=(0, 0, -9.81), integrator=integrator)
    if integrator == "implicit":
        O.dt = 2e-4
    length, m = rod.length, rod.mass
    whole = m + weight.mass
    h = (m * length / 2 + weight.mass * length) / whole
    own = 1 / 12 if mass == "consistent" else 1 / 8 + 1 / 156  # lumped: of nodes, and of slopes
    inertia = own * m * length**2 + m * (h - length / 2) ** 2 + weight.mass * (length - h) ** 2
    period = 2 * math.pi * math.sqrt(inertia / (whole * 9.81 * h))
    speed = swing * 2 * math.pi / period
    rod.setVelocity(lambda p: Vector3(speed * -(p[2] + h), 0, 0))
    bottom = []
    while O.time < 1.1 * period:
        O.step()
        bottom.append((O.time, rod.point(1)[0], rod.point(0)[0]))
    t, x, top = np.array(bottom).T
    down = np.flatnonzero((x[:-1] * x[1:] < 0) & (t[1:] > 0.3 * period))
    found = t[down[0]] + (t[down[0] + 1] - t[down[0]]) * x[down[0]] / (x[down[0]] - x[down[0] + 1])
    assert found == pytest.approx(period / 2, rel=1e-3)
    assert np.abs(top).max() == pytest.approx(swing * h, rel=5e-3)


@pytest.mark.parametrize("integrator", ["leapfrog", "implicit"])
@pytest.mark.parametrize("mass", ["consistent", "lumped"])
def test_momentum_along_is_kept_and_reactions_are_the_rest(stiff, mass, integrator):
    c = cable(((0, 0, 0), (0.2, 0.1, 0), (0.5, 0, 0)), 3, mass=mass, bending=1e-3)
    for knot in (0, 1, 2):
        c.slide(knot, DIRECTION)
    c.setVelocity(lambda p: Vector3(3 * p[1], 2 - 9 * p[0], 4 * p[0]))
    O.engines = ancf.engines(c, integrator=integrator)
    O.dt = 1e-6
    steps(1)  # what is across has been stopped
    unit = array(DIRECTION) / np.linalg.norm(DIRECTION)
    start, before = c.knots, array(c.engine.momentum()[0])
    given, size = np.zeros(3), np.linalg.norm(before)
    for _ in range(400):
        O.step()
        forces = [array(c.reaction(knot)) for knot in (0, 1, 2)]
        given += O.dt * sum(forces)
        assert max(abs(f @ unit) for f in forces) < 1e-12 * max(map(np.linalg.norm, forces))
    gained = array(c.engine.momentum()[0]) - before
    assert abs(gained @ unit) < 1e-11 * size
    close = 1e-11 if integrator == "leapfrog" else 1e-3  # told within the step
    assert np.linalg.norm(given) > 0.01 * size
    assert np.linalg.norm(gained - given) < close * np.linalg.norm(given) + 1e-11 * size
    for knot in (0, 1, 2):
        assert offLine(c.knots[knot], start[knot], DIRECTION) < 1e-15
        assert np.linalg.norm(c.knots[knot] - start[knot]) > 1e-5


@pytest.mark.parametrize("substeps", [1, 3])
@pytest.mark.parametrize("mass", ["consistent", "lumped"])
def test_ball_on_a_sliding_end(stiff, mass, substeps):
    """A ball hits a cable near its sliding ends: momentum along the rails is kept together, energy is
    in balance, and what the rails take is what is missing across."""
    c = cable(((0, 0, 0), (0.3, 0, 0)), 4, diameter=1e-2, contactPoints=3, mass=mass, bending=1e-2)
    c.slide(0, (0, 1, 1))
    c.slide(-1, (0, 1, 1))
    ball = O.bodies.append(utils.sphere((0.05, 0.004, 0.0255), 0.02, material="stiff"))
    O.bodies[ball].state.vel = Vector3(0, 0.5, -1)
    O.materials["stiff"].kineticFriction = O.materials["stiff"].staticFriction = 0.3
    O.engines = ancf.engines(c, substeps=substeps)
    O.trackEnergy = True
    O.dt = 0.5 * substeps * c.criticalTimeStep()
    O.step()
    before, start = momenta(c.engine, {ball: False})[0], O.energy.total()
    across = np.zeros(3)
    met, off, scale = 0, 0.0, O.energy["kinetic"]
    while O.time < 4e-3:
        O.step()
        met += c.engine.contacts
        off = max(off, abs(O.energy.total() - start))
        if substeps == 1:
            across += O.dt * (array(c.reaction(0)) + array(c.reaction(-1)))
    gained = momenta(c.engine, {ball: False})[0] - before
    size = O.bodies[ball].state.mass
    assert met > 10
    assert abs(gained @ [0, 1, 1]) < 1e-12 * size
    assert abs(gained[2] - gained[1]) > 1e-3 * size
    if substeps == 1:
        assert np.abs(gained - across).max() < 1e-11 * size
    assert off < 2e-3 * scale
    assert offLine(c.knots[0], (0, 0, 0), (0, 1, 1)) < 1e-16


def test_friction_across_a_rail_holds_as_at_a_fixed_end(stiff):
    """A ball that is drawn over a sliding knot, across its line: what rubs does not move the knot, and
    takes the same of the ball as at a fixed one."""
    slowed = []
    for slides in (True, False):
        O.reset()
        material("stiff", young=YOUNG, density=1000, staticFriction=0.3, kineticFriction=0.3)
        c = cable(((0, -0.2, 0), (0, 0.2, 0)), 2, diameter=1e-2, contactPoints=3, mass="lumped")
        for knot in (0, 1):
            if slides:
                c.slide(knot, (0, 1, 0))
            else:
                c.fix(knot)
        ball = O.bodies.append(utils.sphere((-1e-4, -0.2, 0.0249), 0.02, material="stiff"))
        O.bodies[ball].state.vel = Vector3(1, 0, -0.2)
        O.bodies[ball].state.blockedDOFs = "XYZ"
        O.engines = ancf.engines(c)
        runTo(3e-4)
        slowed.append(array(O.bodies[ball].state.vel))
    assert slowed[1][0] < 0.99
    assert slowed[0] == pytest.approx(slowed[1], abs=1e-3)


# ---- saves -----------------------------------------------------------------------------------------


def test_goes_on_after_loading(stiff, tmp_path):
    save = str(tmp_path / "scene.xml")
    c = cable(mass="lumped", bending=1e-3)
    c.slide(0, DIRECTION)
    c.slide(-1, (0, 0, 1), clamped=True)
    O.engines = ancf.engines(c, gravity=(0, 0, -9.81))
    steps(50)
    O.save(save)
    steps(200)
    whole, nodes = list(c.engine.position), list(c.engine.slideNodes)
    O.load(save)
    (loaded,) = ancf.structures()
    steps(200)
    assert list(loaded.engine.position) == whole
    assert loaded._claims == c._claims
    assert loaded.moment(-1).norm() > 0
    with pytest.raises(ValueError, match=r"knot 0 is sliding along \(0\.87.*cannot be fixed"):
        loaded.fix(0)
    loaded.release(0)
    assert list(loaded.engine.slideNodes) == nodes[1:]
    loaded.release(-1)
    assert not loaded.engine.slideNodes and not loaded.engine.clampedEnds
    before = array(loaded.engine.momentum()[0])
    steps(10)
    gained = array(loaded.engine.momentum()[0]) - before
    assert gained == pytest.approx([0, 0, -9.81 * 10 * O.dt * loaded.mass], rel=1e-9, abs=1e-12)


def test_lines_go_where_knots_are_put(stiff):
    c = cable(mass="lumped")
    c.slide(0, (0, 0, 1))
    O.engines = ancf.engines(c)
    steps(3)
    engine = c.engine
    stride = engine.stride
    position = np.array(engine.position)
    position[stride : stride + 9] += 0.5  # nodes, along y
    engine.position = list(position)
    steps(3)
    assert c.knots[0][1] == 0.5


# ---- refused ---------------------------------------------------------------------------------------


def test_refused(stiff):
    c = cable()
    spring = ancf.Cable(
        [(0, 1, 0), (1, 1, 0)], diameter=1e-3, material="stiff", model="springs", label="chain"
    )
    body = O.bodies.append(utils.sphere((0, 0, 0), 0.01, material="stiff", fixed=True, mask=2))
    c.clamp(1)
    c.slide(0, (0, 0, 2))
    c.slide(0, (0, 0, 1))  # the same
    with pytest.raises(
        ValueError, match=r"knot 1 is clamped and cannot be sliding along \(0, 0, 1\)"
    ):
        c.slide(1, (0, 0, 1))
    with pytest.raises(
        ValueError, match=r"knot 0 is sliding along \(0, 0, 1\) and cannot be follow"
    ):
        c.follow(0, body)
    with pytest.raises(ValueError, match=r"cannot be sliding along \(1, 0, 0\)"):
        c.slide(0, (1, 0, 0))
    with pytest.raises(ValueError, match=r"cannot be sliding along \(0, 0, 1\), clamped as well"):
        c.slide(0, (0, 0, 1), clamped=True)
    with pytest.raises(ValueError, match="direction = .* has no direction"):
        c.slide(0, (0, 0, 0))
    with pytest.raises(ValueError, match=r"chain.slide\(0\): springs have no slopes"):
        spring.slide(0, (0, 0, 1), clamped=True)
    with pytest.raises(IndexError, match="there are 2 knots"):
        c.slide(2, (0, 0, 1))
    c.append()
    with pytest.raises(
        ValueError, match="node 0 is sliding along a line already: release it first"
    ):
        c.engine.fix(0)
    with pytest.raises(
        ValueError, match="direction = .0, 0, 0.: must be finite, below 1e100 and not 0"
    ):
        c.engine.release(0)
        c.engine.slide(0, Vector3.Zero)


@pytest.mark.parametrize(
    "attributes, told",
    [
        ({"slideNodes": [9]}, r"slideNodes\[0\] = 9: must be a node of nNodes"),
        ({"slideNodes": [0, 0]}, "slideNodes holds 0 twice"),
        ({"slideNodes": []}, "slideAlong has 1 values: must have 0"),
        ({"slideAlong": [Vector3(0, 0, 9)]}, r"slideAlong\[0\] = .*: must be a unit vector"),
        ({"slideAlong": [Vector3(0, 0, math.nan)]}, "must be a unit vector"),
        ({"slideAt": [Vector3(0, 1, 0)]}, r"slideAt\[0\]: node 0 of position is 1 m off its line"),
        ({"slideAt": [Vector3(0, math.nan, 0)]}, r"slideAt\[0\] = .*finite"),
        ({"fixedNodes": [0]}, "slideNodes holds node 0, which is in fixedNodes"),
    ],
)
def test_damaged_attributes_are_told(stiff, attributes, told):
    c = cable()
    c.slide(0, (0, 0, 1))
    O.engines = ancf.engines(c)
    steps(1)
    with pytest.raises(ValueError, match=told):
        c.engine.updateAttrs(attributes)
        O.step()
