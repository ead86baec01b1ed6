"""What cables and nets have in common: they are laid, appended, held, loaded and read in the same
way.
"""

import json
import warnings
from dataclasses import dataclass

import numpy as np
from yade import O, Vector3, wrapper

from . import values
from .laying import curvatureWeights, shape, slopeWeights, unit

# bits of `kind`, plugin/c/include/ancf/model.h
SPRING, LUMPED, AXIAL_REDUCED, CURVATURE_EXACT, ENGINEERING, WOUND = 1, 2, 4, 8, 16, 32

# Bit of groupMask that all bodies of elements have: the collider leaves their pairs out, which the
# CableEngine finds itself.
ELEMENTS = 1 << 29

MASK = 2**31 - 1  # largest groupMask: an int of YADE's
SEGMENTS_MOST = 64  # of an element
SMALLEST, LARGEST = 1e-30, 1e30  # of ea [N], rhoA [kg/m] and, from 0, ei [N m2]
DAMPING_MOST = 1e6  # [s], and of massDamping [1/s]
ITERATIONS_MOST = 2**31 - 1  # of relax: an int of the engine's
TOUCHING = 0.1  # depth over the thinner radius up to which cables touch: check() warns of more


@dataclass
class Section:
    """What an element is made of; follows its material."""

    diameter: float  # [m]
    area: float  # [m2]
    bending: float | None  # bending stiffness [N m2]; None: that of a full round of the material
    damping: float  # Kelvin-Voigt time [s]
    massDamping: float  # mass-proportional damping [1/s]
    kind: int  # sum of the bits above
    material: object  # HollarsMat

    @property
    def spring(self):
        """Whether it is a tension-only spring."""
        return bool(self.kind & SPRING)

    @property
    def engineering(self):
        """Whether its strain is |r'| - 1, and not Green's."""
        return bool(self.kind & (SPRING | ENGINEERING))

    @property
    def ea(self):
        """Axial stiffness [N]."""
        return self.material.young * self.area

    @property
    def ei(self):
        """Bending stiffness [N m2]."""
        if self.bending is not None:
            return self.bending
        return self.material.young * np.pi * self.diameter**4 / 64

    @property
    def rhoA(self):
        """Mass per length [kg/m]."""
        return self.material.density * self.area


@dataclass(slots=True)
class Run:
    """Elements in a row, along which arc length counts: a whole cable, or one edge of a net."""

    first: int
    count: int
    knots: tuple  # knot numbers at its ends


@dataclass
class Layout:
    """Nodes and elements as laid; knots come first among the nodes. E elements."""

    knots: int
    nodes: int
    edges: np.ndarray  # (n, 2) knot numbers
    parts: int  # elements of an edge
    places: np.ndarray | None  # (nodes, 3) [m]; None where only the engine has them
    slopes: np.ndarray | None  # (2 E, 3): start, end of every element
    ends: np.ndarray  # (E, 2) start node, end node
    length: np.ndarray  # (E) unstressed [m]
    next: np.ndarray  # (E) element into which this goes on smoothly, or -1
    runs: list  # of Run

    def stretch(self, ratio):
        """Makes unstressed lengths shorter, each element's by its ratio (E): its curve stays, and
        its slopes are as long as the ratio.
        """
        self.length = self.length / ratio
        self.slopes = self.slopes * np.repeat(ratio, 2)[:, None]

    def wind(self, end, count, length):
        """Puts so many elements of a length before the first one (end 0) or behind the last (-1), at
        the knot there: a drum. Their nodes come last.
        """
        new = self.nodes + np.arange(count)
        out = 1 if end == 0 else 0  # the end of an element that is farther from the drum
        drum = self.ends[end, 1 - out]
        chain = np.concatenate([[drum], new])
        wound = np.stack([chain[:-1], chain[1:]], axis=1)
        self.ends[end, 1 - out] = new[-1]
        each, none = np.full(count, length), np.full(count, -1)
        if end == 0:
            self.ends = np.concatenate([wound, self.ends])
            self.length = np.concatenate([each, self.length])
        else:
            self.ends = np.concatenate([self.ends, wound[::-1, ::-1]])
            self.length = np.concatenate([self.length, each])
        self.next = np.concatenate([none, self.next])  # springs: -1 all of them
        self.nodes += count
        self.runs = [Run(0, len(self.ends), self.runs[0].knots)]
        if self.places is not None:
            self.places = np.concatenate([self.places, np.tile(self.places[drum], (count, 1))])
            slopes = [np.tile(self.slopes[end], (2 * count, 1)), self.slopes]
            self.slopes = np.concatenate(slopes if end == 0 else slopes[::-1])


def layEdges(knots, edges, nodes, slopes, lengths):
    """Layout of elements between knots, edge by edge, none going on into another; no runs yet.

    knots (K, 3), edges (n, 2) knot numbers; of each edge nodes and slopes (n, parts + 1, 3), lengths
    (n, parts).
    """
    layout = chained(len(knots), edges, lengths.shape[1])
    layout.places = np.concatenate([knots, nodes[:, 1:-1].reshape(-1, 3)])
    layout.slopes = np.stack([slopes[:, :-1], slopes[:, 1:]], axis=2).reshape(-1, 3)
    layout.length = lengths.ravel()
    return layout


def chained(knots, edges, parts):
    """Which nodes the elements join: `parts` along each edge (n, 2) between knots; the rest of the
    Layout is still to be filled in.
    """
    n = len(edges)
    chain = np.empty((n, parts + 1), int)
    chain[:, 0], chain[:, -1] = edges.T
    chain[:, 1:-1] = knots + np.arange(n * (parts - 1)).reshape(n, parts - 1)
    return Layout(
        knots=knots,
        nodes=knots + n * (parts - 1),
        edges=edges,
        parts=parts,
        places=None,
        slopes=None,
        ends=np.stack([chain[:, :-1], chain[:, 1:]], axis=2).reshape(-1, 2),
        length=np.ones(n * parts),
        next=np.full(n * parts, -1),
        runs=[],
    )


