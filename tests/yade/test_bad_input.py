"""What cannot work is refused with a sentence that names object, attribute, value and remedy; the
scene lives on.
"""

import copy
import math
import warnings

import numpy as np
import pytest

from ancf import pulleys
from ancf.structure import ELEMENTS
from helpers import O, Vector3, ancf, ball, bodyEngines, material, plane, squareNet, steps, utils
from yade import wrapper
from yade.wrapper import (
    ForceResetter,
    FrictMat,
    InsertionSortCollider,
    InteractionLoop,
    NewtonIntegrator,
)

LINE = [(0, 0, 0), (1, 0, 0)]
GOOD = dict(diameter=1e-3, material="cable")
NAN, INF = float("nan"), float("inf")


@pytest.fixture
def cable(scene):
    """A scene with a material, and a cable not yet appended."""
    material("cable")
    return ancf.Cable(LINE, 2, **GOOD)


@pytest.fixture(autouse=True)
def sceneGoesOn():
    """After each refusal a good cable still steps."""
    yield
    O.reset()
    material("cable")
    good = ancf.Cable(LINE, **GOOD)
    O.engines = ancf.engines(good)
    steps(2)
    assert O.iter == 2


@pytest.mark.parametrize("value", [NAN, 0, -1e-3, INF])
def test_diameter(cable, value):
    with pytest.raises(ValueError, match="diameter"):
        ancf.Cable(LINE, **{**GOOD, "diameter": value})


@pytest.mark.parametrize("value", ["thin", None, True])
def test_diameter_that_is_no_number(cable, value):
    with pytest.raises(TypeError, match="diameter"):
        ancf.Cable(LINE, **{**GOOD, "diameter": value})


@pytest.mark.parametrize("name", ["young", "density", "transitionVelocity"])
@pytest.mark.parametrize("value", [NAN, 0, -1.0])
def test_material(scene, name, value):
    with pytest.raises(ValueError, match=name):
        material("bad", **{name: value})
        ancf.Cable(LINE, diameter=1e-3, material="bad")


def test_friction_that_rises_is_warned_of(scene):
    material("odd", staticFriction=0.2, kineticFriction=0.3)
    with pytest.warns(UserWarning, match="kineticFriction"):
        ancf.Cable(LINE, diameter=1e-3, material="odd")


@pytest.mark.parametrize("label", ["nosuch", 99])
def test_unknown_material(cable, label):
    with pytest.raises(ValueError, match="O.materials"):
        ancf.Cable(LINE, diameter=1e-3, material=label)


def test_material_of_another_class(cable):
    O.materials.append(FrictMat(label="sand"))
    with pytest.raises(TypeError, match="HollarsMat"):
        ancf.Cable(LINE, diameter=1e-3, material="sand")


@pytest.mark.parametrize(
    "points, word",
    [
        ([(0, 0, 0)], "at least 2"),
        ([(0, 0, 0), (0, 0, 0)], "coincide"),
        ([(0, 0, 0), (1, 0, 0), (1, 0, 0), (2, 0, 0)], "coincide"),
        ([(0, 0, 0), (NAN, 0, 0)], "finite"),
        ([(0, 0, 0), (1, 0, 0), (0, 0, 0)], "turns back"),
    ],
)
def test_points(cable, points, word):
    with pytest.raises(ValueError, match=word):
        ancf.Cable(points, **GOOD)


@pytest.mark.parametrize("points", [[(0, 0), (1, 0)], "ab", 3])
def test_points_that_are_none(cable, points):
    with pytest.raises((TypeError, ValueError), match="points"):
        ancf.Cable(points, **GOOD)


@pytest.mark.parametrize(
    "options, error, word",
    [
        (dict(elements=0), ValueError, "elements"),
        (dict(elements=1.5), TypeError, "elements"),
        (dict(model="beam"), ValueError, "model"),
        (dict(mass="heavy"), ValueError, "mass"),
        (dict(axialRule="full"), ValueError, "axialRule"),
        (dict(curvature="slow"), ValueError, "curvature"),
        (dict(contactPoints=-1), ValueError, "contactPoints"),
        (dict(contactPoints=64), ValueError, "below 64.*more elements"),
        (dict(contact="beads"), ValueError, "contact = 'beads'"),
        (dict(damping=-1e-5), ValueError, "damping"),
        (dict(damping=NAN), ValueError, "damping"),
        (dict(area=0), ValueError, "area"),
        (dict(bending=-1), ValueError, "bending"),
        (dict(midPoints=2), ValueError, "midPoints"),
        (dict(model="springs", midPoints=-1), ValueError, "midPoints"),
        (dict(model="springs", bending=1e-5), ValueError, "ancf"),
        (dict(model="springs", elements=3), ValueError, "midPoints"),
        (dict(closed=True), ValueError, "at least 3"),
    ],
)
def test_cable_options(cable, options, error, word):
    with pytest.raises(error, match=word):
        ancf.Cable(LINE, **{**GOOD, **options})


