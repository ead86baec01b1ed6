"""Short form of the work-precision benchmark: ratios within one run, on the plucked string, whose
motion is known in closed form. Times are CPU times of runs in turns, never compared with a number.
"""

import pathlib
import sys

import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / "bench"), str(ROOT / "yade-scripts")]


@pytest.fixture
def case(scene):
    from workprecision import smooth

    return smooth.CASES["string"]


def ours(case, n, mass, integrator, step):
    return case.row("ours", "ancf", n, mass, integrator, step)


def test_error_falls_by_the_order_in_space(case):
    """Cubic elements with consistent mass: 4 at least, here 5; lumped mass: 2 at least, here 3."""
    consistent = [ours(case, n, "consistent", "leapfrog", 0.45).error for n in (4, 8)]
    lumped = [ours(case, n, "lumped", "leapfrog", 0.45).error for n in (16, 32)]
    assert consistent[0] / consistent[1] > 16
    assert lumped[0] / lumped[1] > 4


def test_implicit_error_falls_by_the_order_in_time(case):
    errors = [ours(case, 16, "consistent", "implicit", h).error for h in (1e-4, 5e-5)]
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.15)


def test_leapfrog_error_falls_by_the_order_in_time(case):
    """By differences of runs: of 4 elements the places are what is off most."""
    from workprecision import smooth

    def nodes(part):
        made = []
        smooth.timed(
            lambda: made.append(smooth.string("ancf", 4, "lumped", "leapfrog", part)),
            case.duration,
        )
        return smooth.nodesOf(made[-1])

    whole, half, quarter = (nodes(part) for part in (0.8, 0.4, 0.2))
    ratio = np.linalg.norm(whole - half) / np.linalg.norm(half - quarter)
    assert ratio == pytest.approx(4, rel=0.2)


def test_faster_than_chains_at_equal_error(case):
    """Fourteen times measured with lumped mass, beside sphere chains interpolated to the same error."""
    mine, chain = [], {16: [], 32: []}
    for _ in range(3):
        mine.append(ours(case, 16, "lumped", "leapfrog", 0.9))
        for n, rows in chain.items():
            rows.append(case.chainRow("spheres", n))
    cpu = {n: min(r.cpu for r in rows) for n, rows in chain.items()}
    off = {n: rows[0].error for n, rows in chain.items()}
    slope = np.log(cpu[32] / cpu[16]) / np.log(off[32] / off[16])
    same = cpu[16] * (mine[0].error / off[16]) ** slope
    assert off[32] < mine[0].error < off[16]
    assert same > 4 * min(r.cpu for r in mine)


def test_pendulum_is_that_of_textbook_elements(scene):
    """With exact curvature and Green strain, against elements written in numpy, integrated by DOP853 of
    scipy; their own 24 are 1.5e-5 m from the 32.
    """
    from workprecision import smooth
    from workprecision.references import reference

    made = smooth.single(smooth.PENDULUM, "ancf", 32, "consistent", curvature="exact")
    made.fix(0)
    made.setVelocity(lambda p: (0, 0, -smooth.TURN * p[0]))
    smooth.engines(made, smooth.PENDULUM_GRAVITY, "implicit", 1.25e-4)
    scene.run(round(smooth.SWING / scene.dt), True)
    tip = smooth.nodesOf(made)[-1]
    assert np.linalg.norm(tip - reference("pendulum, exact curvature")) < 1e-5


def test_moved_end_is_that_of_another_program(scene):
    """A stiff bending cable against the limit of CableDyn 0.3.0, of 96 elements and 0.25 ms: it has the
    same element and its own integrator, and its 64 elements are 4e-6 m off.
    """
    from workprecision import moved

    case = moved.CASES["moved end stiff"]
    assert case.off(moved.run(case.ea, 64, "implicit", 2.5e-3)[1], moved.PEER) < 6e-5


def test_long_steps_pay_on_a_stiff_cable(scene):
    """Implicit steps of 5 ms against leapfrog's of 17 us, both as near to the limit as 16 elements come."""
    from workprecision import moved

    case = moved.CASES["moved end stiff"]
    explicit = case.row("explicit", 16, "leapfrog", 0.9)
    implicit = case.row("implicit", 16, "implicit", 5e-3)
    assert implicit.error < 1.2 * explicit.error
    assert explicit.cpu > 15 * implicit.cpu
