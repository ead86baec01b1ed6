"""Mass-spring chains: frequencies, slackness, stiffness, what they refuse."""

import math

import numpy as np
import pytest

from helpers import O, Vector3, ancf, array, material, steps

EA = 1e8 * math.pi * 1e-6  # of YOUNG and DIAMETER below [N]
YOUNG, DIAMETER, DENSITY = 1e8, 2e-3, 1000
RHO_A = DENSITY * math.pi * 1e-6  # [kg/m]


def chain(springs=8, length=0.8, strain=0.0, hold=True, **options):
    """A straight chain along x of `length`, whose springs are shorter by `strain` (negative: slack)."""
    material("m", young=YOUNG, density=DENSITY)
    given = dict(
        diameter=DIAMETER, material="m", model="springs", midPoints=springs - 1, contactPoints=0
    )
    cable = ancf.Cable([(0, 0, 0), (length, 0, 0)], **{**given, **options})
    if hold:
        cable.fix(0)
        cable.fix(-1)
    O.engines = ancf.engines(cable)
    if strain:
        cable.engine.length = [length / springs / (1 + strain)] * springs
    return cable


def displace(cable, axis, shape):
    """Moves the inner nodes by `shape` along an axis."""
    engine = cable.engine
    x = np.array(engine.position).reshape(3, -1)
    inner = list(range(2, engine.nNodes))  # 0 and 1 are the knots
    x[axis, inner] += shape
    engine.position = x.ravel().tolist()
    return inner


@pytest.mark.parametrize("mode", [1, 2, 5, 7])
@pytest.mark.parametrize("axis", [0, 1])
def test_frequencies_of_a_pretensioned_chain(scene, mode, axis):
    """w_j = 2 sqrt(c/m) sin(j pi/2N) with c = k along the chain and T0/l across it.

    Leapfrog turns w into sin(w' dt/2) = w dt/2, exactly: x(n+1) - 2 x(n) + x(n-1) = -(w dt)^2 x(n).
    """
    n, length, strain = 8, 0.8, 0.01
    cable = chain(n, length, strain)
    rest = length / n / (1 + strain)
    stiffness = EA / rest if axis == 0 else EA * strain / (length / n)
    exact = 2 * math.sqrt(stiffness / (RHO_A * rest)) * math.sin(mode * math.pi / (2 * n))
    shape = 1e-7 * np.sin(mode * math.pi * np.arange(1, n) / n)
    before = np.array(cable.engine.position).reshape(3, -1)
    inner = displace(cable, axis, shape)
    O.dt = 0.05 / exact
    if O.dt > 0.5 * cable.criticalTimeStep():
        O.dt = 0.5 * cable.criticalTimeStep()
    record = []
    for _ in range(200):
        O.step()
        moved = np.array(cable.engine.position).reshape(3, -1) - before
        record.append(moved[axis, inner] @ shape)
    x = np.array(record)
    second = x[2:] - 2 * x[1:-1] + x[:-2]
    w2 = -(second @ x[1:-1]) / (x[1:-1] @ x[1:-1]) / O.dt**2
    assert math.sqrt(w2) == pytest.approx(exact, rel=1e-6)


def test_slack_chain_carries_exactly_no_force(scene):
    cable = chain(6, 0.6, strain=-0.05, hold=False, damping=1e-5)
    v = np.zeros((3, cable.engine.stride))
    v[:, : cable.nodeCount] = 1e-3 * np.random.default_rng(1).normal(size=(3, cable.nodeCount))
    cable.engine.velocity = v.ravel().tolist()
    O.dt = 1e-5
    steps(500)
    assert np.array_equal(np.array(cable.engine.velocity).reshape(3, -1), v)
    assert cable.tension(0.3) == 0.0
    assert cable.energy()["axial"] == 0.0


