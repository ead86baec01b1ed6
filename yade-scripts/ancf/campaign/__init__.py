"""Campaigns: a scene run over a table of parameters or random ones, on this machine or on many.

A scene script has a function `run`, whose arguments are the parameters and which returns a dict of
results; it builds its scene and steps it, as scripts do:

    def run(speed, angle=25.0):
        ...
        return dict(caught=True, time=O.time)

`python3 -m ancf.campaign scene.py --table runs.csv` runs it for every row, or call `run` here.
"""

from .results import Results
from .running import run
from .tables import Table, draw, grid, normal, read, uniform

__all__ = ["Results", "Table", "draw", "grid", "normal", "read", "run", "uniform"]
