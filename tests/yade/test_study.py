"""The net study: places of contact, targets, reactions, laws, and short forms of its scripts."""

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


# ---- places of contact ----------------------------------------------------------------------------


def cableOf(points, **options):
    material("m")
    given = dict(diameter=2e-3, material="m", contactPoints=points, damping=2e-5)
    return ancf.Cable([(0, 0, 0), (0.04, 0, 0)], **{**given, **options})


@pytest.mark.parametrize("contact", ["points", "curve"])
@pytest.mark.parametrize("points", [0, 1, 2, 7, 19, 40])
def test_places_of_a_cable_that_lies_flat(scene, points, contact):
    """As points they stand still, at equal ways; on the curve every piece between them has one. 40 are
    closer than the cable is thick.
    """
    cable = cableOf(points, contact=contact)
    table = plane((0.02, 0, -0.1), (1, 1, 0.099 + 1e-6), material="m")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        O.engines = ancf.engines(cable)
    O.dt = 1e-9
    O.step()
    if points == 0:
        assert not cable.bodies and not O.bodies[table].intrs()
        return
    (element,) = cable.bodies
    (found,) = O.bodies[element].intrs()
    assert (found.id1, found.id2) == (table, element)
    places, n = np.array(found.geom.xi), points + 1
    if contact == "points":
        assert list(found.geom.segment) == list(range(n + 1))
        assert places == pytest.approx(np.arange(n + 1) / n, abs=1e-12)
    else:
        assert list(found.geom.segment) == list(range(n))
        assert ((places * n - np.arange(n) >= 0) & (places * n - np.arange(n) <= 1)).all()
    assert found.geom.gap == pytest.approx([-1e-6] * len(places), abs=1e-9)
    assert np.allclose([list(v) for v in found.geom.normals], (0, 0, 1), atol=1e-12)
    assert found.phys.normalForce[2] == pytest.approx(sum(found.geom.force), rel=1e-12)
    assert found.phys.normalForce[2] > 0


@pytest.mark.parametrize("contact", ["points", "curve"])
@pytest.mark.parametrize("points", [19, 40])
@pytest.mark.parametrize("selfContact", [False, True])
def test_neighbours_never_push_each_other(scene, selfContact, points, contact):
    cable = cableOf(points, elements=2, selfContact=selfContact, contact=contact)
    O.engines = ancf.engines(cable)
    before = np.array(cable.engine.position)
    steps(200)
    assert cable.engine.contacts == 0
    assert np.abs(np.array(cable.engine.position) - before).max() < 1e-15


def foldedNet():
    net = squareNet(6, 0.08, fold=0.2)
    net.addBullets(0.05, 0.01, 1.5, 0.4)
    return net


def test_target_in_the_folded_net_is_told(scene):
    material("cable")
    ball((0.0, 0.01, 0), 0.02, material="cable")
    with pytest.warns(UserWarning, match="folded net"):
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
    if shape == "ball":
        ball(center, 0.006, material="m")
    else:
        plane(center, (4e-3,) * 3, material="m")
    O.engines = ancf.engines(cable)
    with pytest.raises((ValueError, RuntimeError), match="start with an overlap of"):
        ancf.check()


# ---- targets -------------------------------------------------------------------------------------


def angularMomentum(body):
    """Of a body about the origin. NewtonIntegrator keeps the spin of aspherical bodies in angMom, from
    which it derives angVel to second order in the step.
    """
    s = body.state
    spin = array(s.angMom) if body.aspherical else s.inertia[0] * array(s.angVel)
    return spin + np.cross(array(s.pos), s.mass * array(s.vel))


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


@pytest.mark.parametrize("kind", ["sphere", "cube", "brick", "clump"])
def test_momentum_through_a_capture(scene, kind):
    """Linear to 1e-9 and angular to 1e-6, with friction, of a spinning target of any inertia."""
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
        assert np.abs(angular - angular0).max() < 1e-6 * size * 0.1, O.time
    assert touched > 2
    assert body.state.vel.norm() > 0.1


# ---- reactions -----------------------------------------------------------------------------------


def change(engine, f):
    """Change of linear momentum of the cables by f(), over the step [N]."""
    before = array(engine.momentum()[0])
    f()
    return (array(engine.momentum()[0]) - before) / O.dt


