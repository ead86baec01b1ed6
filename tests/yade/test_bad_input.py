"""What cannot work is refused with a sentence that names object, attribute, value and remedy; the
scene lives on.
"""

import math

import pytest

from helpers import O, Vector3, ancf, ball, bodyEngines, material, plane, squareNet, steps
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
    with pytest.raises(RuntimeError, match=f"body {cable.bodies[1]} of element 1 was erased"):
        steps(1000)  # it is seen when the collider runs again


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
    with pytest.warns(UserWarning, match="damping"):
        ancf.check()


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
