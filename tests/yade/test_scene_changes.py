"""What is edited, replaced or taken out of a scene that runs: engines, bodies, what is appended, forces of others."""

import ctypes
import math
import os
import subprocess
import sys

import numpy as np
import pytest

import ancf
from helpers import array, ball, material, plane, squareNet, steps
from yade import O, Vector3, wrapper
from yade.wrapper import InteractionLoop, NewtonIntegrator

pytestmark = pytest.mark.usefixtures("scene")

G = 9.81


def rope(z=0.0, **options):
    given = dict(elements=4, diameter=2e-3, material="cable", damping=1e-4)
    return ancf.Cable([(0, 0, z), (1, 0, z)], **{**given, **options})


@pytest.fixture
def falling():
    """A cable that falls on a plane far below, begun."""
    material("cable")
    cable = rope()
    plane((0, 0, -5), (5, 5, 0.1), material="cable")
    O.engines = ancf.engines(cable, gravity=(0, 0, -G))
    steps(3)
    return cable


def refusedNow(told):
    with pytest.raises(RuntimeError, match=told):
        O.step()


# ---- engines -----------------------------------------------------------------------------------------


def without(kind):
    return [e for e in O.engines if not isinstance(e, getattr(wrapper, kind))]


def find(kind):
    return next(e for e in O.engines if isinstance(e, getattr(wrapper, kind)))


def kill(kind):
    find(kind).dead = True


def set_(engines):
    O.engines = engines


def twice(kind):
    engine = find(kind)
    at = O.engines.index(engine)
    O.engines = [*O.engines[: at + 1], engine, *O.engines[at + 1 :]]


EDITS = {
    "cable twice": (lambda: twice("CableEngine"), "same CableEngine at 3 and at 4"),
    "copy of the cable": (
        lambda: set_(
            [*O.engines[:4], wrapper.CableEngine(**find("CableEngine").dict()), *O.engines[4:]]
        ),
        "two CableEngines of family",
    ),
    "newton removed": (lambda: set_(without("NewtonIntegrator")), "no NewtonIntegrator"),
    "newton dead": (lambda: kill("NewtonIntegrator"), "NewtonIntegrator in O.engines is dead"),
    "newton twice": (lambda: twice("NewtonIntegrator"), "same CableNewton at 4 and at 5"),
    "second newton": (
        lambda: set_([*O.engines, NewtonIntegrator(damping=0)]),
        "two live NewtonIntegrators",
    ),
    "loop removed": (lambda: set_(without("InteractionLoop")), "no InteractionLoop"),
    "loop dead": (lambda: kill("InteractionLoop"), "InteractionLoop in O.engines is dead"),
    "loop twice": (lambda: twice("InteractionLoop"), "same InteractionLoop"),
    "second loop": (
        lambda: set_([*O.engines[:3], InteractionLoop([], [], []), *O.engines[3:]]),
        "two live InteractionLoops",
    ),
    "collider removed": (lambda: set_(without("Collider")), "no live collider"),
    "collider dead": (lambda: kill("Collider"), "no live collider"),
    "collider last": (
        lambda: set_([*without("Collider"), find("Collider")]),
        "collider comes after InteractionLoop",
    ),
    "resetter dead": (lambda: kill("ForceResetter"), "ForceResetter in O.engines is dead"),
    "geometry functors": (
        lambda: setattr(find("InteractionLoop").geomDispatcher, "functors", []),
        "no Ig2 functor",
    ),
    "physics functors": (
        lambda: setattr(find("InteractionLoop").physDispatcher, "functors", []),
        "no Ip2 functor",
    ),
    "laws": (
        lambda: setattr(find("InteractionLoop").lawDispatcher, "functors", []),
        "no Law2 functor",
    ),
    "bounds": (
        lambda: setattr(find("Collider").boundDispatcher, "functors", []),
        "no Bo1 functor",
    ),
    "periodic": (lambda: setattr(O, "periodic", True), "periodic"),
    "cable after newton": (
        lambda: set_([*O.engines[:3], O.engines[4], O.engines[3]]),
        "CableEngine comes after NewtonIntegrator",
    ),
}


@pytest.mark.parametrize("what", EDITS)
def test_engines_edited_while_it_runs(falling, what):
    change, told = EDITS[what]
    before = O.engines
    change()
    if what == "periodic":
        O.cell.setBox(20, 20, 20)
    try:
        refusedNow(told)
    finally:
        O.periodic = False
        O.engines = before


