"""The energy watch: sums that close, gains of known size that stop a run, sound runs that go on."""

import math

import numpy as np
import pytest

import outcomes
import random_scenes
from helpers import O, Vector3, ancf, array, ball, hertz, material, plane, runTo, squareNet, steps

YOUNG, POISSON = 4.456e8, 0.3  # of helpers.material


def line(n=8, diameter=2e-3, **options):
    """A cable along x, half a metre long."""
    given = dict(diameter=diameter, material="cable", mass="lumped")
    return ancf.Cable([(-0.25, 0, 0), (0.25, 0, 0)], n, **{**given, **options})


def watched(*structures, tolerance=None, **options):
    """Sets the engines and returns the CableEngine."""
    O.engines = ancf.engines(*structures, **options)
    engine = structures[0].engine
    if tolerance is not None:
        engine.energyTolerance = tolerance
    return engine


# ---- sums ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("damping", [0, 5e-5])
def test_sum_is_that_of_all_energies(scene, damping):
    """With O.trackEnergy and nothing but fixed partners, what is off is what O.energy is off by."""
    O.trackEnergy = True
    material("cable", impactDamping=0.2)
    ball((0.05, 0.004, 0.002), 0.04, material="cable")
    net = squareNet(2, 0.06, damping=damping, center=(-0.001, 0, 0))
    net.addBullets(0.05, 0.008, 1.5, math.radians(15))
    engine = watched(net)
    O.step()
    start, met = O.energy.total(), 0
    while O.time < 0.06:
        O.step()
        met = max(met, engine.contacts)
        off = O.energy.total() - start
        assert engine.energyOff == pytest.approx(off, abs=1e-12 * engine.energyScale)
    assert met > 3
    assert abs(engine.energyOff) < 5e-3 * engine.energyScale
    assert engine.energyScale == pytest.approx(0.5 * 4 * 0.05 * 1.5**2, rel=1e-2)


def test_kinetic_energy_is_that_of_the_mean_velocity(scene):
    """And so never below zero, where fast modes turn back within a step and a ball hangs on a knot: what
    leapfrog's sum has at other times than it is in cableHalfStep, and the sum closes.
    """
    material("cable")
    cable = line(6, contactPoints=0)
    cable.fix(0)
    weight = ball((0.25, 0, 0), 1e-2, mass=0.05, material="cable", mask=2)
    cable.carry(-1, weight)
    O.engines = ancf.engines(cable, gravity=(0, 0, -9.81))
    ancf.settle(tolerance=0.5)
    cable.setVelocity(lambda p: Vector3(0, 0, 0.1 * (-1) ** round(12 * p[2])))
    O.trackEnergy = True
    engine, part, below = cable.engine, cable.length / 6, 0
    mass = cable.section.rhoA * part * np.array([0.5, 0.5] + 5 * [1] + 12 * [part**2 / 78])
    start, largest = None, 0.0
    for _ in range(400):
        before = array(engine.velocity).reshape(3, -1)[:, : len(mass)]
        O.step()
        after = array(engine.velocity).reshape(3, -1)[:, : len(mass)]
        kinetic = O.energy["cableKinetic"]
        exact = 0.5 * (mass * (0.5 * (before + after)) ** 2).sum()
        assert kinetic == pytest.approx(exact, rel=1e-9, abs=1e-20)
        below += 0.5 * (mass * before * after).sum() < 0
        start = O.energy.total() if start is None else start
        largest = max(largest, kinetic)
        assert O.energy.total() == pytest.approx(start, abs=1e-2 * largest + 1e-9)
    assert below > 0


def test_work_of_a_body_that_leads_a_node(scene):
    """A spring k at rest that is drawn out at u from one end, the other fixed: the work is k (u t)^2/2 and
    what the waves have, all of it from outside; nothing is out of balance.
    """
    material("cable")
    post = ball((0.25, 0, 0), 1e-3, material="cable")
    cable = line(contactPoints=0, diameter=1e-3)
    cable.append()
    cable.fix(0)
    cable.follow(1, post)
    O.trackEnergy = True  # looks in every step
    speed = 0.5
    O.bodies[post].state.vel = Vector3(speed, 0, 0)
    engine = watched(cable)
    runTo(4e-3)
    stretch = speed * O.time
    static = cable.section.ea * stretch**2 / 2 / cable.length
    assert sum(cable.energy()[key] for key in ("kinetic", "axial")) == pytest.approx(
        static, rel=0.1
    )
    assert engine.energyScale > 0.8 * static
    assert abs(engine.energyOff) < 1e-4 * engine.energyScale