@pytest.mark.parametrize("knot", [2, -3, 99])
@pytest.mark.parametrize("appended", [False, True])
def test_knot_out_of_range(cable, knot, appended):
    if appended:
        cable.append()
    with pytest.raises(IndexError, match=f"{knot}.*0 to 1"):
        cable.fix(knot)


@pytest.mark.parametrize("appended", [False, True])
def test_two_conditions_on_a_knot(cable, appended):
    number = ball((1, 0, 0), 0.01, mass=0.1, material="cable")
    if appended:
        cable.append()
    cable.fix(-1)
    with pytest.raises(ValueError, match="knot 1 is fixed.*release"):
        cable.carry(-1, number)
    cable.carry(0, number, at=(-1, 0, 0))
    with pytest.raises(ValueError, match="carrying"):
        cable.follow(0, number)
    cable.release(1)
    cable.load(1, (0, 0, 1))
    cable.clamp(1)


def test_body_that_is_not_there(cable):
    with pytest.raises(IndexError, match="O.bodies"):
        cable.carry(0, 77)


def test_body_without_mass_cannot_be_carried(cable):
    number = ball((0, 0, 0), 0.01, mass=0.1, material="cable")
    O.bodies[number].state.mass = 0
    with pytest.raises(ValueError, match="mass"):
        cable.carry(0, number)


def test_element_of_a_cable_cannot_be_carried(cable):
    cable.append()
    other = ancf.Cable(LINE, **GOOD)
    with pytest.raises(ValueError, match="tie"):
        other.carry(0, cable.bodies[0])


def test_springs_cannot_be_clamped(cable):
    springs = ancf.Cable(LINE, model="springs", **GOOD)
    with pytest.raises(ValueError, match="slopes"):
        springs.clamp(0)


@pytest.mark.parametrize("appended", [False, True])
def test_tie_across_engines(cable, appended):
    other = ancf.Cable([(1, 0, 0), (2, 0, 0)], label="other", **GOOD)
    if appended:
        cable.append()
        other.append()
        with pytest.raises(ValueError, match="another CableEngine"):
            cable.tie(1, other, 0)
    else:
        cable.tie(1, other, 0)
        cable.append()
        with pytest.raises(ValueError, match="another CableEngine"):
            other.append()


def test_tie_of_knots_that_are_apart(cable):
    other = ancf.Cable([(1.1, 0, 0), (2, 0, 0)], **GOOD)
    with pytest.raises(ValueError, match="away"):
        cable.tie(1, other, 0)


def test_appending_twice(cable):
    cable.append()
    with pytest.raises(RuntimeError, match="before"):
        cable.append()


def test_velocity_that_is_no_vector(cable):
    with pytest.raises((TypeError, ValueError), match="setVelocity"):
        cable.setVelocity(lambda p: 3)


def test_place_along_the_cable(cable):
    for s in (-0.1, 1.1, NAN):
        with pytest.raises(ValueError, match="s = "):
            cable.point(s)
    with pytest.raises(RuntimeError, match="append"):
        cable.tension(0.5)


@pytest.mark.parametrize("fold", [0, 1, -0.5, NAN, 2])
def test_fold(cable, fold):
    with pytest.raises(ValueError, match="fold"):
        squareNet(2, 0.06, fold=fold)


def test_net_edges(cable):
    points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    for edges, word in ([(0, 0), (1, 2)], "itself"), ([(0, 1)], "no edge"), ([], "at least one"):
        with pytest.raises(ValueError, match=word):
            ancf.Net(points, edges, **GOOD)
    with pytest.raises(IndexError, match="knot numbers"):
        ancf.Net(points, [(0, 3)], **GOOD)
    with pytest.raises(IndexError, match="edge"):
        squareNet(2, 0.06).edge(99)


