"""How a cable lies at the start: tangents and unstressed lengths.

A cable element is the cubic r(x) = S1 r0 + L S2 g0 + S3 r1 + L S4 g1 with x = s/L, end positions
r0, r1 [m] and end slopes g = dr/ds [-] (Shan, Guo, Gill 2019, Eq. 2-4).
"""

import numpy as np

_GAUSS_X, _GAUSS_W = np.polynomial.legendre.leggauss(8)
GAUSS_X, GAUSS_W = 0.5 * (_GAUSS_X + 1), 0.5 * _GAUSS_W  # on [0, 1]


def shape(x, length):
    """Weights of (r0, g0, r1, g1) in the position at x in [0, 1]; (..., 4). Eq. 3-4.

    length: one for all x, or of any shape that goes with theirs.
    """
    x, length = np.broadcast_arrays(np.asarray(x, float), length)
    x2, x3 = x * x, x * x * x
    return np.stack(
        [1 - 3 * x2 + 2 * x3, length * (x - 2 * x2 + x3), 3 * x2 - 2 * x3, length * (x3 - x2)], -1
    )


def slopeWeights(x):
    """Weights of (g0, d, g1), d = (r1 - r0)/L, in the slope dr/ds at x; (..., 3)."""
    x = np.asarray(x, float)
    return np.stack([1 - 4 * x + 3 * x * x, 6 * x - 6 * x * x, 3 * x * x - 2 * x], -1)


def curvatureWeights(x):
    """Weights of (g0, d, g1) in L d2r/ds2 at x; (..., 3)."""
    x = np.asarray(x, float)
    return np.stack([6 * x - 4, 6 - 12 * x, 6 * x - 2], -1)


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def tangents(p, closed):
    """Unit tangents (n, 3) of the curve through the points p (n, 3).

    Inside, that of the circle through three neighbouring points; at the ends, the neighbour's
    mirrored on the chord. Points on a straight line or on a circle so get the exact tangents.
    """
    chord = np.diff(p, axis=0, append=p[:1] if closed else 2 * p[-1:] - p[-2:-1])
    u, l = unit(chord), np.linalg.norm(chord, axis=1, keepdims=True)
    before, lengthBefore = np.roll(u, 1, axis=0), np.roll(l, 1, axis=0)
    t = before * l + u * lengthBefore
    inner = slice(None) if closed else slice(1, -1)
    turned = np.linalg.norm(t, axis=1) < 1e-6 * (l + lengthBefore)[:, 0]
    if turned[inner].any():
        i = int(np.argmax(turned[inner])) + (not closed)
        raise ValueError(
            f"points[{i}] = {tuple(p[i])}: the cable turns back on itself there and has no "
            "tangent; round the corner off with more points, or lay two cables and tie them"
        )
    t[inner] = unit(t[inner])
    if not closed:
        t[0] = _mirrored(t[1], u[0]) if len(p) > 2 else u[0]
        t[-1] = _mirrored(t[-2], u[-2]) if len(p) > 2 else u[0]
    return t


def _mirrored(t, u):
    return 2 * np.dot(t, u) * u - t


def curveLength(r0, g0, r1, g1):
    """Arc lengths L (...) of the cubics whose own L is the length of their parameter: a fixed
    point. Straight: the chord. r0, g0, r1, g1: (..., 3). As exact as the positions' last digits.
    """
    chord = np.linalg.norm(r1 - r0, axis=-1)
    length = chord.copy()
    digits = 4 * np.finfo(float).eps * np.maximum(np.abs(r0), np.abs(r1)).max(axis=-1)
    aside = np.abs(g0 * chord[..., None] - (r1 - r0)).max(axis=-1)
    bent = ~(np.isclose(g0, g1).all(axis=-1) & (aside <= 1e-12 * chord + digits))
    weights = slopeWeights(GAUSS_X)
    for _ in range(200):
        if not bent.any():
            break
        middle = (r1[bent] - r0[bent]) / length[bent, None]
        slope = weights @ np.stack([g0[bent], middle, g1[bent]], axis=-2)
        new = length[bent] * (np.linalg.norm(slope, axis=-1) @ GAUSS_W)
        unsettled = np.abs(new - length[bent]) >= 1e-14 * chord[bent] + digits[bent]
        length[bent] = new
        bent[bent] = unsettled
    return length


TABLE = 401  # arc lengths by which a cubic is divided
TOGETHER = 256  # cubics that are divided at once


def subdivide(r0, g0, r1, g1, parts):
    """Nodes (n, parts + 1, 3) at equal arc lengths of n cubics, and unit slopes there; r0, g0, r1,
    g1: (n, 3), g0 and g1 unit vectors.
    """
    nodes, slopes = np.stack([r0, r1], axis=1), np.stack([g0, g1], axis=1)
    if parts == 1:
        return nodes, slopes
    blocks = range(0, len(r0), TOGETHER)
    inner = [_divide(*(v[k : k + TOGETHER] for v in (r0, g0, r1, g1)), parts) for k in blocks]
    between = [np.concatenate(each) for each in zip(*inner)]
    return tuple(
        np.concatenate([end[:, :1], middle, end[:, 1:]], axis=1)
        for end, middle in zip((nodes, slopes), between)
    )


def _divide(r0, g0, r1, g1, parts):
    """Inner nodes and unit slopes, (n, parts - 1, 3) each."""
    length = curveLength(r0, g0, r1, g1)[:, None]
    x = np.linspace(0, 1, TABLE)
    ends = np.stack([g0, (r1 - r0) / length, g1], axis=1)
    speed = np.linalg.norm(slopeWeights(x) @ ends, axis=-1)
    arc = np.zeros_like(speed)
    np.cumsum(0.5 * (speed[:, 1:] + speed[:, :-1]), axis=1, out=arc[:, 1:])
    share = np.linspace(0, 1, parts + 1)[1:-1]
    at = np.array([np.interp(share * a[-1], a, x) for a in arc])
    nodes = shape(at, length) @ np.stack([r0, g0, r1, g1], axis=1)
    return nodes, unit(slopeWeights(at) @ ends)
