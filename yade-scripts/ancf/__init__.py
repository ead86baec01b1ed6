"""Cables and nets for YADE: ANCF elements, mass-spring chains, Hollars friction."""

from . import _load

globals().update(_load.classes)
__all__ = list(_load.classes)