def layStraight(knots, edges, parts):
    """The same with straight edges of even parts."""
    start, end = knots[edges.T]
    x = np.linspace(0, 1, parts + 1)[:, None]
    nodes = start[:, None] + x * (end - start)[:, None]
    slopes = np.broadcast_to(unit(end - start)[:, None], nodes.shape)
    length = np.linalg.norm(end - start, axis=1, keepdims=True) / parts
    return layEdges(knots, edges, nodes, slopes, np.tile(length, parts))


def section(
    name,
    material,
    diameter,
    area=None,
    bending=None,
    model="ancf",
    mass="consistent",
    axialRule="exact",
    curvature="fast",
    strain="green",
    damping=0.0,
    massDamping=0.0,
):
    """Section from what the user gave; raises ValueError or TypeError that names the attribute."""
    mat = findMaterial(name, material)
    diameter = values.positive(f"{name}.diameter", diameter, "m", values.FARTHEST)
    values.choice(f"{name}.model", model, ("ancf", "springs"))
    values.choice(f"{name}.mass", mass, ("consistent", "lumped"))
    values.choice(f"{name}.axialRule", axialRule, ("exact", "reduced"))
    values.choice(f"{name}.curvature", curvature, ("fast", "exact"))
    values.choice(f"{name}.strain", strain, ("green", "engineering"))
    springs = model == "springs"
    if springs and bending is not None and bending != 0:
        values.refuse(f"{name}.bending", bending, "springs do not bend; use model='ancf'")
    if area is None:
        area = np.pi * diameter**2 / 4
    else:
        area = values.positive(f"{name}.area", area, "m2")
    if springs:
        bending = 0.0
    if bending is not None:
        bending = values.notNegative(f"{name}.bending", bending, "N m2")
    kind = SPRING if springs else 0
    kind |= LUMPED if springs or mass == "lumped" else 0
    kind |= AXIAL_REDUCED if not springs and axialRule == "reduced" else 0
    kind |= CURVATURE_EXACT if not springs and curvature == "exact" else 0
    kind |= ENGINEERING if not springs and strain == "engineering" else 0
    damping = values.notNegative(f"{name}.damping", damping, "s", DAMPING_MOST)
    massDamping = values.notNegative(f"{name}.massDamping", massDamping, "1/s", DAMPING_MOST)
    made = Section(diameter, area, bending, damping, massDamping, kind, mat)
    _checkSection(name, made)
    return made


def _checkSection(name, section):
    """Refuses what no element can be made of, by its cause."""
    for what, value, unit, cause in (
        ("ea", section.ea, "N", "young x area"),
        ("rhoA", section.rhoA, "kg/m", "density x area"),
    ):
        if not SMALLEST < value < LARGEST:
            raise ValueError(
                f"{name}: {what} = {cause} = {value:g} {unit}, out of {SMALLEST:g} to {LARGEST:g}: "
                f"mend diameter = {section.diameter:g} m, area = {section.area:g} m2 or the material"
            )
    if not section.ei < LARGEST:
        raise ValueError(
            f"{name}: EI = {section.ei:g} N m2, must be below {LARGEST:g}: mend bending, or "
            f"diameter = {section.diameter:g} m"
        )


def findMaterial(name, material):
    """The HollarsMat with a label or id, or the given one, its values checked."""
    where = f"{name}.material"
    mat = anyMaterial(where, material)
    if not isinstance(mat, wrapper.HollarsMat):
        values.refuse(
            where, material, f"is a {type(mat).__name__}, but cables need a HollarsMat", TypeError
        )
    checkMaterial(mat)
    return mat


def anyMaterial(where, material):
    """The given Material, or that of O.materials with a label or id."""
    if isinstance(material, wrapper.Material):
        return material
    if isinstance(material, bool) or not isinstance(material, (str, int)):
        remedy = "must be a HollarsMat, or the label or id of one in O.materials"
        values.refuse(where, material, remedy, TypeError)
    try:
        return O.materials[material]
    except (KeyError, IndexError):
        known = [m.label for m in O.materials if m.label]
        remedy = f"no such material in O.materials (labels there: {known}); append a HollarsMat"
        values.refuse(where, material, remedy)


def checkMaterial(mat):
    """Refuses a HollarsMat that cannot be computed with; warns of one that is unlikely to be
    meant.
    """
    name = f"HollarsMat {mat.label!r}" if mat.label else "HollarsMat"
    values.positive(f"{name}.young", mat.young, "Pa")
    values.positive(f"{name}.density", mat.density, "kg/m3")
    values.positive(f"{name}.transitionVelocity", mat.transitionVelocity, "m/s")
    values.notNegative(f"{name}.staticFriction", mat.staticFriction, "-")
    values.notNegative(f"{name}.kineticFriction", mat.kineticFriction, "-")
    values.notNegative(f"{name}.impactDamping", mat.impactDamping, "s/m")
    if not -1 < mat.poisson <= 0.5:
        values.refuse(f"{name}.poisson", mat.poisson, "must be above -1 and at most 0.5")
    if mat.kineticFriction > mat.staticFriction:
        warnings.warn(
            f"{name}.kineticFriction = {mat.kineticFriction!r} is larger than staticFriction = "
            f"{mat.staticFriction!r}: friction that rises with speed is unusual; exchange the two?",
            stacklevel=4,
        )


