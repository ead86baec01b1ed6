"""Engineering strain of ANCF elements beside Green's: closed forms of a bar and of a hanging cable."""

import math

import numpy as np
import pytest
from helpers import material, steps
from scipy.optimize import brentq

import ancf
from yade import O

G = 9.81


@pytest.fixture
def soft(scene):
    return material("soft", young=1e7, density=1000)


def cable(points, elements, strain="engineering", **options):
    given = dict(diameter=1e-2, material="soft", bending=0, contactPoints=0, strain=strain)
    return ancf.Cable(points, elements, **{**given, **options})


@pytest.mark.parametrize("axialRule", ["exact", "reduced"])
@pytest.mark.parametrize("mass", ["consistent", "lumped"])
def test_bar_at_five_percent(soft, axialRule, mass):
    """F = EA eps; with Green's strain EA eps (1 + eps)(1 + eps/2)."""
    for strain, factor in (("engineering", 1), ("green", 1.05 * 1.025)):
        O.reset()
        material("soft", young=1e7, density=1000)
        bar = cable([(0, 0, 0), (1.05, 0, 0)], 5, strain, length=1, axialRule=axialRule, mass=mass)
        bar.fix(0)
        bar.fix(-1)
        bar.append()
        force = bar.section.ea * 0.05 * factor
        assert bar.tension(0.4) == pytest.approx(force, rel=1e-12)
        assert bar.reaction(-1)[0] == pytest.approx(force, rel=1e-12)
        green = strain == "green"
        assert bar.strain(0.3) == pytest.approx(0.05 * (1.025 if green else 1), rel=1e-12)
        pulled = cable([(0, 1, 0), (1, 1, 0)], 3, strain, tension=force, axialRule=axialRule)
        assert pulled.length == pytest.approx(1 / 1.05, rel=1e-12)


def hanging(c, span):
    """Sag of the elastic catenary, T = EA eps (Irvine 1981), by its equation for the span."""
    w, ea, length = c.section.rhoA * G, c.section.ea, c.length

    def error(h):
        return h * length / ea + 2 * h / w * math.asinh(w * length / (2 * h)) - span

    h = brentq(error, 1e-3 * w * length, 1e3 * ea, xtol=1e-14, rtol=1e-14)
    return (
        w * length**2 / (8 * ea) + h / w * (math.hypot(1, w * length / (2 * h)) - 1),
        math.hypot(h, w * length / 2),
    )


def test_hanging_cable_at_five_percent(soft):
    span, sags = 50.0, {}
    for strain in ("engineering", "green"):
        O.reset()
        material("soft", young=6.5e6, density=1000)
        c = cable([(0, 0, 0), (span, 0, 0)], 40, strain)
        c.fix(0)
        c.fix(-1)
        O.engines = ancf.engines(c, gravity=(0, 0, -G))
        c.relax(1e-10)
        sags[strain] = -c.point(0.5)[2]
        sag, largest = hanging(c, span)
        if strain == "engineering":
            assert c.strain(0.0) == pytest.approx(largest / c.section.ea, rel=1e-2)
            assert 0.04 < c.strain(0.5) < 0.06
            assert sags[strain] == pytest.approx(sag, rel=1e-5)
            assert c.maxTension()[0] == pytest.approx(largest, rel=1e-3)
    assert abs(sags["green"] / sags["engineering"] - 1) > 5e-3  # the measures differ here


@pytest.mark.parametrize("curvature", ["fast", "exact"])
@pytest.mark.parametrize("integrator", ["leapfrog", "implicit"])
def test_energy_of_a_swing(soft, curvature, integrator):
    """A cable that swings and stretches keeps its energy."""
    c = cable(
        [(0, 0, 0), (1, 0, 0)], 6, bending=1e-2, curvature=curvature, damping=1e-4, mass="lumped"
    )
    c.fix(0)
    O.engines = ancf.engines(c, gravity=(0, 0, -G), integrator=integrator)
    O.dt = min(O.dt, 2e-4)
    O.trackEnergy = True
    steps(2)
    total = lambda: sum(O.energy[k] for k in O.energy.keys())
    before, largest = total(), 0
    for _ in range(40):
        steps(round(0.01 / O.dt))
        largest = max(largest, O.energy["cableKinetic"])
        assert abs(total() - before) < 2e-4 * max(largest, 1e-3)
    assert largest > 0.05
    assert c.engine.energyOff <= 1e-3 * c.engine.energyScale


def test_kept_with_a_save(soft, tmp_path):
    c = cable([(0, 0, 0), (1, 0, 0)], 2, massDamping=0.7)
    O.engines = ancf.engines(c)
    save = str(tmp_path / "strain.xml")
    O.save(save)
    O.load(save)
    (again,) = ancf.structures()
    assert again.section.engineering and again.section.massDamping == 0.7
    assert list(again.engine.kind) == [16, 16]


def test_unknown_strain_is_refused(soft):
    with pytest.raises(ValueError, match="Cable.strain = 'log': choose one of 'green', 'engineer"):
        cable([(0, 0, 0), (1, 0, 0)], 2, "log")
