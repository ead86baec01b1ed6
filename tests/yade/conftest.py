"""Scenes run inside the process of pytest: every test starts from an empty one."""

import math
import os
import pathlib
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
os.environ.setdefault("OMP_NUM_THREADS", "1")
if "PYTHONPATH" not in os.environ:
    sys.path.insert(0, str(ROOT / "build" / "python"))


@pytest.fixture
def scene():
    """YADE's O, empty."""
    import ancf  # noqa: F401  loads the classes before the first scene is made
    from yade import O

    O.reset()
    O.trackEnergy = False
    yield O
    O.reset()


@pytest.fixture
def net(scene):
    """A net with bullets, a ball and a box, after some steps."""
    import ancf
    from helpers import ball, material, plane, squareNet, steps

    material("cable")
    target = ball((0.3, 0, 0), 0.05, material="cable")
    box = plane((0.3, 0.2, 0), (0.05, 0.04, 0.03), material="cable")
    made = squareNet(2, 0.06, fold=0.8, mass="lumped")
    made.addBullets(0.05, 0.008, 1.5, math.radians(15))
    scene.engines = ancf.engines(made)
    steps(20)
    return made, target, box
