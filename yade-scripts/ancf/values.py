"""Checks of values: each refusal names object, attribute, value and remedy."""

import math
import numbers
from collections.abc import Iterable

import numpy as np


FARTHEST = 1e9  # that a point may be from the origin, or something thick [m]


def refuse(where, value, remedy, error=ValueError):
    """Raises `error` in one sentence: where ("Cable.diameter"), what was given, what to do."""
    plain = (
        value.item() if isinstance(value, np.generic) else value
    )  # numpy 2 writes np.float64(3.0)
    raise error(f"{where} = {plain!r}: {remedy}")


def _number(where, value):
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        refuse(where, value, "must be a number", TypeError)
    return float(value)


def positive(where, value, unit, most=None):
    """`value` as float; refused unless finite, above zero and not above `most`."""
    number = _number(where, value)
    if not (math.isfinite(number) and number > 0):
        refuse(where, value, f"must be finite and above zero [{unit}]")
    if most is not None and number > most:
        refuse(where, value, f"must be at most {most:g} [{unit}]")
    return number


def notNegative(where, value, unit, most=None):
    """`value` as float; refused unless finite, not below zero and not above `most`."""
    number = _number(where, value)
    if not (math.isfinite(number) and number >= 0):
        refuse(where, value, f"must be finite and not below zero [{unit}]")
    if most is not None and number > most:
        refuse(where, value, f"must be at most {most:g} [{unit}]")
    return number


def finite(where, value, unit):
    """`value` as float; refused unless finite."""
    number = _number(where, value)
    if not math.isfinite(number):
        refuse(where, value, f"must be finite [{unit}]")
    return number


def count(where, value, least, most=None):
    """`value` as int; refused if it is no whole number, below `least` or above `most`."""
    if isinstance(value, bool) or not isinstance(value, numbers.Integral):
        refuse(where, value, "must be a whole number", TypeError)
    if value < least:
        refuse(where, value, f"must be at least {least}")
    if most is not None and value > most:
        refuse(where, value, f"must be at most {most}")
    return int(value)


def flag(where, value):
    """`value` as bool; refused unless it is True or False, or 1 or 0."""
    if not isinstance(value, (bool, np.bool_)) and value not in (0, 1):
        refuse(where, value, "must be True or False", TypeError)
    return bool(value)


def choice(where, value, allowed):
    """`value`; refused unless it is one of `allowed`."""
    if not any(value is a or (isinstance(value, type(a)) and value == a) for a in allowed):
        refuse(where, value, "choose one of " + ", ".join(repr(a) for a in allowed))
    return value


def _component(x):
    """x as float; text that reads like a number is none."""
    if isinstance(x, (str, bytes, bool)):
        raise TypeError
    return float(x)


def sequence(where, value, what):
    """`value` as list; refused if it is text or nothing that can be gone through."""
    if isinstance(value, (str, bytes)) or not isinstance(value, Iterable):
        refuse(where, value, f"must be a list of {what}", TypeError)
    return list(value)


def vector(where, value):
    """`value` as three finite floats (3,)."""
    try:
        v = np.array([_component(x) for x in value])
    except (TypeError, ValueError):
        refuse(where, value, "must be a vector of three numbers", TypeError)
    if v.shape != (3,):
        refuse(where, value, "must be a vector of three numbers")
    if not np.isfinite(v).all():
        refuse(where, value, "must be finite")
    return v


def direction(where, value):
    """`value` as a unit vector (3,); refused if its length is zero."""
    v = vector(where, value)
    largest = np.abs(v).max()
    if largest == 0:
        refuse(where, value, "has no direction: give a vector longer than zero")
    v = v / largest
    return v / np.linalg.norm(v)


def points(where, value):
    """`value` as an (n, 3) array of finite floats."""
    try:
        p = np.array([[_component(x) for x in point] for point in value])
    except (TypeError, ValueError):
        refuse(where, value, "must be a list of points, three numbers each [m]", TypeError)
    if p.ndim != 2 or p.shape[1] != 3:
        refuse(where, value, "must be a list of points, three numbers each [m]")
    finiteRows = np.isfinite(p).all(axis=1)
    if not finiteRows.all():
        i = int(np.argmin(finiteRows))
        refuse(f"{where}[{i}]", tuple(p[i]), "must be finite [m]")
    if np.abs(p).max(initial=0) > FARTHEST:
        i = int(np.argmax(np.abs(p).max(axis=1)))
        remedy = f"must be within {FARTHEST:g} m of the origin: use metres, and an origin nearby"
        refuse(f"{where}[{i}]", tuple(p[i]), remedy)
    return p


def brake(where, value, force=0.0):
    """The tension [N] from which a winch slips that draws with up to a force [N]; inf: it never does."""
    if value != math.inf:
        value = positive(where, value, "N")
    if value < force:
        refuse(where, value, f"must be at least force = {force:g} N, or it could never draw")
    return value