class Span:
    """Elements in a row as one curve: a cable, or one edge of a net. s in [0, 1] is measured by
    unstressed length.
    """

    __slots__ = ("_structure", "_run", "_lengthUpTo")

    def __init__(self, structure, run):
        self._structure, self._run, self._lengthUpTo = structure, run, None

    @property
    def _elements(self):
        """Its elements, as a slice."""
        return slice(self._run.first, self._run.first + self._run.count)

    @property
    def _arc(self):
        """Unstressed length up to its nodes, (count + 1) numpy [m]."""
        if self._structure._stored is not None and self._structure.appended:  # it changes
            first = self._engineElement(0)
            lengths = self._structure.engine.length[first : first + self._run.count]
            return np.concatenate([[0.0], np.cumsum(lengths)])
        if self._lengthUpTo is None:
            lengths = self._structure._layout.length[self._elements]
            self._lengthUpTo = np.concatenate([[0.0], np.cumsum(lengths)])
        return self._lengthUpTo

    @property
    def length(self):
        """Unstressed length [m]."""
        return float(self._arc[-1])

    def _place(self, s):
        s = values.finite(f"{self._structure.name}: s", s, "-")
        if not 0 <= s <= 1:
            values.refuse(f"{self._structure.name}: s", s, "must be from 0 to 1")
        arc = self._arc
        at = s * arc[-1]
        k = min(int(np.searchsorted(arc, at, side="right")) - 1, self._run.count - 1)
        return k, min(float((at - arc[k]) / (arc[k + 1] - arc[k])), 1.0)

    def _engineElement(self, k):
        return self._structure._first[1] + self._run.first + k

    def point(self, s):
        """Position at s [m], Vector3."""
        k, xi = self._place(s)
        if self._structure.appended:
            return self._structure.engine.point(self._engineElement(k), xi)
        elements = np.array([self._run.first + k])
        return Vector3(*self._structure._points(self._structure._state(), elements, xi)[0, 0])

    def velocity(self, s):
        """Velocity at s [m/s], Vector3."""
        k, xi = self._place(s)
        engine = self._structure._needEngine("velocity")
        return engine.pointVelocity(self._engineElement(k), xi)

    def tension(self, s):
        """Tension at s, damping included [N]."""
        k, xi = self._place(s)
        return self._structure._needEngine("tension").tension(self._engineElement(k), xi)

    def strain(self, s):
        """Strain at s [-]: Green's, or engineering strain, as for springs always."""
        k, xi = self._place(s)
        return self._structure._needEngine("strain").strain(self._engineElement(k), xi)

    def curve(self, k=8):
        """Points on the cubic curve, k per element and the last end: (k count + 1, 3) numpy [m]."""
        structure = self._structure
        k = values.count(f"{structure.name}.curve", k, 1)
        state = structure._state()
        points = structure._points(state, self._elements, np.arange(k) / k).reshape(-1, 3)
        last = structure._layout.ends[self._elements][-1, 1]
        return np.vstack([points, state[0][last]])

    def stations(self, k=8):
        """s of the points of curve(k), (k count + 1) numpy."""
        k = values.count(f"{self._structure.name}.stations", k, 1)
        arc = self._arc
        along = arc[:-1, None] + np.arange(k) / k * np.diff(arc)[:, None]
        return np.append(along.ravel() / arc[-1], 1.0)

    def tensions(self, k=8):
        """Tension at the points of curve(k), (k count + 1) numpy [N]."""
        engine = self._structure._needEngine("tensions")
        k = values.count(f"{self._structure.name}.tensions", k, 1)
        at = [(e, i / k) for e in range(self._run.count) for i in range(k)]
        at.append((self._run.count - 1, 1.0))
        return np.array([engine.tension(self._engineElement(e), xi) for e, xi in at])

    def curvatures(self, k=8):
        """Curvature |r' x r''| / |r'|^3 of the curve at the points of curve(k), at nodes that of the
        element that begins there, (k count + 1) numpy [1/m]; 0 for springs.
        """
        k = values.count(f"{self._structure.name}.curvatures", k, 1)
        each = self._structure._curvatures(self._elements, np.arange(k + 1) / k)
        return np.append(each[:, :-1].ravel(), each[-1, -1])