@pytest.mark.parametrize("model", ["ancf", "springs"])
@pytest.mark.parametrize(
    "kind", ["fixed", "following", "carried", "carried off its centre", "tied"]
)
def test_reactions_are_the_change_of_momentum(scene, kind, model):
    """Forces on the cable from all that holds it, and its weight, sum up to its change of momentum."""
    material("m", young=1e8, density=1000)
    given = dict(diameter=2e-3, material="m", contactPoints=0, model=model, damping=1e-5)
    more = dict(elements=4) if model == "ancf" else dict(midPoints=3)
    cable = ancf.Cable([(0, 0, 0), (0.3, 0, 0), (0.6, 0, 0)], **given, **more)
    cables = [cable]
    if kind == "fixed":
        cable.fix(0)
        cable.fix(1)
    elif kind == "following":
        winch = ball((0, 0.05, 0), 0.01, material="m")
        O.bodies[winch].state.angVel = Vector3(0, 0, 5.0)
        O.bodies[winch].state.vel = Vector3(0.1, 0, 0)
        cable.follow(0, winch)
    elif kind.startswith("carried"):
        at = (0, 0, 0) if kind == "carried" else (0, 0.03, 0.01)
        number = ball(np.array((0.6, 0, 0)) - at, 0.02, mass=0.05, material="m")
        cable.carry(-1, number, at=at)
    else:
        cables.append(ancf.Cable([(0.3, 0, 0), (0.3, 0.3, 0)], **given, **more))
        cables[1].tie(0, cable, 1)
        cables[1].fix(-1)
        cable.fix(0)
    cable.setVelocity(lambda p: Vector3(0, 3 * p[0], 2 * p[0]))
    O.engines = ancf.engines(*cables, gravity=(0, 0, -9.81))
    engine = cable.engine
    held = {"fixed": [0, 1], "following": [0], "tied": [0]}.get(kind, [2])
    weight = sum(c.mass for c in cables) * np.array([0, 0, -9.81])
    O.step()  # the first is a half step for velocities
    size = 0.0
    for _ in range(300):
        before = array(O.bodies[number].state.vel) if kind.startswith("carried") else 0
        gain = change(engine, O.step)
        force = weight + sum(array(cable.reaction(k)) for k in held)
        if kind == "tied":
            force = force + array(cables[1].reaction(-1))
        size = max(size, np.abs(force).max(), 1)
        if kind.startswith("carried"):
            gained = 0.05 * (array(O.bodies[number].state.vel) - before) / O.dt
            on = 0.05 * np.array([0, 0, -9.81]) - array(cable.reaction(-1))
            assert np.abs(gained - on).max() < 1e-9 * size
        if kind == "carried":  # the engine's momentum counts the body's
            gain = gain - gained
        assert np.abs(gain - force).max() < 1e-9 * size


# ---- laws and scripts ----------------------------------------------------------------------------


def test_laws_drawn_are_the_laws(scene):
    """Figs. 7 and 8: what acts on bodies in YADE, against Table 1 and Eq. 11 written down here."""
    import contact_laws as laws

    hertz, e = laws.given.YOUNG / (1 - laws.given.POISSON**2) / 2, {}
    k = 4 / 3 * math.sqrt(laws.RADIUS) * hertz
    depth, force, e["hertz"] = laws.impact("hertz", 3e-4)
    # Forces are whole multiples of what moves the ball by 2^-53 of its size, so that sums are exact.
    step, inertia = 3e-4 / laws.STEPS, 0.4 * laws.MASS * laws.RADIUS**2
    grain = 2**-53 * math.sqrt(laws.MASS * inertia) / step**2
    assert np.abs(force - k * depth**1.5).max() < grain
    for alpha in (0.08, 0.32):
        depth, force, e[alpha] = laws.impact("nonlinear", 3e-4, impactDamping=alpha)
        rate = np.gradient(depth) * laws.STEPS / 3e-4
        law = k * depth**1.5 * (1 + 1.5 * alpha * rate)
        assert np.abs(force - law)[5:-5].max() < 5e-3 * force.max()
    assert e["hertz"] == pytest.approx(1, abs=1e-3)
    assert e[0.08] == pytest.approx(0.892734, abs=2e-3)
    assert e[0.32] == pytest.approx(0.672262, abs=2e-3)
    depth, force, _ = laws.impact(
        "linear", 1e-3, normalStiffness=5e5, normalExponent=1.0, dashpot=20.0
    )
    rate = np.gradient(depth) * laws.STEPS / 1e-3
    law = 5e5 * depth + 20 * rate
    assert np.abs(force - law)[5:-5].max() < 5e-3 * force.max()

    v0, mu = laws.TRANSITION, (0.5, 0.2)
    u = np.array([-8.0, -1.0, -0.3, 0.5, 1.0, 3.0])
    hollars = np.sign(u) * np.minimum(abs(u), 1) * (mu[1] + 2 * (mu[0] - mu[1]) / (1 + u * u))
    assert np.allclose(laws.drawnBall("hollars", mu, u * v0), hollars, rtol=1e-9)
    assert np.allclose(laws.drawnBox(mu, u * v0), hollars, rtol=1e-4)
    coulomb = mu[1] * np.clip(u, -1, 1)
    assert np.allclose(laws.drawnBall("coulomb", mu, u * v0), coulomb, rtol=1e-9)


