"""Saving, loading and the number of threads change no bit."""

import math
import os
import pathlib
import subprocess

import numpy as np
import pytest

from helpers import O, ancf, ball, material, squareNet, steps

ROOT = pathlib.Path(__file__).resolve().parents[2]


def capture():
    material("cable")
    ball((0.05, 0.004, 0.002), 0.04, material="cable")
    net = squareNet(2, 0.06, fold=0.8, mass="lumped", damping=5e-5, center=(-0.01, 0, 0))
    net.addBullets(0.05, 0.008, 1.5, math.radians(15))
    O.engines = ancf.engines(net)
    while net.engine.contacts < 3 and O.time < 0.1:
        steps(50)
    assert net.engine.contacts >= 3
    return net


def state(net):
    """Everything that moves, as text without rounding. The bodies of elements do not: they stand where
    their cable was when the collider last ran, which it does after each O.load.
    """
    moving = [b for b in O.bodies if not isinstance(b.shape, ancf.CableElement)]
    bodies = [
        [list(v) for v in (b.state.pos, b.state.vel, b.state.ori, b.state.angVel)] for b in moving
    ]
    return repr((O.iter, O.time, list(net.engine.position), list(net.engine.velocity), bodies))


@pytest.mark.parametrize("name", ["scene.xml", "scene.xml.gz", "scene.yade", "scene.yade.bz2"])
def test_saved_scene_goes_on_bit_for_bit(scene, tmp_path, name):
    net = capture()
    touching = net.engine.contacts
    O.save(str(tmp_path / name))
    steps(500)
    there = state(net)
    O.load(str(tmp_path / name))
    assert net.engine.contacts == touching >= 3 and net.engine in list(O.engines)
    steps(500)
    assert state(net) == there


def test_saved_in_memory_goes_on_bit_for_bit(scene):
    net = capture()
    O.saveTmp()
    steps(500)
    there = state(net)
    O.loadTmp()
    steps(500)
    assert state(net) == there


@pytest.mark.parametrize("integrator", ["leapfrog", "implicit"])
def test_tracked_energies_go_on_bit_for_bit(scene, integrator):
    """What a step has not counted yet (damping, lift) is counted by the first one after loading."""

    def energies():
        return repr(sorted(O.energy.items()))

    material("cable")
    net = squareNet(2, 0.06, mass="lumped", damping=5e-5, contactPoints=0)
    net.setVelocity(lambda p: (30 * p[1], 0, 0))
    net.carry(0, ball(net.knots[0], 0.01, mass=0.02, mask=0))
    O.engines = ancf.engines(net, gravity=(0, 0, -9.81), integrator=integrator)
    O.trackEnergy = True
    steps(20)
    O.saveTmp()
    steps(20)
    there = energies()
    O.loadTmp()
    steps(20)
    assert energies() == there


def test_reload_from_the_start(scene):
    material("cable")
    net = squareNet(2, 0.06, fold=0.8)
    net.addBullets(0.05, 0.008, 1.5, math.radians(15))
    O.engines = ancf.engines(net)
    O.saveTmp()
    steps(300)
    there = state(net)
    O.reload()
    steps(300)
    assert state(net) == there


SCRIPT = """
import sys
sys.path.insert(0, {folder!r})
import math, ancf
from helpers import O, ball, material, squareNet, steps
material("cable")
ball((0.05, 0.004, 0.002), 0.04, mass={mass}, material="cable")
net = squareNet(2, 0.06, fold=0.8, mass="lumped", damping=5e-5, center=(-0.01, 0, 0))
net.addBullets(0.05, 0.008, 1.5, math.radians(15))
O.engines = ancf.engines(net)
touched = 0
while O.time < 0.05:
    steps(50)
    touched = max(touched, net.engine.contacts)
assert touched >= 3, touched
with open("state.txt", "w") as f:
    f.write(" ".join(x.hex() for x in net.engine.position))
"""


# Long enough for the cable's own step to be shared among threads.
LONG = """
import sys
sys.path.insert(0, {folder!r})
import math, ancf
from helpers import O, material, steps
material("cable")
cable = ancf.Cable(
    [(0, 0, 0), (50, 0, 0)], elements=5000, diameter=1e-3, material="cable", mass="lumped",
    damping=1e-6, contactPoints=0,
)
cable.setVelocity(lambda p: (0, math.sin(p[0]), math.cos(3 * p[0])))
cable.fix(0)
O.engines = ancf.engines(cable, gravity=(0, 0, -9.81))
steps(100)
assert abs(cable.point(0.3)[1]) > 1e-6
with open("state.txt", "w") as f:
    f.write(" ".join(x.hex() for x in cable.engine.position))
"""


def threads(n, mass, tmp_path, script=SCRIPT):
    """Positions after a capture in `yade -j n`."""
    folder = tmp_path / f"j{n}"
    folder.mkdir()
    (folder / "scene.py").write_text(
        script.format(folder=str(pathlib.Path(__file__).parent), mass=mass)
    )
    env = {k: v for k, v in os.environ.items() if k != "OMP_NUM_THREADS"}
    env.setdefault("PYTHONPATH", str(ROOT / "build" / "python"))
    command = ["yade", f"-j{n}", "-n", "-x", "scene.py"]
    done = subprocess.run(command, cwd=folder, env=env, capture_output=True, text=True, timeout=300)
    assert (folder / "state.txt").exists(), done.stdout + done.stderr
    return [float.fromhex(x) for x in (folder / "state.txt").read_text().split()]


def test_threads_change_no_bit(tmp_path):
    assert threads(1, None, tmp_path) == threads(2, None, tmp_path)


def test_threads_of_a_long_cable_change_no_bit(tmp_path):
    assert threads(1, None, tmp_path, LONG) == threads(2, None, tmp_path, LONG)


def test_threads_with_a_free_ball(tmp_path):
    one, two = (np.array(threads(n, 0.3, tmp_path)) for n in (1, 2))
    assert np.abs(one - two).max() < 1e-9
