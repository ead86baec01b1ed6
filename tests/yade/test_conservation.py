"""Momentum and energy of nets, bullets and balls in YADE."""

import math

import numpy as np
import pytest

from helpers import O, Vector3, ancf, array, ball, material, momenta, runTo, squareNet


def capture(gravity=(0, 0, 0), damping=5e-5):
    """A small net with bullets flies into a free ball."""
    material("cable", impactDamping=0.2)
    target = ball((0.06, 0.004, 0.002), 0.04, mass=0.3, material="cable")
    net = squareNet(2, 0.06, fold=0.8, damping=damping, center=(-0.01, 0, 0))
    net.addBullets(0.05, 0.008, 1.5, math.radians(15))
    O.engines = ancf.engines(net, gravity=gravity)
    return net, target


def test_momentum_through_a_capture(scene):
    net, target = capture()
    bodies = {target: False, **{b: True for b in net.bullets}}
    linear0, angular0 = momenta(net.engine, bodies)
    size = 4 * 0.05 * 1.5
    touched = 0
    while O.time < 0.15:
        runTo(O.time + 0.005)
        touched = max(touched, net.engine.contacts)
        linear, angular = momenta(net.engine, bodies)
        assert np.abs(linear - linear0).max() < 1e-9 * size
        assert np.abs(angular - angular0).max() < 1e-6 * size * 0.1
    assert touched > 2
    state = O.bodies[target].state
    assert state.vel.norm() > 0.1 and state.angVel.norm() > 1e-3  # it was hit, and rubbed


def test_energy_error_of_a_smooth_motion_is_of_second_order(scene):
    """A net that swings and never goes slack or jerks: a quarter at half the step."""

    def drift(factor):
        O.reset()
        O.trackEnergy = True
        material("cable")
        net = squareNet(2, 0.08)
        net.setVelocity(
            lambda p: Vector3(
                2 * math.sin(20 * p[1]) * math.cos(10 * p[2]),
                0.3 * math.cos(20 * p[2]),
                0.2 * math.sin(15 * p[1]),
            )
        )
        O.engines = ancf.engines(net, substeps=1)
        O.dt = factor * net.criticalTimeStep()
        O.step()
        start, worst = O.energy.total(), 0.0
        while O.time < 5e-3:
            O.step()
            worst = max(worst, abs(O.energy.total() / start - 1))
        O.trackEnergy = False
        return worst

    found = [drift(factor) for factor in (0.8, 0.4, 0.2)]
    assert found[0] < 3e-7
    assert np.divide(found[1:], found[:-1]) == pytest.approx([0.25, 0.25], rel=0.01)


def test_energy_of_a_free_net(scene):
    """Edges that snap taut leave their mark, of first order in the step."""

    def drift(factor):
        O.reset()
        O.trackEnergy = True
        material("cable")
        net = squareNet(2, 0.08, fold=0.8)
        net.addBullets(0.05, 0.008, 1.5, math.radians(25))
        O.engines = ancf.engines(net, substeps=1)
        O.dt = factor * net.criticalTimeStep()
        O.step()
        start, worst = O.energy.total(), 0.0
        while O.time < 0.12:  # taut from 0.05 s on
            O.step()
            worst = max(worst, abs(O.energy.total() / start - 1))
        O.trackEnergy = False
        return worst, start

    coarse, total = drift(0.5)
    fine, _ = drift(0.25)
    assert total == pytest.approx(0.5 * 4 * 0.05 * 1.5**2, rel=5e-3)  # and the corners' knots
    assert coarse < 1e-4
    assert fine < 0.6 * coarse


def test_energy_with_damping_and_contact_balances(scene):
    O.trackEnergy = True
    net, target = capture()
    O.step()
    start = O.energy.total()
    while O.time < 0.12:
        runTo(O.time + 0.01)
    items = dict(O.energy.items())
    assert O.energy.total() == pytest.approx(start, rel=1e-2), items
    O.trackEnergy = False


def test_momentum_under_gravity(scene):
    """Falling freely, the whole gains m g t and nothing else."""
    net, target = capture(gravity=(0, 0, -9.81))
    bodies = {target: False, **{b: True for b in net.bullets}}
    runTo(0.01)
    before, start = momenta(net.engine, bodies)[0], O.time
    runTo(0.06)
    gained = momenta(net.engine, bodies)[0] - before
    mass = net.mass + 4 * 0.05 + 0.3
    assert np.abs(gained[:2]).max() < 1e-9
    assert gained[2] == pytest.approx(-mass * 9.81 * (O.time - start), rel=1e-6)
    assert array(net.knots).shape == (9, 3)
