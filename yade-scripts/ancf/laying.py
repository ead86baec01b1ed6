"""How a cable lies at the start: tangents and unstressed lengths.

A cable element is the cubic r(x) = S1 r0 + L S2 g0 + S3 r1 + L S4 g1 with x = s/L, end positions
r0, r1 [m] and end slopes g = dr/ds [-] (Shan, Guo, Gill 2019, Eq. 2-4).
"""

import numpy as np

_GAUSS_X, _GAUSS_W = np.polynomial.legendre.leggauss(8)
GAUSS_X, GAUSS_W = 0.5 * (_GAUSS_X + 1), 0.5 * _GAUSS_W  # on [0, 1]


def shape(x, length):
    """Weights of (r0, g0, r1, g1) in the position at x in [0, 1]; (..., 4). Eq. 3-4."""
    x = np.asarray(x, float)
    x2, x3 = x * x, x * x * x
    return np.stack(
        [1 - 3 * x2 + 2 * x3, length * (x - 2 * x2 + x3), 3 * x2 - 2 * x3, length * (x3 - x2)], -1
    )


def slopeWeights(x):
    """Weights of (g0, d, g1), d = (r1 - r0)/L, in the slope dr/ds at x; (..., 3)."""
    x = np.asarray(x, float)
    return np.stack([1 - 4 * x + 3 * x * x, 6 * x - 6 * x * x, 3 * x * x - 2 * x], -1)


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def tangents(p, closed):
    """Unit tangents (n, 3) of the curve through the points p (n, 3).

    Inside, that of the circle through three neighbouring points; at the ends, the neighbour's
    mirrored on the chord. Points on a straight line or on a circle so get the exact tangents.
    """
    n = len(p)
    chord = np.diff(p, axis=0, append=p[:1] if closed else 2 * p[-1:] - p[-2:-1])
    u, l = unit(chord), np.linalg.norm(chord, axis=1)
    t = np.empty_like(p)
    for i in range(n) if closed else range(1, n - 1):
        t[i] = u[i - 1] * l[i] + u[i] * l[i - 1]
        if np.linalg.norm(t[i]) < 1e-6 * (l[i] + l[i - 1]):
            raise ValueError(
                f"points[{i}] = {tuple(p[i])}: the cable turns back on itself there and has no "
                "tangent; round the corner off with more points, or lay two cables and tie them"
            )
        t[i] = unit(t[i])
    if not closed:
        t[0] = _mirrored(t[1], u[0]) if n > 2 else u[0]
        t[-1] = _mirrored(t[-2], u[-2]) if n > 2 else u[0]
    return t


def _mirrored(t, u):
    return 2 * np.dot(t, u) * u - t


def curveLength(r0, g0, r1, g1):
    """Arc length L of the cubic whose own L is the length of its parameter: a fixed point.
    Straight: the chord.
    """
    chord = np.linalg.norm(r1 - r0)
    if np.allclose(g0, g1) and np.allclose(g0 * chord, r1 - r0, rtol=1e-12, atol=1e-14 * chord):
        return chord
    length = chord
    for _ in range(200):
        weights = slopeWeights(GAUSS_X)
        slope = weights @ np.stack([g0, (r1 - r0) / length, g1])
        new = length * np.dot(GAUSS_W, np.linalg.norm(slope, axis=1))
        if abs(new - length) < 1e-14 * chord:
            return new
        length = new
    return length


def subdivide(r0, g0, r1, g1, elements):
    """Nodes (elements + 1, 3) at equal arc lengths of the cubic, and unit slopes there."""
    length = curveLength(r0, g0, r1, g1)
    x = np.linspace(0, 1, 401)
    slope = slopeWeights(x) @ np.stack([g0, (r1 - r0) / length, g1])
    speed = np.linalg.norm(slope, axis=1)
    arc = np.concatenate([[0], np.cumsum(0.5 * (speed[1:] + speed[:-1]))])
    at = np.interp(np.linspace(0, arc[-1], elements + 1), arc, x)
    nodes = shape(at, length) @ np.stack([r0, g0, r1, g1])
    slopes = unit(slopeWeights(at) @ np.stack([g0, (r1 - r0) / length, g1]))
    nodes[0], nodes[-1], slopes[0], slopes[-1] = r0, r1, g0, g1
    return nodes, slopes
