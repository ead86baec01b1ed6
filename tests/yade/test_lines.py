"""Lines through rings in scenes: Atwood, capstan, purse, energy and momentum, winches, saves."""

import math

import numpy as np
import pytest

import random_lines  # first: sets the number of threads
import ancf
from helpers import bodyEngines, material, squareNet
from outcomes import FAULTS
from yade import O, Quaternion, Vector3, utils

G = 9.81


@pytest.fixture(autouse=True)
def scene():
    O.reset()
    material("cord", young=2e9, density=1100)


def ball(place, mass, fixed=False, radius=0.02):
    number = O.bodies.append(utils.sphere(place, radius, material="cord", fixed=fixed))
    O.bodies[number].state.mass = mass
    O.bodies[number].state.inertia = Vector3(1, 1, 1) * 0.4 * mass * radius**2
    return number


def strand(**options):
    """A cable far from everything: a scene of lines needs a CableEngine."""
    cable = ancf.Cable(
        [(50, 0, 0), (51, 0, 0)], 1, diameter=2e-3, material="cord", contactPoints=0, **options
    )
    cable.fix(0)
    cable.fix(1)
    return cable


def test_atwood_over_a_ring():
    """a = g (m1 - c m2)/(m1 + c m2), c = exp(mu pi), on bodies."""
    heavy, ring, light = ball((0, 0, 0), 3), ball((0, 0, 3), 1, fixed=True), ball((0, 0, 0), 1)
    O.bodies[light].groupMask = 2  # at the place of the other one
    line = ancf.Line(
        [heavy, ring, light],
        diameter=2e-3,
        area=1e-3,  # so stiff that one side is not stretched more than the other
        material="cord",
        friction=0.2,
        ringRadius=0,
        label="w",
    )
    O.engines = ancf.engines(strand(), line, gravity=(0, 0, -G))
    c = math.exp(0.2 * math.pi)
    a = G * (3 - c) / (3 + c)
    line.engine.tension = [3 * (G - a), G + a]  # those of the motion, so that nothing swings
    line.engine.length = [3 / (1 + t / line.engine.ea) for t in line.engine.tension]
    line.engine.updateAttrs({"slides": [0, -1, 0]})
    while O.time < 0.4:
        O.step()
    assert O.bodies[heavy].state.pos[2] == pytest.approx(-a * O.time**2 / 2, rel=3e-4)
    assert O.bodies[light].state.pos[2] == pytest.approx(a * O.time**2 / 2, rel=3e-4)
    ratio = line.tensions[0] / line.tensions[1]
    assert ratio == pytest.approx(c, rel=1e-9)


def test_capstan_over_fixed_knots():
    """The product of exp(mu a) over rings on a fixed cable; its reactions carry the line."""
    points = [(math.cos(t), 0, math.sin(t)) for t in np.linspace(0, math.pi, 7)]
    frame = ancf.Cable(
        points, diameter=4e-3, material="cord", model="springs", contactPoints=0
    )  # all of it is in its knots
    for k in range(7):
        frame.fix(k)
    weight = ball((-1, 0, -1), 2)
    hand = ball((1, 0, -1), 1, fixed=True)
    with pytest.warns(UserWarning, match="knot 0 of Cable is fixed: the line runs through"):
        line = ancf.Line(
            [hand, *[(frame, k) for k in range(7)], weight],
            diameter=2e-3,
            material="cord",
            friction=0.1,
        )
        O.engines = ancf.engines(frame, line, gravity=(0, 0, -G))
    line.haul(0.05, 1e3, end=0)
    while O.time < 0.4:
        O.step()
    d = np.diff(line.points, axis=0)
    d /= np.linalg.norm(d, axis=1)[:, None]
    turn = np.arccos((d[1:] * d[:-1]).sum(axis=1)).sum()
    assert line.tensions[0] / line.tensions[-1] == pytest.approx(math.exp(0.1 * turn), rel=1e-4)
    assert turn == pytest.approx(math.pi, rel=0.01)
    # What the frame takes is what both ends of the line pull, and its own weight.
    total = sum((frame.reaction(k) for k in range(7)), Vector3.Zero)
    ends = -line.tensions[0] * Vector3(*d[0]) + line.tensions[-1] * Vector3(*d[-1])
    weightOf = Vector3(0, 0, G * frame.mass)
    assert (
        total - (weightOf - ends)
    ).norm() < 2e-4 * total.norm()  # points are those of a step later