class Structure:
    """Nodes and elements under one name. Conditions on knots may be set before and after
    append().
    """

    def __init__(self, name, section, layout, contact, contactPoints, selfContact, mask):
        self.name = name
        self.section = section
        self.bodies = []  # ids of the elements in O.bodies
        self.contact = values.choice(f"{name}.contact", contact, ("curve", "points"))
        self.selfContact = values.flag(f"{name}.selfContact", selfContact)
        self.mask = checkedMask(f"{name}.mask", mask)
        self._layout = layout
        self.spans = [Span(self, run) for run in layout.runs]
        self._contactPoints = values.count(f"{name}.contactPoints", contactPoints, 0)
        if self._contactPoints >= SEGMENTS_MOST:
            remedy = f"must be below {SEGMENTS_MOST}; take more elements"
            values.refuse(f"{name}.contactPoints", contactPoints, remedy)
        self._engine = None  # engine() looks it up again after O.load
        self._family = None
        self._first = (0, 0)  # numbers of our first node and element in the engine
        self._number = -1  # of us in its record
        self._claims = {}  # knot -> what holds it
        self._later = []  # (condition, what follows from it) to be carried out at append
        self._stored = None  # (end, elements) of what is on a winch's drum at the start
        self._velocity = None  # (nodes (n, 3), slopes (2 E, 3)) at the start
        self._ties = []  # (structure, knot, structure, knot) to be made once both are in an engine

    @property
    def _segments(self):
        """Pieces of an element with one place of contact each."""
        return 1 if self.section.spring else self._contactPoints + 1

    # ---- sizes -----------------------------------------------------------------------------------

    @property
    def length(self):
        """Unstressed length of all elements [m]."""
        return float(self._layout.length.sum())

    @property
    def mass(self):
        """Mass without carried bodies [kg]."""
        return self.section.rhoA * self.length

    @property
    def radius(self):
        """Half the diameter [m]."""
        return 0.5 * self.section.diameter

    @property
    def elementCount(self):
        return len(self._layout.ends)

    @property
    def nodeCount(self):
        return self._layout.nodes

    # ---- into the scene --------------------------------------------------------------------------

    @property
    def appended(self):
        """True once append() was called."""
        return self._family is not None

    @property
    def engine(self):
        """The CableEngine that computes this: the one with our family number in O.engines, also
        after O.load.
        """
        if not self.appended:
            return None
        for engine in cableEngines():
            if engine.family == self._family:
                return engine
        self._checkScene()
        return self._engine

    def _checkScene(self):
        """Refuses what is left of a scene before O.reset()."""
        if self.bodies and not any(isOfFamily(i, self._family) for i in self.bodies):
            raise RuntimeError(
                f"{self.name}: its bodies, {self.bodies[0]} to {self.bodies[-1]}, are not in O.bodies: "
                "it belongs to a scene that O.reset() or O.load() has taken away; make a new one"
            )

    def append(self, engine=None):
        """Puts a body for each element into O.bodies, and nodes and elements into a CableEngine.

        engine: the CableEngine to join (`other.engine`); None makes a new one, which goes between
        InteractionLoop and NewtonIntegrator if O.engines has them. Returns self. Raises
        RuntimeError if it was appended before, ValueError if O is periodic; after an error the
        scene is as it was.
        """
        if self.appended:
            raise RuntimeError(f"{self.name}.append: was appended before")
        if O.periodic:
            raise ValueError(
                "O.periodic = True: cables do not know periodic cells; set it to False"
            )
        if engine is not None and not isinstance(engine, wrapper.CableEngine):
            remedy = "must be a CableEngine, such as other.engine of a cable that was appended"
            values.refuse(f"{self.name}.append: engine", engine, remedy, TypeError)
        checkMaterial(self.section.material)
        _checkSection(self.name, self.section)
        engine = engine or _newEngine()
        engine.begin()
        self._engine, self._family = engine, engine.family
        try:
            self._first = self._addElements(engine)
            self._pushVelocity()
            self._coverElements()
            self._tieAll()
            for condition, _ in self._later:
                condition()
        except BaseException:
            engine.rollback()
            self._engine, self._family, self._first = None, None, (0, 0)
            raise
        engine.commit()
        bends = self.section.bending is None
        engine.madeOf(self._first[1], _inContainer(self.section.material).id, bends)
        self._addBodies()
        for _, after in self._later:
            after()
        self._later = []
        for tie in [t for t in self._ties if t[0].appended and t[2].appended]:
            for structure in {tie[0], tie[2]}:
                structure._ties.remove(tie)
        self._appendBodies()
        self._number = len(engine.record)
        self._note()
        _insertEngine(engine)
        return self

    def _addElements(self, engine):
        lay, sec = self._layout, self.section
        return engine.add(
            np.ascontiguousarray(lay.places),
            np.ascontiguousarray(lay.slopes),
            lay.ends.astype(np.int32, order="C"),
            lay.next.astype(np.int32),
            sec.kind,
            np.ascontiguousarray(lay.length),
            sec.ea,
            sec.ei,
            sec.rhoA,
            sec.damping,
            sec.massDamping,
        )

    def _note(self):
        """Saves with the engine what it does not know; see record.py."""
        layout, section = self._layout, self.section
        known = {
            "class": type(self).__name__,
            "label": self.name,
            "first": self._first,
            "knots": layout.knots,
            "edges": layout.edges.tolist(),
            "parts": layout.parts,
            "material": section.material.id,
            "section": {
                "diameter": section.diameter,
                "area": section.area,
                "bending": section.bending,
                "damping": section.damping,
                "massDamping": section.massDamping,
            },
            "shows": {
                "contact": self.contact,
                "contactPoints": self._contactPoints,
                "selfContact": self.selfContact,
                "mask": self.mask,
            },
            "own": self._own(),
        }
        self.engine.note(self._number, json.dumps(known))

    def _own(self):
        """What only its class knows, for record.py."""
        return {}

    def _recall(self, own):
        """Takes what _own() gave."""

    def _appendBodies(self):
        """Bodies that belong to the structure and come with it (bullets of a net)."""

    def _coverElements(self):
        """Tells the engine what the elements show to the outside."""
        engine, lay = self.engine, self._layout
        count = np.array([r.count for r in lay.runs])
        first = np.array([r.first for r in lay.runs])
        ahead = np.concatenate([[0.0], np.cumsum(lay.length)])  # of all elements, in their order
        returns = lay.ends[first, 0] == lay.ends[first + count - 1, 1]
        closed = np.where(returns, ahead[first + count] - ahead[first], 0.0)
        engine.cover(
            self._first[1],
            self.radius,
            self._segments,
            self.contact == "points",
            self.selfContact,
            np.repeat(first, count).astype(np.int32),
            ahead[:-1] - np.repeat(ahead[first], count),
            np.repeat(closed, count),
        )

    def _addBodies(self):
        """Gives each element a body."""
        if self._contactPoints == 0:
            return
        material = self.section.material
        self.bodies = list(self.engine.addBodies(self._first[1], material, self.mask | ELEMENTS))

    # ---- conditions on knots ---------------------------------------------------------------------

    def knot(self, number):
        """`number` counted from 0; negative counts from the last knot. IndexError if there is
        none.
        """
        if isinstance(number, bool) or not isinstance(number, (int, np.integer)):
            values.refuse(f"{self.name}: knot", number, "must be a whole number", TypeError)
        n = self._layout.knots
        if not -n <= number < n:
            remedy = f"there are {n} knots, so use 0 to {n - 1} or -{n} to -1"
            values.refuse(f"{self.name}: knot", number, remedy, IndexError)
        return int(number) % n

    def _node(self, knot):
        """Number in the engine of what stands for a knot; ValueError for one that is on a drum."""
        if self._wound(knot):
            raise ValueError(
                f"{self.name}: knot {knot} is wound on the drum of a winch: pay it out first"
            )
        return self.engine.tied(self._first[0] + knot)

    def _wound(self, knot):
        """Whether it is on a drum."""
        return self._stored is not None and self.engine.wound(self._first[0] + knot)

    def _mayClaim(self, knot, what):
        """Refuses what does not go with that which holds a knot."""
        held = self._claims.get(knot)
        if held and held != what and {held, what} != {"fixed", "clamped"}:
            raise ValueError(
                f"{self.name}: knot {knot} is {held} and cannot be {what} as well; "
                f"release({knot}) first, or take another knot"
            )

    @property
    def _attached(self):
        """(knot, body id) that it carries or follows."""
        return [(k, int(w.split()[-1])) for k, w in self._claims.items() if " body " in w]

    def _when(self, condition, after=lambda: None):
        """Carries a condition of the engine out now, or at append, and then what follows from it.
        Where the engine refuses it, nothing has changed.
        """
        if self.appended:
            condition()
            after()
        else:
            self._later.append((condition, after))

    def fix(self, knot):
        """Holds a knot where it is."""
        knot = self.knot(knot)
        self._mayClaim(knot, "fixed")
        if self._claims.get(knot) in ("fixed", "clamped"):
            return
        self._when(lambda: self.engine.fix(self._node(knot)))
        self._claims[knot] = "fixed"

    def clamp(self, knot, bodyId=None):
        """Holds a knot where it is and the slopes of the cables at it; or, with a bodyId, both as
        they are in that body's frame, whatever moves and turns the body.

        ValueError for springs, which have no slopes, and for a body that moves freely: it would not
        feel the clamp.
        """
        knot = self.knot(knot)
        if self.section.spring:
            raise ValueError(
                f"{self.name}.clamp({knot}): springs have no slopes; use model='ancf', fix or follow"
            )
        if bodyId is not None:
            self._lead(knot, bodyId, f"{self.name}.clamp", "clamped to", self._clampToNow)
            return
        self._mayClaim(knot, "clamped")
        wasHeld = self._claims.get(knot) in ("fixed", "clamped")
        self._when(lambda: self._clampNow(knot, wasHeld))
        self._claims[knot] = "clamped"

    def _clampNow(self, knot, wasHeld):
        engine = self.engine
        if not wasHeld:
            engine.fix(self._node(knot))
        for element, end in self._endsAt(knot):
            engine.clamp(element, end)

    def _clampToNow(self, knot, bodyId):
        self.engine.follow(self._node(knot), bodyId)
        for element, end in self._endsAt(knot):
            self.engine.followSlope(element, end)

    def _endsAt(self, knot):
        """(element of the engine, its end) that meet at a knot of ours."""
        ends = np.argwhere(self._layout.ends == knot).tolist()
        return [(self._first[1] + e, end) for e, end in ends]

    def follow(self, knot, bodyId):
        """Keeps a knot at its place in a body's frame, whatever moves the body."""
        self._lead(
            knot,
            bodyId,
            f"{self.name}.follow",
            "following",
            lambda knot, bodyId: self.engine.follow(self._node(knot), bodyId),
        )

    def slide(self, knot, direction, clamped=False):
        """Lets a knot go along a straight line alone, which goes through it and stands still: a
        slider without mass and friction.

        direction: (3), of any length but 0. clamped: the slopes of the cables at the knot stay as
        they are, so that it slides without turning; ValueError for springs, which have none.
        """
        knot = self.knot(knot)
        where = f"{self.name}.slide({knot})"
        direction = Vector3(*values.direction(f"{where}: direction", direction))
        if values.flag(f"{where}: clamped", clamped) and self.section.spring:
            raise ValueError(f"{where}: springs have no slopes; use clamped=False or model='ancf'")
        claim = slidingClaim(direction, clamped)
        if self._claims.get(knot) == claim:
            return
        self._mayClaim(knot, claim)
        self._when(lambda: self._slideNow(knot, direction, clamped))
        self._claims[knot] = claim

    def _slideNow(self, knot, direction, clamped):
        self.engine.slide(self._node(knot), direction)
        for element, end in self._endsAt(knot):
            if clamped:
                self.engine.clamp(element, end)

    def _lead(self, knot, bodyId, where, what, now):
        """Lets a body lead a knot: now(knot, bodyId) tells the engine."""
        knot = self.knot(knot)
        findBody(where, bodyId)
        claim = f"{what} body {bodyId}"
        if self._claims.get(knot) == claim:
            return
        self._mayClaim(knot, claim)
        self._when(lambda: now(knot, bodyId), lambda: self._attach(knot, bodyId))
        self._claims[knot] = claim

    def carry(self, knot, bodyId, at=(0, 0, 0)):
        """Hangs a body on a knot: the knot stays at `at` [m] in the body's frame, the body's mass
        moves with it.

        Carried at its centre, the body's translation becomes the knot's (blockedDOFs 'xyz'). A body
        that moves gives the knot its velocity. Raises ValueError for a body without mass, or one
        carried elsewhere.
        """
        knot = self.knot(knot)
        body = findBody(f"{self.name}.carry", bodyId)
        at = values.vector(f"{self.name}.carry: at", at)
        values.positive(f"{self.name}.carry: mass of body {bodyId}", body.state.mass, "kg")
        claim = f"carrying body {bodyId}"
        self._mayClaim(knot, claim)
        self._when(
            lambda: self._carryNow(knot, bodyId, at),
            lambda: (_makeCarried(O.bodies[bodyId]), self._attach(knot, bodyId)),
        )
        self._claims[knot] = claim

    def _carryNow(self, knot, bodyId, at):
        engine, state = self.engine, O.bodies[bodyId].state
        engine.carry(self._node(knot), bodyId, Vector3(*at))
        if state.vel.norm() > 0 or state.angVel.norm() > 0:
            arm = state.ori * Vector3(*at)
            velocity = np.array(list(state.vel + state.angVel.cross(arm)))
            engine.setVelocities(self._first[0] + knot, velocity, 0, np.empty(0))

    def load(self, knot, force):
        """Lets a constant force [N] act on a knot; a second call replaces the first."""
        knot = self.knot(knot)
        force = Vector3(*values.vector(f"{self.name}.load: force", force))
        self._when(lambda: self.engine.load(self._node(knot), force))

    def release(self, knot):
        """Lets a fixed, clamped, led or sliding knot go, and takes its load away."""
        knot = self.knot(knot)
        held = self._claims.get(knot, "")
        if held.startswith(("carrying", "tied")):
            raise ValueError(f"{self.name}.release({knot}): it is {held}, which is for good")
        self._when(lambda: self.engine.release(self._node(knot)))
        self._claims.pop(knot, None)

    def tie(self, knot, other, otherKnot):
        """Makes a knot of this and one of another (or the same) structure one. ValueError if their
        engines differ.
        """
        if not isinstance(other, Structure):
            values.refuse(f"{self.name}.tie: other", other, "must be a Cable or a Net", TypeError)
        knot, otherKnot = self.knot(knot), other.knot(otherKnot)
        if self is other and knot == otherKnot:
            raise ValueError(f"{self.name}.tie: knot {knot} cannot be tied to itself")
        if self.appended and other.appended:
            self._sameEngine(other)
        apart = np.linalg.norm(self._knotAt(knot) - other._knotAt(otherKnot))
        if apart > 1e-6 * self._layout.length.max():
            raise ValueError(
                f"{self.name}.tie: knot {knot} is {apart:g} m away from knot {otherKnot} of "
                f"{other.name}; "
                "lay them at the same place"
            )
        claim = f"tied to knot {otherKnot} of {other.name}"
        self._mayClaim(knot, claim)
        tie = (self, knot, other, otherKnot)
        if self.appended and other.appended:
            _tieNow(*tie)
        else:
            for structure in {self, other}:
                structure._ties.append(tie)
        self._claims[knot] = claim

    def _sameEngine(self, other):
        if self._family != other._family:
            raise ValueError(
                f"{self.name}.tie: {other.name} is in another CableEngine; "
                "append the second with append(engine=first.engine)"
            )

    def _tieAll(self):
        """Makes the ties to what is in the engine already."""
        for tie in self._ties:
            mine, _, other, _ = tie
            if mine.appended and other.appended:
                mine._sameEngine(other)
                _tieNow(*tie)

    def _attach(self, knot, bodyId):
        """The elements that meet at a knot, and those that reach into the body now, never touch the
        body that it carries or follows. The others do: what lies on it, or winds on it later. A
        cable never touches the body at its drum, into which it is hauled.
        """
        if not self.bodies:
            return
        body = O.bodies[bodyId]
        members = [bodyId, *body.shape.members.keys()] if body.isClump else [bodyId]
        meets = np.array(self.engine.elementsAt(self._node(knot)), int) - self._first[1]
        meets = meets[(meets >= 0) & (meets < self.elementCount)]
        if self._stored is not None and knot == self.knot(self._stored[0]):
            meets = np.arange(self.elementCount)
        state = self._state()
        for member in members:
            for e in np.union1d(meets, self._reaching(O.bodies[member], state)):
                shape = O.bodies[self.bodies[e]].shape
                shape.exclude = list(shape.exclude) + [member]

    def _reaching(self, body, state):
        """Numbers of the elements that reach into a sphere or box now, deeper than what touches it."""
        size = _reach(body.shape)
        if size is None:
            return np.array([], int)
        thin = min(self.radius, size) if isinstance(body.shape, wrapper.Sphere) else self.radius
        radius = self.radius - TOUCHING * thin
        # A curve is no farther from its chord's middle than half the chord and what slopes bend it.
        start, end = state[0][self._layout.ends.T]
        steep = np.linalg.norm(state[1], axis=1).reshape(-1, 2).sum(axis=1)
        out = 0.5 * np.linalg.norm(end - start, axis=1) + 4 / 27 * self._layout.length * steep
        gap = np.linalg.norm(0.5 * (start + end) - np.array(list(body.state.pos)), axis=1) - out
        near = np.flatnonzero(gap < size + self.radius)
        return near[_overlaps(body, self._points(state, near, np.linspace(0, 1, 17)), radius)]

    # ---- state -----------------------------------------------------------------------------------

    def setVelocity(self, f):
        """Gives every point p the velocity f(p): f takes and returns a Vector3 ([m], [m/s]).

        Slopes change at the rate of f along them (central difference). Bodies carried at knots move
        along.
        """
        if not callable(f):
            remedy = "must be a function of a point, such as lambda p: Vector3(0, 0, 1)"
            values.refuse(f"{self.name}.setVelocity: f", f, remedy, TypeError)
        carried = [(k, i) for k, i in self._attached if self._claims[k].startswith("carrying")]
        for knot, bodyId in carried:
            findBody(f"{self.name}.setVelocity: knot {knot} carries", bodyId)
        nodes, slopes = self._state()
        step = 1e-4 * self._layout.length.min()

        def at(p):
            return values.vector(
                f"{self.name}.setVelocity: f({tuple(map(float, p))})", f(Vector3(*p))
            )

        ofNodes = np.array([at(p) for p in nodes])
        ofSlopes = np.empty_like(slopes)
        for i, (p, g) in enumerate(zip(nodes[self._layout.ends.ravel()], slopes)):
            ofSlopes[i] = (at(p + 0.5 * step * g) - at(p - 0.5 * step * g)) / step
        self._velocity = (ofNodes, ofSlopes)
        if self.appended:
            self._pushVelocity()
        for _, bodyId in carried:
            state = O.bodies[bodyId].state
            state.vel = f(state.pos)

    def _pushVelocity(self):
        if self._velocity is not None:
            nodes, slopes = (np.ascontiguousarray(v) for v in self._velocity)
            self.engine.setVelocities(self._first[0], nodes, self._first[1], slopes)

    def _state(self):
        """Nodes (n, 3) [m] and slopes (2 E, 3), ours only, as they are now."""
        if not self.appended:
            return self._layout.places, self._layout.slopes
        count = self.nodeCount
        raw = self.engine.state(self._first[0], count, self._first[1], self.elementCount)
        state = np.frombuffer(raw).reshape(-1, 3)
        return state[:count], state[count:]

    def _knotAt(self, knot):
        """Position of one knot (3) [m]."""
        if not self.appended:
            return self._layout.places[knot]
        return np.frombuffer(self.engine.state(self._first[0] + knot, 1, 0, 0))

    def _unknowns(self, state, elements):
        """Positions and slopes at the starts and ends, r0, g0, r1, g1 (n, 3), of the elements that a
        slice or numbers (n) choose.
        """
        nodes, slopes = state
        r0, r1 = np.moveaxis(nodes[self._layout.ends[elements]], 1, 0)
        g0, g1 = np.moveaxis(slopes.reshape(-1, 2, 3)[elements], 1, 0)
        return r0, g0, r1, g1

    def _points(self, state, elements, xi):
        """Positions (n, k, 3) at xi (k, or one) of the elements that a slice or numbers (n) choose."""
        r0, g0, r1, g1 = self._unknowns(state, elements)
        xi = np.atleast_1d(xi)
        if self.section.spring:
            return r0[:, None] + xi[:, None] * (r1 - r0)[:, None]
        weights = shape(xi, self._layout.length[elements][:, None])
        return weights @ np.stack([r0, g0, r1, g1], axis=1)

    def _curvatures(self, elements, xi):
        """Curvature (n, k) of the cubics at xi (k) [1/m]."""
        if self.section.spring:
            return np.zeros((len(self._layout.length[elements]), len(xi)))
        r0, g0, r1, g1 = self._unknowns(self._state(), elements)
        length = self._layout.length[elements][:, None]
        ends = np.stack([g0, (r1 - r0) / length, g1], axis=1)
        first, second = slopeWeights(xi) @ ends, curvatureWeights(xi) @ ends / length[..., None]
        across = np.linalg.norm(np.cross(first, second), axis=-1)
        return across / np.linalg.norm(first, axis=-1) ** 3

    def contactForces(self):
        """Forces of bodies on the cables in the last step, normal and friction together: [(span, s,
        force (3) [N])], one for each place that presses. Cables on cables are not among them.
        """
        found = []
        for body in self.bodies:
            for contact in O.bodies[body].intrs():
                if contact.id2 != body or not contact.isReal:
                    continue
                geom, element = contact.geom, O.bodies[body].shape.element - self._first[1]
                for xi, n, push, friction in zip(geom.xi, geom.normals, geom.force, geom.friction):
                    if push:
                        number, s = self._stationOf(element, xi)
                        found.append((self.spans[number], s, np.array(list(push * n + friction))))
        return found

    def _stationOf(self, element, xi):
        """Number of the span that an element of ours belongs to, and s at its xi."""
        firsts = [span._run.first for span in self.spans]
        number = int(np.searchsorted(firsts, element, side="right")) - 1
        span = self.spans[number]
        arc, k = span._arc, element - span._run.first
        return number, float((arc[k] + xi * (arc[k + 1] - arc[k])) / arc[-1])

    def _needEngine(self, what):
        if not self.appended:
            raise RuntimeError(f"{self.name}.{what}: append() first")
        return self.engine

    @property
    def knots(self):
        """Positions of the knots, (K, 3) numpy [m]."""
        return self._state()[0][: self._layout.knots].copy()

    def reaction(self, knot):
        """Force that holds a knot [N], Vector3: by what fixes or leads it; across the line of a
        sliding one; for a carried body, by the body.
        """
        knot = self.knot(knot)
        return self._needEngine("reaction").reaction(self._node(knot))

    def moment(self, knot):
        """Moment about a clamped knot by which its clamp turns the cable [N m], Vector3."""
        knot = self.knot(knot)
        return self._needEngine("moment").moment(self._node(knot))

    def anchorForce(self):
        """Sum of the forces that hold the knots [N], Vector3: of all that are fixed, clamped,
        follow a body or slide. What carried bodies do is not among them; a knot that is tied to a held one
        counts where that is held.
        """
        self._needEngine("anchorForce")
        held = [k for k, what in self._claims.items() if not what.startswith(("carrying", "tied"))]
        return sum((self.reaction(knot) for knot in held), Vector3.Zero)

    def _mostTension(self):
        """Largest tension now [N], over 8 places of each element, its span's number and s there."""
        engine, first = self._needEngine("maxTension"), self._first[1]
        tension, e, xi = engine.maxTension(first, first + self.elementCount, 8)
        return tension, *self._stationOf(e - first, xi)

    def energy(self):
        """Energies [J]: kinetic, axial, bending, gravity; carried bodies not counted."""
        engine, first = self._needEngine("energy"), self._first[1]
        return dict(engine.energy(first, first + self.elementCount))

    # ---- statics and time step -------------------------------------------------------------------

    def criticalTimeStep(self):
        """Largest stable step of the engine's cables, contacts not counted [s]."""
        return self._needEngine("criticalTimeStep").criticalTimeStep()

    def relax(self, tolerance=1e-8, iterations=2_000_000):
        """Moves all cables of the engine to static equilibrium under gravity, loads and contact, at
        rest.

        They lie on the bodies of the scene, which stand still, and on each other, by normal forces
        alone: friction does not hold anything, and what would slide away has no equilibrium.

        tolerance: of the force on every free unknown, as part of the largest force. RuntimeError if
        none is found, if the cables press on a body that may move, or if a line pulls at them: append
        it afterwards.
        """
        engine = self._needEngine("relax")
        for line in O.engines:
            if isinstance(line, wrapper.LineEngine) and engine.family in line.families:
                raise RuntimeError(
                    f"{self.name}.relax: the line {line.name!r} pulls at it, which relax() does not know: "
                    "append the line after relax()"
                )
        tolerance = values.positive(f"{self.name}.relax: tolerance", tolerance, "-")
        iterations = values.count(f"{self.name}.relax: iterations", iterations, 1, ITERATIONS_MOST)
        engine.relax(tolerance, iterations)


