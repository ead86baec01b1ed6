"""Tables of parameters: from a CSV, all combinations, or random ones."""

import csv
import itertools
import math
import numbers
import pathlib

import numpy as np

from .. import values
from ..needs import needed

OWN = ("run", "finished", "worker", "cpuSeconds", "error")  # columns of the results' own


class Table:
    """Names of parameters and, for each run, their values: numbers, texts, True and False."""

    def __init__(self, names, rows, source="Table"):
        self.names, self.source = list(names), str(source)
        self._checkNames()
        self.rows = [self._checked(i, row) for i, row in enumerate(rows, 1)]
        if not self.rows:
            raise ValueError(f"{self.source}: has no runs: give at least one row of values")

    def __len__(self):
        return len(self.rows)

    def _checkNames(self):
        seen = {}
        for place, name in enumerate(self.names, 1):
            where = f"{self.source}: column {place}"
            if not isinstance(name, str) or not name.isidentifier():
                values.refuse(where, name, "must be the name of a parameter of run()")
            if name.casefold() in seen:
                values.refuse(
                    where, name, f"is column {seen[name.casefold()]} already: take one out"
                )
            if name.casefold() in map(str.casefold, OWN):
                values.refuse(where, name, "is a column of the results' own: rename the parameter")
            seen[name.casefold()] = place

    def _checked(self, number, row):
        row = [x.item() if isinstance(x, np.generic) else x for x in row]
        if len(row) != len(self.names):
            raise ValueError(
                f"{self.source}: run {number} has {len(row)} values for {len(self.names)} columns "
                f"({', '.join(self.names)})"
            )
        for name, value in zip(self.names, row):
            where = f"{self.source}: run {number}, {name}"
            if not isinstance(value, (str, bool, numbers.Real)) or value == "":
                values.refuse(where, value, "must be a number or a text", TypeError)
            if isinstance(value, float) and not math.isfinite(value):
                values.refuse(where, value, "must be finite")
            if isinstance(value, int) and abs(value) >= 2**63:
                values.refuse(where, value, "is too large for a table: write it with a point")
        return tuple(row)

    def checkParameters(self, scene, parameters, needed):
        """Refuses columns that run() does not take, and needed parameters that have none. parameters:
        None where it takes any.
        """
        known = needed if parameters is None else parameters
        takes = f"run() of {scene} takes {', '.join(known) or 'nothing'}"
        for name in self.names:
            if parameters is not None and name not in known:
                values.refuse(f"{self.source}: column", name, f"unknown: {takes}")
        missing = [name for name in needed if name not in self.names]
        if missing:
            raise ValueError(
                f"{self.source}: has no column {', '.join(missing)}: {takes}; add it, or give the "
                "argument of run() a default"
            )


def read(path):
    """The Table of a CSV file: names in the first line, a run in each further one.

    Raises ValueError that names line and column.
    """
    path = pathlib.Path(path)
    with open(path, newline="", encoding="utf-8-sig") as file:
        lines = [line for line in csv.reader(file, skipinitialspace=True) if line]
    if not lines:
        raise ValueError(f"{path}: is empty: write the parameters' names into its first line")
    return Table([n.strip() for n in lines[0]], [map(_value, line) for line in lines[1:]], path)


def _value(text):
    """The whole number, number, or True, False that a text says, or the text."""
    text = text.strip()
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return {"True": True, "False": False}.get(text, text)


def grid(**axes):
    """The Table of all combinations: grid(speed=[1, 1.5, 2], angle=[20, 25])."""
    lists = [values.sequence(f"grid: {name}", axis, "values") for name, axis in axes.items()]
    return Table(axes, itertools.product(*lists), "grid()")


def draw(runs, seed=1, **distributions):
    """The Table of independent random parameters: draw(1000, speed=uniform(1, 2), spin=normal(0, 3)).

    distributions   uniform, normal, or any other with ppf(), as those of scipy.stats
    The same seed gives the same runs, and more of them begin with the same.
    """
    runs = values.count("draw: runs", runs, 1)
    seed = values.count("draw: seed", seed, 0)
    for name, distribution in distributions.items():
        if not hasattr(distribution, "ppf"):
            remedy = "must be a distribution: uniform(low, high), normal(mean, deviation) or one of scipy.stats"
            values.refuse(f"draw: {name}", distribution, remedy, TypeError)
    chances = np.random.default_rng(seed).random((runs, len(distributions)))
    columns = [d.ppf(chance) for d, chance in zip(distributions.values(), chances.T)]
    return Table(distributions, zip(*columns), f"draw({runs}, seed={seed})")


def uniform(low, high):
    """Any number from low to high, each as likely."""
    with needed("python3-scipy"):
        from scipy import stats

    low, high = (values.finite(f"uniform: {n}", x, "") for n, x in (("low", low), ("high", high)))
    if low >= high:
        values.refuse("uniform: high", high, f"must be above low = {low:g}")
    return stats.uniform(low, high - low)


def normal(mean, deviation):
    """Normally distributed numbers; deviation: the standard one."""
    with needed("python3-scipy"):
        from scipy import stats

    mean = values.finite("normal: mean", mean, "")
    return stats.norm(mean, values.positive("normal: deviation", deviation, "unit of the mean"))