def purse(rings=12, friction=0.0, model="springs", **options):
    """A ring of bodies that a cable joins, and a line through them."""
    angles = 2 * math.pi * np.arange(rings) / rings
    hoop = ancf.Cable(
        [(math.cos(t), math.sin(t), 0) for t in angles],
        diameter=1e-3,
        material="cord",
        model=model,
        contactPoints=0,
        closed=True,
        damping=0.0,
    )
    line = ancf.Line(
        [(hoop, k) for k in [*range(rings), 0]],
        diameter=1e-3,
        material="cord",
        friction=friction,
        **options,
    )
    return hoop, line


def test_purse_drawn_at_a_force():
    """R'' = -2 F sin(pi/n)/m while the hoop of tension-only springs is slack."""
    hoop, line = purse(ringRadius=0, tension=5.0)
    O.engines = ancf.engines(hoop, line)
    line.haul(1e3, 5.0)
    mass = hoop.mass / 12
    pull = 2 * 5.0 * math.sin(math.pi / 12) / mass
    end = math.sqrt(2 * 0.4 / pull)
    O.dt = end / math.ceil(end / O.dt)
    while O.time < end - 0.5 * O.dt:
        O.step()
    radius = np.linalg.norm(hoop.knots, axis=1)
    assert radius == pytest.approx(1 - pull * O.time**2 / 2, rel=1e-9)
    assert line.winch() == "strains"
    kinetic = hoop.energy()["kinetic"]
    assert line.energy()["winches"] == pytest.approx(kinetic, rel=0.02)


@pytest.mark.parametrize("friction", [0.0, 0.15])
@pytest.mark.parametrize("model", ["ancf", "springs"])
def test_purse_keeps_energy_and_momentum(friction, model):
    hoop, line = purse(friction=friction, model=model, ringRadius=0.02, slack=0.01)
    hoop.setVelocity(lambda p: Vector3(0.3, -0.2 + 2 * p[0], 1 - 2 * p[1]))
    O.engines = ancf.engines(hoop, line)
    O.dt /= 2
    O.trackEnergy = True
    before = hoop.engine.momentum()
    line.haul(4.0, 30.0, to=1.5, brake=60.0)
    O.step()
    first = O.energy.total()
    scale = 0.0
    while O.time < 0.6:
        O.step()
        scale = max(scale, O.energy["cableKinetic"] + O.energy["lineElastic"])
    after = hoop.engine.momentum()
    for one, other in zip(before, after):
        assert (other - one).norm() < 1e-10 * scale
    assert abs(O.energy.total() - first) < 2e-3 * scale
    assert line.engine.unsettled == 0
    assert hoop.engine.energyScale > 0.5 * scale  # the watch has seen it, and did not stop
    if friction:
        assert line.energy()["friction"] > 0.01 * scale
    else:
        assert line.energy()["friction"] == pytest.approx(0, abs=1e-9 * scale)


@pytest.mark.parametrize("substeps", [1, 4])
def test_sub_steps_keep_momenta(substeps):
    """The whole pull where the line found the knots: nothing turns them together."""
    hoop, line = purse(friction=0.1, model="ancf", ringRadius=0.02, tension=5.0)
    hoop.setVelocity(lambda p: Vector3(0.3 - 2 * p[1], -0.2 + 2 * p[0], 1))
    O.engines = ancf.engines(hoop, line, substeps=substeps)
    line.haul(4.0, 30.0)
    before = hoop.engine.momentum()
    for _ in range(2000):
        O.step()
    for one, other in zip(before, hoop.engine.momentum()):
        assert (other - one).norm() < 1e-11 * one.norm()


def test_energy_error_is_of_second_order():
    errors = []
    for part in (1, 2):
        O.reset()
        material("cord", young=2e9, density=1100)
        hoop, line = purse(ringRadius=0.02, model="ancf", tension=2.0)
        hoop.setVelocity(lambda p: Vector3(0.3, -0.2 + 2 * p[0], 1 - 2 * p[1]))
        O.engines = ancf.engines(hoop, line)
        O.dt = 2e-6 / part
        O.trackEnergy = True
        line.haul(1e3, 30.0)
        O.step()
        first = O.energy.total()
        off = []
        while O.time < 0.01:
            O.step()
            off.append(O.energy.total() - first)
        errors.append(np.abs(off).max())
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.25)


