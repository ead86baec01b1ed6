"""A worker's side: keeps a process with YADE, gives it runs, and starts it anew when one of them ends
it or takes too long.
"""

import os
import pathlib
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from multiprocessing.connection import Connection

START = 120  # in which YADE and a scene have to load [s]
INSIDE = "ANCF_CAMPAIGN"  # environment variable of the processes that run scenes
RENEW = 1000  # runs of a process: YADE never frees all of a scene


class CannotStart(RuntimeError):
    """This scene cannot be run here at all."""


class Process:
    """A process of its own that has YADE and a scene loaded."""

    def __init__(self, scene):
        self.scene, self.runs = scene, 0
        self._output = tempfile.TemporaryFile("a+b")  # truncated between runs
        ours, theirs = socket.socketpair()
        folders = [str(pathlib.Path(folder).parent) for folder in sys.modules["ancf"].__path__]
        path = os.pathsep.join(filter(None, [*folders, os.environ.get("PYTHONPATH")]))
        with theirs:
            self._process = subprocess.Popen(
                [sys.executable, "-m", __package__ + ".scenes", str(theirs.fileno()), scene],
                stdin=subprocess.PIPE,  # held open: the process ends with this one
                stdout=self._output,
                stderr=subprocess.STDOUT,
                env={**os.environ, "PYTHONPATH": path, INSIDE: "1"},
                pass_fds=[theirs.fileno()],
                start_new_session=True,  # Ctrl-C is for the campaign
            )
        self._connection = Connection(ours.detach())
        try:
            self.about = self._answer(START, "to load")
        except BaseException:
            self.end()
            raise

    @property
    def pid(self):
        return self._process.pid

    @property
    def alive(self):
        return self._process.poll() is None

    def ask(self, limit, *task):
        """The answer to a task; RuntimeError if the process ended or took longer than limit [s]."""
        self._output.truncate(0)
        return self._answer(limit, "the time limit of a run", task)

    def _answer(self, limit, why, task=None):
        try:
            if task:
                self._connection.send(task)
            if not self._connection.poll(limit):
                self.kill()
                raise TimeoutError(f"took more than {limit:g} s, {why}: ended{self._said()}")
            state, answer = self._connection.recv()
        except (EOFError, ConnectionError):
            raise RuntimeError(f"YADE {self._how()}{self._said()}") from None
        if state == "cannot":
            raise CannotStart(answer)
        return answer

    def _how(self):
        """How the process ended."""
        code = self._process.wait()
        if code < 0:
            return f"ended by signal {signal.Signals(-code).name}"
        return f"ended with exit code {code}"

    def _said(self):
        """The last words of its output."""
        self._output.seek(0)
        lines = self._output.read().decode(errors="replace").strip("\0 \n").splitlines()
        return f"; its last words: {' / '.join(lines[-3:])[-300:]}" if lines else ""

    def kill(self):
        self._process.kill()
        self._process.wait()

    def end(self):
        self.kill()
        self._process.stdin.close()
        self._connection.close()
        self._output.close()


_idle, _all, _lock = [], set(), threading.Lock()


def take(scene):
    """A process that has the scene loaded and nothing to do."""
    with _lock:
        fit = [p for p in _idle if p.scene == scene and p.alive]
        others = [p for p in _idle if p not in fit]
        found = fit.pop() if fit else None
        _idle[:] = fit
    for process in others:
        _end(process)
    if found:
        return found
    try:
        process = Process(scene)
    except (CannotStart, RuntimeError, TimeoutError, OSError) as error:
        raise CannotStart(f"{scene} cannot be run on {socket.gethostname()}: {error}") from error
    with _lock:
        _all.add(process)
    return process


def giveBack(process):
    process.runs += 1
    if process.runs >= RENEW:
        _end(process)
    else:
        with _lock:
            _idle.append(process)


def _end(process):
    with _lock:
        _all.discard(process)
    process.end()


def endIdle():
    """Ends the processes that have nothing to do."""
    with _lock:
        ending = list(_idle)
        _idle.clear()
    for process in ending:
        _end(process)


def endAll():
    """Ends the idle processes, and kills the busy ones, which ends the work() that waits for them."""
    endIdle()
    with _lock:
        busy = list(_all)
    for process in busy:
        process.kill()


def work(scene, digest, number, parameters, limit):
    """One run by a process of this worker: dict of results, error, cpuSeconds and worker.

    Raises CannotStart if no run of this scene can be made here.
    """
    process = take(scene)
    if process.about["digest"] != digest:
        _end(process)
        raise CannotStart(
            f"{scene} on {socket.gethostname()} is another version than that of the campaign: put it back, "
            "or start a campaign with other results"
        )
    start = time.perf_counter()
    try:
        outcome = process.ask(limit, "run", number, parameters)
    except (RuntimeError, TimeoutError) as error:
        _end(process)
        outcome = dict(results={}, error=str(error), cpuSeconds=time.perf_counter() - start)
    else:
        giveBack(process)
    return dict(outcome, worker=f"{socket.gethostname()}:{process.pid}")
