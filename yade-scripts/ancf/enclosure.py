"""A net as a surface: its meshes, filled, and how far it encloses a body."""

import numpy as np
from yade import O

from . import values
from .structure import findBody

DIRECTIONS = 400  # in which enclosedShare looks; its error is about 1 %


def meshes(edges):
    """Meshes of a net: shortest closed ways through each of its edges, as lists of knots in order.

    edges   pairs of knot numbers

    In a net of squares, triangles or hexagons, and in a spider's web, these are its meshes. A hole wider than
    the meshes around it, and the mouth, are none.
    """
    neighbours = {}
    for a, b in edges:
        neighbours.setdefault(a, []).append(b)
        neighbours.setdefault(b, []).append(a)
    found = {}
    for a, b in edges:
        for way in _shortest(neighbours, a, b):
            found.setdefault(frozenset(way), way)
    return list(found.values())


def _shortest(neighbours, a, b):
    """All shortest ways from a to b, as lists of knots, but for the edge between them."""
    far, ring = {b: 0}, [b]  # how many edges a knot is from b
    while ring and a not in far:
        last, ring = ring, []
        for knot in last:
            for k in neighbours[knot]:
                if k not in far and {k, knot} != {a, b}:
                    far[k] = far[knot] + 1
                    ring.append(k)
    ways = [[a]] if a in far else []
    for left in reversed(range(far.get(a, 0))):
        ways = [
            [*way, k]
            for way in ways
            for k in neighbours[way[-1]]
            if far.get(k) == left and {k, way[-1]} != {a, b}
        ]
    return ways


class Skin:
    """Triangles that fill the meshes of a net, each between two nodes and the middle of its mesh."""

    def __init__(self, net):
        layout = net._layout
        between = {}  # nodes along an edge, from its first knot on
        for run in layout.runs:
            ends = layout.ends[run.first : run.first + run.count]
            way = [*ends[:, 0], ends[-1, 1]]
            between[run.knots] = way
            between[run.knots[::-1]] = way[::-1]
        rings = []
        for mesh in meshes([run.knots for run in layout.runs]):
            sides = zip(mesh, mesh[1:] + mesh[:1])
            rings.append([node for side in sides for node in between[side][:-1]])
        self.corner = np.array([k for ring in rings for k in ring], int)
        self.after = np.array([k for ring in rings for k in ring[1:] + ring[:1]], int)
        self.mesh = np.repeat(np.arange(len(rings)), [len(ring) for ring in rings])
        self.sizes = np.bincount(self.mesh)[:, None]
        self.starts = np.flatnonzero(np.diff(self.mesh, prepend=-1))

    def corners(self, nodes):
        """Corners a, b, c (n, 3) of the triangles, at places of the net's nodes (m, 3)."""
        a = nodes[self.corner]
        middle = np.add.reduceat(a, self.starts) / self.sizes if len(a) else a
        return a, nodes[self.after], middle[self.mesh]

    def blocked(self, nodes, center, directions):
        """Whether rays from a point (3) in directions (n, 3) meet the net, (n)."""
        a, b, c = self.corners(nodes - center)
        sides = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)])
        volume = np.einsum("ij,ij->i", a, sides[0])
        seen = volume != 0  # not edgewise
        sides = sides[:, seen] * np.sign(volume[seen])[:, None]
        # A ray is a sum of the three corners with these weights, times |volume|.
        weights = sides.astype(np.float32) @ directions.T.astype(np.float32)
        return (weights.min(axis=0) >= 0).any(axis=0)


def everywhere(count):
    """Directions (count, 3) spread evenly over the unit sphere: Fibonacci's lattice."""
    k = np.arange(count) + 0.5
    z, turn = 1 - 2 * k / count, np.pi * (1 + np.sqrt(5)) * k
    r = np.sqrt(1 - z**2)
    return np.column_stack([r * np.cos(turn), r * np.sin(turn), z])


def enclosedShare(net, target, directions=DIRECTIONS):
    """Share of the directions from the centre of a body in which the net is in the way [-]: of a sphere, the
    share of its surface that the net encloses.

    Meshes count as filled: with the triangles between their nodes and their middle. How many layers of the net
    lie over one another does not count.

    target       id of the body
    directions   how many are looked at; the error is about 1/directions^(3/4)
    """
    findBody("enclosedShare", target, "target")
    count = values.count("enclosedShare: directions", directions, 1)
    center = np.array(list(O.bodies[target].state.pos))
    return float(Skin(net).blocked(net._state()[0], center, everywhere(count)).mean())
