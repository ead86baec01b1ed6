"""Materials edited at any time: cables and contacts follow them."""

import math

import numpy as np
import pytest

from helpers import O, Vector3, ancf, ball, bodyEngines, material, steps, utils
from yade import wrapper

G = 9.81
LINE = [(0, 0, 0), (1, 0, 0)]
AREA, EI = math.pi * 1e-3**2 / 4, math.pi * 1e-3**4 / 64  # EI of a unit modulus


@pytest.fixture
def mat(scene):
    material("cable", young=1e8, density=1000)
    return O.materials["cable"]


def cable(**options):
    given = dict(diameter=1e-3, material="cable")
    elements = 1 if options.get("model") == "springs" else 2
    return ancf.Cable(LINE, elements, **{**given, **options})


# ---- ropes of a catalogue ------------------------------------------------------------------------


def test_rope_material(scene):
    """A cable of it has the axial stiffness and the mass that were asked for; the rest is HollarsMat's."""
    O.materials.append(ancf.ropeMaterial(2e-3, 5e3, 0.02, label="rope", poisson=0.2, dashpot=3.0))
    c = cable(diameter=2e-3, material="rope")
    c.append()
    ea, ei, rhoA, _ = sectionOf(c)
    assert (ea, rhoA) == pytest.approx((5e3, 0.02), rel=1e-14)
    assert ei == pytest.approx(ea * 2e-3**2 / 16, rel=1e-14)  # of a full round
    mat = O.materials["rope"]
    assert (mat.poisson, mat.dashpot) == (0.2, 3.0)


# ---- young and density -------------------------------------------------------------------------


def sectionOf(c):
    engine, (node, first) = c.engine, c._first
    return tuple(list(getattr(engine, name))[first] for name in ("ea", "ei", "rhoA", "kelvinVoigt"))


@pytest.mark.parametrize("when", ["before", "appended", "running"])
@pytest.mark.parametrize("contactPoints", [0, 3])
@pytest.mark.parametrize("bending", [None, 3e-4])
def test_young_and_density(mat, when, contactPoints, bending):
    c = cable(contactPoints=contactPoints, bending=bending)
    if when != "before":
        O.engines = ancf.engines(c)
    if when == "running":
        steps(2)
    mat.young, mat.density = 3e8, 700
    if when == "before":
        c.append()
    else:
        O.dt = 0.1 * O.dt
        O.step()
    ei = 3e8 * EI if bending is None else bending
    assert sectionOf(c)[:3] == pytest.approx((3e8 * AREA, ei, 700 * AREA), rel=1e-15)
    assert c.mass == pytest.approx(700 * AREA, rel=1e-15)


def test_only_cables_of_the_material(mat):
    material("other", young=1e8, density=1000)
    cables = [cable(), cable(material="other", mask=2), cable(mask=4)]
    O.engines = ancf.engines(*cables)
    mat.young = 2e8
    O.dt = 0.1 * O.dt
    O.step()
    assert [sectionOf(c)[0] for c in cables] == pytest.approx(np.array([2e8, 1e8, 2e8]) * AREA)


def test_critical_step_follows_at_once(mat):
    """Of springs with lumped mass it is 2/w, w^2 = 4 EA/(rhoA l^2): goes with sqrt(density/young)."""
    c = cable(model="springs", midPoints=4, contactPoints=0).append()
    before = c.criticalTimeStep()
    mat.young, mat.density = 4e8, 1000 / 4
    assert c.criticalTimeStep() == pytest.approx(before / 4, rel=1e-12)


def test_weight_follows_in_relax(mat):
    c = cable()
    c.fix(0)
    c.fix(-1)
    O.engines = ancf.engines(c, gravity=(0, 0, -G))
    for density in (1000, 2500):
        mat.density = density
        c.relax(tolerance=1e-12)
        O.step()
        weight = c.reaction(0)[2] + c.reaction(-1)[2]
        assert weight == pytest.approx(density * AREA * 1.0 * G, rel=1e-6)


def test_tension_follows_while_running(mat):
    """A spring's tension is EA times its strain."""
    c = cable(model="springs", contactPoints=0)
    c.fix(0)
    c.load(-1, (1, 0, 0))
    O.engines = ancf.engines(c)
    c.relax()
    for young in (1e8, 2.5e8, 1e8):
        mat.young = young
        O.dt = 1e-6
        steps(5)
        assert c.strain(0.7) > 1e-4
        assert c.tension(0.7) == pytest.approx(young * AREA * c.strain(0.7), rel=1e-12)


