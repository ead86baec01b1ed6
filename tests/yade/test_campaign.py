"""Campaigns: tables, results that nothing spoils, workers that die, and what a campaign says."""

import os
import pathlib
import signal
import socket
import subprocess
import sys
import time

import numpy as np
import pytest

from helpers import ancf  # noqa: F401  loads YADE
from ancf import campaign
from ancf.campaign import statistics

ROOT = pathlib.Path(__file__).resolve().parents[2]
PATH = os.environ.get("PYTHONPATH", str(ROOT / "build" / "python")).split(os.pathsep)
ENV = {**os.environ, "PYTHONPATH": os.pathsep.join(map(os.path.abspath, PATH))}
LOAD = 300  # in which a process has to load YADE on a busy machine [s]

SCENE = """
import os, pathlib, signal, time
from ancf import campaign
from yade import O, utils

VARY = dict(x=campaign.uniform(0, 1), wait=campaign.uniform(0.01, 0.03))
LOG, HOLD = (pathlib.Path(__file__).with_name(name) for name in ("log", "hold"))


def run(x, kind="good", wait=0.0):
    bodies = O.bodies.append(utils.sphere((0, 0, 0), 1)) + 1
    if kind == "crash":
        os.kill(os.getpid(), signal.SIGSEGV)
    if kind == "exit":
        print("an engine is missing")
        os._exit(3)
    if kind == "wrong":
        raise ValueError("no such net")
    if kind == "hang":
        while True:
            pass
    if kind == "vector":
        return dict(position=O.bodies[0].state.pos)
    time.sleep(wait)
    while HOLD.exists():
        time.sleep(0.01)
    with open(LOG, "a") as log:
        log.write(f"{x}\\n")
    return dict(square=x * x, bodies=bodies)
"""


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "scene.py"
    path.write_text(SCENE)
    return path


def table(path, text):
    path.write_text(text)
    return campaign.read(path)


def logged(scene):
    """x of the runs that came to their end."""
    log = scene.with_name("log")
    return [float(x) for x in log.read_text().split()] if log.exists() else []


def waitFor(what, process=None, limit=LOAD):
    """Until what() is true, as long as a process lives that makes it so."""
    end = time.monotonic() + limit
    while not what():
        assert process is None or process.poll() is None, process.communicate()[0]
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.02)


# ---- tables --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "text, told",
    [
        ("", "is empty"),
        ("x,kind\n", "has no runs"),
        ("x,kind,x\n1,good,2\n", r"column 3 = 'x': is column 1 already"),
        ("x,X\n1,2\n", r"column 2 = 'X': is column 1 already"),
        ("x,\n1,2\n", r"column 2 = '': must be the name"),
        ("x,error\n1,2\n", r"column 2 = 'error': is a column of the results' own"),
        ("x,kind\n1,good\n2\n", r"run 2 has 1 values for 2 columns \(x, kind\)"),
        ("x,kind\n,good\n", r"run 1, x = '': must be a number or a text"),
        ("x\nnan\n", r"run 1, x = nan: must be finite"),
        ("x\n99999999999999999999\n", "too large"),
    ],
)
def test_bad_tables_are_told(tmp_path, text, told):
    with pytest.raises((ValueError, TypeError), match=told):
        table(tmp_path / "runs.csv", text)


def test_table_has_numbers_texts_and_truths(tmp_path):
    read = table(tmp_path / "runs.csv", "\ufeffa, b,c,d\n1,2.5e-1,True, red\n")
    assert read.names == ["a", "b", "c", "d"] and read.rows == [(1, 0.25, True, "red")]


def test_grid_has_all_combinations():
    made = campaign.grid(a=[1, 2], b=["x", "y"])
    assert made.rows == [(1, "x"), (1, "y"), (2, "x"), (2, "y")]


def test_more_random_runs_begin_with_the_same():
    vary = dict(a=campaign.uniform(2, 3), b=campaign.normal(5, 0.1))
    few, many = campaign.draw(10, 7, **vary), campaign.draw(4000, 7, **vary)
    assert many.rows[:10] == few.rows != campaign.draw(10, 8, **vary).rows
    a, b = np.array(many.rows).T
    assert 2 <= a.min() < 2.01 and 2.99 < a.max() <= 3 and abs(a.mean() - 2.5) < 0.02
    assert abs(b.mean() - 5) < 0.01 and abs(b.std() - 0.1) < 0.01
    assert abs(np.corrcoef(a, b)[0, 1]) < 0.06