@pytest.mark.parametrize("what", EDITS)
def test_engines_edited_before_the_start(what):
    material("cable")
    cable = rope()
    plane((0, 0, -5), (5, 5, 0.1), material="cable")
    O.engines = ancf.engines(cable, gravity=(0, 0, -G))
    change, told = EDITS[what]
    change()
    if what == "periodic":
        O.cell.setBox(20, 20, 20)
    try:
        with pytest.raises((RuntimeError, ValueError), match=told):
            ancf.check()
    finally:
        O.periodic = False


def test_engines_put_back_go_on(falling):
    before = O.engines
    O.engines = without("NewtonIntegrator")
    refusedNow("no NewtonIntegrator")
    O.engines = before
    at = O.iter
    steps(3)
    assert O.iter == at + 3


def test_engine_replaced_by_its_copy():
    """The elements then show the curve of the new one: a ball that both hit once, not twice."""
    material("cable")
    cable = rope()
    number = ball((0.5, 0, -0.0115), 0.01, material="cable")
    O.engines = ancf.engines(cable, gravity=(0, 0, -G))
    steps(5)
    engines = O.engines
    old = engines[3]
    state = {k: v for k, v in old.dict().items() if k not in ("execTime", "execCount")}
    O.engines = [*engines[:3], wrapper.CableEngine(**state), *engines[4:]]
    steps(round(0.05 / O.dt))
    new = O.engines[3]
    middle = new.point(1, 1.0)
    assert new.maxPenetration > 0
    assert middle[2] > -0.001  # free fall: -0.012 m
    assert old.point(1, 1.0)[2] > -1e-4  # stays where it was


# ---- drives ------------------------------------------------------------------------------------------


@pytest.fixture
def turning():
    """A sheave that turns at a speed, beside a cable."""
    material("cable")
    cable = rope()
    number = ball((0, 0, 3), 0.1, mass=1.0, material="cable")
    O.bodies[number].state.blockedDOFs = "xyzXYZ"
    sheaves = ancf.SheaveEngine()
    sheaves.add(number, speed=2.0)
    *engines, newton = ancf.engines(cable)
    O.engines = [*engines, sheaves, newton]
    steps(3)
    return number, sheaves


def test_drive_in_the_wrong_place(turning):
    number, sheaves = turning
    *engines, drive, newton = O.engines
    O.engines = [*engines, newton, drive]
    refusedNow("SheaveEngine stands after NewtonIntegrator")
    O.engines = [*engines[:3], drive, engines[3], newton]
    refusedNow("SheaveEngine stands before CableEngine")
    O.engines = [*engines, drive, newton]
    O.step()


def test_drive_twice_or_two_of_one_body(turning):
    number, sheaves = turning
    *engines, drive, newton = O.engines
    O.engines = [*engines, drive, drive, newton]
    refusedNow("same SheaveEngine")
    other = ancf.SheaveEngine()
    other.add(number, speed=1.0)
    O.engines = [*engines, drive, other, newton]
    refusedNow(f"body {number} is driven by two SheaveEngines")


@pytest.mark.parametrize("how", ["dead", "removed"])
def test_drive_switched_off(turning, how):
    number, sheaves = turning
    if how == "dead":
        sheaves.dead = True
    else:
        O.engines = without("SheaveEngine")
    refusedNow(f"body {number} was driven by an engine that is dead or no longer")
    O.bodies[number].state.angVel = Vector3(0, 0, 0)
    steps(3)


# ---- bodies ------------------------------------------------------------------------------------------


@pytest.fixture
def carrying():
    """A free cable with a bullet at its end, and a heavy ball far away that it may meet."""
    material("cable")
    cable = rope()
    bullet = ball((1, 0, 0), 0.01, mass=0.1, material="cable")
    cable.carry(-1, bullet)
    target = ball((0, 0, 3), 0.1, mass=1.0, material="cable")
    O.engines = ancf.engines(cable, gravity=(0, 0, -G))
    steps(3)
    return cable, bullet, target


def test_shape_of_an_element_replaced(carrying):
    cable, bullet, target = carrying
    number = cable.bodies[1]
    for shape in (wrapper.Sphere(radius=0.1), None):
        before = O.bodies[number].shape
        O.bodies[number].shape = shape
        refusedNow(f"body {number} .* stands in the place of element 1")
        O.bodies[number].shape = before
    O.step()


def test_number_of_an_element_taken_by_another_body(carrying):
    cable, bullet, target = carrying
    number = cable.bodies[1]
    O.bodies.erase(number)
    other = wrapper.Body()
    other.shape = wrapper.Sphere(radius=0.1)
    other.material = O.materials["cable"]
    other.state.pos = (0, 0, 5)
    O.bodies.insertAtId(other, number)
    refusedNow(f"body {number} .Sphere.* stands in the place of element 1")
    assert other.state.pos == Vector3(0, 0, 5)


