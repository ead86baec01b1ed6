"""Unstressed length other than the length as laid: slack and pre-tension."""

import numpy as np

from . import values

MOST, LEAST = 3.0, 0.1  # that a cable may be laid as long as its unstressed length


def underTension(force, section):
    """How many times its unstressed length a straight element of a section is under forces [N]
    (n): T = EA (ratio^2 - 1)/2 ratio for Green's strain, EA (ratio - 1) for engineering strain.
    """
    pull = np.asarray(force, float) / section.ea
    if section.engineering:
        return 1 + pull
    ratio = (
        np.cbrt(2 * pull) + 1.0
    )  # above the root of ratio^3 - ratio = 2 T/EA, where that is convex
    for _ in range(60):
        ratio = ratio - (ratio**3 - ratio - 2 * pull) / (3 * ratio**2 - 1)
    return ratio


def oneOf(prefix, **given):
    """(name, value) of the one of several that is not None, or None. ValueError for two."""
    known = [(what, value) for what, value in given.items() if value is not None]
    if len(known) > 1:
        both = " and ".join(f"{what} = {value!r}" for what, value in known)
        raise ValueError(
            f"{prefix}{both}: give one of {', '.join([*given][:-1])} and {[*given][-1]}"
        )
    return known[0] if known else None


def ratios(prefix, section, laid, length=None, slack=None, tension=None):
    """How many times its unstressed length each of n curves of lengths laid (n) [m] is laid, (n).

    length [m], slack [-]: unstressed length less that as laid, in parts of the latter, or
    tension [N] >= 0: one of the three, a number or one for each curve; none: 1. prefix: of their
    names in messages.
    """
    given = oneOf(prefix, length=length, slack=slack, tension=tension)
    if given is None:
        return np.ones(len(laid))
    what, value = given
    each = _each(f"{prefix}{what}", value, len(laid))
    if what == "length":
        numbers = [values.positive(where, v, "m") for where, v in each]
        ratio = laid / numbers
    elif what == "slack":
        numbers = [values.finite(where, v, "-") for where, v in each]
        ratio = 1 / np.maximum(1 + np.array(numbers), 1e-300)
    else:
        numbers = [values.notNegative(where, v, "N", most=1e300) for where, v in each]
        ratio = underTension(numbers, section)
    wrong = ~((LEAST <= ratio) & (ratio <= MOST))
    if wrong.any():
        i = int(np.argmax(wrong))
        remedy = (
            f"it would be laid {ratio[i]:.3g} times as long as it is without stress; "
            f"must be from {LEAST:g} to {MOST:g}"
        )
        values.refuse(each[i][0], numbers[i], remedy)
    return ratio


def _each(where, value, n):
    """(place in words, value) for each of n curves."""
    if isinstance(value, str) or not hasattr(value, "__len__"):
        return [(where, value)] * n
    if len(value) != n:
        remedy = f"must be a number, or one for each of {n} edges" if n > 1 else "must be a number"
        values.refuse(where, value, remedy)
    return [(f"{where}[{i}]", v) for i, v in enumerate(value)]
