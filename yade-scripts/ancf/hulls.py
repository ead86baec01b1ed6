"""Convex hulls of nets and of their targets, and how well they agree."""

from dataclasses import dataclass

import numpy as np
from yade import O, wrapper

from . import values
from .needs import needed
from .structure import findBody, matrix
from .surfaces import solids, surfaces

with needed("python3-scipy"):
    from scipy.spatial import ConvexHull, QhullError


@dataclass(frozen=True)
class Hull:
    """A convex body.

    volume    [m3]
    surface   [m2]; of a flat one both sides
    center    of its volume, a flat one's of its area (3) [m]
    """

    volume: float
    surface: float
    center: np.ndarray


def hull(points):
    """The convex Hull of points (n, 3) [m]."""
    points = np.asarray(points, float)
    middle = points.mean(axis=0)
    local = points - middle
    try:
        made = ConvexHull(local)
    except QhullError:  # it has no volume
        return _flat(local, middle)
    return Hull(float(made.volume), float(made.area), middle + _centroid(local[made.simplices]))


def _flat(local, middle):
    """The Hull of points (n, 3) around their middle that lie in a plane, on a line, or together."""
    _, sizes, axes = np.linalg.svd(local, full_matrices=False)
    if len(local) < 3 or sizes[1] < 1e-9 * sizes[0] or not sizes[0]:
        return Hull(0.0, 0.0, middle)
    made = ConvexHull(local @ axes[:2].T)
    center = middle + _centroid(made.points[made.simplices]) @ axes[:2]
    return Hull(0.0, 2 * float(made.volume), center)  # scipy's volume is the area there


def _centroid(faces):
    """Centroid (d) of the hull with these faces (n, d, d), the origin being inside."""
    parts = np.abs(np.linalg.det(faces))
    return parts @ faces.sum(axis=1) / ((faces.shape[-1] + 1) * parts.sum())


def targetSize(target):
    """Volume [m3], surface [m2] and characteristic length [m] of a body's convex hull; the length is the mean of
    its extents along its own three axes.

    Clumps count by the hull of their members. Spheres are exact, but in a clump they count with 32 faces around
    them, 1 % too small.
    """
    body = findBody("targetSize", target, "target")
    if isinstance(body.shape, wrapper.Sphere):
        r = body.shape.radius
        return 4 / 3 * np.pi * r**3, 4 * np.pi * r**2, 2 * r
    center = np.array(list(body.state.pos))
    found = surfaces(solids([target]), center)
    if not found:
        values.refuse("targetSize: target", target, "has no surface that is known here")
    points = np.concatenate([points for _, points, _ in found])
    extent = np.ptp((points - center) @ matrix(body.state.ori), axis=0)
    made = hull(points)
    if not made.volume > 0:
        values.refuse("targetSize: target", target, "is flat, and has no volume")
    return made.volume, made.surface, float(extent.mean())


def qualityIndex(net, target):
    """Capture quality index [-] of a net around a body: 0 where the net's convex hull is as large as the target's
    and in the same place.

        0.1 |V_n - V_t| / V_t + 0.1 |S_n - S_t| / S_t + 0.8 |q_n - q_t| / L_t

    with volume V, surface S and centre q of the convex hull of the net's nodes and of the target (its body's
    place), and the target's characteristic length L_t: Barnes and Botta, A quality index for net-based capture
    of space debris, Acta Astronautica 176 (2020), 455-463. It does not see whether the net is closed.
    """
    size = targetSize(target)
    return indexOf(hull(net._state()[0]), size, np.array(list(O.bodies[target].state.pos)))


def indexOf(made, size, center):
    """The index of a net's Hull, with targetSize() and place (3) [m] of its target."""
    volume, surface, length = size
    sizes = abs(made.volume / volume - 1) + abs(made.surface / surface - 1)
    return float(0.1 * sizes + 0.8 * np.linalg.norm(made.center - center) / length)
