"""What is refused leaves the scene as it was, and goes through once its cause is mended."""

import numpy as np
import pytest

from helpers import O, Vector3, ancf, ball, material, squareNet, steps
from yade import wrapper

GOOD = dict(diameter=1e-3, material="cable")
LINE = [(0, 0, 0), (1, 0, 0)]


@pytest.fixture
def cable(scene):
    material("cable")
    return ancf.Cable(LINE, 2, **GOOD)


def sceneNow(*engines):
    """All that a cable changes when it is appended, comparable."""
    bodies = [
        (b.id, type(b.shape).__name__, b.state.blockedDOFs, tuple(b.state.vel), b.groupMask)
        for b in O.bodies
    ]
    made = [
        {name: str(value) for name, value in e.dict().items() if name != "label"} for e in engines
    ]
    return len(O.bodies), bodies, [e.__class__.__name__ for e in O.engines], len(O.materials), made


def unclaimed(structure):
    return not structure.appended and structure.engine is None and structure.bodies == []


def farBody():
    return ball((5, 0, 0), 0.01, mass=0.1, material="cable")


def clumpMember():
    _, members = O.bodies.appendClumped([wrapper.Body() for _ in range(0)] or spheres())
    return members[0]


def spheres():
    from helpers import utils

    return [utils.sphere((1 + x, 0, 0), 0.01, material="cable") for x in (0, 0.01)]


def blocked():
    number = ball((1, 0, 0), 0.01, mass=0.1, material="cable")
    O.bodies[number].state.blockedDOFs = "xyzXYZ"
    return number


def moving():
    return ball((1, 0, 0), 0.01, mass=0.1, material="cable")


REFUSED = [
    ("carry", farBody, "m from the point"),
    ("carry", clumpMember, "clump's member"),
    ("carry", blocked, "blocked in all freedoms"),
    ("follow", moving, "moves freely"),
]


@pytest.mark.parametrize("joined", [False, True], ids=["new engine", "joined engine"])
@pytest.mark.parametrize("how, make, word", REFUSED)
def test_append_refused_by_a_condition(cable, how, make, word, joined):
    """Two conditions that hold are taken back with the one that does not."""
    first = ancf.Cable([(0, 1, 0), (1, 1, 0)], 2, **GOOD)
    if joined:
        O.engines = ancf.engines(first)
        steps(3)
    engines = [first.engine] if joined else []
    good = ball((0, 0, 0), 0.01, mass=0.1, material="cable")
    O.bodies[good].state.vel = Vector3(0, 0, 1)
    number = make()
    cable.carry(0, good)
    cable.setVelocity(lambda p: Vector3(0, 1, 0))
    getattr(cable, how)(1, number)
    before = sceneNow(*engines)
    for _ in range(2):
        with pytest.raises(ValueError, match=word):
            cable.append(engine=first.engine)
        assert sceneNow(*engines) == before
        assert unclaimed(cable)
    if make is farBody:
        O.bodies[number].state.pos = Vector3(1, 0, 0)
        cable.append(engine=first.engine)
        assert type(O.bodies[good].shape) is wrapper.CarriedSphere
        assert O.bodies[good].state.blockedDOFs == "xyz"
        if not joined:
            O.engines = ancf.engines(cable)
        steps(2)


def test_append_refused_by_a_tie(cable):
    other = ancf.Cable([(1, 0, 0), (2, 0, 0)], **GOOD)
    cable.tie(1, other, 0)
    other.append()
    other.setVelocity(lambda p: Vector3(0, 0, 100))
    O.engines = ancf.engines(other)
    steps(100)
    before = sceneNow(other.engine)
    with pytest.raises(ValueError, match="m apart: they must be at one place"):
        cable.append(engine=other.engine)
    assert sceneNow(other.engine) == before and unclaimed(cable)
    assert len(cable._ties) == len(other._ties) == 1


def test_append_refused_for_its_engine(cable):
    before = sceneNow()
    for engine in (3, O.engines, wrapper.NewtonIntegrator()):
        with pytest.raises(TypeError, match="append: engine"):
            cable.append(engine=engine)
    assert sceneNow() == before and unclaimed(cable)


@pytest.mark.parametrize("how, make, word", REFUSED)
def test_condition_refused_after_append(cable, how, make, word):
    """The knot stays free: it may be fixed, and let go again."""
    O.engines = ancf.engines(cable)
    number = make()
    O.bodies[number].state.vel = Vector3(0, 0, 1)
    before = sceneNow(cable.engine)
    with pytest.raises(ValueError, match=word):
        getattr(cable, how)(1, number)
    assert sceneNow(cable.engine) == before
    cable.fix(1)
    cable.release(1)
    cable.fix(1)


def test_tie_refused_after_append(cable):
    other = ancf.Cable([(1, 0, 0), (2, 0, 0)], **GOOD)
    cable.append()
    other.append(engine=cable.engine)
    cable.engine.fix(cable._node(1))  # by hand: the cable does not know
    with pytest.raises(ValueError, match="fixed already"):
        cable.tie(1, other, 0)
    cable.engine.release(cable._node(1))
    cable.tie(1, other, 0)


@pytest.mark.parametrize("appended", [False, True])
def test_bullets_refused(scene, appended):
    material("cable")
    net = squareNet(2, 0.06)
    if appended:
        net.append()
    net.fix(2)
    engines = [net.engine] if appended else []
    before = sceneNow(*engines)
    bullets = dict(mass=0.05, radius=0.005, speed=1.0, angle=0.4)
    with pytest.raises(ValueError, match="knot 2 is fixed"):
        net.addBullets(**bullets)
    with pytest.raises(ValueError, match="nosuch"):
        net.addBullets(**bullets, material="nosuch")
    assert sceneNow(*engines) == before and net.bullets == []
    net.release(2)
    net.addBullets(**bullets)
    with pytest.raises(ValueError, match="carrying a bullet|carrying body"):
        net.fix(2)
    O.engines = ancf.engines(net)
    assert len(net.bullets) == 4
    steps(2)


# ---- a scene that is gone ----------------------------------------------------------------------


def test_cable_of_a_scene_before_reset(cable):
    O.engines = ancf.engines(cable)
    steps(2)
    O.reset()
    material("cable")
    for _ in range(2):  # with nothing in the scene, and with a cable that looks the same
        for read in (
            lambda: cable.point(0.5),
            lambda: cable.knots,
            lambda: ancf.engines(cable),
            lambda: cable.fix(0),
        ):
            with pytest.raises(RuntimeError, match=r"Cable: its bodies, 0 to 1.*O.reset\(\)"):
                read()
        ancf.Cable(LINE, 2, **GOOD).append()


def test_engine_of_a_scene_before_reset(cable):
    cable.append()
    old = cable.engine
    O.reset()
    material("cable")
    new = ancf.Cable(LINE, 2, **GOOD)
    before = sceneNow(old)
    with pytest.raises(RuntimeError, match=r"CableEngine.*O.reset\(\)"):
        new.append(engine=old)
    assert sceneNow(old) == before and unclaimed(new)
    O.engines = [*ancf.engines(new)[:3], old, *ancf.engines(new)[3:]]
    with pytest.raises(RuntimeError, match=r"O.reset\(\)|CableElement"):
        O.step()


def test_cable_goes_on_after_load(cable, tmp_path):
    """The same scene again is no other one."""
    O.engines = ancf.engines(cable)
    steps(2)
    O.save(str(tmp_path / "s.xml"))
    O.load(str(tmp_path / "s.xml"))
    steps(1)
    assert np.isfinite(cable.knots).all()