def test_pulls_on_a_body_off_its_centre():
    """A free body and a knot, drawn together: momenta are exact."""
    cable = ancf.Cable([(0, 0, 1), (0, 0.5, 1)], 2, diameter=5e-3, material="cord", contactPoints=0)
    box = O.bodies.append(utils.box((0, 0, 0), (0.2, 0.1, 0.1), material="cord"))
    O.bodies[box].state.mass = 1.0
    O.bodies[box].state.inertia = Vector3(0.02, 0.05, 0.06)
    O.bodies[box].state.ori = Quaternion((0, 0, 1), 2.5)
    line = ancf.Line([(box, (0.2, 0.1, 0.1)), (cable, 1)], diameter=1e-3, material="cord")
    O.engines = ancf.engines(cable, line)
    line.haul(0.5, 5.0)

    def momenta():
        s = O.bodies[box].state
        linear, angular = cable.engine.momentum()
        turn = s.ori * Vector3(
            *(s.inertia[i] * (s.ori.conjugate() * s.angVel)[i] for i in range(3))
        )
        return linear + s.mass * s.vel, angular + turn + s.mass * s.pos.cross(s.vel)

    O.step()
    first = momenta()
    while O.time < 0.3:
        O.step()
    linear, angular = (now - before for now, before in zip(momenta(), first))
    assert line.winch() == "draws"
    assert O.bodies[box].state.vel.norm() > 1e-3
    assert O.bodies[box].state.angVel.norm() > 1e-2
    assert linear.norm() < 1e-12
    assert (
        angular.norm() < 2e-3 * O.bodies[box].state.angVel.norm() * 0.05
    )  # step error of YADE's turning


def test_hangs_on_a_brake_and_lets_out():
    weight, hook = ball((0, 0, 0), 2), ball((0, 0, 1), 1, fixed=True)
    line = ancf.Line([hook, weight], diameter=2e-3, material="cord", tension=2 * G, ringRadius=0)
    O.engines = ancf.engines(strand(), line, gravity=(0, 0, -G))
    for _ in range(200):
        O.step()
    assert O.bodies[weight].state.pos[2] == pytest.approx(0, abs=1e-9)
    assert line.winch(0) == "holds"
    line.payOut(0.5, to=1.1, end=0)
    while O.time < 0.1:
        O.step()
    assert line.winch(0) == "lets out"
    while O.time < 0.5:
        O.step()
    assert line.winch(0) == "stopped"
    assert line.length == pytest.approx(1.1, rel=1e-12)


def test_slips_at_its_brake():
    """A brake at half the weight lets it fall at half of gravity."""
    weight, hook = ball((0, 0, 0), 2), ball((0, 0, 1), 1, fixed=True)
    line = ancf.Line([hook, weight], diameter=2e-3, material="cord", tension=G, ringRadius=0)
    O.engines = ancf.engines(strand(), line, gravity=(0, 0, -G))
    line.hold(brake=G, end=0)
    while O.time < 0.2:
        O.step()
    assert line.winch(0) == "slips"
    assert O.bodies[weight].state.pos[2] == pytest.approx(-G / 4 * O.time**2, rel=1e-3)
    assert line.energy()["winches"] == pytest.approx(G * O.bodies[weight].state.pos[2], rel=1e-2)


def test_speed_as_a_function_of_time():
    weight, hook = ball((0, 0, 0), 2), ball((0, 0, 3), 1, fixed=True)
    line = ancf.Line([hook, weight], diameter=2e-3, material="cord", tension=2 * G, ringRadius=0)
    O.engines = ancf.engines(strand(), line, gravity=(0, 0, -G))
    line.haul(lambda t: math.sin(10 * t), 1e4, end=0)
    stored = line.energy()["elastic"]
    while O.time < 0.2:
        O.step()
    assert 3 / (1 + 2 * G / line.engine.ea) - line.length == pytest.approx(
        (1 - math.cos(10 * O.time)) / 10, rel=1e-3
    )
    # The work that lifts: m g h, what it moves with, and what the line stores.
    state = O.bodies[weight].state
    lifted = 2 * G * state.pos[2] + state.vel.squaredNorm() + line.energy()["elastic"] - stored
    assert line.energy()["winches"] == pytest.approx(lifted, rel=1e-3)