def test_penetration_of_the_true_curve(scene):
    """Of points in and around a sphere and a turned box, by hand."""
    import net_study as study

    material("m")
    number = ball((1, 0, 0), 0.5, material="m")
    deep = study.depth([(1, 0, 0.6), (1, 0, 0.5), (1.2, 0, 0)], O.bodies[number], 0.01)
    assert np.allclose(deep, [-0.09, 0.01, 0.31])
    box = utils.box((0, 0, 1), (0.1, 0.2, 0.3), material="m", fixed=True)
    box.state.ori = Quaternion((0, 0, 1), math.pi / 2)  # x and y change places
    number = O.bodies.append(box)
    points = [(0, 0, 1), (0.25, 0, 1), (0, 0.13, 1.34), (0.1, 0.08, 1)]
    deep = study.depth(points, O.bodies[number], 0.01)
    assert np.allclose(deep, [0.11, -0.04, -0.04, 0.03])


def test_springs_without_mid_points_cut_through(scene):
    """Short form of net_study: the capture up to 0.95 s, depths in diameters of the cable."""
    import net_study as study

    bare = study.Run("ball", "springs 0", 1, duration=0.95)
    fine = study.Run("ball", "ANCF 1", 1, duration=0.95)
    assert bare.deepest > 5
    assert fine.deepest < 1.5
    assert max(bare.pointPenetration, fine.pointPenetration) < study.given.ASSUMED["diameter"]
    until = study.BEFORE
    assert study.apart(bare, fine, until) < 0.06  # the study's 6 cm
    assert (fine.nodes, fine.dof, bare.dof) == (49, 651, 147)


def test_net_opens(scene):
    """Its mouth is square then, and its corners have flown freely but for the net, which they must unfold: it has
    a 26th of their mass.
    """
    import deployment

    flight = deployment.Flight(0.05, 1.5, 25)
    after, until, _ = flight.deployment
    open_, stowed = math.sqrt(deployment.OPEN), deployment.given.ASSUMED["fold"]
    corner = (open_ - stowed) * 6 * 0.08 / math.sqrt(2)
    free = corner / (1.5 * math.sin(math.radians(25)))
    assert free < after < 1.3 * free
    assert until == pytest.approx(1.5 * math.cos(math.radians(25)) * after, rel=0.3)
    assert deployment.Flight(0.05, 1.5, 2).open is None  # shot straight ahead it stays narrow


def test_less_error_than_built_in_chains(scene):
    """Sizes so far apart that the wall times cannot change places."""
    import chains

    for builtIn in ("grid", "spheres", "wire"):
        wall, error = chains.hangBuiltIn(builtIn, 32, limit=2.0)
        own, ownError = chains.hangOurs("ancf", 16)
        assert own < wall and max(ownError) < 0.2 * max(error)
        wall, error = chains.swingBuiltIn(builtIn, 32)
        own, ownError = chains.swingOurs("ancf", 8)
        assert own < wall and ownError[0] < 0.5 * error[0]
    _, error = chains.bendBuiltIn("grid", 10, limit=0.4)
    _, ownError = chains.bendOurs(8)
    assert ownError[0] < 0.2 * error[0]
    assert chains.dropBuiltIn("grid", 1, "box")[2] > 10  # falls through without a word
    assert chains.dropOurs("ancf", 4, "box")[2] < 1
