"""The process that runs a scene: loads it once, then makes one run after the other.

`python3 -m ancf.campaign.scenes FD SCENE` is started by `worker`, which talks to it through the
socket FD.
"""

import fcntl
import hashlib
import importlib.util
import inspect
import numbers
import os
import pathlib
import random
import select
import sys
import time
import traceback
from multiprocessing.connection import Connection

import numpy as np

from . import tables

LAST = 300  # letters of an error that are kept


def digest(scene):
    """What tells a version of a script from others."""
    return hashlib.sha256(pathlib.Path(scene).read_bytes()).hexdigest()[:16]


def load(path):
    """The script as a module, without what it does as `__main__`."""
    path = pathlib.Path(path).resolve()
    sys.path.insert(0, str(path.parent))
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = sys.modules[path.stem] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    if not callable(getattr(module, "run", None)):
        raise ValueError(
            f"{path.name}: has no function run: define `def run(speed, ...)`, which builds the scene, "
            "steps it and returns a dict of results"
        )
    return module


def describe(module):
    """Parameters that run() takes (None: any), and those that it cannot do without."""
    parameters = inspect.signature(module.run).parameters.values()
    named = [p for p in parameters if p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY)]
    takesAny = any(p.kind is p.VAR_KEYWORD for p in parameters)
    return dict(
        parameters=None if takesAny else [p.name for p in named],
        needed=[p.name for p in named if p.default is p.empty],
    )


def drawn(module, runs, seed):
    """The random Table of the distributions that the script names in VARY."""
    if not isinstance(getattr(module, "VARY", None), dict):
        raise ValueError(
            f"{module.__name__}.py: random runs need VARY = dict(speed=campaign.uniform(1, 2), ...), "
            "the distribution of each parameter"
        )
    return tables.draw(runs, seed, **module.VARY)


def one(module, number, parameters):
    """Results of one run, or its error, and its cost."""
    from yade import O

    start = time.process_time()
    O.reset()
    O.trackEnergy = False
    random.seed(number)
    np.random.seed(number)
    try:
        outcome = dict(results=_plain(module.run(**parameters), parameters), error=None)
    except (Exception, SystemExit) as error:
        outcome = dict(results={}, error=_told(error))
    return dict(outcome, cpuSeconds=time.process_time() - start)


def _told(error):
    """Error and where it came from, in a line."""
    frames = traceback.extract_tb(error.__traceback__)
    where = f" ({pathlib.Path(frames[-1].filename).name}:{frames[-1].lineno})" if frames else ""
    text = f"{type(error).__name__}: {error}"[:LAST] + where
    return text.encode(errors="backslashreplace").decode()


def _plain(results, parameters):
    """Results as plain numbers and texts; refused if they are anything else."""
    if not isinstance(results, dict):
        raise TypeError(f"run() returned {results!r:.60}: must return a dict of results")
    plain = {}
    for name, value in results.items():
        value = value.item() if isinstance(value, np.generic) else value
        if not isinstance(name, str) or not name.isidentifier():
            raise ValueError(f"run(): result {name!r}: must have a name like a variable's")
        if name.casefold() in map(str.casefold, (*parameters, *tables.OWN)):
            raise ValueError(
                f"run(): result {name!r}: is a parameter's or the table's own: rename it"
            )
        if not (value is None or isinstance(value, (str, bool, numbers.Real))):
            raise TypeError(f"run(): result {name} = {value!r:.60}: must be a number or a text")
        if isinstance(value, int) and abs(value) >= 2**63:
            raise ValueError(f"run(): result {name} = {value}: is too large for a table")
        plain[name] = value
    return plain


def endWithParent():
    """Lets the kernel end this process (SIGIO) when the other end of its standard input closes:
    also while it computes, and however the parent ended.
    """
    fcntl.fcntl(0, fcntl.F_SETOWN, os.getpid())
    fcntl.fcntl(0, fcntl.F_SETFL, os.O_ASYNC)
    if select.select([0], [], [], 0)[0]:
        sys.exit("the process that started this one has ended")


def main(socket, scene):
    endWithParent()
    sys.stdout.reconfigure(line_buffering=True)  # of a run that crashes, its last words are kept
    connection = Connection(int(socket))
    try:
        module = load(scene)
        connection.send(("ready", dict(describe(module), digest=digest(scene))))
    except BaseException as error:
        connection.send(("cannot", _told(error)))
        return
    answers = {"run": one, "draw": drawn}
    while True:
        try:
            what, *arguments = connection.recv()
        except EOFError:
            return
        try:
            connection.send(("done", answers[what](module, *arguments)))
        except (ValueError, TypeError) as error:
            connection.send(("cannot", str(error)))


if __name__ == "__main__":
    main(*sys.argv[1:])