@pytest.mark.parametrize("name", ["mass", "radius"])
@pytest.mark.parametrize("value", [NAN, 0, -1])
def test_bullets(cable, name, value):
    net = squareNet(2, 0.06)
    given = dict(mass=0.05, radius=0.01, speed=1.5, angle=math.radians(25))
    with pytest.raises(ValueError, match=name):
        net.addBullets(**{**given, name: value})


def test_periodic_cell(cable):
    O.periodic = True
    with pytest.raises(ValueError, match="periodic"):
        cable.append()
    O.periodic = False


def test_periodic_cell_set_later(cable):
    O.engines = ancf.engines(cable)
    O.periodic = True
    O.cell.setBox(10, 10, 10)  # else the collider finds the elements too large for it
    with pytest.raises((ValueError, RuntimeError), match="periodic"):
        O.step()
    with pytest.raises(ValueError, match="periodic"):
        ancf.check()
    O.periodic = False


def test_step_above_the_critical_one(cable):
    O.engines = ancf.engines(cable, substeps=1)
    limit = cable.criticalTimeStep()
    O.dt = 1.5 * limit
    with pytest.raises(RuntimeError, match="O.dt"):
        O.step()
    O.dt = 0.9 * limit


def test_engine_after_newton(cable):
    engines = ancf.engines(cable)
    O.engines = [*engines[:3], engines[4], engines[3]]
    with pytest.raises(RuntimeError, match="NewtonIntegrator"):
        O.step()
    with pytest.raises(RuntimeError, match="order"):
        ancf.check()


def test_contact_body_erased(cable):
    O.engines = ancf.engines(cable, gravity=(0, 0, -9.81))
    O.step()
    O.bodies.erase(cable.bodies[1])
    for _ in range(2):
        with pytest.raises(RuntimeError, match=f"body {cable.bodies[1]} of element 1 was erased"):
            O.step()


@pytest.mark.parametrize("how", ["carry", "follow"])
def test_body_at_a_knot_erased(cable, how):
    number = ball((1, 0, 0), 0.01, mass=0.1 if how == "carry" else None, material="cable")
    getattr(cable, how)(-1, number)
    O.engines = ancf.engines(cable)
    O.step()
    O.bodies.erase(number)
    with pytest.raises(RuntimeError, match=f"body {number}, which node 1 {how[:-1]}.*was erased"):
        O.step()


def cableAmong(loop, cable):
    """Engines with another InteractionLoop."""
    engines = ancf.engines(cable)
    engines[2] = loop
    O.engines = engines


def test_missing_functors(cable):
    ball((0.5, 0, 0.5), 0.1, material="cable")
    full = ancf.engines(cable)[2]
    geom, phys, law = (
        full.geomDispatcher.functors,
        full.physDispatcher.functors,
        full.lawDispatcher.functors,
    )
    for loop, word in (
        (InteractionLoop([], phys, law), "Ig2"),
        (InteractionLoop(geom, [], law), "Ip2"),
        (InteractionLoop(geom, phys, []), "Law2"),
    ):
        cableAmong(loop, cable)
        with pytest.raises(RuntimeError, match=f"can meet, but.*{word}"):
            ancf.check()


def test_missing_bound_functor(cable):
    engines = ancf.engines(cable)
    engines[1] = InsertionSortCollider([], verletDist=0.01)
    O.engines = engines
    with pytest.raises(RuntimeError, match="Bo1_CableElement"):
        ancf.check()


def test_missing_engines(cable):
    cable.append()
    O.engines = [ForceResetter(), cable.engine, NewtonIntegrator(damping=0)]
    with pytest.raises(RuntimeError, match="InteractionLoop"):
        ancf.check()


def test_damping_of_newton_is_warned_of(cable):
    engines = ancf.engines(cable)
    engines[4] = NewtonIntegrator()
    O.engines = engines
    ancf.check()  # no body that a cable could feel
    O.bodies.append(utils.sphere((0.5, 0, 0.5), 0.1, material="cable"))
    with pytest.warns(UserWarning, match="damping"):
        ancf.check()


# ---- what cables may meet --------------------------------------------------------------------------


def above(z=1.0, **options):
    """A cable over the one of the fixture."""
    return ancf.Cable([(0, 0, z), (1, 0, z)], 2, **{**GOOD, **options})