def test_followed_after_load(mat, tmp_path):
    c = cable()
    O.engines = ancf.engines(c)
    O.step()
    O.save(str(tmp_path / "s.xml"))
    O.load(str(tmp_path / "s.xml"))
    O.materials["cable"].young = 2e8
    O.dt = 0.1 * O.dt
    O.step()
    assert sectionOf(c)[0] == pytest.approx(2e8 * AREA, rel=1e-15)


def test_a_bad_value_is_refused_at_the_edit(mat):
    for name in ("young", "density"):
        for value in (0, -1, float("nan"), float("inf")):
            with pytest.raises(ValueError, match=name):
                setattr(mat, name, value)


def test_engine_with_a_wrong_list_of_materials(mat):
    c = cable()
    O.engines = ancf.engines(c)
    for name, value in (("sectionMaterials", [7]), ("sections", [0, 99]), ("sectionYoung", [])):
        good = getattr(c.engine, name)
        with pytest.raises((ValueError, RuntimeError), match="section"):
            c.engine.updateAttrs({name: value})
            mat.young *= 1.5
            O.step()
        c.engine.updateAttrs({name: good})
    for first, number in ((9, 0), (0, 7), (0, 0)):
        with pytest.raises(ValueError, match="madeOf"):
            c.engine.madeOf(first, number, True)


# ---- friction ----------------------------------------------------------------------------------

COULOMB = dict(friction="coulomb", normal="hertz")


def ratio(contact):
    """Friction over normal force: the coefficient, while it slides."""
    return contact.phys.shearForce.norm() / contact.phys.normalForce.norm()


def floor(label, size=5):
    return O.bodies.append(utils.box((0, 0, -1), (size, size, 1), fixed=True, material=label))


def slidingBall(label):
    number = ball((0, 0, 0.01 - 1e-5), 0.01, mass=0.1, material=label)
    O.bodies[number].state.vel = Vector3(3, 0, 0)
    O.bodies[number].state.blockedDOFs = "XYZ"


def rough(label, mu, frict=False, **values):
    """A material of one coefficient, of either class; a function that sets another one."""
    if frict:
        O.materials.append(
            wrapper.FrictMat(label=label, young=1e8, density=1000, frictionAngle=math.atan(mu))
        )
    else:
        material(label, young=1e8, staticFriction=mu, kineticFriction=mu, **values)

    def edit(mu):
        m = O.materials[label]
        if frict:
            m.frictionAngle = math.atan(mu)
        else:
            m.kineticFriction = 0
            m.staticFriction = mu
            m.kineticFriction = mu

    return edit


@pytest.mark.parametrize("frict", [False, True], ids=["HollarsMat", "FrictMat"])
def test_friction_of_a_cable_on_a_floor(scene, frict):
    rough("cable", 0.5)
    edit = rough("floor", 0.3, frict)
    floor("floor")
    c = ancf.Cable([(0, 0, 5e-4 - 1e-6), (0.2, 0, 5e-4 - 1e-6)], 2, diameter=1e-3, material="cable")
    c.setVelocity(lambda p: Vector3(0, 3, 0))
    O.engines = ancf.engines(c, gravity=(0, 0, -G), contact=COULOMB)

    def coefficients():
        O.step()
        return [ratio(i) for i in O.interactions if i.phys.normalForce.norm() > 0]

    for mu in (0.3, 0.1, 0.4):
        edit(mu)
        found = coefficients()
        assert found and found == pytest.approx([mu] * len(found), rel=1e-9)


@pytest.mark.parametrize("frict", [False, True], ids=["HollarsMat", "FrictMat"])
def test_friction_of_a_grain(scene, frict):
    rough("grain", 0.5)
    edit = rough("floor", 0.3, frict)
    floor("floor")
    slidingBall("grain")
    O.engines = bodyEngines((0, 0, -G), **COULOMB)
    O.engines[2].physDispatcher.functors = [
        ancf.Ip2_HollarsMat_HollarsMat_HollarsPhys(),
        ancf.Ip2_FrictMat_HollarsMat_HollarsPhys(),
    ]
    O.dt = 1e-6
    for mu in (0.3, 0.1, 0.4):
        edit(mu)
        O.step()
        (contact,) = O.interactions
        assert ratio(contact) == pytest.approx(mu, rel=1e-9)


