"""Cables on winches that several tests use."""

import pytest

import ancf
from helpers import material, steps
from yade import O


@pytest.fixture
def cordScene():
    """An empty scene with the material 'cord'."""
    O.reset()
    O.trackEnergy = False
    material("cord", young=2e9, density=1000)


def cord(points, parts, damping=2e-5, **options):
    """A cable of springs, 3 mm thick, of the material 'cord'; so many parts between two points."""
    return ancf.Cable(
        points,
        midPoints=parts - 1,
        model="springs",
        diameter=3e-3,
        material="cord",
        damping=damping,
        **options,
    )


def tether(points, stored=5.0, end=0, parts=20, contactPoints=0, drum=None, **options):
    """A cord and the Winch at its end, with so much more on it; drum: arguments of the Winch."""
    cable = cord(points, parts, contactPoints=contactPoints, **options)
    return cable, ancf.Winch(cable, stored, end, **(drum or {}))


def runFor(time):
    steps(round(time / O.dt))
