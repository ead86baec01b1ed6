"""Cables."""

import numpy as np

from . import values
from .arguments import documented
from .laying import curveLength, subdivide, tangents
from .stretch import ratios
from .structure import Run, Structure, layEdges, layStraight, section


def divisions(name, model, elements, midPoints):
    """Elements an edge consists of: `elements` for ANCF, midPoints + 1 springs."""
    elements = values.count(f"{name}.elements", elements, 1)
    midPoints = values.count(f"{name}.midPoints", midPoints, 0)
    if model != "springs":
        if midPoints:
            values.refuse(
                f"{name}.midPoints", midPoints, "belongs to model='springs'; use elements="
            )
        return elements
    if elements != 1:
        values.refuse(f"{name}.elements", elements, "belongs to model='ancf'; use midPoints=")
    return midPoints + 1


@documented
class Cable(Structure):
    """A cable along a polyline.

    points           (n, 3) [m], its knots; every segment between two of them is an edge of
                     `elements` elements. The cable goes through the points smoothly, and unless
                     length, slack or tension is given it is as long as it lies: a straight or round
                     one starts without strain. Its ends have slopes of their own, free unless
                     clamped.
    closed           the last point joins the first (belts)
    {arguments}
    """

    def __init__(
        self,
        points,
        elements=1,
        *,
        diameter,
        material,
        model="ancf",
        midPoints=0,
        contact="curve",
        contactPoints=3,
        length=None,
        slack=None,
        tension=None,
        damping=0.0,
        massDamping=0.0,
        area=None,
        bending=None,
        mass="consistent",
        axialRule="exact",
        curvature="fast",
        strain="green",
        selfContact=False,
        closed=False,
        mask=1,
        label="Cable",
    ):
        sec = section(
            label,
            material,
            diameter,
            area,
            bending,
            model,
            mass,
            axialRule,
            curvature,
            strain,
            damping,
            massDamping,
        )
        parts = divisions(label, model, elements, midPoints)
        closed = values.flag(f"{label}.closed", closed)
        p = _checkedPoints(label, points, closed)
        layout = _laySprings(p, parts, closed) if model == "springs" else _lay(p, parts, closed)
        laid = np.array([layout.length.sum()])
        layout.stretch(
            ratios(f"{label}.", sec, laid, length, slack, tension).repeat(len(layout.length))
        )
        super().__init__(label, sec, layout, contact, contactPoints, selfContact, mask)

    @staticmethod
    def _runs(edges, parts):
        return [Run(0, len(edges) * parts, (int(edges[0, 0]), int(edges[-1, 1])))]

    def _own(self):
        return {"stored": self._stored} if self._stored else {}

    def _recall(self, own):
        self._stored = tuple(own["stored"]) if own.get("stored") else None

    @property
    def _span(self):
        return self.spans[0]

    def point(self, s):
        """Position [m] at s in [0, 1] along the unstressed length, Vector3."""
        return self._span.point(s)

    def velocity(self, s):
        """Velocity [m/s] at s, Vector3."""
        return self._span.velocity(s)

    def tension(self, s):
        """Tension at s, damping included [N]."""
        return self._span.tension(s)

    def maxTension(self):
        """Largest tension now [N], and s where it is: (tension, s). Of 8 places of each element and
        its end."""
        tension, _, s = self._mostTension()
        return tension, s

    def strain(self, s):
        """Strain at s [-]: Green's, or engineering strain, as for springs always."""
        return self._span.strain(s)

    def curve(self, k=8):
        """Points on the true curve, k per element and the last end, (k elements + 1, 3) numpy
        [m].
        """
        return self._span.curve(k)

    def tensions(self, k=8):
        """Tension at the points of curve(k) [N]."""
        return self._span.tensions(k)


def _checkedPoints(name, given, closed):
    p = values.points(f"{name}.points", given)
    least = 3 if closed else 2
    if len(p) < least:
        values.refuse(f"{name}.points", given, f"a cable needs at least {least} points here")
    following = np.roll(p, -1, axis=0) if closed else p[1:]
    gaps = np.linalg.norm(following - p[: len(following)], axis=1)
    coincide = gaps <= 1e-12 * max(1.0, np.abs(p).max())
    if coincide.any():
        i = int(np.argmax(coincide))
        j = (i + 1) % len(p)
        raise ValueError(
            f"{name}.points[{i}] and [{j}] = {tuple(p[i])} coincide: take one of them out"
            + (" (a closed cable joins the last point to the first itself)" if j == 0 else "")
        )
    return p


def _edges(p, closed):
    """Knot numbers (edges, 2)."""
    n = len(p)
    start = np.arange(n if closed else n - 1)
    return np.stack([start, (start + 1) % n], axis=1)


def _lay(p, parts, closed):
    """Layout of an ANCF cable: smooth from its first element to its last."""
    edges, t = _edges(p, closed), tangents(p, closed)
    i, j = edges.T
    nodes, slopes = subdivide(p[i], t[i], p[j], t[j], parts)
    lengths = curveLength(nodes[:, :-1], slopes[:, :-1], nodes[:, 1:], slopes[:, 1:])
    layout = layEdges(p, edges, nodes, slopes, lengths)
    count = len(layout.ends)
    layout.next = np.append(np.arange(1, count), 0 if closed else -1)
    layout.runs = Cable._runs(layout.edges, parts)
    return layout


def _laySprings(p, parts, closed):
    """Layout of a chain of springs: straight from point to point."""
    layout = layStraight(p, _edges(p, closed), parts)
    layout.runs = Cable._runs(layout.edges, parts)
    return layout