@pytest.mark.parametrize(
    "bad",
    [lambda: campaign.uniform(2, 1), lambda: campaign.normal(0, 0), lambda: campaign.draw(1, x=3)],
)
def test_bad_distributions_are_told(bad):
    with pytest.raises((ValueError, TypeError), match="must be"):
        bad()


# ---- runs ----------------------------------------------------------------------------------------


def test_a_failed_run_is_a_row_with_its_error(scene, tmp_path):
    kinds = ["good", "crash", "hang", "exit", "wrong", "vector", "good"]
    text = "x,kind\n" + "".join(f"{x},{kind}\n" for x, kind in enumerate(kinds))
    runs = table(tmp_path / "runs.csv", text)
    with campaign.run(scene, runs, tmp_path / "a.db", workers=2, limit=2) as results:
        assert results.count() == (7, 7, 5)
        columns = results.columns()
        assert list(columns["run"]) == [1, 7] and list(columns["square"]) == [0, 36]
        assert list(columns["bodies"]) == [1, 1]  # each from an empty scene
        told = " | ".join(results.errors())
        results.writeCsv(tmp_path / "a.csv")
    for part in (
        "ended by signal SIGSEGV",
        "took more than 2 s",
        "exit code 3; its last words: an engine is missing",
        "ValueError: no such net (scene.py:",
        "result position = Vector3(0,0,0): must be a number or a text",
    ):
        assert part in told
    assert len((tmp_path / "a.csv").read_text().splitlines()) == 8
    # Failed runs are made again when that is asked for, others never.
    with campaign.run(scene, runs, tmp_path / "a.db", workers=1, limit=2) as results:
        assert results.count() == (7, 7, 5)
    with campaign.run(scene, runs, tmp_path / "a.db", workers=1, limit=2, again=True) as results:
        assert results.count() == (7, 7, 5)
    assert sorted(logged(scene)) == [0, 6]


def test_other_results_are_not_added_to(scene, tmp_path):
    def start(runs, path=scene):
        campaign.run(path, runs, tmp_path / "a.db").close()

    start(campaign.grid(x=[1, 2]))
    start(campaign.grid(x=[1, 2, 3]))
    assert logged(scene) == [1, 2, 3]
    for runs, told in (
        (campaign.grid(x=[1, 2]), "holds 3 runs"),
        (campaign.grid(x=[1, 5, 3]), "run 2 of grid"),
        (campaign.grid(x=[1, 2, 3], wait=[0]), "over x, not over x, wait"),
        (
            campaign.grid(speed=[1]),
            "column = 'speed': unknown: run.. of scene.py takes x, kind, wait",
        ),
        (campaign.grid(wait=[0]), "has no column x"),
    ):
        with pytest.raises(ValueError, match=told):
            start(runs)
    other = tmp_path / "other.py"
    other.write_text(SCENE)
    with pytest.raises(ValueError, match="results of the scene"):
        start(campaign.grid(x=[1, 2, 3]), other)
    scene.write_text(SCENE + "\n# changed\n")
    with pytest.raises(ValueError, match="before it was changed"):
        start(campaign.grid(x=[1, 2, 3]))
    with campaign.Results(tmp_path / "a.db") as kept:
        assert kept.count() == (3, 3, 0)


def test_a_file_of_something_else_is_left_alone(scene, tmp_path):
    (tmp_path / "notes.txt").write_text("speed of the net: 1.5 m/s")
    with pytest.raises(ValueError, match="holds no results of a campaign"):
        campaign.run(scene, campaign.grid(x=[1]), tmp_path / "notes.txt")
    assert (tmp_path / "notes.txt").read_text() == "speed of the net: 1.5 m/s"
    with pytest.raises(ValueError, match="no such file"):
        campaign.Results(tmp_path / "none.db")