def slidingClaim(direction, clamped):
    """What a knot is that slides."""
    x, y, z = direction
    return f"sliding along ({x:g}, {y:g}, {z:g})" + (", clamped" if clamped else "")


def findBody(where, bodyId, what="bodyId"):
    """O.bodies[bodyId]; IndexError if there is none, ValueError for an element of a cable."""
    whole = isinstance(bodyId, (int, np.integer)) and not isinstance(bodyId, bool)
    if not whole or not 0 <= bodyId < len(O.bodies) or O.bodies[bodyId] is None:
        values.refuse(f"{where}: {what}", bodyId, "there is no such body in O.bodies", IndexError)
    body = O.bodies[bodyId]
    if isinstance(body.shape, wrapper.CableElement):
        values.refuse(f"{where}: {what}", bodyId, "is an element of a cable; tie knots instead")
    return body


def cableEngines():
    """The CableEngines of O.engines."""
    return [e for e in O.engines if isinstance(e, wrapper.CableEngine)]


_families = (
    0  # given so far: none comes twice, so that no cable takes another scene's engine for its own
)


def _newEngine():
    global _families
    families = [e.family for e in cableEngines()]
    families += [b.shape.family for b in O.bodies if isinstance(b.shape, wrapper.CableElement)]
    _families = max([_families, *families]) + 1
    return wrapper.CableEngine(family=_families)


