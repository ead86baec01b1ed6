"""Cables and nets for YADE: ANCF elements, mass-spring chains, Hollars friction."""

from . import _load

globals().update(_load.classes)

from .cables import Cable  # noqa: E402
from .nets import Net  # noqa: E402
from .scene import check, engines, timeStep  # noqa: E402

__all__ = [*_load.classes, "Cable", "Net", "check", "engines", "timeStep"]