def test_a_speed_of_either_sign():
    """haul() with a function of time draws in and lets out: what is out goes with its integral."""
    weight, hook = ball((0, 0, 0), 2), ball((0, 0, 3), 1, fixed=True)
    line = ancf.Line([hook, weight], diameter=2e-3, material="cord", tension=2 * G, ringRadius=0)
    O.engines = ancf.engines(strand(), line, gravity=(0, 0, -G))
    line.haul(lambda t: 0.5 * math.sin(20 * t), 1e4, end=0, brake=2e4)
    out = line.length
    while O.time < 0.26:  # the sine is below 0 from 0.157 s on
        O.step()
    assert line.winch(0) == "lets out"
    drawn = 0.5 * (1 - math.cos(20 * O.time)) / 20
    assert out - line.length == pytest.approx(
        drawn, abs=0.5 * O.dt
    )  # speeds are those of step ends


def test_lets_out_with_a_brake():
    """At its speed while the tension is below the brake's, and not by fits and starts."""
    weight, hook = ball((0, 0, 0), 2), ball((0, 0, 1), 1, fixed=True)
    line = ancf.Line([hook, weight], diameter=2e-3, material="cord", tension=2 * G, ringRadius=0)
    O.engines = ancf.engines(strand(), line, gravity=(0, 0, -G))
    O.bodies[weight].state.vel = Vector3(0, 0, -2)
    line.payOut(0.5, brake=30, end=0)
    braked = (2 - 0.5) / (30 / 2 - G)
    done, most = set(), 0.0
    while O.time < 0.8 * braked:
        O.step()
        most = max(most, line.tensions[0])
        done.add(line.winch(0))
    assert O.bodies[weight].state.vel[2] == pytest.approx(-2 + 0.8 * 1.5, abs=0.02)
    assert most == pytest.approx(30, rel=1e-9) and "slips" in done
    while O.time < 2 * braked:
        O.step()
        done.add(line.winch(0))
    assert O.bodies[weight].state.vel[2] == pytest.approx(-0.5, abs=0.2)
    assert done == {"slips", "lets out"}
    assert line.engine.unsettled == 0


def gantry(n, height=2):
    """n fixed cables beside each other, so many metres above the origin: no bodies to meet."""
    cables = []
    for i in range(n):
        x = 0.02 * (i - (n - 1) / 2)
        points = [(x, 0, height), (x, 0, 2 * height)]
        cables.append(
            ancf.Cable(points, 1, diameter=2e-2, material="cord", model="springs", contactPoints=0)
        )
        cables[-1].fix(0)
        cables[-1].fix(1)
    return cables


def test_step_of_several_lines_at_one_body():
    """Each makes what they pull at stiffer: n times as many allow 1/sqrt(n) of the step, and it swings
    no faster than at first.
    """
    steps = []
    for n in (1, 4):
        O.reset()
        material("cord", young=2e9, density=1100)
        weight = ball((0, 0, 0), 0.02)
        cables = gantry(n) + gantry(n, -2)
        lines = [
            ancf.Line(
                [(cable, 0), weight], diameter=2e-2, material="cord", tension=100, label=f"{i}"
            )
            for i, cable in enumerate(cables)
        ]
        O.engines = ancf.engines(*cables, *lines)
        O.bodies[weight].state.vel = Vector3(0, 0, 1e-3)
        for _ in range(500):
            O.step()
            assert O.bodies[weight].state.vel.norm() < 3e-3
        steps.append(O.dt)
        assert lines[0].criticalTimeStep() == pytest.approx(O.dt, rel=0.05)
    assert steps[1] == pytest.approx(steps[0] / 2, rel=0.05)


def test_between_what_is_held():
    """Nothing moves, so that it allows any step."""
    cable = strand()
    line = ancf.Line(
        [ball((x, 0, 0), 1, fixed=True) for x in (0, 1)], diameter=2e-3, material="cord"
    )
    O.engines = ancf.engines(cable, line)
    assert line.criticalTimeStep() == math.inf
    assert O.dt > 0
    O.step()


def test_a_step_that_is_refused_stays_so():
    """When it is tried again, and at once when O.dt is changed."""
    weight = ball((0, 0, 0), 0.02)
    cables = gantry(1)
    line = ancf.Line([(cables[0], 0), weight], diameter=2e-2, material="cord", ringRadius=0.01)
    O.engines = ancf.engines(*cables, line, gravity=(0, 0, -G))
    for _ in range(5):
        O.step()
    O.dt *= 3
    for _ in range(3):
        with pytest.raises(RuntimeError, match="is above the stable one"):
            O.step()
    assert O.iter == 5
    O.dt /= 3
    O.step()


