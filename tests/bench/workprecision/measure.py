"""CPU time of a run, and the row that it becomes."""

import math
import statistics
import time
from dataclasses import dataclass

import numpy as np
from yade import O, wrapper

INSIDE = 40  # leapfrog steps of a cable in one step of YADE, where nothing touches
LEAST, REPEATS = 0.3, 3  # runs that take less [s] are made so many times
FIRST = 2  # steps that are not measured: checks and the factors of mass and stiffness


@dataclass
class Row:
    """One run. error and second: see the case."""

    method: str  # a line of the diagram
    elements: int
    mass: str
    integrator: str
    step: float  # [s]; of the cable itself
    cpu: float  # [s]
    error: float
    second: float = math.nan


def cpuOf(steps):
    """CPU time of O.run(steps) [s]."""
    start = time.process_time()
    O.run(steps, True)
    return time.process_time() - start


def timed(build, duration):
    """Builds the scene, which sets O.dt, and runs it for a duration [s]; CPU time [s] of all steps as
    that of those behind the first, the median of a few runs if they are short.
    """
    found = []
    while not found or (found[0] < LEAST and len(found) < REPEATS):
        build()
        steps = max(FIRST + 1, math.ceil(duration / O.dt * (1 - 1e-9)))
        O.dt = duration / steps
        O.run(FIRST, True)
        found.append(cpuOf(steps - FIRST) * steps / (steps - FIRST))
    return statistics.median(found)


def withoutCollider(engines):
    """The list without what only scenes with contact need."""
    return [e for e in engines if not isinstance(e, wrapper.InsertionSortCollider)]


def rms(a, b):
    """Root of the mean squared distance of points (n, 3)."""
    return float(np.sqrt(((np.asarray(a) - np.asarray(b)) ** 2).sum(axis=-1).mean()))