def test_elements_whose_shapes_were_exchanged(carrying):
    cable, bullet, target = carrying
    a, b = (O.bodies[i] for i in cable.bodies[:2])
    a.shape, b.shape = b.shape, a.shape
    refusedNow("stands in the place of element 0")


def test_mass_of_a_bullet_edited(carrying):
    """It falls as before, and has the new mass from the next step on: p = m v, energy m g h."""
    cable, bullet, target = carrying
    speed = O.bodies[bullet].state.vel[2]
    mass = cable.mass + 0.1
    assert cable.engine.momentum()[0][2] == pytest.approx(mass * speed, rel=1e-9)
    O.bodies[bullet].state.mass = 0.3
    O.step()
    speed -= G * O.dt
    assert O.bodies[bullet].state.vel[2] == pytest.approx(speed, rel=1e-9)
    assert cable.engine.momentum()[0][2] == pytest.approx((mass + 0.2) * speed, rel=1e-9)


BAD = [
    ("mass", 0.0, "state.mass = 0"),
    ("mass", -1.0, "state.mass = -1"),
    ("mass", math.nan, "state.mass = -?nan"),
    ("inertia", Vector3(0, 1, 1), "state.inertia = 0"),
    ("inertia", Vector3(1, math.nan, 1), "state.inertia = -?nan"),
    ("blockedDOFs", "", "state.blockedDOFs = 0: must hold 'xyz'"),
]


@pytest.mark.parametrize("name, value, told", BAD)
def test_state_of_a_bullet_edited(carrying, name, value, told):
    cable, bullet, target = carrying
    setattr(O.bodies[bullet].state, name, value)
    refusedNow(f"body {bullet} .*which node 1 carries: {told}")


def test_state_of_a_bullet_replaced(carrying):
    cable, bullet, target = carrying
    O.bodies[bullet].state = wrapper.State()
    refusedNow(f"body {bullet} .*state.mass = 0")


def test_bullet_clumped(carrying):
    cable, bullet, target = carrying
    O.bodies.clump([bullet, ball((1, 0, 0.02), 0.01, mass=0.1, material="cable")])
    refusedNow(f"body {bullet} .*must stay on its own")


def test_bullet_replaced_by_a_body_of_its_mass(carrying):
    cable, bullet, target = carrying
    O.bodies.erase(bullet)
    other = wrapper.Body()
    other.shape = wrapper.Sphere(radius=0.1)
    other.material = O.materials["cable"]
    other.state.mass, other.state.inertia = 0.1, Vector3(1, 1, 1)
    other.state.blockedDOFs = "xyz"
    O.bodies.insertAtId(other, bullet)
    refusedNow(f"body {bullet} .*took the place of the body that node 1 carries")


@pytest.mark.parametrize(
    "part, name, value",
    [
        ("state", "mass", 0.0),
        ("state", "mass", math.nan),
        ("state", "inertia", Vector3(math.nan, 1, 1)),
        ("state", "pos", Vector3(math.nan, 0, 0)),
        ("shape", "radius", math.nan),
        ("shape", "radius", 0.0),
    ],
)
def test_partner_spoilt_while_it_runs(carrying, part, name, value):
    cable, bullet, target = carrying
    setattr(getattr(O.bodies[target], part), name, value)
    with pytest.raises(
        RuntimeError, match=f"body {target} .*({part}.{name}|look at its mass, its inertia)"
    ):
        steps(101)


# ---- appended while it runs --------------------------------------------------------------------------


@pytest.mark.parametrize("after", [1, 100])
@pytest.mark.parametrize(
    "model", [dict(model="ancf"), dict(model="springs", elements=1, midPoints=3)]
)
def test_appended_cable_starts_with_its_own_half_kick(falling, after, model):
    """Leapfrog from rest: v = -g dt/2 after the first step, z exactly as z = -g t^2/2 (Hairer,
    Lubich, Wanner 2003: the scheme is exact for a constant force).
    """
    steps(after)
    late = rope(z=1.0, **model)
    late.append(engine=falling.engine)
    begin = O.iter
    O.step()
    engine, dt = falling.engine, O.dt
    first = late._first[0]
    speeds = np.array(engine.velocity).reshape(3, -1)[2, first : first + 5]
    assert speeds == pytest.approx(np.full(5, -G * dt / 2), rel=1e-9)
    steps(200)
    t = (O.iter - begin) * dt
    assert late.knots[:, 2] == pytest.approx(np.full(2, 1 - G * t**2 / 2), abs=1e-14)
    t = O.iter * dt
    assert falling.knots[:, 2] == pytest.approx(np.full(2, -G * t**2 / 2), abs=1e-13)