def test_place_in_engines():
    """Where nothing would feel it, it is told."""

    def hung():
        O.reset()
        material("cord", young=2e9, density=1100)
        hook, weight = ball((0, 0, 1), 1, fixed=True), ball((0, 0, 0), 2)
        line = ancf.Line([hook, weight], diameter=2e-3, material="cord")
        O.engines = ancf.engines(strand(), line, gravity=(0, 0, -G))
        rest = [e for e in O.engines if e is not line.engine and not hasattr(e, "ringRadius")]
        return rest, line.engine

    for place, told in (
        (lambda rest, e: [e, *rest], "before ForceResetter"),
        (lambda rest, e: [*rest, e], "behind NewtonIntegrator"),
        (lambda rest, e: [*rest[:-2], e, e, *rest[-2:]], "in O.engines twice"),
    ):
        O.engines = place(*hung())
        with pytest.raises(RuntimeError, match=f"LineEngine 'Line': stands {told}"):
            O.step()


def test_without_cables():
    """In a scene of bodies alone it goes into O.engines as well."""
    hook, weight = ball((0, 0, 1), 1, fixed=True), ball((0, 0, 0), 2)
    O.engines = bodyEngines(gravity=(0, 0, -G))
    O.dt = 1e-5
    line = ancf.Line([hook, weight], diameter=2e-3, material="cord", tension=2 * G).append()
    for _ in range(1000):
        O.step()
    assert O.bodies[weight].state.pos[2] == pytest.approx(0, abs=1e-6)
    with pytest.raises(RuntimeError, match="O.dt = 0 s: must be finite and above 0"):
        O.dt = 0
        O.step()
    O.dt = 1e-5
    O.step()


def test_the_scene_goes_away():
    hook, weight = ball((0, 0, 1), 1, fixed=True), ball((0, 0, 0), 2)
    line = ancf.Line([hook, weight], diameter=2e-3, material="cord")
    O.engines = ancf.engines(strand(), line, gravity=(0, 0, -G))
    O.step()
    O.bodies.erase(weight)
    for read in (lambda: line.points, lambda: line.velocities, line.criticalTimeStep, O.step):
        with pytest.raises(
            RuntimeError, match=r"place 1 of families and numbers \(body 1\) was erased"
        ):
            read()
    engine = line.engine
    O.reset()
    with pytest.raises(
        RuntimeError, match=r"place 0 of families and numbers \(body 0\) was erased"
    ):
        engine.points()
    material("cord", young=2e9, density=1100)
    ball((7, 0, 0), 1), ball((8, 0, 0), 1)
    assert [p[0] for p in engine.points()] == [7, 8]  # those of the scene that is there


def test_random_scenes(scene):
    """The first few of those that random_lines.py runs by the hundred."""
    ends = [random_lines.scene(seed, 600)[0] for seed in range(20)]
    O.trackEnergy = False
    assert not set(ends) & set(FAULTS)
    assert ends.count("sound") > 15


def test_saved_to_the_last_bit(tmp_path):
    def run(steps):
        for _ in range(steps):
            O.step()

    hoop, line = purse(friction=0.1, model="ancf", ringRadius=0.02)
    ball((3, 0, 0), 1)
    O.engines = ancf.engines(hoop, line, gravity=(0, 0, -1))
    hoop.setVelocity(lambda p: Vector3(p[1], 0.2, 0))
    line.haul(3.0, 20.0, to=2.0)
    run(500)
    O.save(str(tmp_path / "half.yade.bz2"))
    run(500)
    there = line.engine.dict(), list(hoop.engine.position)
    O.reset()
    O.load(str(tmp_path / "half.yade.bz2"))
    (line,) = ancf.lines()
    run(500)
    again = line.engine.dict()
    for name in ("length", "tension", "slides", "flow", "rubbed", "drawn"):
        assert again[name] == there[0][name], name
    assert list(ancf.structures()[0].engine.position) == there[1]
    assert line.name == "Line" and line.winch() == "draws"


