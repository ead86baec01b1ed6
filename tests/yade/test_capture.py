"""The capture of a free ball, whole: momenta, energy, and that what is skipped or saved changes no bit."""

import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest

from helpers import O, Vector3, ancf, array, momenta
from yade import wrapper

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "yade-scripts"))

import ball_capture  # noqa: E402

MASS = 0.5  # of the ball [kg]
FOLD = 0.65  # of the net: it crumples before it meets the ball, and wraps it as a heap that is full of contacts


def capture(friction=True):
    """The study's net, self-contact on, and a ball that is free. Returns the net and the ball's
    id.
    """
    net, ball = ball_capture.build(np.zeros(4), fold=FOLD)
    state, radius = O.bodies[ball].state, ball_capture.BALL_RADIUS
    state.mass, state.blockedDOFs = MASS, ""
    state.inertia = 0.4 * MASS * radius**2 * Vector3(1, 1, 1)
    if not friction:
        net.engine.friction = "none"
    return net, ball


def run(net, until):
    """Runs to a time; how many steps had contact, of those that were looked at."""
    touched = 0
    while O.time < until - 0.5 * O.dt:
        for _ in range(min(20, round((until - O.time) / O.dt))):
            O.step()
        touched += net.engine.contacts > 0
    return touched


def scales(net):
    """Sums of what the bullets have at the start: linear [N s] and, about their centre, angular
    momentum without its sign [N m s].
    """
    states = [O.bodies[i].state for i in net.bullets]
    center = sum((array(s.pos) for s in states), np.zeros(3)) / len(states)
    linear = sum(s.mass * s.vel.norm() for s in states)
    angular = sum(s.mass * s.vel.norm() * np.linalg.norm(array(s.pos) - center) for s in states)
    return linear, angular


def balance(friction, part=1.0, inside=1):
    """Worst of a whole capture: linear and angular momentum off, as parts of their scales, energy
    off as part of all. part: of the step that engines() set; inside: steps of the cable in O.dt.
    """
    O.reset()
    net, ball = capture(friction)
    net.engine.substeps = inside
    O.dt *= part * inside
    linear, angular = scales(net)
    bodies = {ball: False, **{i: True for i in net.bullets}}
    O.trackEnergy = True
    O.step()
    start, energy = momenta(net.engine, bodies), O.energy.total()
    worst, off, touched = np.zeros(2), 0.0, 0
    while O.time < ball_capture.DURATION:
        touched += run(net, O.time + 0.01)
        now = list(momenta(net.engine, bodies))
        now[1] -= array(net.engine.twistLeft)
        worst = np.maximum(worst, [np.abs(a - b).max() for a, b in zip(now, start)])
        off = max(off, abs(O.energy.total() / energy - 1))
    O.trackEnergy = False
    worst /= [linear, angular]
    left = np.abs(array(net.engine.twistLeft)).max() / angular
    print(f"linear {worst[0]:.1e}, angular {worst[1]:.1e}, twist {left:.1e}, energy {off:.1e}")
    assert touched > 100 and O.bodies[ball].state.vel.norm() > 0.1  # it was caught, or hit at least
    return worst[0], worst[1], off, left


@pytest.fixture(scope="module")
def smooth():
    return balance(friction=False)


@pytest.fixture(scope="module")
def rough():
    return balance(friction=True)


def test_linear_momentum_of_a_whole_capture(smooth, rough):
    assert max(smooth[0], rough[0]) < 1e-12


def test_angular_momentum_of_a_whole_capture(smooth, rough):
    """Couples on slopes balance friction between two cables; what would twist them is told."""
    assert max(smooth[1], rough[1]) < 1e-9
    assert smooth[3] == 0 < rough[3] < 1e-5


def test_energy_of_a_whole_capture(rough):
    assert rough[2] < 2e-3


def test_steps_of_the_cable_inside_one_of_yade():
    """Contacts are found every third step and act in each: all is kept as well."""
    linear, angular, energy, left = balance(friction=True, inside=3)
    assert linear < 1e-12 and angular < 1e-9 and energy < 4e-3 and left < 1e-5


def test_cables_that_fight_each_other_do_not_gain():
    """Two slack elements, nearly parallel, whose segments turn each other in between two searches:
    what was looked for in the direction of the hit alone gained 71 % here.
    """
    assert balance(friction=False, inside=3)[2] < 4e-3