def toldInTime(text, error=RuntimeError):
    """By check(), and by the first step."""
    with pytest.raises(error, match=text):
        ancf.check()
    with pytest.raises(RuntimeError, match=text):
        O.step()


def test_cables_of_two_engines(cable):
    other = above()
    for structure in (cable, other):
        structure.append()
    engines = ancf.engines(cable, other)
    O.engines = engines
    ids = cable.bodies[0], other.bodies[0]
    text = r"body {} \(CableElement 0\) and body {} .*of CableEngine {}.*append\(engine="
    told = text.format(*ids, other.engine.family)
    toldInTime(told)
    cable.fix(0)
    cable.fix(-1)
    with pytest.raises(RuntimeError, match=told):
        cable.relax()
    for number in other.bodies:
        O.bodies[number].mask = 2 | ELEMENTS
    ancf.check()
    O.step()
    cable.relax()


@pytest.mark.parametrize("at", [(0, 0, 0), (0, 0, 0.1)])
def test_body_carried_by_the_cable_of_another_engine(cable, at):
    other = above(mask=2)
    number = ball((1, 0, 1 - at[2]), 0.01, mass=0.1, material="cable")
    cable.append()
    other.append()
    other.carry(-1, number, at=at)
    O.engines = ancf.engines(cable, other)
    toldInTime(f"body {number} .*carried by a knot of CableEngine {other.engine.family}")
    O.bodies[number].mask = 2
    ancf.check()


def strange(shape, **values):
    body = wrapper.Body()
    body.shape = getattr(wrapper, shape)(**values)
    body.material = O.materials["cable"]
    body.state.pos = (0, 0, 3)
    body.state.blockedDOFs = "xyzXYZ"
    return O.bodies.append(body)


@pytest.mark.parametrize(
    "shape",
    ["GridConnection", "GridNode", "Cylinder", "ChainedCylinder", "PFacet", "Polyhedra", "Tetra"],
)
@pytest.mark.parametrize("when", ["before", "meanwhile"])
def test_shapes_that_cables_do_not_touch(cable, shape, when):
    if not hasattr(wrapper, shape):
        pytest.skip(f"this YADE was built without {shape}")
    O.engines = ancf.engines(cable)
    if when == "meanwhile":
        O.step()
    number = strange(shape)
    told = rf"body {number} \({shape}\) can meet cables, which do not touch such a shape.*groupMask"
    toldInTime(told)
    if isinstance(O.bodies[number].shape, wrapper.Sphere):  # else it lacks functors, too
        O.bodies[number].mask = 2
        ancf.check()


def test_shape_that_a_carried_ball_may_meet(cable):
    number = ball((1, 0, 0), 0.01, mass=0.1, material="cable", mask=2)
    cable.carry(-1, number)
    O.engines = ancf.engines(cable)
    other = strange("GridNode")
    O.bodies[other].mask = 2
    toldInTime(f"body {other} .*can meet cables")


PARTNERS = [
    ("state.mass", 0, "state.mass = 0 and may move .*blockedDOFs"),
    ("state.mass", -1, "state.mass = -1"),
    ("state.inertia", Vector3(1, 0, 1), r"state.inertia = \(1, 0, 1\) and may move"),
    ("shape.radius", 0, "shape.radius = 0"),
    ("shape.radius", -0.1, "shape.radius = -0.1"),
    ("shape.radius", NAN, "shape.radius = nan"),
]


@pytest.mark.parametrize("where, value, word", PARTNERS)
def test_partner_that_cannot_be_computed(cable, where, value, word):
    O.engines = ancf.engines(cable)
    number = ball((0.5, 0, 3), 0.1, mass=1.0, material="cable")
    part, name = where.split(".")
    good = copy.copy(getattr(getattr(O.bodies[number], part), name))
    setattr(getattr(O.bodies[number], part), name, value)
    toldInTime(rf"body {number} \(Sphere\).*{word}")
    setattr(getattr(O.bodies[number], part), name, good)
    ancf.check()
    O.step()


def test_partner_in_touch_does_not_end_yade(cable):
    """Hertz has no stiffness for it, which an Ip2 functor cannot tell."""
    number = ball((0.5, 0, 0), 0.1, material="cable")
    O.bodies[number].shape.radius = 0
    O.engines = ancf.engines(cable)
    toldInTime(f"body {number} .*shape.radius = 0")