@pytest.mark.parametrize(
    "text, told",
    [
        ("speed = 1", "has no function run"),
        ("import nothingOfThatName", "No module named 'nothingOfThatName'"),
        ("raise SystemExit('no licence')", "no licence"),
        (
            "from ancf import campaign\ncampaign.run(__file__, campaign.grid(x=[1]), 'a.db')",
            "put it under `if __name__ == '__main__':`",
        ),
    ],
)
def test_a_scene_that_cannot_be_run_is_told(tmp_path, text, told):
    (tmp_path / "bad.py").write_text(text)
    with pytest.raises(RuntimeError, match=told):
        campaign.run(tmp_path / "bad.py", campaign.grid(x=[1]), tmp_path / "a.db")
    assert not (tmp_path / "a.db").exists()


def test_a_scene_may_take_any_parameter(tmp_path):
    (tmp_path / "any.py").write_text(
        "def run(x, **more):\n    return dict(sum=x + sum(more.values()))"
    )
    runs = campaign.grid(x=[1], speed=[2], angle=[4])
    with campaign.run(tmp_path / "any.py", runs, tmp_path / "a.db") as results:
        assert list(results.columns()["sum"]) == [7]
    with pytest.raises(ValueError, match="has no column x: run.. of any.py takes x"):
        campaign.run(tmp_path / "any.py", campaign.grid(speed=[2]), tmp_path / "b.db")


@pytest.mark.parametrize("name", ["none.py", "/usr/bin/yade"])
def test_what_is_no_script_is_told(tmp_path, name):
    with pytest.raises(ValueError, match="must be a script"):
        campaign.run(tmp_path / name, campaign.grid(x=[1]), tmp_path / "a.db")


def test_the_same_run_gives_the_same_bits_in_any_process(tmp_path):
    """A net hits a ball: first in a process, and after others in it."""
    (tmp_path / "net.py").write_text(
        f"""
import sys
sys.path.insert(0, {str(ROOT / "yade-scripts")!r})
import numpy as np
import ball_capture
from yade import O

def run(nudge):
    ball_capture.TARGET_DISTANCE = 0.3
    net, ball = ball_capture.build(nudge * np.ones(4))
    while O.time < 0.3:
        O.step()
    return dict(position=repr(list(net.engine.position)), touched=net.engine.maxPenetration > 0)
"""
    )
    states = []
    for name, nudges in (("a", [1e-3, 1e-2, 0, 1e-3]), ("b", [1e-3])):
        with campaign.run(
            tmp_path / "net.py", campaign.grid(nudge=nudges), tmp_path / f"{name}.db"
        ) as results:
            columns = results.columns()
            states += list(columns["position"])
            assert columns["touched"].all()
    assert states[0] == states[3] == states[4] != states[1]


# ---- the command ---------------------------------------------------------------------------------


def heedCtrlC():
    """What a shell starts in the background ignores it, and so do its processes."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def command(scene, *options):
    """The command, in the scene's folder."""
    return subprocess.Popen(
        [sys.executable, "-m", "ancf.campaign", str(scene), *options],
        cwd=scene.parent,
        env=ENV,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
        preexec_fn=heedCtrlC,
    )


def said(process, limit=LOAD):
    text, _ = process.communicate(timeout=limit)
    return text


def test_ctrl_c_and_the_same_command_again(scene):
    options = ("--random", "60", "--workers", "2", "--csv", "runs.csv")
    first = command(scene, *options)
    waitFor(lambda: len(logged(scene)) > 15, first)
    scene.with_name("hold").touch()  # all that is under way waits
    second = command(scene, *options)
    assert "another campaign is adding to it" in said(second) and second.returncode == 1
    os.killpg(first.pid, signal.SIGINT)
    assert "the same command goes on" in said(first) and first.returncode == 130
    scene.with_name("hold").unlink()
    with campaign.Results(scene.with_name("scene.db")) as results:
        runs, finished, failed = results.count()
    assert runs == 60 and 10 < finished < 60 and failed == 0
    again = command(scene, *options)
    text = said(again)
    assert "60 of 60 runs finished, 0 of them failed" in text and again.returncode == 0, text
    assert 60 <= len(logged(scene)) <= 62  # two were under way, and not finished
    assert not scene.with_name("scene.db.lock").exists()


def test_a_scheduler_that_does_not_answer_is_told(scene):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    process = command(scene, "--random", "3", "--scheduler", f"tcp://127.0.0.1:{port}")
    text = said(process)
    assert "does not answer" in text and "dask-scheduler" in text and process.returncode == 1, text


