"""Scenes spread over processes by yade.mpy end as in one process; what cannot be spread is refused."""

import json
import os
import pathlib
import subprocess
import sys
import types

import pytest

from ancf import mpi
from helpers import O, ancf, ball, material, utils
from yade import wrapper

HERE = pathlib.Path(__file__).resolve().parent


def run(folder, processes, steps):
    """What the scene of spread.py ends with."""
    result = folder / f"{processes}.json"
    started = ["mpirun", "-n", str(processes)] if processes > 1 else []
    script = str(HERE / "spread.py")
    command = [*started, "yade", "-n", "-x", script, str(processes), str(steps), str(result)]
    polite = {"OMPI_MCA_mpi_yield_when_idle": "1", "OMP_NUM_THREADS": "1"}
    polite["OMPI_MCA_btl_tcp_if_include"] = "lo"  # they are all on this machine
    polite["OMPI_MCA_rmaps_base_oversubscribe"] = "1"  # more processes than cores: Debian 12
    polite["PRTE_MCA_rmaps_default_mapping_policy"] = ":oversubscribe"  # Debian 13
    root = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    package = {"PYTHONPATH": str(pathlib.Path(ancf._load.__file__).parents[1])}
    environment = {**os.environ, **polite, **root, **package}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=600)
    assert result.is_file(), done.stdout + done.stderr
    return json.loads(result.read_text())


def numbers(found):
    knots, energies, *balance = found["cables"]
    flat = [x for knot in knots for x in knot] + list(energies.values()) + balance
    return flat + [x for body in found["bodies"] for x in body]


def test_spread_scene_ends_as_in_one_process(tmp_path):
    """Grains on two processes, the rope on one of them: the same to rounding."""
    one, spread = run(tmp_path, 1, 400), run(tmp_path, 3, 400)
    assert one["cables"][1]["axial"] > 1e-3  # [J]: the rope was hit
    assert numbers(spread) == pytest.approx(numbers(one), rel=1e-9, abs=1e-12)
    assert (
        "run this scene by mpy.mpirun" in spread["afterwards"]
    )  # the first process's cables are old


# ---- refusals ------------------------------------------------------------------------------------


@pytest.fixture
def rope(scene, monkeypatch):
    """A rope above a ball, and a yade.mpy that was imported."""
    monkeypatch.setitem(sys.modules, "yade.mpy", types.ModuleType("yade.mpy"))
    material("cable")
    made = ancf.Cable([(0, 0, 0), (1, 0, 0)], 4, diameter=1e-3, material="cable")
    O.bodies.append(utils.sphere((0.5, 0, -0.1), 0.05, material="cable"))
    O.bodies[0].subdomain = 1
    O.engines = ancf.engines(made)
    return made


def clump():
    both = [utils.sphere((x, 0, -1), 0.05, material="cable") for x in (0, 0.05)]
    O.bodies.appendClumped(both)


REFUSED = [
    (lambda: O.bodies[0].__setattr__("subdomain", 0), ValueError, "subdomain = 0: it may move"),
    (lambda: O.bodies[0].__setattr__("mask", 1 << 28), ValueError, "has bit 28"),
    (lambda: setattr(O, "engines", [ancf.SheaveEngine()]), RuntimeError, "no CableEngine"),
    (
        lambda: setattr(O, "engines", [*O.engines, ancf.GuideEngine()]),
        RuntimeError,
        "has a GuideEngine, which cannot be spread",
    ),
    (
        lambda: setattr(O, "engines", [ancf.LineEngine(), *O.engines]),
        RuntimeError,
        "has a LineEngine, which cannot be spread",
    ),
    (clump, RuntimeError, "belongs to a clump"),
    (lambda: sys.modules.pop("yade.mpy"), RuntimeError, "from yade import mpy"),
]


@pytest.mark.parametrize("spoil, error, text", REFUSED)
def test_what_cannot_be_spread_is_refused(rope, spoil, error, text):
    spoil()
    before = [type(e).__name__ for e in O.engines]
    with pytest.raises(error, match=text):
        mpi.spread()
    assert [type(e).__name__ for e in O.engines] == before


def test_rank_0_and_no_function_are_refused(rope):
    with pytest.raises(ValueError, match="mpi.spread: rank = 0: must be at least 1"):
        mpi.spread(0)
    with pytest.raises(TypeError, match="mpi.ask: read = 3: must be a function"):
        mpi.ask(3)


def test_spread_keeps_who_may_meet_whom(rope):
    """Bodies of cables leave the bit by which mpy's boxes meet; pairs that could meet still can."""
    mpi.spread(1)
    grain, elements = O.bodies[0], [O.bodies[i] for i in rope.bodies]
    assert all(e.subdomain == 1 and not e.mask & 1 and e.mask & grain.mask for e in elements)
    assert grain.mask & 1
    assert [type(e).__name__ for e in O.engines][-1] == "NewtonIntegrator"


def test_a_scene_that_mpy_spreads_alone_is_refused(rope):
    """The boxes of processes that mpy puts into a scene are known; such a scene wants spread()."""
    box = wrapper.Body(shape=wrapper.Subdomain(ids=[0]))
    O.bodies.append(box)
    with pytest.raises(RuntimeError, match=r"call ancf.mpi.spread\(\) before mpy.mpirun\(\)"):
        ancf.check()


def test_boxes_of_mpy_beside_cables_are_nothing_to_warn_of(rope, capfd):
    mpi.spread(1)
    O.bodies.append(wrapper.Body(shape=wrapper.Subdomain(ids=[0])))
    ancf.check()
    assert "Subdomain" not in capfd.readouterr().err
