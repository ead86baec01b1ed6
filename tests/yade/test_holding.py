"""What holds a cable, and what it takes: clamps that a body leads, their moments, sums of forces."""

import math

import numpy as np
import pytest
from helpers import array, material, plane, steps

import ancf
from ancf import pulleys
from yade import O, Quaternion, Vector3, utils

YOUNG, DIAMETER = 1e9, 2e-2
EI = YOUNG * math.pi * DIAMETER**4 / 64


@pytest.fixture
def stiff(scene):
    return material("stiff", young=YOUNG, density=1000)


def beam(points=((0, 0, 0), (0.5, 0, 0)), elements=8, **options):
    given = dict(diameter=DIAMETER, material="stiff", contactPoints=0)
    return ancf.Cable(points, elements, **{**given, **options})


def hub(center=(0, 0, 0)):
    """A body that the scene leads."""
    return O.bodies.append(utils.sphere(center, 0.01, material="stiff", fixed=True, mask=2))


def turn(body, axis, angle, n):
    """Turns a body about its centre by an angle within n steps, smoothly from rest to rest."""
    axis = Vector3(*axis).normalized()
    for i in range(n):
        speed = angle / (n * O.dt) * (1 - math.cos(2 * math.pi * (i + 0.5) / n))
        O.bodies[body].state.angVel = speed * axis
        O.step()
    O.bodies[body].state.angVel = Vector3.Zero


def rotation(axis, angle):
    m = Quaternion(Vector3(*axis).normalized(), angle).toRotationMatrix()
    return np.array([[m[i, j] for j in range(3)] for i in range(3)])


# ---- clamps that a body leads ----------------------------------------------------------------------


@pytest.mark.parametrize("mass", ["consistent", "lumped"])
def test_shape_turns_with_the_body(stiff, mass):
    """A bow between two clamps on one body: turned about any axis it comes to rest in the same shape."""
    t = np.linspace(0, math.pi, 7)
    bow = beam(np.stack([-np.cos(t), np.sin(t), 0.1 * t], axis=1), 2, mass=mass, damping=1e-3)
    centre = hub()
    bow.clamp(0, centre)
    bow.clamp(-1, centre)
    O.engines = ancf.engines(bow)
    bow.relax(1e-11)
    before, axis, angle = bow.curve(5), (1, 2, -0.5), 2.0
    turn(centre, axis, angle, 4000)
    bow.relax(1e-11)
    assert np.abs(bow.curve(5) - before @ rotation(axis, angle).T).max() < 1e-7
    assert np.abs(bow.curve(5) - before).max() > 0.5


def test_moment_of_a_turned_clamp(stiff):
    """Slope deflection: 4 EI/L at the end that is turned, 2 EI/L at the other, 6 EI/L^2 across."""
    b = beam()
    centre, angle = hub(), 1e-4
    b.clamp(0, centre)
    b.clamp(-1)
    O.engines = ancf.engines(b)
    turn(centre, (0, 0, 1), angle, 200)
    b.relax(1e-12)
    unit = EI * angle / b.length
    assert array(b.moment(0)) == pytest.approx([0, 0, 4 * unit], rel=1e-5, abs=1e-9 * unit)
    assert array(b.moment(-1)) == pytest.approx([0, 0, 2 * unit], rel=1e-5, abs=1e-9 * unit)
    assert b.reaction(0)[1] == pytest.approx(6 * unit / b.length, rel=1e-5)


def test_moment_of_a_cantilever_under_load(stiff):
    b = beam()
    b.clamp(0)
    b.load(-1, (0, 0, 1e-3))
    b.append()
    b.relax(1e-12)
    assert array(b.moment(0)) == pytest.approx([0, 1e-3 * b.length, 0], rel=1e-6, abs=1e-12)
    with pytest.raises(ValueError, match="no slope is held there"):
        b.moment(-1)


@pytest.mark.parametrize("knot", [0, 1])
@pytest.mark.parametrize("mass", ["consistent", "lumped"])
@pytest.mark.parametrize("integrator", ["leapfrog", "implicit"])
def test_moment_is_the_change_of_angular_momentum(stiff, knot, mass, integrator):
    """About the clamp, which a body turns faster and faster; at an end, and where a slope goes on."""
    b = beam(((0, 0, 0), (0.2, 0, 0), (0.5, 0, 0)), 2, mass=mass, damping=1e-5)
    centre = hub(b.knots[knot])
    b.clamp(knot, centre)
    O.engines = ancf.engines(b, integrator=integrator)
    O.dt = 2e-6 if integrator == "leapfrog" else 2e-5
    at, off, size = Vector3(*b.knots[knot]), 0, 0
    axis = Vector3(5, 30, -20)

    def momentum():
        linear, angular = b.engine.momentum()
        return array(angular) - np.cross(at, linear)

    before = momentum()
    while O.time < 4e-3:
        O.bodies[centre].state.angVel = (O.time / 4e-3) ** 2 * axis
        O.step()
        after, moment = momentum(), array(b.moment(knot))
        off = max(off, np.abs((after - before) / O.dt - moment).max())
        size = max(size, np.abs(moment).max())
        before = after
    assert off < (1e-6 if integrator == "leapfrog" else 5e-3) * size
    assert size > 1


