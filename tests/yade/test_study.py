"""The net study: contact points, targets, reactions, laws, and short forms of its scripts."""

import math
import pathlib
import sys
import warnings

import numpy as np
import pytest

from helpers import O, Vector3, ancf, array, ball, material, plane, runTo, squareNet, steps
from yade import Quaternion, utils

SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "yade-scripts"
sys.path.insert(0, str(SCRIPTS))


# ---- contact points ------------------------------------------------------------------------------


def cableOf(points, **options):
    material("m")
    given = dict(diameter=2e-3, material="m", contactPoints=points, damping=2e-5)
    return ancf.Cable([(0, 0, 0), (0.04, 0, 0)], **{**given, **options})


@pytest.mark.parametrize("points", [0, 1, 2, 7, 19])
def test_any_number_of_contact_points(scene, points):
    """19 points inside 0.04 m and two at its ends are 2 mm apart: a chain of touching spheres."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        cable = cableOf(points)
    cable.append()
    places = np.array([list(O.bodies[i].state.pos) for i in cable.bodies])
    assert len(places) == (points + 2 if points else 0)
    if points:
        apart = np.diff(np.sort(places[:, 0]))
        assert np.allclose(apart, 0.04 / (points + 1))
    if points == 19:
        assert np.allclose(apart, 2e-3)


@pytest.mark.parametrize("selfContact", [False, True])
def test_neighbours_never_push_each_other(scene, selfContact):
    cable = cableOf(19, elements=2, selfContact=selfContact)
    O.engines = ancf.engines(cable)
    before = np.array(cable.engine.position)
    steps(200)
    assert cable.engine.contacts == 0
    assert np.abs(np.array(cable.engine.position) - before).max() < 1e-15


def test_more_points_than_fit_are_told(scene):
    with pytest.warns(UserWarning, match="contactPoints.*19 fit inside"):
        cableOf(20)
    O.reset()
    material("m")
    with pytest.warns(UserWarning, match="midPoints"):
        ancf.Cable(
            [(0, 0, 0), (0.04, 0, 0)], diameter=2e-3, material="m", model="springs", midPoints=25
        )


def foldedNet():
    net = squareNet(6, 0.08, fold=0.2)
    net.addBullets(0.05, 0.01, 1.5, 0.4)
    return net


def test_target_in_the_folded_net_is_told(scene):
    material("cable")
    ball((0.0, 0.01, 0), 0.02, material="cable")
    with pytest.raises(ValueError, match="folded net"):
        ancf.engines(foldedNet())


def test_target_before_the_folded_net_is_fine(scene):
    material("cable")
    ball((0.4, 0, 0), 0.08, material="cable")
    net = foldedNet()
    O.engines = ancf.engines(net)
    ancf.check()


@pytest.mark.parametrize("shape", ["ball", "box"])
def test_cable_through_a_body_is_told(scene, shape):
    cable = cableOf(3)
    center = (0.02, 0, 0)
    ball(center, 0.006, material="m") if shape == "ball" else plane(
        center, (4e-3,) * 3, material="m"
    )
    O.engines = ancf.engines(cable)
    with pytest.raises((ValueError, RuntimeError), match="inside it"):
        ancf.check()


# ---- targets -------------------------------------------------------------------------------------


def angularMomentum(body):
    """Of a body about the origin, spin by its principal axes."""
    s = body.state
    local = s.ori.conjugate() * s.angVel
    spin = s.ori * Vector3(*(s.inertia[i] * local[i] for i in range(3)))
    return array(spin) + np.cross(array(s.pos), s.mass * array(s.vel))


def target(kind):
    """A free target of 0.3 kg that spins."""
    center, spin = Vector3(0.07, 0.004, 0.002), Vector3(3.0, -2.0, 4.0)
    if kind == "sphere":
        number = ball(center, 0.04, mass=0.3, material="cable")
    elif kind in ("cube", "brick"):
        half = np.array([0.03, 0.03, 0.03] if kind == "cube" else [0.02, 0.03, 0.04])
        body = utils.box(center, tuple(half), material="cable", fixed=False)
        body.dynamic, body.state.blockedDOFs = True, ""
        body.state.mass = 0.3
        square = 4 * half**2
        body.state.inertia = Vector3(*(0.3 / 12 * (square.sum() - square)))
        body.state.ori = Quaternion((1, 2, 3), 0.4)
        body.aspherical = kind == "brick"
        number = O.bodies.append(body)
    else:
        shift = Vector3(0, 0.02, 0.005)
        balls = [utils.sphere(center + s * shift, 0.025, material="cable") for s in (-1, 1)]
        number, _ = O.bodies.appendClumped(balls)
    O.bodies[number].state.angVel = spin
    if O.bodies[number].aspherical:  # NewtonIntegrator turns by it
        s = O.bodies[number].state
        local = s.ori.conjugate() * spin
        s.angMom = s.ori * Vector3(*(s.inertia[i] * local[i] for i in range(3)))
    return number


def capture(kind):
    material("cable", impactDamping=0.2)
    number = target(kind)
    net = squareNet(2, 0.06, fold=0.8, damping=5e-5, center=(-0.04, 0, 0), mass="lumped")
    net.addBullets(0.05, 0.008, 1.5, math.radians(15))
    O.engines = ancf.engines(net)
    return net, number


@pytest.mark.parametrize(
    "kind, bound", [("sphere", 1e-6), ("cube", 1e-6), ("clump", 1e-2), ("brick", 1e-2)]
)
def test_momentum_through_a_capture(scene, kind, bound):
    """Linear to 1e-9 and angular to 1e-6. Where the moments of inertia differ, NewtonIntegrator's own
    turning of a body is what limits the angular momentum, with no cable at all: see below.
    """
    net, number = capture(kind)
    body = O.bodies[number]

    def momenta():
        linear, angular = (array(v) for v in net.engine.momentum())
        for i in net.bullets:
            state = O.bodies[i].state
            angular = angular + state.inertia[0] * array(state.angVel)
        linear = linear + body.state.mass * array(body.state.vel)
        return linear, angular + angularMomentum(body)

    linear0, angular0 = momenta()
    size, touched = 4 * 0.05 * 1.5, 0
    while O.time < 0.15:
        runTo(O.time + 0.005)
        touched = max(touched, net.engine.contacts)
        linear, angular = momenta()
        assert np.abs(linear - linear0).max() < 1e-9 * size
        assert np.abs(angular - angular0).max() < bound * size * 0.1, O.time
    assert touched > 2
    assert body.state.vel.norm() > 0.1
