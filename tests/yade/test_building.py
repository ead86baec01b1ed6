"""Scenes are built in a time and a memory that grow with their size, no faster."""

import os
import subprocess
import sys
import time

import numpy as np
import pytest

import ancf
from helpers import ball, material
from yade import O, Vector3, timing


def built(*structures):
    """Appends them to one engine and takes the first step."""
    for structure in structures:
        structure.append(engine=structures[0].engine)
    O.engines = ancf.engines(*structures)
    O.step()


def cable(n):
    built(ancf.Cable([(0, 0, 0), (0.01 * n, 0, 0)], n, diameter=1e-3, material="cable"))


def polyline(n):
    s = 0.01 * np.arange(n + 1)
    points = np.stack([s, 0.1 * np.sin(s), 0 * s], axis=1)
    built(ancf.Cable(points, diameter=1e-3, material="cable"))


def flatNet(n):
    built(ancf.Net.square(round((n / 2) ** 0.5), 0.08, diameter=1e-3, material="cable"))


def cables(n):
    lines = [[(0, 0.01 * i, 0), (1, 0.01 * i, 0)] for i in range(n // 8)]
    built(*[ancf.Cable(line, 8, diameter=1e-3, material="cable") for line in lines])


def tiedAndCarrying(n):
    """Cables tied in a row, with a body on every eighth knot."""
    parts, previous = [], None
    for i in range(n // 8):
        points = np.stack([0.08 * np.arange(9) + 0.64 * i, np.zeros(9), np.zeros(9)], axis=1)
        part = ancf.Cable(points, diameter=1e-3, material="cable")
        part.append(engine=previous and previous.engine)
        body = ball(points[4], 0.01, mass=0.01, material="cable")
        O.bodies[body].state.vel = Vector3(0, 0, 0.1)
        part.carry(4, body)
        if previous:
            part.tie(0, previous, -1)
        parts, previous = [*parts, part], part
    O.engines = ancf.engines(*parts)
    O.step()


def secondsFor(scene, build, n):
    """Least CPU time of three builds [s]."""
    times = []
    for _ in range(3):
        scene.reset()
        material("cable")
        start = time.process_time()
        build(n)
        times.append(time.process_time() - start)
    return min(times)


@pytest.mark.parametrize(
    "build, n",
    [(cable, 5000), (polyline, 4000), (flatNet, 8000), (cables, 2400), (tiedAndCarrying, 1200)],
)
def test_building_is_linear(scene, build, n):
    small, large = (secondsFor(scene, build, size) for size in (n, 4 * n))
    print(f"{build.__name__}: {small:.3f} s for {n} elements, {large:.3f} s for {4 * n}")
    assert large < 6 * small


MEMORY = """
import sys
import ancf
from yade import O

def resident():
    with open("/proc/self/status") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmRSS"))

O.materials.append(ancf.HollarsMat(label="cable", young=4.456e8, poisson=0.3, density=1440))
n, before = int(sys.argv[1]), resident()
cable = ancf.Cable([(0, 0, 0), (0.01 * n, 0, 0)], n, diameter=1e-3, material="cable")
O.engines = ancf.engines(cable)
for _ in range(20):
    O.step()
print(resident() - before)
"""


def kilobytesOf(elements):
    """Of a cable and its scene, with what the first step loads once."""
    run = subprocess.run(
        [sys.executable, "-c", MEMORY, str(elements)],
        capture_output=True,
        text=True,
        env={**os.environ},
    )
    assert run.returncode == 0, run.stderr
    return float(run.stdout.split()[-1])


def test_an_element_takes_4_kilobytes(scene):
    few, many = 10000, 30000
    kilobytes = (kilobytesOf(many) - kilobytesOf(few)) / (many - few)
    print(f"{kilobytes:.2f} kB an element, with its body")
    assert kilobytes < 4.0


def secondsToSort(scene, normal, along):
    """Time that the collider takes to sort a net once that flies along its plane [s]."""
    scene.reset()
    material("cable")
    net = ancf.Net.square(60, 0.08, diameter=1e-3, material="cable", mass="lumped", normal=normal)
    O.engines = ancf.engines(net)
    O.step()
    net.setVelocity(lambda p: Vector3(*along))
    collider = next(e for e in O.engines if "Collider" in type(e).__name__)
    O.timingEnabled = True
    timing.reset()
    O.run(350, True)
    O.timingEnabled = False
    assert collider.execCount >= 3
    return 1e-9 * collider.execTime / collider.execCount


def test_a_flat_net_is_sorted_as_fast_as_a_tilted_one(scene):
    """All bounds of a flat net are the same along its normal, but for rounding."""
    flat = secondsToSort(scene, (1, 0, 0), (0, 0, 1))
    tilted = secondsToSort(scene, (0.48, 0.6, 0.64), (0.8, 0, -0.6))
    print(f"flat {1e3 * flat:.2f} ms, tilted {1e3 * tilted:.2f} ms")
    assert flat < 4 * tilted
