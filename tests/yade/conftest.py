"""Scenes run inside the process of pytest: every test starts from an empty one."""

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
