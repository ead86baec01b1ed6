"""Cables and nets for YADE: ANCF elements, mass-spring chains, Hollars friction."""

import pkgutil

# A script beside this source folder finds the compiled part in the folders of PYTHONPATH.
__path__ = pkgutil.extend_path(__path__, __name__)

from . import _load  # noqa: E402

globals().update(_load.classes)

from ._built import VERSION as __version__  # noqa: E402
from .cables import Cable  # noqa: E402
from .lines import Line, lines  # noqa: E402
from .materials import ropeMaterial  # noqa: E402
from .nets import Net  # noqa: E402
from .record import structures  # noqa: E402
from .running import progress, settle, stop  # noqa: E402
from .scene import check, engines, plan, timeStep  # noqa: E402
from .winches import Winch, winches  # noqa: E402

__all__ = [
    *_load.classes,
    "Cable",
    "Line",
    "Net",
    "Winch",
    "check",
    "engines",
    "lines",
    "plan",
    "progress",
    "ropeMaterial",
    "settle",
    "stop",
    "structures",
    "timeStep",
    "winches",
]