@pytest.mark.parametrize("substeps", [1, 3])
def test_energy_of_a_clamp_that_is_turned_fast(stiff, substeps):
    """What the clamp gives is what the cable stores and moves with; the watch finds no more."""
    b = beam(damping=0)
    centre = hub()
    b.clamp(0, centre)
    O.engines = ancf.engines(b, substeps=substeps)
    b.engine.energyTolerance = 1e-5
    O.dt *= 0.2
    work, n = 0.0, 3000
    for i in range(n):
        speed = 40 * math.sin(math.pi * (i + 0.5) / n)
        O.bodies[centre].state.angVel = Vector3(0, 0, speed)
        O.step()
        work += b.moment(0)[2] * speed * O.dt
    energy = b.energy()
    stored = energy["kinetic"] + energy["bending"] + energy["axial"]
    assert stored > 0.1
    assert work == pytest.approx(stored, rel=2e-3)
    assert abs(b.engine.energyOff) < 1e-5 * b.engine.energyScale


def test_contact_on_a_clamped_element(stiff):
    """A ball that flies onto the cable beside a clamp in its middle: forces and moment are what changes
    the momenta of the cable and the ball.
    """
    b = beam(((-0.2, 0, 0), (0, 0, 0), (0.2, 0, 0)), 2, contactPoints=3, damping=0)
    centre = hub()
    b.clamp(1, centre)
    one = O.bodies.append(utils.sphere((0.03, 0, 0.0302), 0.02, material="stiff"))
    state = O.bodies[one].state
    state.vel = Vector3(0, 0, -1)
    O.engines = ancf.engines(b)
    O.bodies[centre].state.angVel = Vector3(0, 1, 0)
    steps(1)

    def momenta():
        linear, angular = (array(p) for p in b.engine.momentum())
        return linear + state.mass * array(state.vel), angular + state.mass * np.cross(
            array(state.pos), array(state.vel)
        )

    before, touched, off, size = momenta(), 0, np.zeros(2), np.zeros(2)
    for _ in range(400):
        O.step()
        after = momenta()
        told = array(b.anchorForce()), array(b.moment(1))
        for k in range(2):
            off[k] += np.abs((after[k] - before[k]) - told[k] * O.dt).max()
            size[k] += np.abs(told[k] * O.dt).max()
        before, touched = after, touched + b.engine.contacts
    assert touched > 20
    assert off[0] < 1e-6 * size[0]
    assert off[1] < 1e-3 * size[1]


def test_saved_and_loaded(stiff, tmp_path):
    """A clamp that turns goes on to the last bit."""
    b = beam()
    centre = hub()
    b.clamp(0, centre)
    O.engines = ancf.engines(b, gravity=(0, 0, -9.81))
    O.bodies[centre].state.angVel = Vector3(0, 3, 20)
    steps(100)
    save = str(tmp_path / "turning.xml")
    O.save(save)
    steps(100)
    end = list(b.engine.position), list(b.engine.velocity)
    O.load(save)
    (b,) = ancf.structures()
    assert b._claims == {0: f"clamped to body {centre}"}
    steps(100)
    assert (list(b.engine.position), list(b.engine.velocity)) == end


def test_release_of_a_led_clamp(stiff):
    b = beam()
    centre = hub()
    b.clamp(0, centre)
    b.append()
    b.release(0)
    assert list(b.engine.followEnds) == list(b.engine.followNodes) == []
    O.engines = ancf.engines(b)
    O.bodies[centre].state.angVel = Vector3(0, 0, 10)
    steps(20)
    assert np.abs(b.curve(2)[:, 1]).max() == 0


def test_what_cannot_lead_a_clamp_is_refused(stiff):
    free = O.bodies.append(utils.sphere((0, 0, 0), 0.01, material="stiff"))
    b = beam().append()
    with pytest.raises(ValueError, match=f"body {free} moves freely and would not feel .* moment"):
        b.clamp(0, free)
    assert b._claims == {} and list(b.engine.followNodes) == []
    with pytest.raises(IndexError, match="Cable.clamp: bodyId = 99"):
        b.clamp(0, 99)
    springs = ancf.Cable([(0, 1, 0), (1, 1, 0)], diameter=1e-3, material="stiff", model="springs")
    with pytest.raises(ValueError, match="springs have no slopes"):
        springs.clamp(0, hub())
    with pytest.raises(ValueError, match="follows no body: follow.. first"):
        b.engine.followSlope(0, 0)
    b.clamp(0, hub())
    with pytest.raises(ValueError, match="knot 0 is clamped to body .* and cannot be fixed"):
        b.fix(0)


# ---- contact with the body that leads it -----------------------------------------------------------


def excluding(cable):
    return [i for i, b in enumerate(cable.bodies) if O.bodies[b].shape.exclude]