@pytest.fixture
def cluster(scene):
    """A Dask scheduler and two workers, processes each: address, [scheduler, worker, worker]."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        host, port = free.getsockname()
    address, started = f"tcp://{host}:{port}", []

    def start(ready, *module):
        log = scene.with_name(f"process{len(started)}")
        options = dict(cwd=scene.parent, env=ENV, stdout=open(log, "w"), stderr=subprocess.STDOUT)
        started.append(subprocess.Popen([sys.executable, "-m", *module], **options))
        waitFor(lambda: ready in log.read_text(), started[-1])

    try:
        options = ("--host", host, "--port", str(port), "--no-dashboard")
        start("Scheduler at", "distributed.cli.dask_scheduler", *options)
        for _ in range(2):
            start("works for", "ancf.campaign.join", address, "--workers", "1")
        yield address, started
    finally:
        for process in started:
            process.kill()
            process.wait()


def test_a_worker_killed_in_the_middle_of_200_runs(scene, cluster):
    """Nothing is lost and nothing is there twice."""
    address, (_, first, _) = cluster
    process = command(scene, "--random", "200", "--scheduler", address)
    waitFor(lambda: len(logged(scene)) > 60 and len(workers(scene)) == 2, process)
    scene.with_name("hold").touch()  # each worker has a run under way
    time.sleep(0.5)
    assert len(logged(scene)) < 200
    first.kill()
    first.wait()  # and with it, what it computed
    scene.with_name("hold").unlink()
    text = said(process)
    assert "200 of 200 runs finished, 0 of them failed" in text, text
    with campaign.Results(scene.with_name("scene.db")) as results:
        columns = results.columns()
    assert len(columns["run"]) == len(set(columns["x"])) == 200
    assert np.array_equal(columns["square"], columns["x"] ** 2)
    assert sorted(logged(scene)) == sorted(columns["x"])  # each came to its end once


def test_a_scheduler_that_ends_in_the_middle_is_told(scene, cluster):
    address, (scheduler, *_) = cluster
    process = command(scene, "--random", "200", "--scheduler", address)
    waitFor(lambda: len(logged(scene)) > 20, process)
    scene.with_name("hold").touch()
    scheduler.kill()
    text = said(process)
    assert "results so far are kept" in text and process.returncode == 1, text
    scene.with_name("hold").unlink()
    process = command(scene, "--random", "200", "--workers", "2")
    assert "200 of 200 runs finished, 0 of them failed" in said(process)
    assert len(logged(scene)) <= 204  # two were under way, and perhaps as many not yet written


def workers(scene):
    """Those that have finished a run."""
    with campaign.Results(scene.with_name("scene.db")) as results:
        return set(results.columns()["worker"])


def test_a_process_ends_with_its_worker(scene):
    """Also while it computes: nobody else would end it."""
    code = (
        "import sys, ancf.campaign.worker as w; p = w.take(sys.argv[1]); print(p.pid, flush=True);"
        "p.ask(600, 'run', 1, dict(x=1, kind='hang'))"
    )
    parent = subprocess.Popen(
        [sys.executable, "-c", code, str(scene)], env=ENV, stdout=subprocess.PIPE, text=True
    )
    child = next(int(line) for line in parent.stdout if line.strip().isdigit())
    try:
        assert pathlib.Path(f"/proc/{child}").exists()
        time.sleep(0.5)
        parent.kill()
        parent.communicate()
        waitFor(lambda: not pathlib.Path(f"/proc/{child}").exists(), limit=10)
    except AssertionError:
        os.kill(child, signal.SIGKILL)
        raise


def test_a_run_costs_little_more_than_itself(scene, tmp_path):
    """All but the runs themselves, in processor time of all processes: below 10 % of 0.2 s, the
    cheapest capture.
    """
    runs = campaign.grid(x=[float(i) for i in range(300)])
    campaign.run(scene, campaign.grid(x=[0.5]), tmp_path / "warm.db").close()
    start = [sum(os.times()[:4])]
    with campaign.run(scene, campaign.grid(x=[0.5]), tmp_path / "one.db"):
        start.append(sum(os.times()[:4]))
    with campaign.run(scene, runs, tmp_path / "a.db"):
        start.append(sum(os.times()[:4]))
    each = ((start[2] - start[1]) - (start[1] - start[0])) / (len(runs) - 1)
    print(f"{1e3 * each:.2f} ms a run")
    assert each < 0.02


# ---- what a campaign says ------------------------------------------------------------------------


@pytest.mark.parametrize(
    "successes, runs, low, high, method",
    [
        (81, 263, 0.2553, 0.3662, "wilson"),  # Newcombe 1998, Table I, methods 3 and 5
        (15, 148, 0.0624, 0.1605, "wilson"),
        (0, 20, 0.0, 0.1611, "wilson"),
        (1, 29, 0.0061, 0.1718, "wilson"),
        (81, 263, 0.2527, 0.3676, "exact"),
        (15, 148, 0.0578, 0.1617, "exact"),
        (0, 20, 0.0, 0.1684, "exact"),
        (1, 29, 0.0009, 0.1776, "exact"),
    ],
)
def test_confidence_intervals_are_those_published(successes, runs, low, high, method):
    found = statistics.probability([1] * successes + [0] * (runs - successes), method=method)
    assert found.low == pytest.approx(low, abs=5e-5) and found.high == pytest.approx(high, abs=5e-5)
    assert (found.successes, found.runs) == (successes, runs)


def test_logistic_regression_on_two_groups_is_the_odds_ratio():
    """Closed form: log(a d/(b c)), with the error sqrt(1/a + 1/b + 1/c + 1/d)."""
    a, b, c, d = 30, 12, 9, 45
    x = np.repeat([1.0, 1, 0, 0], [a, b, c, d])
    success = np.repeat([True, False, True, False], [a, b, c, d])
    (factor,), (error,) = statistics.logistic(x[:, None], success)
    assert factor / x.std() == pytest.approx(np.log(a * d / (b * c)), rel=1e-8)
    assert error / x.std() == pytest.approx(np.sqrt(1 / a + 1 / b + 1 / c + 1 / d), rel=1e-8)


def test_sensitivities_find_what_was_put_in():
    rng = np.random.default_rng(3)
    steep, middle, idle = rng.uniform(-1, 1, (3, 4000))
    odds = np.exp(2.0 * steep / np.std(steep) - 3 * middle**2 + 1)
    success = rng.random(4000) < odds / (1 + odds)
    found = {
        s.name: s
        for s in statistics.sensitivities(dict(steep=steep, middle=middle, idle=idle), success)
    }
    assert list(found)[0] == "steep" and found["steep"].rank > 0.5
    assert found["middle"].chance < 1e-6 and abs(found["middle"].rank) < 0.06
    assert found["idle"].low < 1 < found["idle"].high and found["idle"].chance > 1e-3
    assert 5 < found["steep"].low < found["steep"].oddsRatio < found["steep"].high < 9
    separated = statistics.sensitivities(dict(x=steep), steep > 0)[0]
    assert np.isnan(separated.oddsRatio) and separated.rank > 0.8


def test_map_counts_each_run_once():
    x, y = [0, 0, 1, 1, 1], [0, 1, 0, 1, 1]
    found = statistics.successMap(x, y, [1, 0, 0, 1, 0], bins=2)
    assert found.runs.tolist() == [[1, 1], [1, 2]] and found.successes.tolist() == [[1, 0], [0, 1]]
    assert found.share[1, 1] == 0.5


@pytest.mark.parametrize(
    "call, told",
    [
        (lambda: statistics.probability([]), "at least one"),
        (lambda: statistics.probability([0.5]), "must be True or False"),
        (lambda: statistics.probability([1], confidence=95), "between 0 and 1"),
        (lambda: statistics.probability([1], method="wald"), "choose one of"),
        (lambda: statistics.successMap([1], [1, 2], [0, 1]), "one for each of the 2 runs"),
        (lambda: statistics.sensitivities(dict(x=[1, 2]), [1, 1]), "the same outcome"),
        (lambda: statistics.sensitivities(dict(x=[2, 2]), [0, 1]), "the same in every run"),
    ],
)
def test_bad_questions_are_told(call, told):
    with pytest.raises(ValueError, match=told):
        call()
