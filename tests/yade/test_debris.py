"""Scripts in their short forms: forces, momenta, energies, grains lost."""

import pathlib
import sys

import numpy as np
import pytest

from helpers import O, ancf, array, material, steps

SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "yade-scripts"
sys.path.insert(0, str(SCRIPTS))


def test_summary_tells_what_is_out_of_bounds(capsys):
    import grains

    out = grains.Summary()
    out.tell("good", 1.0, "N", least=0.9, most=1.1)
    assert out.code == 0
    out.tell("low", 0.8, "N", least=0.9)
    out.tell("high", 1.2, "N", most=1.1)
    out.tell("no number", np.nan, "N", most=1.1)
    assert out.failed == ["low", "high", "no number"] and out.code == 1
    assert capsys.readouterr().out.count("FAILED") == 3


def test_crane_counts_its_work(scene):
    """It lifts a rope: weight times height and the rope's kinetic energy."""
    import grains

    material("m", young=1e7, density=1000)
    rope = ancf.Cable([(0, 0, 0), (0, 0, -1)], 8, diameter=0.01, material="m", contactPoints=0)
    crane = grains.Crane(rope, [0])
    O.engines = ancf.engines(rope, gravity=(0, 0, -9.81))
    rope.relax(1e-8)
    before = sum(rope.energy().values())
    crane.move((0, 0, 0.5))
    for _ in range(4000):
        steps(1)
        crane.count()
    assert sum(rope.energy().values()) - before == pytest.approx(crane.work, rel=2e-3)
    assert crane.work > 9.81 * rope.mass * 0.5 * O.time


def test_bag_of_stones(scene):
    """At rest it bears the weight; no stone is lost till it is poured; impulse and energy."""
    import debris_bag

    bag, out = debris_bag.study(quick=True)
    assert not out.failed
    assert out.values["crane at rest, over the weight"] == pytest.approx(1, abs=5e-3)
    assert out.values["stones in the net at rest"] == len(bag.stones)
    assert out.values["stones in the net after dragging"] == len(bag.stones)
    assert 0.05 < out.values["ground, mean friction over pressure"] < debris_bag.GROUND_FRICTION
    assert abs(out.values["energy, off by"]) < 5e-3


def test_drape_stops_a_block(scene):
    import rockfall

    stop, out = rockfall.study(quick=True)
    assert not out.failed
    weight = 9.81 * (stop.net.mass + sum(a.mass for a in stop.absorbers))
    assert stop.anchors[0].sum() > weight  # before the block is there, and slanting
    assert out.values["energy, off by"] < 5e-3
    assert out.values["impulse against momentum, off by"] < 1e-3
    last = stop.energy[-1]
    assert last["cableDamping"] > 0.5 * 0.5 * rockfall.BLOCK * rockfall.SPEED**2


def test_ball_walks_over_a_bridge(scene):
    import bridge

    walk, out = bridge.study(quick=True)
    assert not out.failed
    assert array(walk.state.pos)[0] > bridge.QUICK_END
    assert abs(out.values["far end against the lever rule, mean"]) < 0.03
    assert abs(out.values["energy, off by"]) < 0.02


def test_geogrid_is_pulled_out(scene):
    import geogrid

    runs, out = geogrid.study(quick=True)
    assert not out.failed
    assert len(runs) == 2
    for (run,) in runs.values():
        assert 0 < run.late < 2 * geogrid.FRICTION * run.above


def test_mine_hoist(scene):
    """hoist.py: tension, stopping way, frequency and stretch against theory."""
    import hoist

    run, out = hoist.study(quick=True)
    assert not out.failed
    assert out.values["tension in trips / law, most"] < 1.01
    assert out.values["stretch / theory"] == pytest.approx(1, abs=2e-3)
    assert out.values["frequency / theory"] == pytest.approx(1, abs=2e-3)
    assert run.winch.length == pytest.approx(run.stopped[1], abs=1e-9)