def test_texts():
    hoop, line = purse()
    with pytest.raises(
        ValueError, match=r"Line.places\[0\]: Cable was not appended: append it first"
    ):
        line.append()
    hoop.append()
    with pytest.raises(
        ValueError, match=r"Line.length = 3.0: is shorter than the way through its places, 6\.2"
    ):
        ancf.Line(
            [(hoop, k) for k in [*range(12), 0]], diameter=1e-3, material="cord", length=3.0
        ).append()
    line.append()
    O.engines = ancf.engines(hoop, gravity=(0, 0, 0))
    with pytest.raises(
        ValueError,
        match=r"Line.haul: to = 7.0: the line has 6\.2.* m left: there is nothing to draw in",
    ):
        line.haul(1.0, 10.0, to=7.0)
    with pytest.raises(ValueError, match=r"brake = 5.0: must be at least force = 10 N"):
        line.haul(1.0, 10.0, brake=5)
    with pytest.raises(ValueError, match=r"end = 1: must be 0, the first place, or -1"):
        line.hold(end=1)
    with pytest.raises(ValueError, match="a line needs at least two places"):
        ancf.Line([(hoop, 0)], diameter=1e-3, material="cord")
    with pytest.raises(ValueError, match=r"places\[0\] and \[1\] are the same place"):
        ancf.Line([(hoop, 0), (hoop, 0)], diameter=1e-3, material="cord")
    other = ancf.Cable([(1, 0, 0), (2, 0, 0)], diameter=1e-3, material="cord").append()
    with pytest.raises(
        ValueError, match=r"places\[0\] and \[1\] are at one point: give ringRadius"
    ):
        ancf.Line([(hoop, 0), (other, 0)], diameter=1e-3, material="cord", ringRadius=0).append()
    with pytest.raises(TypeError, match=r"places\[1\] = 'x': must be \(cable or net, knot\)"):
        ancf.Line([(hoop, 0), "x"], diameter=1e-3, material="cord")
    with pytest.raises(
        ValueError, match=r"friction = \[0.1\]: must be a number, or one for each of 11 rings"
    ):
        ancf.Line(
            [(hoop, k) for k in [*range(12), 0]], diameter=1e-3, material="cord", friction=[0.1]
        )
    with pytest.raises(ValueError, match="length = 2 and slack = 0.1: give one of"):
        ancf.Line([(hoop, 0), (hoop, 1)], diameter=1e-3, material="cord", length=2, slack=0.1)
    with pytest.raises(RuntimeError, match="relax: the line 'Line' pulls at it"):
        O.engines = [*O.engines[:3], line.engine, *O.engines[3:]]
        hoop.relax()


def test_order_of_engines_and_steps_are_checked():
    hoop, line = purse(friction=0.1)
    engines = ancf.engines(hoop, line)
    i = engines.index(line.engine)
    O.engines = engines[:i] + [engines[i + 1], engines[i]] + engines[i + 2 :]
    with pytest.raises(RuntimeError, match="stands behind CableEngine .* put it before it"):
        O.step()
    O.engines = engines
    O.dt *= 20
    with pytest.raises(RuntimeError, match="is above the stable one"):
        O.step()


def test_two_lines_keep_apart():
    hoop, first = purse(tension=5.0)
    _, second = purse()
    second.places = [(hoop, k) for k in (0, 3, 6)]
    second._friction = [0.0] * 3
    O.engines = ancf.engines(hoop, first, second)
    O.step()
    assert first.engine is not None and first.engine.line != second.engine.line
    assert len(first.tensions) == 12 and len(second.tensions) == 2
    assert [line.length for line in ancf.lines()] == [first.length, second.length]


@pytest.mark.parametrize("every, elements, closes", [(1, 1, False), (1, 2, True), (2, 1, True)])
def test_a_closing_line_folds_the_rim_where_it_can(every, elements, closes):
    """A single element between two rings holds them apart; rings at every other knot let the rim fold, and so do two
    elements (guide/closing.rst)."""
    O.reset()
    material("cable")
    net = squareNet(4, 0.08, elements=elements, mass="lumped", damping=5e-5)
    net.addBullets(mass=0.05, radius=0.01, speed=1e-9, angle=0)
    around = 16 * 0.08
    line = ancf.Line(
        [(net, knot) for knot in [*net.rim[::every], net.rim[0]]],
        diameter=1e-3,
        material="cable",
        length=1.02 * around,
    )
    O.engines = ancf.engines(net, line)
    O.dt *= 0.5
    line.haul(4, 10, to=0.15 * around)
    while O.time < 0.4 and line.winch() != "stopped":
        O.step()
    assert (line.winch() == "stopped") == closes
    assert closes or (line.winch() == "strains" and line.length > 0.5 * around)