def test_half_kick_is_not_lost_when_saved_before_the_first_step(falling, tmp_path):
    late = rope(z=1.0)
    late.append(engine=falling.engine)
    O.save(str(tmp_path / "a.xml"))
    O.load(str(tmp_path / "a.xml"))
    O.step()
    engine = find("CableEngine")
    speeds = np.array(engine.velocity).reshape(3, -1)[2, 5:10]
    assert speeds == pytest.approx(np.full(5, -G * O.dt / 2), rel=1e-9)


# ---- forces of others on elements --------------------------------------------------------------------


@pytest.mark.parametrize(
    "model", [dict(model="ancf"), dict(model="springs", elements=1, midPoints=3)]
)
def test_force_on_elements_acts_as_weight_does(model):
    """Each element's weight as a force on its body: free fall, no element bends or stretches."""
    material("cable")
    cable = rope(**model)
    O.engines = ancf.engines(cable)
    weight = Vector3(0, 0, -G * cable.mass / 4)
    for number in cable.bodies:
        O.forces.setPermF(number, weight)
    steps(100)
    t = 100 * O.dt
    assert cable.knots[:, 2] == pytest.approx(np.full(2, -G * t**2 / 2), abs=1e-14)
    assert cable.energy()["bending"] == pytest.approx(0, abs=1e-20)


def test_force_on_one_element_moves_all_of_the_mass():
    """Newton: momentum = F t."""
    material("cable")
    cable = rope()
    O.engines = ancf.engines(cable)
    steps(2)
    start = array(cable.engine.momentum()[0])
    force = np.array([0.1, 0.2, -0.3])
    O.forces.setPermF(cable.bodies[2], Vector3(*force))
    steps(50)
    gained = array(cable.engine.momentum()[0]) - start
    assert gained == pytest.approx(force * 50 * O.dt, rel=1e-9)


def test_torque_on_an_element_is_refused(falling):
    O.forces.setPermT(falling.bodies[0], Vector3(1, 0, 0))
    refusedNow(f"a torque acts on body {falling.bodies[0]} of element 0")


# ---- memory ------------------------------------------------------------------------------------------


class Mallinfo2(ctypes.Structure):
    """From glibc's malloc.h."""

    _fields_ = [
        (name, ctypes.c_size_t)
        for name in (
            "arena ordblks smblks hblks hblkhd usmblks fsmblks uordblks fordblks keepcost".split()
        )
    ]


def inUse():
    """Memory that malloc has given out [bytes]."""
    libc = ctypes.CDLL(None)
    libc.mallinfo2.restype = Mallinfo2
    info = libc.mallinfo2()
    return info.uordblks + info.hblkhd


def growth(build, times=50):
    """Of a scene that is reset, built and run for five steps [bytes each]."""

    def once():
        O.reset()
        build()
        steps(5)

    for _ in range(10):
        once()
    before = inUse()
    for _ in range(times):
        once()
    return (inUse() - before) / times


def growthOfNet():
    def build():
        material("cable")
        O.engines = ancf.engines(squareNet(6), gravity=(0, 0, -G))

    return growth(build)


def growthOfSpheres():
    """As many, and the engines that a net has."""

    def build():
        material("cable")
        for i in range(84):
            ball((i, 0, 0), 0.1, mass=1.0, material="cable")
        O.engines = ancf.engines(rope(contactPoints=0), gravity=(0, 0, -G))

    return growth(build)


def growthOfLists(times=500):
    """Of an attribute that is set, each time to numbers of its own [bytes each]."""
    material("cable")
    net = squareNet(6)
    O.engines = ancf.engines(net)
    engine = net.engine

    def assign():
        for i in range(times):
            engine.ea = [1e3 + i + k / 7 for k in range(engine.nElements)]

    assign()
    before = inUse()
    assign()
    return (inUse() - before) / times


def measured(name):
    """What a function above returns in a process of its own, where Python takes its memory by malloc."""
    program = f"import test_scene_changes as t; print(t.{name}())"
    env = dict(os.environ, PYTHONMALLOC="malloc", PYTHONPATH=os.pathsep.join(sys.path))
    out = subprocess.run([sys.executable, "-c", program], env=env, capture_output=True, text=True)
    assert out.returncode == 0, out.stderr
    return float(out.stdout.splitlines()[-1])


def test_reset_gives_memory_back():
    """YADE itself never frees the engines of a scene: one of as many spheres is the measure."""
    ours, theirs = measured("growthOfNet"), measured("growthOfSpheres")
    assert ours - theirs < 20e3, (ours, theirs)


def test_lists_given_to_attributes_are_given_back():
    assert measured("growthOfLists") < 100  # 84 numbers of Python have 24 bytes each
