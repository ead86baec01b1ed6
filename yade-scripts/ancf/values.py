"""Checks of values: each refusal names object, attribute, value and remedy."""

import math
import numbers

import numpy as np


def refuse(where, value, remedy, error=ValueError):
    """Raises `error` in one sentence: where ("Cable.diameter"), what was given, what to do."""
    raise error(f"{where} = {value!r}: {remedy}")


def _number(where, value):
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        refuse(where, value, "must be a number", TypeError)
    return float(value)


def positive(where, value, unit):
    """`value` as float; refused unless finite and above zero."""
    number = _number(where, value)
    if not (math.isfinite(number) and number > 0):
        refuse(where, value, f"must be finite and above zero [{unit}]")
    return number


def notNegative(where, value, unit):
    """`value` as float; refused unless finite and not below zero."""
    number = _number(where, value)
    if not (math.isfinite(number) and number >= 0):
        refuse(where, value, f"must be finite and not below zero [{unit}]")
    return number


def finite(where, value, unit):
    """`value` as float; refused unless finite."""
    number = _number(where, value)
    if not math.isfinite(number):
        refuse(where, value, f"must be finite [{unit}]")
    return number


def count(where, value, least):
    """`value` as int; refused if it is no whole number or below `least`."""
    if isinstance(value, bool) or not isinstance(value, numbers.Integral):
        refuse(where, value, "must be a whole number", TypeError)
    if value < least:
        refuse(where, value, f"must be at least {least}")
    return int(value)


def choice(where, value, allowed):
    """`value`; refused unless it is one of `allowed`."""
    if value not in allowed:
        refuse(where, value, "choose one of " + ", ".join(repr(a) for a in allowed))
    return value


def vector(where, value):
    """`value` as three finite floats (3,)."""
    try:
        v = np.array([float(x) for x in value])
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
    if np.linalg.norm(v) == 0:
        refuse(where, value, "has no direction: give a vector longer than zero")
    return v / np.linalg.norm(v)


def points(where, value):
    """`value` as an (n, 3) array of finite floats."""
    try:
        p = np.array([[float(x) for x in point] for point in value])
    except (TypeError, ValueError):
        refuse(where, value, "must be a list of points, three numbers each [m]", TypeError)
    if p.ndim != 2 or p.shape[1] != 3:
        refuse(where, value, "must be a list of points, three numbers each [m]")
    finiteRows = np.isfinite(p).all(axis=1)
    if not finiteRows.all():
        i = int(np.argmin(finiteRows))
        refuse(f"{where}[{i}]", tuple(p[i]), "must be finite [m]")
    return p