def test_work_of_a_force_on_a_carried_body(scene):
    """A constant force F on a mass at the end of a slack cable: its energy is F x."""
    material("cable")
    cable = line(contactPoints=0, bending=0)
    body = ball((0.25, 0, 0), 0.01, mass=0.1, material="cable")
    cable.append()
    cable.carry(1, body)
    O.trackEnergy = True
    O.forces.setPermF(body, Vector3(0, 3, 4))
    engine = watched(cable)
    runTo(0.02)
    way = array(O.bodies[body].state.pos) - [0.25, 0, 0]
    work = float(np.dot(way, [0, 3, 4]))
    assert engine.energyScale == pytest.approx(work, rel=2e-2)
    assert abs(engine.energyOff) < 1e-4 * work


def test_loads_that_change(scene):
    """A load that is turned on, doubled and taken off does work, and puts nothing out of balance."""
    material("cable")
    cable = line(contactPoints=0)
    cable.append()
    cable.fix(0)
    engine = watched(cable, gravity=(0, 0, -9.81))
    for force in ((0, 0, 0), (0, 2, 0), (0, 4, 0), (0, 0, 0)):
        cable.load(1, force)
        steps(400)
    assert engine.energyScale > 1e-3
    assert abs(engine.energyOff) < 2e-3 * engine.energyScale


def test_energy_given_to_a_free_ball(scene):
    """A flying cable that shoots a ball away has lost what the ball has got."""
    material("cable", impactDamping=0)
    number = ball((0, 0, 0.0215), 0.02, mass=0.01, material="cable")
    cable = line()
    cable.setVelocity(lambda p: (0, 0, 2))
    O.trackEnergy = True
    engine = watched(cable)
    before = cable.energy()["kinetic"]
    steps(1)
    start = O.energy.total()
    assert start == pytest.approx(before, rel=1e-9)
    while O.time < 0.02:
        O.step()
    got = 0.5 * 0.01 * O.bodies[number].state.vel.squaredNorm()
    assert got > 0.03 * before
    assert engine.energyOff == pytest.approx(O.energy.total() - start, abs=1e-6 * got)


def shot():
    """A cable flies at a fixed ball. Returns its engine."""
    O.reset()
    material("cable")
    ball((0, 0, 0.0215), 0.02, material="cable")
    cable = line()
    cable.setVelocity(lambda p: (0, 0, 2))
    return watched(cable)


@pytest.mark.parametrize("loaded", [False, True])
def test_tracking_that_begins_while_contacts_are_pressed(scene, tmp_path, loaded):
    """O.energy has all energies from its first step on, also right after O.load."""
    shot()
    O.trackEnergy, known = True, []
    while len(known) < 20 or not known[-1].get("contactElastic", 0) > 1e-4:
        O.step()
        known.append(dict(O.energy.items()))
    engine = shot()
    steps(len(known) - 1)
    assert engine.contacts > 0
    if loaded:
        O.save(str(tmp_path / "pressed.yade"))
        O.load(str(tmp_path / "pressed.yade"))
    O.trackEnergy = True
    O.step()
    for name in ("contactElastic", "cableElastic", "cableKinetic", "cableHalfStep"):
        assert O.energy[name] == pytest.approx(known[-1][name], rel=1e-9), name


# ---- stopped -------------------------------------------------------------------------------------


def shifted(depth, watch=None):
    """A cable at rest in front of a fixed ball, which is then moved into it by hand. Returns the engine, and the
    elastic energy by Hertz that comes from nowhere.
    """
    material("cable", impactDamping=0, staticFriction=0, kineticFriction=0)
    number = ball((0.01, 0, 0.0215), 0.02, material="cable")
    cable = line()
    cable.append()
    engine = watched(cable, tolerance=watch, gravity=(0, 0, 0))
    steps(5)
    O.bodies[number].state.pos = Vector3(0.01, 0, 0.021 - depth)
    reduced = 1 / (1 / 0.02 + 1 / 1e-3)
    return engine, hertz(reduced, YOUNG, POISSON, YOUNG, POISSON) * depth**2.5 / 2.5