def crossing():
    """A spring that slides lengthwise over a fixed one, which takes all that it gives."""
    below = ancf.Cable(
        [(0, -0.5, 0), (0, 0.5, 0)], model="springs", diameter=1e-3, material="cable"
    )
    above = ancf.Cable(
        [(-0.5, 0, 9.99e-4), (0.5, 0, 9.99e-4)], model="springs", diameter=1e-3, material="cable"
    )
    above.setVelocity(lambda p: Vector3(3, 0, 0))
    below.fix(0)
    below.fix(1)
    O.engines = ancf.engines(below, above, contact=COULOMB)
    O.dt = 1e-6
    return below


def test_friction_between_cables(scene):
    edit = rough("cable", 0.3)
    below = crossing()
    for mu in (0.3, 0.1, 0.4):
        edit(mu)
        O.step()
        force = below.reaction(0) + below.reaction(1)
        assert force[2] > 0
        assert -force[0] / force[2] == pytest.approx(mu, rel=1e-6)


def test_stiffness_of_a_contact_follows(scene):
    """Hertz: with the modulus of two that are alike."""
    rough("grain", 0.0)
    floor("grain")
    slidingBall("grain")
    O.engines = bodyEngines(**COULOMB)
    O.dt = 1e-7
    O.step()
    (contact,) = O.interactions
    before = contact.phys.normalStiffness
    O.materials["grain"].young *= 3
    O.step()
    assert contact.phys.normalStiffness == pytest.approx(3 * before, rel=1e-14)


def test_contact_edited_by_hand_stays(scene, tmp_path):
    """Until its materials are edited; also after loading."""
    edit = rough("grain", 0.3)
    floor("grain")
    slidingBall("grain")
    O.engines = bodyEngines((0, 0, -G), **COULOMB)
    O.dt = 1e-6
    O.step()

    def mu():
        O.step()
        (contact,) = O.interactions
        return ratio(contact)

    (contact,) = O.interactions
    contact.phys.staticFriction = contact.phys.kineticFriction = 0.05
    assert mu() == pytest.approx(0.05, rel=1e-9)
    O.save(str(tmp_path / "s.xml"))
    O.load(str(tmp_path / "s.xml"))
    assert mu() == pytest.approx(0.05, rel=1e-9)
    edit(0.2)
    assert mu() == pytest.approx(0.2, rel=1e-9)
    O.save(str(tmp_path / "s.xml"))
    O.load(str(tmp_path / "s.xml"))
    edit(0.25)  # before its first step
    assert mu() == pytest.approx(0.25, rel=1e-9)


def test_set_contact_friction(scene):
    """YADE's own tool takes every material for a FrictMat: it reaches friction and nothing else."""
    rough("grain", 0.5)
    rough("floor", 0.4)
    floor("floor")
    slidingBall("grain")
    O.engines = bodyEngines((0, 0, -G), **COULOMB)
    O.dt = 1e-6
    O.step()
    (contact,) = O.interactions
    before = contact.phys.normalStiffness
    for angle in (0.2, 0.3):
        utils.setContactFriction(angle)
        O.step()
        assert contact.phys.normalStiffness == before
        assert ratio(contact) == pytest.approx(math.tan(angle), rel=1e-9)
        grain = O.materials["grain"]
        assert grain.staticFriction == grain.kineticFriction == math.tan(angle)
    assert O.materials["floor"].staticFriction == 0.4  # it does not move


def test_set_contact_friction_of_carried_and_cables(scene):
    rough("cable", 0.5)
    floor("cable")
    c = ancf.Cable([(0, 0, 5e-4 - 1e-6), (0.2, 0, 5e-4 - 1e-6)], 2, diameter=1e-3, material="cable")
    c.carry(-1, ball((0.2, 0, 5e-4 - 1e-6), 4e-4, mass=1e-3, material="cable"))
    c.setVelocity(lambda p: Vector3(0, 3, 0))
    O.engines = ancf.engines(c, gravity=(0, 0, -G), contact=COULOMB)
    O.step()

    def stiffness():
        return {(i.id1, i.id2): i.phys.normalStiffness for i in O.interactions if i.isReal}

    before = stiffness()
    utils.setContactFriction(0.2)
    O.step()
    assert before and {pair: stiffness()[pair] for pair in before} == before
    found = [ratio(i) for i in O.interactions if i.phys.normalForce.norm() > 0]
    assert found and found == pytest.approx([math.tan(0.2)] * len(found), rel=1e-9)