@pytest.mark.parametrize("begun", [False, True])
def test_partner_that_was_mended_touches(cable, begun):
    """Though the collider saw no elements in the step that was refused."""
    if begun:
        O.engines = ancf.engines(cable)
        steps(3)
    upper = above()
    number = ball((0.5, 0, 1.10046), 0.1, mass=1.0, material="cable")
    if begun:
        upper.append(engine=cable.engine)
    else:
        O.engines = ancf.engines(cable, upper)
    O.bodies[number].state.mass = 0
    for _ in range(3):
        with pytest.raises(RuntimeError, match=f"body {number} .*state.mass = 0"):
            O.step()
    O.bodies[number].state.mass = 1
    O.step()
    assert upper.engine.contacts > 0


def test_clump_without_mass(cable):
    O.engines = ancf.engines(cable)
    balls = [utils.sphere((x, 0, 3), 0.1, material="cable") for x in (0, 0.3)]
    clump, members = O.bodies.appendClumped(balls)
    O.bodies[clump].state.mass = 0
    toldInTime(rf"body {members[0]} \(Sphere\) of clump {clump} .*state.mass = 0")


def test_flat_partners_without_extent(cable):
    O.engines = ancf.engines(cable)
    box = plane((0, 0, 3), (1, 1, 0.1), material="cable")
    O.bodies[box].shape.extents = Vector3(1, 0, 1)
    toldInTime(rf"body {box} \(Box\): shape.extents = \(1, 0, 1\)")
    O.bodies.erase(box)
    line = utils.facet([(0, 0, 3), (1, 0, 3), (2, 0, 3)], material="cable")
    number = O.bodies.append(line)
    toldInTime(rf"body {number} \(Facet\): shape.area = 0")


@pytest.mark.parametrize(
    "made, word",
    [
        (wrapper.Material(label="m"), "its material is a Material: .*HollarsMat or a FrictMat"),
        (FrictMat(young=0, label="m"), r"material.young = 0 \(FrictMat 'm'\)"),
        (FrictMat(poisson=0.6, label="m"), "material.poisson = 0.6"),
        (FrictMat(frictionAngle=2, label="m"), "material.frictionAngle = 2"),
        (wrapper.ElastMat(young=NAN, label="m"), "material.young = nan"),
    ],
)
def test_material_of_a_partner(cable, made, word):
    O.materials.append(made)
    O.engines = ancf.engines(cable)
    number = ball((0.5, 0, 3), 0.1, material="m")
    toldInTime(rf"body {number} \(Sphere\).*{word}")


def test_partner_without_a_material(cable):
    O.engines = ancf.engines(cable)
    number = ball((0.5, 0, 3), 0.1, material="cable")
    O.bodies[number].material = None
    toldInTime(f"body {number} .*its material is None")


@pytest.mark.parametrize("division", [dict(elements=10), dict(model="springs", midPoints=9)])
def test_elements_shorter_than_thick(scene, division):
    material("cable")
    O.engines = ancf.engines(ancf.Cable(LINE, diameter=0.2, material="cable", **division))
    told = r"body \d \(CableElement .*0.1 m long, but 0.2 m thick.* 10 such elements"
    with pytest.warns(UserWarning, match=told):
        ancf.check()


# ---- overlap at the start --------------------------------------------------------------------------


def startsWithin(first, second, depth, part):
    return rf"body {first} .*and body {second} .*overlap of {depth:g} m.*, {part}%.*groupMask"


OVERLAPPING = [
    lambda z: ball((0.5, 0, 0.1005 - z), 0.1, material="cable"),
    lambda z: plane((0.5, 0, 0.1005 - z), (1, 1, 0.1), material="cable"),
    lambda z: O.bodies.append(utils.wall(0.0005 - z, 2, material="cable", sense=-1)),
    lambda z: O.bodies.append(
        utils.facet(
            [(0, -1, 0.0005 - z), (1, 1, 0.0005 - z), (1, -1, 0.0005 - z)], material="cable"
        )
    ),
]