@pytest.mark.parametrize("depth", [1e-4, 3e-4])
def test_contact_that_is_found_deep_stops_before_it_acts(scene, depth):
    engine, gained = shifted(depth)
    before = np.array(engine.velocity)
    with pytest.raises(
        RuntimeError, match="out of balance: .* gained.* the contact of bodies 0 and"
    ) as told:
        steps(3)
    amount = float(str(told.value).split("out of balance: ")[1].split(" J")[0])
    assert amount == pytest.approx(gained, rel=0.02)
    assert (np.array(engine.velocity) == before).all()  # not a thing has moved


def test_without_the_watch_it_flies_away(scene):
    engine, gained = shifted(3e-4, math.inf)
    steps(400)
    assert engine.contacts == 0
    assert sum(engine.energy(0, engine.nElements).values()) == pytest.approx(gained, rel=0.02)


@pytest.mark.parametrize("seed", [17, 189])
def test_springs_that_gain_are_stopped(scene, seed):
    """Nets of springs that snap at the longest stable step lose their balance."""
    end, share, told = random_scenes.scene(seed)
    assert end == "stopped by the watch" and "element" in told
    assert share < outcomes.LATE
    end, without, _ = random_scenes.scene(seed, tolerance=math.inf)
    assert end == "silent" and without > outcomes.SOUND
    O.trackEnergy = False


# ---- sound runs ----------------------------------------------------------------------------------


def test_random_scenes(scene):
    """The first few of those that random_scenes.py runs by the hundred."""
    ends = [random_scenes.scene(seed, 600)[0] for seed in range(20)]
    O.trackEnergy = False
    assert not set(ends) & set(outcomes.FAULTS), ends
    assert ends.count("sound") > 10


def test_a_loaded_run_goes_on_with_its_sums(scene, tmp_path):
    def start():
        O.reset()
        material("cable", impactDamping=0.2)
        ball((0.05, 0.004, 0.002), 0.04, mass=0.2, material="cable")
        net = squareNet(2, 0.06, damping=5e-5, center=(-0.001, 0, 0))
        net.addBullets(0.05, 0.008, 1.5, math.radians(15))
        return watched(net, gravity=(0, 0, -9.81))

    engine = start()
    steps(777)
    O.save(str(tmp_path / "scene.xml"))
    steps(1000)
    whole = engine.energyOff, engine.energyScale
    O.load(str(tmp_path / "scene.xml"))
    (engine,) = [e for e in O.engines if isinstance(e, ancf.CableEngine)]
    assert engine.energyTolerance == 0.02
    steps(1000)
    assert (engine.energyOff, engine.energyScale) == whole
    assert whole[1] > 0.05


def test_an_edit_after_a_load_is_no_gain(scene, tmp_path):
    material("cable")
    cable = line(contactPoints=0)
    cable.setVelocity(lambda p: (0, 0, 1))
    watched(cable)
    steps(50)
    O.save(str(tmp_path / "scene.xml"))
    O.load(str(tmp_path / "scene.xml"))
    (engine,) = [e for e in O.engines if isinstance(e, ancf.CableEngine)]
    engine.velocity = [3 * v for v in engine.velocity]
    steps(200)
    assert abs(engine.energyOff) < 1e-3 * engine.energyScale


@pytest.mark.parametrize("value", [math.inf, 1e-9])
def test_tolerance(scene, value):
    """A run that is off by rounding stops when that is not allowed, and only then."""
    material("cable")
    net = squareNet(2, 0.08, fold=0.8)
    net.addBullets(0.05, 0.008, 1.5, math.radians(25))
    engine = watched(net, tolerance=value)
    if math.isinf(value):
        steps(2000)
        assert engine.energyScale == 0
    else:
        with pytest.raises(RuntimeError, match="energyTolerance = 1e-09"):
            steps(2000)


@pytest.mark.parametrize("value", [0, -1, math.nan])
def test_bad_tolerance(scene, value):
    material("cable")
    engine = watched(line())
    with pytest.raises(ValueError, match=f"energyTolerance = {value}: must be above 0"):
        engine.energyTolerance = value
