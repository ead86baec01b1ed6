"""Nets: knots joined by edges, each edge a cable of one or more elements."""

import numpy as np
from yade import O, Vector3, utils

from . import values
from .arguments import documented
from .cables import divisions
from .laying import unit
from .stretch import ratios
from .structure import Run, Structure, _inContainer, anyMaterial, layStraight, section

BULLET = "carrying a bullet"


@documented
class Net(Structure):
    """A net of knots and edges; every edge starts straight, and without strain unless length, slack
    or tension is given: a number, or one for each of `edges`. Edges have slopes of their own at the
    knots, which pass on forces, not moments.

    points           (K, 3) [m], the knots
    edges            pairs of knot numbers
    rim              knot numbers around the mouth, in order; needed by mouthArea
    {arguments}
    """

    def __init__(
        self,
        points,
        edges,
        elements=1,
        *,
        diameter,
        material,
        rim=(),
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
        mask=1,
        label="Net",
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
        p = values.points(f"{label}.points", points)
        pairs = _checkedEdges(label, edges, p)
        layout = _lay(p, pairs, parts, model)
        laid = layout.length.reshape(-1, parts).sum(axis=1)
        layout.stretch(ratios(f"{label}.", sec, laid, length, slack, tension).repeat(parts))
        super().__init__(label, sec, layout, contact, contactPoints, selfContact, mask)
        self.rim = [self.knot(k) for k in values.sequence(f"{label}.rim", rim, "knot numbers")]
        self.corners = []  # knots that addBullets shoots
        self.folded = False  # whether it was laid folded
        self.bullets = []  # ids of the bullets in O.bodies
        self._normal = None
        self._bulletsLater = None

    @classmethod
    def square(
        cls,
        meshes=6,
        meshLength=0.08,
        elements=1,
        *,
        center=(0, 0, 0),
        normal=(1, 0, 0),
        fold=None,
        **cable,
    ):
        """A square net of meshes x meshes meshes: (meshes + 1)^2 knots, row by row, and 2 meshes
        (meshes + 1) edges.

        meshLength       [m], of every edge as laid
        center, normal   of the net [m], [-]; its sides are as parallel to the coordinate axes as
                         they can be
        fold             None: flat. 0 < fold < 1: folded like an egg box, without strain. The grid
                         of knots is shrunk to that fraction in its plane, and every second knot set
                         back along the normal by meshLength sqrt(1 - fold^2), so that all edges
                         stay straight and as long as they are; the corners are in front where
                         meshes is even.
        """
        label = cable.get("label", "Net")
        n = values.count(f"{label}.meshes", meshes, 1) + 1
        meshLength = values.positive(f"{label}.meshLength", meshLength, "m")
        center = values.vector(f"{label}.center", center)
        normal = values.direction(f"{label}.normal", normal)
        if fold is not None and not 0 < values.finite(f"{label}.fold", fold, "-") < 1:
            values.refuse(
                f"{label}.fold", fold, "must be above 0 and below 1, or None for a flat net"
            )
        u, w = _axes(normal)
        ratio = 1.0 if fold is None else float(fold)
        offset = (np.arange(n) - 0.5 * (n - 1)) * meshLength * ratio
        depth = meshLength * np.sqrt(1 - ratio**2)
        points = [
            center + offset[i] * u + offset[j] * w + depth * (0.5 - (i + j) % 2) * normal
            for i in range(n)
            for j in range(n)
        ]
        edges = [(n * i + j, n * i + j + 1) for i in range(n) for j in range(n - 1)]
        edges += [(n * i + j, n * i + j + n) for i in range(n - 1) for j in range(n)]
        if "rim" in cable:
            values.refuse(f"{label}.rim", cable["rim"], "a square has its own: leave it out")
        net = cls(points, edges, elements, rim=_squareRim(n), **cable)
        net.corners = [0, n - 1, n * n - 1, n * (n - 1)]
        net.folded = fold is not None
        net._normal = normal
        return net

    def edge(self, i):
        """Edge i as a curve: point(s), velocity(s), tension(s), curve(k). Negative i counts from
        the last edge.
        """
        n = len(self.spans)
        if isinstance(i, bool) or not isinstance(i, (int, np.integer)) or not -n <= i < n:
            remedy = f"there are {n} edges, so use 0 to {n - 1}"
            values.refuse(f"{self.name}.edge", i, remedy, IndexError)
        return self.spans[i]

    @property
    def edges(self):
        """All edges as curves."""
        return list(self.spans)

    def curve(self, k=8):
        """Points on the true curves of all edges, (edges, k elements + 1, 3) numpy [m]."""
        k = values.count(f"{self.name}.curve", k, 1)
        state, layout = self._state(), self._layout
        points = self._points(state, slice(None), np.arange(k) / k)
        ends = [layout.ends[run.first + run.count - 1, 1] for run in layout.runs]
        return np.append(points.reshape(len(ends), -1, 3), state[0][ends][:, None], axis=1)

    def maxTension(self):
        """Largest tension now [N], the number of its edge and s on that: (tension, edge, s). Of 8
        places of each element and its end.
        """
        return self._mostTension()

    def mouthArea(self, axis=None):
        """Area of the rim's polygon [m2]: the length of its area vector, sum of p_i x p_(i+1) / 2.

        For a rim that is not plane this is the largest of its projected areas. axis: the area seen
        along that direction.
        """
        rim = [self.knot(k) for k in values.sequence(f"{self.name}.rim", self.rim, "knot numbers")]
        if len(rim) < 3:
            raise ValueError(
                f"{self.name}.rim = {self.rim}: name the knots around the mouth, in order"
            )
        area = areaVector(self.knots[rim])
        if axis is None:
            return float(np.linalg.norm(area))
        return float(abs(area @ values.direction(f"{self.name}.mouthArea: axis", axis)))

    def addBullets(self, mass, radius, speed, angle, material=None):
        """Hangs a ball on each corner knot and shoots it along the normal, turned outwards along
        the diagonal.

        mass [kg], radius [m], speed [m/s], angle [rad] between velocity and normal; material: of
        the balls, None: the net's. Their ids are in `bullets` once the net is appended.
        Elements that meet at the corner, and those that reach into a ball at the start, never touch it.
        """
        name = f"{self.name}.addBullets"
        self.corners = [
            self.knot(k) for k in values.sequence(f"{self.name}.corners", self.corners, "knots")
        ]
        if not self.corners:
            raise ValueError(f"{name}: this net has no corners; set `corners` or use Net.square")
        if self._bulletsLater or self.bullets:
            raise ValueError(f"{name}: the net has bullets already")
        if material is not None:
            material = anyMaterial(f"{name}: material", material)
        bullets = (
            values.positive(f"{name}: mass", mass, "kg"),
            values.positive(f"{name}: radius", radius, "m"),
            values.finite(f"{name}: speed", speed, "m/s"),
            values.finite(f"{name}: angle", angle, "rad"),
            material,
        )
        for knot in self.corners:
            self._mayClaim(knot, BULLET)
        self._claims.update(dict.fromkeys(self.corners, BULLET))
        self._bulletsLater = bullets
        if self.appended:
            self._appendBodies()
            self._note()

    def _appendBodies(self):
        if not self._bulletsLater:
            return
        mass, radius, speed, angle, material = self._bulletsLater
        mat = _inContainer(self.section.material if material is None else material)
        knots = self.knots[self.corners]
        center = knots.mean(axis=0)
        for knot, p in zip(self.corners, knots):
            outward = unit(p - center)
            velocity = speed * (np.cos(angle) * self.normal + np.sin(angle) * outward)
            ball = utils.sphere(Vector3(*p), radius, material=mat, color=(0.75, 0.3, 0.1))
            ball.state.mass = mass
            ball.state.inertia = 0.4 * mass * radius**2 * Vector3(1, 1, 1)
            ball.state.vel = Vector3(*velocity)
            ball.state.blockedDOFs = "xyz"
            number = O.bodies.append(ball)
            self.bullets.append(number)
            del self._claims[knot]
            self.carry(knot, number)
        self._bulletsLater = None

    @staticmethod
    def _runs(edges, parts):
        return [Run(parts * i, parts, (int(a), int(b))) for i, (a, b) in enumerate(edges)]

    def _own(self):
        normal = None if self._normal is None else self._normal.tolist()
        names = ("rim", "corners", "folded", "bullets")
        return {name: getattr(self, name) for name in names} | {"normal": normal}

    def _recall(self, own):
        self.__dict__.update({k: v for k, v in own.items() if k != "normal"})
        self._normal = None if own["normal"] is None else np.array(own["normal"])
        self._bulletsLater = None

    @property
    def normal(self):
        """Direction in which bullets are shot, (3,): the net's normal as laid."""
        if self._normal is not None:
            return self._normal
        p = self.knots[self.corners]
        return unit(np.cross(p[1] - p[0], p[2] - p[1]))


def areaVector(p):
    """Area vector of a closed polygon with corners p (n, 3), sum of p_i x p_(i+1) / 2 (3) [m2]."""
    products = p.T @ np.concatenate([p[1:], p[:1]])
    return 0.5 * (products - products.T)[[1, 2, 0], [2, 0, 1]]


def _checkedEdges(name, edges, p):
    pairs, seen = [], set()
    for i, pair in enumerate(values.sequence(f"{name}.edges", edges, "pairs of knot numbers")):
        where = f"{name}.edges[{i}]"
        remedy = f"must be two knot numbers from 0 to {len(p) - 1}"
        ends = values.sequence(where, pair, "two knot numbers")
        if len(ends) != 2:
            values.refuse(where, pair, remedy, IndexError)
        a, b = (values.count(where, k, 0) for k in ends)
        if max(a, b) >= len(p):
            values.refuse(where, pair, remedy, IndexError)
        if a == b or frozenset((a, b)) in seen:
            values.refuse(where, pair, "joins a knot to itself or is there twice: take it out")
        seen.add(frozenset((a, b)))
        pairs.append((a, b))
    if not pairs:
        values.refuse(f"{name}.edges", edges, "a net needs at least one edge")
    a, b = np.array(pairs).T
    coincide = np.linalg.norm(p[a] - p[b], axis=1) <= 1e-12 * max(1.0, np.abs(p).max())
    if coincide.any():
        i = int(np.argmax(coincide))
        values.refuse(f"{name}.edges[{i}]", pairs[i], "its knots coincide: move one")
    unused = set(range(len(p))) - {k for pair in pairs for k in pair}
    if unused:
        values.refuse(f"{name}.points[{min(unused)}]", tuple(p[min(unused)]), "no edge meets it")
    return pairs


def _lay(p, pairs, parts, model):
    layout = layStraight(p, np.array(pairs), parts)
    if model == "ancf":
        layout.next = np.arange(1, len(layout.ends) + 1)
        layout.next[parts - 1 :: parts] = -1
    layout.runs = Net._runs(layout.edges, parts)
    return layout


def _axes(normal):
    """Two unit vectors across the normal, along coordinate axes where that is possible."""
    start = np.eye(3)[(int(np.argmax(np.abs(normal))) + 1) % 3]
    u = unit(start - np.dot(start, normal) * normal)
    return u, np.cross(normal, u)


def _squareRim(n):
    """Knot numbers around a square of n x n knots."""
    top = list(range(n))
    right = [n * i + n - 1 for i in range(1, n)]
    bottom = [n * (n - 1) + j for j in range(n - 2, -1, -1)]
    left = [n * i for i in range(n - 2, 0, -1)]
    return top + right + bottom + left