@pytest.mark.parametrize("make", OVERLAPPING)
@pytest.mark.parametrize("contact", ["curve", "points"])
def test_cable_in_a_body(scene, make, contact):
    material("cable")
    cable = ancf.Cable(LINE, 2, contact=contact, **GOOD)
    O.engines = ancf.engines(cable)
    number = make(3e-4)
    toldInTime(startsWithin("[01]", number, 3e-4, 60), ValueError)
    O.bodies.erase(number)
    number = make(2e-4)
    with pytest.warns(UserWarning, match=startsWithin("[01]", number, 2e-4, 40)):
        ancf.check()
    O.bodies.erase(number)
    make(4e-5)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        ancf.check()


def test_cable_in_a_body_that_it_shall_not_touch(cable):
    O.engines = ancf.engines(cable)
    one = ball((0.5, 0, 0), 0.1, material="cable", mask=2)
    for number in cable.bodies:
        O.bodies[number].shape.exclude = [one + 1]
    ball((0.3, 0, 0), 0.1, material="cable")
    ancf.check()


def test_cable_curved_into_a_ball(scene):
    """Between points that are all free of it."""
    material("cable")
    bent = ancf.Cable([(-1, 0, 0), (0, 0, 0.1), (1, 0, 0)], 1, contactPoints=1, **GOOD)
    O.engines = ancf.engines(bent)
    at = bent.point(0.6)
    number = ball(at, 1e-3, material="cable")
    toldInTime(rf"body 1 \(CableElement 1.*and body {number} .*overlap", ValueError)


@pytest.mark.parametrize("apart", [4e-4, 8e-4, 9.6e-4])
def test_cable_in_a_cable(cable, apart):
    other = ancf.Cable([(0.3, -1, apart), (0.3, 1, apart)], 1, **GOOD)
    O.engines = ancf.engines(cable, other)
    told = startsWithin(0, 2, 1e-3 - apart, round((1e-3 - apart) / 5e-6))
    if apart == 4e-4:
        toldInTime(told, ValueError)
    elif apart == 8e-4:
        with pytest.warns(UserWarning, match=told):
            ancf.check()
    else:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            ancf.check()


@pytest.mark.parametrize("clumped", [False, True])
def test_carried_ball_in_a_body(cable, clumped):
    if clumped:
        balls = [utils.sphere((1, 0, z), 0.01, material="cable") for z in (-0.015, 0.015)]
        carried, (ball0, _) = O.bodies.appendClumped(balls)
    else:
        carried = ball0 = ball((1, 0, 0), 0.01, mass=0.1, material="cable")
    cable.carry(-1, carried)
    O.engines = ancf.engines(cable)
    below = O.bodies[ball0].state.pos[2] - 0.01
    number = plane((1, 0, below + 0.006 - 0.1), (0.005, 1, 0.1), material="cable")
    toldInTime(
        rf"body {ball0} \(CarriedSphere.*and body {number} \(Box.*overlap of 0.006 m", ValueError
    )
    O.bodies[number].state.pos -= Vector3(0, 0, 0.0055)
    ancf.check()


def test_two_carried_balls_in_one_another(cable):
    carried = [ball((x, 0, 0), 0.01, mass=0.1, material="cable") for x in (1, 1.005)]
    other = ancf.Cable([(1.005, 0, 0), (2, 0, 0)], 2, **GOOD)
    cable.carry(-1, carried[0])
    other.carry(0, carried[1])
    O.engines = ancf.engines(cable, other)
    for body in O.bodies:  # the cables leave them alone
        if isinstance(body.shape, wrapper.CableElement):
            body.mask = 2 | ELEMENTS
    toldInTime(f"body {carried[0]} .*and body {carried[1]} .*overlap of 0.015 m", ValueError)


def test_overlap_is_looked_for_at_the_start_only(cable):
    O.engines = ancf.engines(cable)
    O.step()
    ball((0.5, 0, 0), 0.1, material="cable")
    ancf.check()


def test_part_of_an_overlap(cable):
    cable.append()
    for part in (-1, NAN):
        with pytest.raises(ValueError, match="part ="):
            cable.engine.overlaps(part)


# ---- laws ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name, value", [("normal", "hertz"), ("friction", "none")])
def test_law_that_does_not_reach_cables(cable, name, value):
    O.engines = ancf.engines(cable)
    bodies, cables, _ = O.engines[2].lawDispatcher.functors
    with pytest.raises(AttributeError, match=f"{name}.*CableEngine.{name}"):
        setattr(cables, name, value)
    with pytest.raises(AttributeError, match="nosuch"):
        cables.nosuch = 1
    cables.label = "found"
    setattr(bodies, name, value)
    with pytest.warns(UserWarning, match=f"{name} = '{value}', but CableEngine.{name}"):
        ancf.check()
    setattr(cable.engine, name, value)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        ancf.check()


