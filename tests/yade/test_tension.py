"""Tension along cables against statics, where the strain of the cubic itself is far off."""

import math

import numpy as np
import pytest
from helpers import array, material, steps

import ancf
from yade import O, Vector3


def hanging(elements, slack, diameter, young):
    material("cable", young=young, density=7800)
    cable = ancf.Cable(
        [(0, 0, 0), (10, 0, 2)],
        elements,
        slack=slack,
        diameter=diameter,
        material="cable",
        contactPoints=0,
    )
    cable.fix(0)
    cable.fix(1)
    O.engines = ancf.engines(cable, gravity=(0, 0, -9.81))
    cable.relax()
    return cable


@pytest.mark.parametrize("elements, within", [(4, 1e-4), (16, 2e-5), (32, 1e-5)])
def test_stiff_cable_at_rest(scene, elements, within):
    """What is cut off at a place is in balance: the force there is the reaction and the weight."""
    cable = hanging(elements, 0.02, 0.01, 2.1e11)
    weight = cable.section.rhoA * 9.81
    s, curve = cable._span.stations(32), cable.curve(32)
    along = np.gradient(curve, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    force = -array(cable.reaction(0)) + np.outer(s * cable.length, [0, 0, weight])
    true = (force * along).sum(axis=1)
    inner = slice(1, -1)  # where np.gradient is central
    assert np.abs(cable.tensions(32) - true)[inner].max() < within * true.max()
    local = np.array([cable.section.ea * cable.strain(x) for x in s])
    assert elements == 32 or np.abs(local - true).max() > true.max()  # what it is better than


@pytest.mark.parametrize("elements", [1, 5])
def test_reaction_before_the_first_step(scene, elements):
    cable = hanging(elements, None, 0.005, 1e9)
    weight = cable.section.rhoA * 9.81 * cable.length
    held = array(cable.reaction(0)) + array(cable.reaction(1))
    assert held == pytest.approx([0, 0, weight], abs=1e-6 * weight)
    steps(1)
    again = array(cable.reaction(0)) + array(cable.reaction(1))
    assert again == pytest.approx(held, abs=1e-6 * weight)


def test_weight_in_the_middle(scene):
    """The tension jumps where something hangs."""
    material("cable", young=1e9, density=1.0)
    cable = ancf.Cable(
        [(0, 0, 0), (0, 0, -1), (0, 0, -2)],
        3,
        diameter=2e-3,
        material="cable",
        contactPoints=0,
        bending=0.0,
    )
    cable.fix(0)
    cable.load(1, (0, 0, -30))
    cable.load(2, (0, 0, -10))
    O.engines = ancf.engines(cable)
    cable.relax()
    assert [cable.tension(s) for s in (0, 0.3, 0.499)] == pytest.approx([40] * 3, rel=1e-6)
    assert [cable.tension(s) for s in (0.501, 0.8, 1)] == pytest.approx([10] * 3, rel=1e-6)


def test_spinning_cable(scene):
    """T = rho A w^2 (R^2 - s^2)/2 of a stiff cable that turns about its end."""
    material("cable", young=1e11, density=1000)
    cable = ancf.Cable([(0, 0, 0), (1, 0, 0)], 20, diameter=5e-3, material="cable", contactPoints=0)
    cable.fix(0)
    O.engines = ancf.engines(cable)
    cable.setVelocity(lambda p: Vector3(0, 0, 10).cross(p))
    mean, count = np.zeros(81), 0
    for _ in range(2000):
        O.step()
        mean += cable.tensions(4)
        count += 1
    s = cable._span.stations(4)
    true = cable.section.rhoA * 100 * (1 - s**2) / 2
    assert np.abs(mean / count - true).max() < 0.01 * true.max()
    assert math.isclose(true.max(), 50 * cable.mass, rel_tol=1e-12)


@pytest.mark.parametrize("elements", [1, 2])
def test_hanging_straight_down(scene, elements):
    """Its own weight, from nothing at the end to all of it at the top."""
    material("cable", young=1e8, density=1000)
    cable = ancf.Cable(
        [(0, 0, 0), (0, 0, -1)], elements, diameter=5e-3, material="cable", contactPoints=0
    )
    cable.fix(0)
    O.engines = ancf.engines(cable, gravity=(0, 0, -9.81))
    cable.relax()
    s = cable._span.stations(8)
    weight = 9.81 * cable.mass
    assert cable.tensions(8) == pytest.approx(weight * (1 - s), abs=1e-4 * weight)
