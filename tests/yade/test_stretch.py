"""Unstressed length other than as laid: against statics in closed form."""

import math

import numpy as np
import pytest
from helpers import array, material
from scipy.optimize import brentq

import ancf
from ancf import pulleys
from yade import O

GRAVITY = 9.81
THIN = dict(diameter=5e-3, material="cable", contactPoints=0)


def catenary(span, length, weight, ea):
    """Horizontal force [N] and sag [m] of an elastic catenary between two points of one height
    (Irvine 1981, Eq. 1.22 and 1.23).
    """

    def tooShort(h):
        return h * length / ea + 2 * h / weight * math.asinh(weight * length / (2 * h)) - span

    h = brentq(tooShort, 1e-9 * weight, ea, xtol=1e-13, rtol=1e-13)
    v = weight * length / 2
    return h, v * length / (4 * ea) + h / weight * (math.hypot(1, v / h) - 1)


@pytest.mark.parametrize(
    "kind, elements, within",
    [(dict(bending=0.0), 32, 2e-5), (dict(model="springs"), 40, 5e-4)],
    ids=["ancf", "springs"],
)
@pytest.mark.parametrize("how", [dict(slack=0.1), dict(length=1.02), dict(slack=0.6)])
def test_slack_cable_hangs_in_a_catenary(scene, kind, elements, within, how):
    material("cable", young=1e8)
    parts = dict(midPoints=elements - 1) if "model" in kind else dict(elements=elements)
    cable = ancf.Cable([(0, 0, 0), (1, 0, 0)], **parts, **how, **kind, **THIN)
    cable.fix(0)
    cable.fix(1)
    O.engines = ancf.engines(cable, gravity=(0, 0, -GRAVITY))
    cable.relax()
    length = how.get("length", 1 + how.get("slack", 0))
    assert cable.length == pytest.approx(length, rel=1e-14)
    weight = cable.section.rhoA * GRAVITY
    h, sag = catenary(1, length, weight, cable.section.ea)
    assert -cable.point(0.5)[2] == pytest.approx(sag, rel=within)
    held = array(cable.reaction(0))
    assert held[2] == pytest.approx(weight * length / 2, rel=1e-6)
    assert -held[0] == pytest.approx(h, rel=60 * within)  # Green's strain and polygon


@pytest.mark.parametrize("slack", [0.02, 0.3])
def test_stiff_slack_cable_hangs_and_does_not_stand(scene, slack):
    material("cable", young=1e9, density=1000)
    cable = ancf.Cable([(0, 0, 0), (1, 0, 0)], 16, slack=slack, **THIN)
    cable.fix(0)
    cable.fix(1)
    O.engines = ancf.engines(cable, gravity=(0, 0, -GRAVITY))
    cable.relax()
    heights = cable.curve()[:, 2]
    assert heights.max() < 1e-12 and heights.min() < -0.08


@pytest.mark.parametrize("model", ["ancf", "springs"])
@pytest.mark.parametrize("pull", [50.0, 5000.0])
def test_tension_as_laid(scene, model, pull):
    material("cable", young=1e9)
    cable = ancf.Cable([(0, 0, 0), (1, 0, 0), (2, 0, 0)], tension=pull, model=model, **THIN)
    cable.fix(0)
    cable.fix(-1)
    O.engines = ancf.engines(cable)
    assert array(cable.reaction(0)) == pytest.approx([-pull, 0, 0], rel=1e-12)
    assert cable.tensions(4) == pytest.approx(np.full(len(cable.tensions(4)), pull), rel=1e-12)
    for _ in range(100):
        O.step()
    assert cable.energy()["kinetic"] < 1e-20


def test_curve_is_that_of_the_points(scene):
    material("cable")
    points = [(0, 0, 0), (1, 0.2, 0), (2, 0, 0.3)]
    laid = ancf.Cable(points, 3, **THIN)
    for how in (dict(slack=0.2), dict(slack=-0.01), dict(tension=100.0)):
        assert np.abs(ancf.Cable(points, 3, **how, **THIN).curve() - laid.curve()).max() < 1e-14


def test_edges_of_a_net(scene):
    material("cable")
    slack = np.linspace(-0.01, 0.1, 12)
    net = ancf.Net.square(2, 0.1, slack=slack, diameter=1e-3, material="cable")
    assert [e.length for e in net.edges] == pytest.approx(0.1 * (1 + slack), rel=1e-14)
    net = ancf.Net.square(2, 0.1, 3, length=0.099, diameter=1e-3, material="cable")
    assert [e.length for e in net.edges] == pytest.approx([0.099] * 12, rel=1e-14)


def test_belt_of_a_length(scene):
    material("cable")
    wheels = [pulleys.sheave((x, 0, 0), 0.1, width=0.02, material="cable") for x in (0, 1)]
    path = pulleys.Path([(i, 1) for i in wheels], diameter=5e-3)
    belt = pulleys.lay(path, 60, slack=-0.01, diameter=5e-3, material="cable")
    assert belt.length == pytest.approx(0.99 * path.length, rel=1e-5)
    belt = pulleys.lay(path, 60, length=2.6, diameter=5e-3, material="cable")
    assert belt.length == pytest.approx(2.6, rel=1e-14)


@pytest.mark.parametrize(
    "given, told",
    [
        (dict(slack=0.1, length=1.0), "Cable.length = 1.0 and slack = 0.1: give one of"),
        (dict(slack=-1.0), "Cable.slack = -1.0: it would be laid"),
        (dict(slack=50), "Cable.slack = 50.0: it would be laid"),
        (dict(length=0), "Cable.length = 0: must be finite and above zero"),
        (dict(tension=-1), "Cable.tension = -1: must be finite and not below zero"),
        (dict(tension=1e300), "Cable.tension = 1e[+]300: it would be laid"),
        (dict(slack=[0.1, 0.2]), "Cable.slack = .0.1, 0.2.: must be a number"),
        (dict(slack=math.nan), "Cable.slack = nan: must be finite"),
    ],
)
def test_refusals(scene, given, told):
    material("cable")
    with pytest.raises(ValueError, match=told):
        ancf.Cable([(0, 0, 0), (1, 0, 0)], **given, **THIN)
