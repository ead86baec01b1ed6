"""Runs a campaign: hands out runs to workers, and keeps what comes back."""

import concurrent.futures
import contextlib
import os
import pathlib
import queue
import sys

from .. import values
from ..needs import needed
from . import worker
from .results import Keeper, Results
from .tables import Table

LIMIT = 3600.0  # of a run [s]
ANSWER = 10  # in which a scheduler has to answer [s]
LOOK = 5  # between two looks whether it still does [s]


def run(scene, table, results, workers=1, scheduler=None, limit=LIMIT, again=False):
    """Runs a scene for each row of a table that `results` does not have yet, and returns the Results.

    scene      script with a function run(), whose arguments are the parameters
    table      Table of parameters: read(csv), grid(), draw()
    results    SQLite file; made if it does not exist, added to otherwise
    workers    processes on this machine
    scheduler  address of a Dask scheduler, tcp://host:8786, whose workers are taken instead; they need
               the scene under the same path
    limit      of a run [s]: a longer one is ended, and its row says so
    again      make failed runs again

    A run that fails, ends its process or takes too long is a row with its error. Ctrl-C, and any
    other end, keeps what is finished; the same call goes on.
    Raises ValueError, TypeError, RuntimeError that say what to do before the first run.
    """
    if worker.INSIDE in os.environ:
        raise RuntimeError(
            "campaign.run() in a script that a campaign loads: put it under `if __name__ == '__main__':`"
        )
    scene = _script(scene)
    if not isinstance(table, Table):
        values.refuse(
            "campaign.run: table", table, "must be a Table: read(), grid(), draw()", TypeError
        )
    workers = values.count("campaign.run: workers", workers, 1)
    limit = values.positive("campaign.run: limit", limit, "s")
    about = describe(scene)
    table.checkParameters(pathlib.Path(scene).name, about["parameters"], about["needed"])
    with Keeper(results, scene, about["digest"], table) as kept:
        if again:
            kept.forgetFailed()
        if kept.open():
            with _pool(scheduler, workers) as pool:
                _runAll(pool, kept, table, scene, about["digest"], limit)
    worker.endIdle()
    return Results(results)


def _script(scene):
    """Path of a script, for a worker anywhere."""
    path = pathlib.Path(scene).resolve()
    if path.suffix != ".py" or not path.is_file():
        remedy = "must be a script, scene.py, that is there; under `yade`, __file__ is YADE itself"
        values.refuse("campaign: scene", str(scene), remedy)
    return str(path)


def describe(scene):
    """What run() of a script takes, found out by a process that loads it."""
    process = worker.take(scene)
    worker.giveBack(process)
    return process.about


def drawn(scene, runs, seed):
    """The random Table of the distributions VARY of a script."""
    process = worker.take(_script(scene))
    try:
        return process.ask(worker.START, "draw", runs, seed)
    finally:
        worker.giveBack(process)


# ---- workers -------------------------------------------------------------------------------------


class Local:
    """Workers on this machine: threads, with a process of YADE each."""

    def __init__(self, workers):
        self.executor = concurrent.futures.ThreadPoolExecutor(workers)

    def check(self):
        pass

    def end(self):
        self.executor.shutdown(wait=False, cancel_futures=True)
        worker.endAll()


def noScheduler(address, error):
    """Why a Dask scheduler cannot be used, and what to do."""
    if isinstance(error, ImportError):
        return f"needs Dask's distributed (Debian: apt install python3-distributed): {error}"
    return (
        f"scheduler = {address!r}: does not answer ({error}): start one by `dask-scheduler`, and give "
        "the address that it prints, tcp://host:8786"
    )


class Remote:
    """Workers of a Dask scheduler."""

    def __init__(self, address):
        worker.endIdle()  # this machine only hands out
        self.address = address
        try:
            from distributed import Client

            self._client = Client(address, timeout=ANSWER, set_as_default=False)
        except (ImportError, OSError, ValueError) as error:
            raise RuntimeError(noScheduler(address, error)) from error
        self.executor = self._client.get_executor(pure=False)
        if not self._client.scheduler_info()["workers"]:
            print(
                f"{address} has no workers yet, runs begin when it has: start some by `python3 -m "
                f"ancf.campaign.join {address}`",
                file=sys.stderr,
            )

    def check(self):
        """Raises RuntimeError if the scheduler is gone."""
        if self._client.status != "running":
            raise RuntimeError(
                f"the scheduler at {self.address} no longer answers: results so far are kept; start it and its "
                "workers anew, then this campaign, which goes on"
            )

    def end(self):
        with contextlib.suppress(Exception):  # a scheduler that is gone has nothing to end
            self.executor.shutdown(wait=False)
            self._client.run(worker.endIdle)
        self._client.close(timeout=ANSWER)


@contextlib.contextmanager
def _pool(scheduler, workers):
    pool = Local(workers) if scheduler is None else Remote(scheduler)
    try:
        yield pool
    finally:
        pool.end()


# ---- runs ----------------------------------------------------------------------------------------


def _runAll(pool, kept, table, scene, digest, limit):
    """Hands out all open runs, and keeps each when it is there."""
    with needed("python3-tqdm"):
        from tqdm import tqdm

    numbers, there = {}, queue.SimpleQueue()
    for number in kept.open():
        parameters = dict(zip(table.names, table.rows[number - 1]))
        future = pool.executor.submit(worker.work, scene, digest, number, parameters, limit)
        numbers[future] = number
        future.add_done_callback(there.put)
    total, done, failed = kept.count()
    seldom = 0.3 if sys.stderr.isatty() else 60
    with tqdm(total=total, initial=done, unit="run", mininterval=seldom, smoothing=0.05) as bar:
        while numbers:
            outcomes = []
            try:
                for future in _next(there, pool):
                    outcomes.append((numbers.pop(future), _outcome(future, pool)))
            finally:  # also when it is found that no worker can go on
                kept.keep(outcomes)
            failed += sum(outcome["error"] is not None for _, outcome in outcomes)
            bar.set_postfix(failed=failed, refresh=False)
            bar.update(len(outcomes))


def _next(there, pool):
    """All that has come back, at least one."""
    while True:
        try:
            found = [there.get(timeout=LOOK)]
            break
        except queue.Empty:
            pool.check()
    while not there.empty():
        found.append(there.get())
    return found


def _outcome(future, pool):
    """What a worker found; RuntimeError if none can work."""
    try:
        return future.result()
    except concurrent.futures.CancelledError:
        pool.check()
        raise RuntimeError("a run was cancelled: start again, which goes on") from None
    except Exception as error:
        if type(error).__name__ == "KilledWorker":
            told = f"KilledWorker: each of its workers ended, the last of them {error.last_worker}"
            return dict(results={}, error=told, cpuSeconds=None, worker=None)
        if isinstance(error, worker.CannotStart):
            raise
        raise RuntimeError(
            f"a worker cannot work ({type(error).__name__}: {error}): is yade-ancf installed there, and was it "
            "started by `python3 -m ancf.campaign.join`? Results so far are kept"
        ) from error
