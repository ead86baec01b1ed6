"""How coefficients of friction of two materials mix: what slides is slowed by mu g."""

import numpy as np
import pytest
from helpers import ball, material, plane, steps

import ancf
from yade import O, Vector3

G = 9.81
RULES = {"min": 0.2, "max": 0.5, "mean": 0.35, "pair": 0.4}


def materials():
    """One with mu = 0.2 and one with 0.5."""
    for label, mu in (("low", 0.2), ("high", 0.5)):
        material(
            label, young=1e7, density=1000, staticFriction=mu, kineticFriction=mu, impactDamping=50
        )


def mixing(rule):
    if rule == "pair":
        return dict(frictionPairs={("high", "low"): (0.4, 0.4)})
    return dict(frictionRule=rule)


def rope(**options):
    given = dict(diameter=1e-2, material="low", bending=0, label="rope")
    return ancf.Cable([(-0.2, 0, 0), (0.2, 0, 0)], 4, **{**given, **options})


def slowing(speed, time=0.02):
    """Mean deceleration [m/s2]."""
    steps(round(0.03 / O.dt))
    before, start = speed(), O.time
    steps(round(time / O.dt))
    return (before - speed()) / (O.time - start)


def slider():
    """A ball that does not turn, on a plane: its number."""
    far = rope(contactPoints=0)  # there for its engine alone
    far.fix(0)
    number = ball((0, 0, 0.01 - 1e-6), 0.01, material="low")
    O.bodies[number].state.blockedDOFs = "XYZ"
    O.bodies[number].state.vel = Vector3(1, 0, 0)
    plane((0, 0, -0.1), (1, 1, 0.1), material="high")
    return far, number


@pytest.mark.parametrize("rule", RULES)
def test_block_on_a_plane(scene, rule):
    materials()
    far, number = slider()
    O.engines = ancf.engines(far, gravity=(0, 0, -G), contact=mixing(rule))
    a = slowing(lambda: O.bodies[number].state.vel[0])
    assert a == pytest.approx(RULES[rule] * G, rel=5e-3)


@pytest.mark.parametrize("rule", RULES)
def test_cable_on_a_plane(scene, rule):
    materials()
    plane((0, 0, -0.105), (1, 1, 0.1), material="high")
    c = rope()
    O.engines = ancf.engines(c, gravity=(0, 0, -G), contact=mixing(rule))
    c.relax(1e-6)
    c.setVelocity(lambda p: Vector3(0, 1, 0))
    a = slowing(lambda: c.engine.momentum()[0][1] / c.mass)
    assert a == pytest.approx(RULES[rule] * G, rel=5e-3)


@pytest.mark.parametrize("rule", RULES)
def test_cable_on_cables(scene, rule):
    """One that slides over two taut ones."""
    materials()
    c = rope(bending=None, damping=1e-3)
    under = [
        ancf.Cable(
            [(x, -0.3, -0.01), (x, 0.3, -0.01)], 4, diameter=1e-2, material="high", tension=200
        )
        for x in (-0.12, 0.12)
    ]
    for rail in under:
        rail.fix(0)
        rail.fix(-1)
    O.engines = ancf.engines(c, *under, gravity=(0, 0, -G), contact=mixing(rule))
    ancf.settle()
    c.setVelocity(lambda p: Vector3(0, 1, 0))
    a = slowing(lambda: np.mean([c.velocity(s)[1] for s in np.linspace(0, 1, 17)]), 0.05)
    assert a == pytest.approx(RULES[rule] * G, rel=5e-2)


def test_an_edit_reaches_contacts_that_are_there(scene, tmp_path):
    materials()
    far, number = slider()
    O.engines = ancf.engines(far, gravity=(0, 0, -G))
    speed = lambda: O.bodies[number].state.vel[0]
    assert slowing(speed) == pytest.approx(0.2 * G, rel=5e-3)
    loop = next(e for e in O.engines if hasattr(e, "physDispatcher"))
    functor = loop.physDispatcher.functors[0]
    functor.frictionRule = "max"
    assert slowing(speed) == pytest.approx(0.5 * G, rel=5e-3)
    functor.setFriction(O.materials["high"].id, O.materials["low"].id, 0.1, 0.1)
    functor.setFriction(O.materials["low"].id, O.materials["high"].id, 0.3, 0.3)  # the same pair
    assert slowing(speed) == pytest.approx(0.3 * G, rel=5e-3)
    save = str(tmp_path / "sliding.xml")
    O.save(save)
    O.load(save)
    assert slowing(speed) == pytest.approx(0.3 * G, rel=5e-3)


@pytest.mark.parametrize(
    "given, error, told",
    [
        (dict(frictionRule="sum"), ValueError, "frictionRule'. = 'sum': choose one of 'min'"),
        (dict(frictionPairs=[1]), TypeError, "frictionPairs'. = .1.: must be a dict"),
        (dict(frictionPairs={("low", "high"): 0.3}), TypeError, "must be a list of two coeff"),
        (dict(frictionPairs={("low", "high"): (0.3,)}), ValueError, "two coefficients"),
        (dict(frictionPairs={("low", "high"): (0.3, -1)}), ValueError, "not below zero"),
        (dict(frictionPairs={("low", "no"): (0.3, 0.3)}), ValueError, "no such material"),
        (dict(frictionPairs={"low": (0.3, 0.3)}), ValueError, "for a pair of materials"),
    ],
)
def test_bad_rules_are_refused(scene, given, error, told):
    materials()
    with pytest.raises(error, match=told):
        ancf.engines(rope(), contact=given)


def test_functors_refuse_bad_rules(scene):
    for name in ("Ip2_HollarsMat_HollarsMat_HollarsPhys", "Ip2_FrictMat_HollarsMat_HollarsPhys"):
        functor = getattr(ancf, name)()
        with pytest.raises(ValueError, match=f"{name}.frictionRule = 'sum': must be 'min', 'max'"):
            functor.frictionRule = "sum"
        with pytest.raises(ValueError, match="frictionPairs holds -1: must be ids of materials"):
            functor.setFriction(-1, 0, 0.1, 0.1)
        for bad in (float("nan"), float("inf"), 1e200, -0.1):
            with pytest.raises(ValueError, match=f"pairFriction holds {bad:g}".replace("+", "[+]")):
                functor.setFriction(0, 1, 0.1, bad)
        assert list(functor.frictionPairs) == []