def test_energy_without_friction_is_of_second_order(smooth):
    """Two to three times as much is in motion then, and leapfrog's own error with it."""
    assert smooth[2] < 4e-3
    assert balance(friction=False, part=0.5)[2] < 0.6 * smooth[2]


# ---- the sequence of the study -------------------------------------------------------------------


@pytest.mark.parametrize("number", [1, 7])
def test_stowed_net_opens_meets_embraces_and_recoils(scene, number):
    """Shan, Guo and Gill 2019 show it open at 0.7 s at the latest, around its target at 1.1 s. Two of the perturbed
    runs of ball_capture --runs 8, the one that embraces the ball for the shortest time among them.
    """
    duration = ball_capture.DURATION
    run = ball_capture.Run(ball_capture.nudges(number), False, duration, "capture").run()
    stages, row = run.capture, run.capture.row()
    assert 0.4 < stages.open < stages.contact < 0.7
    assert row["mouth_open_m2"] > 0.9 * (ball_capture.MESHES * ball_capture.MESH_LENGTH) ** 2
    assert run.embraced and stages.embraced[0] < 1.1 < stages.embraced[1]
    assert row["mouth_tightest"] < 0.1 and row["enclosed_most"] > 0.9
    assert stages.recoil < 1.5 and stages.lock is None  # nothing holds it together


# ---- no bit is changed ---------------------------------------------------------------------------


def state(net):
    """Everything that moves, without rounding; bodies of elements only show where their cables
    were.
    """
    solid = [b for b in O.bodies if b.id not in set(net.bodies)]
    bodies = [
        [list(x) for x in (b.state.pos, b.state.vel, b.state.ori, b.state.angVel)] for b in solid
    ]
    return repr((O.iter, list(net.engine.position), list(net.engine.velocity), bodies))


def captured(change=None, until=0.8):
    """State after a capture; change(net): before its first step."""
    net, _ = capture()
    if change:
        change(net)
    O.run(round(until / O.dt), True)
    return state(net), net.engine.maxPenetration


@pytest.fixture(scope="module")
def reference():
    O.reset()
    O.trackEnergy = False
    return captured()


def awake(net):
    net.engine.sleep = False


def plainNewton(net):
    newton = wrapper.NewtonIntegrator(damping=0, gravity=O.engines[-1].gravity)
    O.engines = list(O.engines)[:-1] + [newton]


@pytest.mark.parametrize("change", [awake, plainNewton])
def test_skipping_changes_no_bit(scene, reference, change):
    assert reference[1] > 0  # something touched
    assert captured(change)[0] == reference[0]


def test_elements_sleep_in_flight_and_wake(scene):
    net, _ = capture()
    O.run(round(0.1 / O.dt), True)
    flying = net.engine.asleep
    least = flying
    while O.time < 0.8:
        run(net, O.time + 0.01)
        least = min(least, net.engine.asleep)
    print(f"asleep: {flying} in flight, {least} at least, of {net.elementCount}")
    assert flying > 0.9 * net.elementCount > least


def test_saved_in_contact_goes_on_bit_for_bit(scene, tmp_path):
    net, _ = capture()
    rng = np.random.default_rng(10)
    O.run(round(rng.uniform(0.42, 0.7) / O.dt), True)
    for i in range(2):
        while net.engine.contacts < 2:
            O.step()
        for _ in range(int(rng.integers(1, 30))):
            O.step()
        name = str(tmp_path / f"scene{i}.yade.gz")
        O.save(name)
        O.run(2000, True)
        there = state(net)
        O.load(name)
        O.run(2000, True)
        assert state(net) == there


SCRIPT = """
import sys
sys.path.insert(0, {folder!r})
import test_capture
from yade import O
text, deep = test_capture.captured()
assert deep > 0
with open("state.txt", "w") as f:
    f.write(text)
"""


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_threads_change_no_bit(reference, threads, tmp_path):
    (tmp_path / "scene.py").write_text(SCRIPT.format(folder=str(pathlib.Path(__file__).parent)))
    env = {k: v for k, v in os.environ.items() if k != "OMP_NUM_THREADS"}
    env.setdefault("PYTHONPATH", str(ROOT / "build" / "python"))
    command = ["yade", f"-j{threads}", "-n", "-x", "scene.py"]
    done = subprocess.run(
        command, cwd=tmp_path, env=env, capture_output=True, text=True, timeout=300
    )
    assert (tmp_path / "state.txt").exists(), done.stdout + done.stderr
    assert (tmp_path / "state.txt").read_text() == reference[0]