def isOfFamily(bodyId, family):
    """Whether a body is there and an element of the CableEngine with a number."""
    body = O.bodies[bodyId] if bodyId < len(O.bodies) else None
    return body is not None and getattr(body.shape, "family", None) == family


def checkedMask(where, mask):
    """A groupMask; refused if YADE's int does not hold it, or it has the bit of all elements."""
    mask = values.count(where, mask, 1, MASK)
    if mask & ELEMENTS:
        values.refuse(where, mask, f"has bit 29 ({ELEMENTS}), which all elements of cables have")
    return mask


def _insertEngine(engine):
    """Puts the engine before NewtonIntegrator if O.engines has one and not yet the engine."""
    engines = list(O.engines)
    newton = [i for i, e in enumerate(engines) if isinstance(e, wrapper.NewtonIntegrator)]
    if newton and all(e.family != engine.family for e in cableEngines()):
        O.engines = engines[: newton[0]] + [engine] + engines[newton[0] :]


def _inContainer(material):
    """The material, in O.materials."""
    if material.id < 0:
        O.materials.append(material)
    return material


def _tieNow(mine, knot, other, otherKnot):
    mine.engine.tie(other._node(otherKnot), mine._node(knot))


def _makeCarried(body):
    """Spheres that a knot carries are told apart: the engine of the cable solves their contacts."""
    for member in body.shape.members if body.isClump else [body.id]:
        shape = O.bodies[member].shape
        if type(shape) is wrapper.Sphere:
            O.bodies[member].shape = wrapper.CarriedSphere(**shape.dict())


def matrix(ori):
    """A Quaternion as rotation matrix (3, 3)."""
    m = ori.toRotationMatrix()
    return np.array([[m[i, j] for j in range(3)] for i in range(3)])


def _reach(shape):
    """How far a sphere or box reaches from its centre [m]; None: it is neither."""
    if isinstance(shape, wrapper.Sphere):
        return shape.radius
    return shape.extents.norm() if isinstance(shape, wrapper.Box) else None


def _overlaps(body, points, radius):
    """Which of the curves (n, k, 3) have a point around which a ball overlaps a sphere or box."""
    local = points - np.array(list(body.state.pos))
    if isinstance(body.shape, wrapper.Sphere):
        return (np.linalg.norm(local, axis=-1) < body.shape.radius + radius).any(axis=1)
    turned = local @ matrix(body.state.ori)
    inside = np.abs(turned) < np.array(list(body.shape.extents)) + radius
    return inside.all(axis=-1).any(axis=1)
