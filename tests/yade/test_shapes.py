"""Surfaces that are built of others: a rope slides down a tilted box, and along the top of a cylinder at a slope, as a block does."""

import math

import ancf
import pytest
from ancf import pulleys
from yade import O, Quaternion, Vector3, geom, utils

SLOPE, MU, G, RADIUS, DIAMETER = math.radians(30), 0.3, 9.81, 0.1, 0.01
TILT = Quaternion(Vector3(0, 1, 0), SLOPE)  # turns the x axis downhill
UP, DOWNHILL = TILT * Vector3(0, 0, 1), TILT * Vector3(1, 0, 0)


def box():
    top = UP * RADIUS
    tilted = utils.box(top - UP * 0.1, (2, 1, 0.1), orientation=TILT, fixed=True, material="rope")
    O.bodies.append(tilted)


def facets():
    toAxis = TILT * Quaternion(Vector3(0, 1, 0), math.pi / 2)
    O.bodies.append(
        geom.facetCylinder(
            (0, 0, 0),
            RADIUS,
            2,
            orientation=toAxis,
            segmentsNumber=36,
            wallMask=4,
            material="rope",
            fixed=True,
        )
    )


def sheave():
    pulleys.sheave((0, 0, 0), RADIUS, axis=DOWNHILL, width=2, profile="flat", material="rope")


@pytest.mark.parametrize("surface", [box, facets, sheave])
def test_slides_as_a_block(surface):
    O.reset()
    O.materials.append(
        ancf.HollarsMat(
            label="rope", young=1e8, density=1150, staticFriction=MU, kineticFriction=MU
        )
    )
    surface()
    start = UP * (RADIUS + DIAMETER / 2)
    rope = ancf.Cable(
        [start, start + DOWNHILL * 0.5], 8, diameter=DIAMETER, material="rope", damping=1e-5
    )
    O.engines = pulleys.engines(rope, gravity=(0, 0, -G))
    O.run(round(0.3 / O.dt), True)
    speed = sum(rope.velocity((i + 0.5) / 32).dot(DOWNHILL) for i in range(32)) / 32
    assert speed / O.time == pytest.approx(G * (math.sin(SLOPE) - MU * math.cos(SLOPE)), rel=2e-3)