@pytest.mark.parametrize("midPoints", [0, 1, 3, 10])
def test_stiffness_is_ea_over_length(scene, midPoints):
    """A spring of length dl has k = EA/dl (Eq. 1 of Shan, Guo, Gill 2019), and so the whole EA/L."""
    material("m", young=YOUNG, density=DENSITY)
    cable = ancf.Cable(
        [(0, 0, 0), (0.5, 0, 0)],
        diameter=DIAMETER,
        material="m",
        model="springs",
        midPoints=midPoints,
        contactPoints=0,
    )
    assert cable.elementCount == midPoints + 1
    cable.fix(0)
    cable.load(-1, (3.0, 0, 0))
    O.engines = ancf.engines(cable)
    cable.relax(1e-12)
    assert cable.knots[1][0] - 0.5 == pytest.approx(3.0 * 0.5 / EA, rel=1e-8)
    assert cable.tension(0.5) == pytest.approx(3.0, rel=1e-8)
    steps(1)
    assert cable.reaction(0)[0] == pytest.approx(-3.0, rel=1e-8)


def test_damper_acts_only_where_the_spring_does(scene):
    eta = 1e-3
    cable = chain(1, 0.5, strain=0.01, hold=False, damping=eta)
    cable.setVelocity(lambda p: Vector3(0.2 * p[0], 0, 0))  # stretches at 0.2/s
    rate = 0.2 * (1 + 0.01)  # of the strain, by unstressed length
    assert cable.tension(0.5) == pytest.approx(EA * (0.01 + eta * rate), rel=1e-9)
    cable.setVelocity(lambda p: Vector3(-20 * p[0], 0, 0))  # the damper alone would push
    assert cable.tension(0.5) == 0.0


def test_momentum_and_energy_of_a_flying_chain(scene):
    def run(factor):
        O.reset()
        cable = chain(8, 0.8, strain=0.02, hold=False)
        cable.setVelocity(lambda p: Vector3(1, 3 * p[0], -2 * p[0]))
        O.dt = factor * cable.criticalTimeStep()
        linear0, angular0 = (array(m) for m in cable.engine.momentum())
        start, worst = None, 0.0
        O.trackEnergy = True
        while O.time < 0.05:
            O.step()
            total = O.energy.total()
            start = start or total
            worst = max(worst, abs(total / start - 1))
        linear, angular = (array(m) for m in cable.engine.momentum())
        O.trackEnergy = False
        mass = cable.mass
        assert np.abs(linear - linear0).max() < 1e-11 * mass * 4
        # the velocity is that of the half step: x(n) x v(n-1/2) does not change with n
        assert np.abs(angular - angular0).max() < 1e-10 * mass * 4
        return worst

    coarse, fine = run(0.4), run(0.2)
    assert coarse < 0.03
    assert fine < 0.5 * coarse


@pytest.mark.parametrize(
    "wrong, error, words",
    [
        (dict(midPoints=-1), ValueError, ("midPoints = -1",)),
        (dict(midPoints=1.5), TypeError, ("midPoints",)),
        (dict(bending=1e-6), ValueError, ("bending", "model='ancf'")),
        (dict(elements=2), ValueError, ("elements", "midPoints")),
    ],
)
def test_bad_input(scene, wrong, error, words):
    material("m")
    with pytest.raises(error) as told:
        ancf.Cable(
            [(0, 0, 0), (1, 0, 0)],
            **{**dict(diameter=1e-3, material="m", model="springs"), **wrong},
        )
    assert all(word in str(told.value) for word in words)


def test_clamp_is_refused(scene):
    material("m")
    cable = ancf.Cable([(0, 0, 0), (1, 0, 0)], diameter=1e-3, material="m", model="springs")
    with pytest.raises(ValueError, match="model='ancf'"):
        cable.clamp(0)


def test_mid_points_belong_to_springs(scene):
    material("m")
    with pytest.raises(ValueError, match="springs"):
        ancf.Cable([(0, 0, 0), (1, 0, 0)], diameter=1e-3, material="m", midPoints=3)