@pytest.mark.parametrize("body", ["sphere", "sheave"])
def test_winds_on_the_drum_that_it_is_clamped_to(stiff, body):
    """In a turn as much of it goes on as the drum's surface goes, in contact all along."""
    radius, thick = 0.03, 4e-3
    material("rope", young=1e8, density=1000, staticFriction=0.3, kineticFriction=0.3)
    if body == "sheave":
        drum = pulleys.sheave((0, 0, 0), radius, width=0.08, axis=(0, 1, 0), material="rope")
    else:
        drum = O.bodies.append(utils.sphere((0, 0, 0), radius, material="rope", fixed=True))
        O.bodies[drum].state.blockedDOFs = "xyzXYZ"
    way = radius + thick / 2
    given = dict(diameter=thick, material="rope", bending=1e-4, damping=1e-4, mass="lumped")
    rope = ancf.Cable([(0, 0, way), (0.3, 0, way)], 24, contactPoints=2, **given)
    rope.clamp(0, drum)
    rope.load(1, (10, 0, 0))
    O.engines = pulleys.engines(rope)
    O.dt = 0.7 * rope.criticalTimeStep()
    assert excluding(rope) == [0]
    turned, angle = 0.0, 2 * math.pi
    while turned < angle:
        O.bodies[drum].state.angVel = Vector3(0, -60 * min(1, O.time / 0.02), 0)
        turned -= O.dt * O.bodies[drum].state.angVel[1]
        O.step()
    assert turned == pytest.approx(angle, rel=1e-2)
    off = np.linalg.norm(rope.curve(8)[:, ::2], axis=1) - way
    assert off.min() > -0.05 * thick
    assert (off < 0.1 * thick).mean() * rope.length == pytest.approx(angle * way, abs=0.02)
    assert rope.engine.contacts > 20


def test_lies_on_the_table_that_it_is_clamped_to(stiff):
    """Laid into it by a hair, as it comes to lie there: it does not fall through."""
    table = plane((0.2, 0, -0.05), (0.4, 0.2, 0.05), material="stiff")
    height = DIAMETER / 2 - 1e-5
    b = beam([(0, 0, height), (0.4, 0, height)], 10, contactPoints=3, massDamping=20)
    b.clamp(0, table)
    O.engines = ancf.engines(b, gravity=(0, 0, -9.81))
    assert excluding(b) == [0]
    steps(round(0.05 / O.dt))
    assert np.abs(b.curve(4)[:, 2] - DIAMETER / 2).max() < 5e-5


def test_what_sticks_out_of_a_body_never_touches_it(stiff):
    hollow = O.bodies.append(utils.sphere((0, 0, 0), 0.1, material="stiff", fixed=True))
    b = beam([(0, 0, 0), (0.4, 0, 0)], 10, contactPoints=3)
    b.clamp(0, hollow)
    O.engines = ancf.engines(b)
    assert excluding(b) == [0, 1, 2]  # of 40 mm; 110 mm are inside


# ---- sums and largest ------------------------------------------------------------------------------


def test_anchor_force_is_the_weight(stiff):
    """Of a cable between a fixed knot and one that follows a body, with a load."""
    c = beam(((0, 0, 0), (0.25, 0, 0), (0.5, 0, 0)), 4, bending=0, slack=0.05)
    c.fix(0)
    c.follow(-1, hub((0.5, 0, 0)))
    c.load(1, (1, 0, -2))
    O.engines = ancf.engines(c, gravity=(0, 0, -9.81))
    c.relax(1e-10)
    weight = c.mass * 9.81 + 2
    assert array(c.anchorForce()) == pytest.approx([-1, 0, weight], rel=1e-6, abs=1e-6 * weight)
    with pytest.raises(RuntimeError, match="anchorForce"):
        beam().anchorForce()


def test_largest_tension_of_a_catenary(stiff):
    """At its supports, H cosh(span/2a); the sag is that of the closed form."""
    a, half = 0.4, 0.25
    x = np.linspace(-half, half, 9)
    points = np.stack([x, 0 * x, a * (np.cosh(x / a) - math.cosh(half / a))], axis=1)
    c = beam(points, 4, bending=0, length=2 * a * math.sinh(half / a))
    c.fix(0)
    c.fix(-1)
    O.engines = ancf.engines(c, gravity=(0, 0, -9.81))
    c.relax(1e-10)
    tension, s = c.maxTension()
    assert s in (0.0, 1.0)
    assert tension == pytest.approx(c.section.rhoA * 9.81 * a * math.cosh(half / a), rel=1e-3)
    assert tension == max(c.tensions(8)) == c.tension(s)


def test_largest_tension_of_a_net(stiff):
    net = ancf.Net(
        [(0, 0, 0), (1, 0, 0), (0, 1, 0), (-1, 0, 0)],
        [(0, 1), (0, 2), (3, 0)],
        3,
        diameter=1e-3,
        material="stiff",
        tension=[10, 30, 20],
    )
    for knot in range(4):
        net.fix(knot)
    net.append()
    tension, edge, s = net.maxTension()
    assert (edge, tension) == (1, pytest.approx(30, rel=1e-9))
    assert net.edge(edge).tension(s) == tension