def test_strays_from_the_arc_of_a_sheave(scene):
    """What is told is how far the cable is from its arc."""
    material("cable")
    pulleys.sheave((0, 0, 0), 0.05, axis=(0, 0, 1), width=0.01, material="cable", profile="flat")
    radius = 0.052

    def ring(n, **options):
        angles = np.arange(n) * 2 * math.pi / n
        points = [(radius * math.cos(a), radius * math.sin(a), 0) for a in angles]
        return ancf.Cable(points, diameter=4e-3, material="cable", closed=True, **options)

    def told(cable):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            pulleys.check(cable)
        return [str(w.message) for w in caught]

    assert told(ring(14)) == []
    for cable, what, remedy in (
        (ring(5), "elements of 0.065", "elements make"),
        (ring(20, model="springs"), "straight springs of 0.0163", "midPoints make"),
    ):
        (text,) = told(cable)
        assert what in text and remedy in text
        found = float(text.split("can stray from its arc by ")[1].split()[0])
        strays = radius - np.hypot(*cable.curve(64)[:, :2].T).min()
        assert found == pytest.approx(strays, rel=0.1)
    (text,) = told(ring(14, contact="points", contactPoints=1))
    assert "contact points 0.0117 m apart" in text and "elements or contactPoints make" in text


# ---- engines ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "options, word",
    [
        (dict(integrator="euler"), "integrator"),
        (dict(substeps=0), "substeps"),
        (dict(contact=dict(normal="soft")), "normal"),
        (dict(contact=dict(rolling="none")), "contact"),
        (dict(gravity=(0, 0, NAN)), "gravity"),
        (dict(verletDist=0), "verletDist"),
    ],
)
def test_engine_options(cable, options, word):
    with pytest.raises(ValueError, match=word):
        ancf.engines(cable, **options)


def test_engines_of_nothing(scene):
    with pytest.raises(ValueError, match="at least one"):
        ancf.engines()
    with pytest.raises(TypeError, match="Cable"):
        ancf.engines(Vector3(0, 0, 0))


def test_mechanism_has_no_equilibrium(cable):
    O.engines = ancf.engines(cable, gravity=(0, 0, -9.81))
    with pytest.raises(RuntimeError, match="equilibrium"):
        cable.relax(1e-9, iterations=2000)


def test_gravity_of_an_integrator_switched_off_does_not_count(cable):
    """A body that slides down a guide, and a second NewtonIntegrator that is dead."""
    slider = ball((0, 1, 0), 0.01, mass=1.0, material="cable")
    guide = ancf.GuideEngine()
    guide.add(slider, direction=(0, 0, 1))
    engines = ancf.engines(cable, gravity=(0, 0, -10))
    O.engines = [*engines[:-1], guide, engines[-1], NewtonIntegrator(damping=0, dead=True)]
    O.step()
    assert O.bodies[slider].state.vel[2] == pytest.approx(-10 * O.dt)


@pytest.mark.parametrize("masks, avoided", [((1, 2), 0), ((5, 6), 4)])
def test_step_without_pairs_that_masks_keep_apart(cable, masks, avoided):
    def grains(masks):
        for i, mask in enumerate(masks):
            ball((0, i, 1), 1e-3, mass=1e-6, material="cable", mask=mask)

    O.engines = ancf.engines(cable)
    O.engines[1].avoidSelfInteractionMask |= avoided
    alone = ancf.timeStep()
    assert alone == cable.criticalTimeStep()
    grains(masks)
    assert ancf.timeStep() == alone
    grains(masks[:1] if not avoided else (1, 1))
    assert ancf.timeStep() < alone


def test_scene_without_cables_is_untouched(scene):
    material("m")
    plane((0, 0, -0.1), (1, 1, 0.1), material="m")
    ball((0, 0, 0.2), 0.1, mass=1.0, material="m")
    O.engines = bodyEngines((0, 0, -9.81))
    O.dt = 1e-6
    steps(10)
    assert O.iter == 10
