"""What integrator='auto' takes, and that it tells so."""

import math

import numpy as np
import pytest

from helpers import O, Vector3, ancf, material, runTo, squareNet, utils
from yade import wrapper


def pendulum(integrator, young=4e7):
    """Let go from the horizontal, 1 m; nothing touches. Returns it, and its tip after 0.5 s."""
    O.reset()
    material("rope", young=young, density=1000)
    rope = ancf.Cable(
        [(0, 0, 0), (1, 0, 0)],
        elements=8,
        diameter=0.01,
        material="rope",
        contactPoints=0,
        mass="consistent",
    )
    rope.fix(0)
    O.engines = ancf.engines(rope, gravity=(0, 0, -9.81), integrator=integrator)
    runTo(0.5)
    late = O.time - 0.5  # steps of different lengths end at different times
    return rope, np.array(list(rope.point(1) - late * rope.velocity(1)))


def test_leapfrog_where_something_may_touch(scene):
    material("cable")
    net = squareNet(4)
    O.engines = ancf.engines(net, integrator="auto")
    plain = O.dt
    assert net.engine.integrator == "leapfrog" and net.engine.substeps == 0
    assert "something may touch" in ancf.plan()
    O.engines = ancf.engines(net)
    assert O.dt == plain


def test_many_short_steps_in_one_of_yade(scene):
    rope, tip = pendulum("auto")
    engine = rope.engine
    assert engine.integrator == "leapfrog" and 1 < engine.substeps <= 40
    assert O.dt == pytest.approx(engine.substeps * engine.criticalTimeStep(), rel=0.05)
    assert O.dt <= 1.1e-3
    assert f"{engine.substeps} of its steps" in ancf.plan()
    _, once = pendulum("leapfrog")
    assert np.abs(tip - once).max() < 2e-5


def test_long_steps_for_stiff_cables(scene):
    rope, tip = pendulum("auto", young=4e9)
    assert rope.engine.integrator == "implicit" and O.dt == 1e-3
    assert "implicit" in ancf.plan() and "steps of leapfrog" in ancf.plan()
    _, short = pendulum("leapfrog", young=4e9)
    assert np.abs(tip - short).max() < 2e-4


def test_substeps_as_told(scene):
    rope, _ = pendulum("auto")
    O.engines = ancf.engines(rope, integrator="auto", substeps=3)
    assert rope.engine.substeps == 3


def test_time_step_covers_grains(scene):
    """Half of what a sound wave takes through the smallest grain, as YADE has it for all of them."""
    material("cable")
    O.materials.append(wrapper.FrictMat(young=1e9, density=2600, label="grain"))
    cable = ancf.Cable([(0, 0, 1), (1, 0, 1)], diameter=1e-2, material="cable")
    small = utils.sphere(Vector3(0, 0, 0), 1e-4, material="grain")
    O.bodies.append(small)
    alone = ancf.timeStep(ancf.engines(cable)[3:4])
    O.bodies.append(utils.sphere(Vector3(0.5, 0, 0), 2e-2, material="grain"))
    O.engines = ancf.engines(cable)
    assert O.dt == pytest.approx(0.5 * utils.PWaveTimeStep(), rel=1e-12)
    assert O.dt == pytest.approx(0.5 * 1e-4 * math.sqrt(2600 / 1e9), rel=1e-12)
    assert alone > O.dt  # which meets nothing of its law
