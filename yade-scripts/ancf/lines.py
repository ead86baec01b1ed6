"""Lines through rings: closing lines of nets, reeving, tethers from a winch."""

import math
import warnings

import numpy as np
from yade import O, Vector3, wrapper

from . import values
from ._load import showLines
from .record import structures
from .stretch import oneOf
from .structure import Structure, cableEngines, findBody, findMaterial

RING = 5.0  # default size of a ring, in diameters of the line


class Line:
    """A line that runs through rings, in which its material slides.

    places       two or more, in the order in which the line comes to them: (cable or net, knot), the
                 id of a body, or (id, point) with a point in the body's frame [m]. The line ends at
                 the first and the last; the others are rings. It may come to a place several times
    diameter     [m]; gives the area, and how thick it is drawn
    material     HollarsMat, or its label or id in O.materials: EA = young x area
    area         [m2] instead of that of the diameter
    friction     coefficient mu of the rings, one or one for each: beside a ring at which the line turns
                 by an angle a, one tension is at most exp(mu a) of the other (Eytelwein)
    ringRadius   size r of the rings [m]; None: five diameters. The way between two centres at the
                 distance d is sqrt(d^2 + r^2), so that rings can be drawn together
    length       its unstressed length [m]; or
    slack        by how much of its way the unstressed length is longer [-]; or
    tension      that it has at the start [N]. None of them: as long as its way
    label        its name in messages

    It has no mass and no bending stiffness and touches nothing: right where rho A v^2 and the weight of
    a span are small against its tension. A span pulls as a spring with EA/length, or is slack. Raises
    ValueError, TypeError or IndexError that names the attribute.
    """

    def __init__(
        self,
        places,
        *,
        diameter,
        material,
        area=None,
        friction=0.0,
        ringRadius=None,
        length=None,
        slack=None,
        tension=None,
        label="Line",
    ):
        self.name = label
        self.places = _checkedPlaces(label, places)
        self.diameter = values.positive(f"{label}.diameter", diameter, "m")
        if area is None:
            area = 0.25 * math.pi * self.diameter**2
        area = values.positive(f"{label}.area", area, "m2")
        self._ea = findMaterial(label, material).young * area
        self._friction = _frictions(label, friction, len(self.places))
        if ringRadius is None:
            ringRadius = RING * self.diameter
        self._ring = values.notNegative(f"{label}.ringRadius", ringRadius, "m")
        self._cut = _cut(label, length, slack, tension)
        self._number = -1
        self._engine = None

    # ---- into the scene --------------------------------------------------------------------------

    @property
    def appended(self):
        """True once append() was called."""
        return self._number >= 0

    @property
    def engine(self):
        """The LineEngine that computes this, also after O.load."""
        if not self.appended:
            return None
        return next((e for e in lineEngines() if e.line == self._number), self._engine)

    def append(self):
        """Puts a LineEngine into O.engines, before the CableEngines and the NewtonIntegrator that are
        there. Returns self.

        The cables and nets that it runs through must have been appended. ValueError for a length that
        is shorter than its way, RuntimeError if it was appended before.
        """
        if self.appended:
            raise RuntimeError(f"{self.name}.append: was appended before")
        families, numbers, offsets = zip(*(self._resolved(i) for i in range(len(self.places))))
        n = len(self.places)
        engine = wrapper.LineEngine(
            line=_newNumber(),
            name=self.name,
            families=list(families),
            numbers=list(numbers),
            offsets=list(offsets),
            friction=self._friction,
            ea=self._ea,
            ringRadius=self._ring,
            diameter=self.diameter,
            length=[1.0] * (n - 1),
            tension=[0.0] * (n - 1),
            slides=[0] * n,
            flow=[0.0] * n,
            speed=[0.0, 0.0],
            force=[0.0, 0.0],
            brake=[math.inf, math.inf],
            least=[0.0, 0.0],
            most=[math.inf, math.inf],
            scripted=[0, 0],
        )
        cables = {w.engine.family: w.engine for w, _ in self.places if isinstance(w, Structure)}
        ways = np.array(engine.ways(list(cables.values())))
        for i in np.flatnonzero(ways == 0):
            raise ValueError(
                f"{self.name}.places[{i}] and [{i + 1}] are at one point: give ringRadius above 0, or "
                "take one of them out"
            )
        strain = ways.sum() / self._unstressed(ways.sum()) - 1
        engine.length = list(ways / (1 + strain))
        engine.tension = [max(0.0, self._ea * strain)] * (n - 1)
        self._engine, self._number = engine, engine.line
        engines = list(O.engines)
        movers = wrapper.CableEngine, wrapper.NewtonIntegrator
        first = next((i for i, e in enumerate(engines) if isinstance(e, movers)), None)
        if first is not None:
            O.engines = engines[:first] + [engine] + engines[first:]
        showLines()
        return self

    def _resolved(self, i):
        """Family of the CableEngine, or -1, number of the node or body, and point in the body."""
        what, at = self.places[i]
        where = f"{self.name}.places[{i}]"
        if isinstance(what, Structure):
            if not what.appended:
                raise ValueError(f"{where}: {what.name} was not appended: append it first")
            if 0 < i < len(self.places) - 1 and what._claims.get(at) in ("fixed", "clamped"):
                warnings.warn(
                    f"{where}: knot {at} of {what.name} is {what._claims[at]}: the line runs through its "
                    "ring but cannot draw it anywhere; release() it if it should",
                    stacklevel=4,
                )
            return what.engine.family, what._node(at), Vector3.Zero
        findBody(where, what)
        return -1, what, Vector3(*at)

    def _unstressed(self, way):
        """Unstressed length for a way [m]."""
        what, value = self._cut
        if what == "tension":
            return way / (1 + value / self._ea)
        length = value if what == "length" else way * (1 + value)
        if length < way * (1 - 1e-9):
            values.refuse(
                f"{self.name}.{what}",
                value,
                f"is shorter than the way through its places, {way:.6g} m; give tension= for a line "
                "that pulls from the start",
            )
        return length

    def _needEngine(self, what):
        if not self.appended:
            raise RuntimeError(f"{self.name}.{what}: append it to the scene first")
        return self.engine

    # ---- winches ---------------------------------------------------------------------------------

    def haul(self, speed, force, to=None, brake=math.inf, end=-1):
        """Lets a winch at an end draw the line in from now on.

        speed   unstressed length a time [m/s], or a function of the time; where it is below 0, the
                winch lets out
        force   tension at most [N]: beyond, it draws more slowly, or strains without moving
        to      unstressed length of the whole line at which it stops to draw in [m]; None: when all
                rings are drawn together
        brake   tension above which its drum slips and lets out [N]
        end     0: at the first place, -1: at the last

        ValueError if there is nothing left to draw in.
        """
        engine = self._needEngine("haul")
        least = max(self._least(), 1e-3 * engine.wholeLength)
        to = least if to is None else values.positive(f"{self.name}.haul: to", to, "m")
        force = values.positive(f"{self.name}.haul: force", force, "N")
        if not callable(speed):
            speed = values.positive(f"{self.name}.haul: speed", speed, "m/s")
            if to >= engine.wholeLength:
                remedy = (
                    f"the line has {engine.wholeLength:.6g} m left: there is nothing to draw in"
                )
                values.refuse(f"{self.name}.haul: to", to, remedy)
        brake = values.brake(f"{self.name}.haul: brake", brake, force)
        engine.setWinch(self._end("haul", end), speed, force, brake, to, math.inf)

    def payOut(self, speed, to=math.inf, brake=math.inf, end=-1):
        """Lets a winch at an end let the line out at a speed [m/s], until the whole line has an
        unstressed length [m], and faster where its tension is above the brake's [N].
        """
        engine = self._needEngine("payOut")
        speed = values.positive(f"{self.name}.payOut: speed", speed, "m/s")
        to = to if to == math.inf else values.positive(f"{self.name}.payOut: to", to, "m")
        if to <= engine.wholeLength:
            remedy = f"the line has {engine.wholeLength:.6g} m out already"
            values.refuse(f"{self.name}.payOut: to", to, remedy)
        brake = values.brake(f"{self.name}.payOut: brake", brake)
        engine.setWinch(self._end("payOut", end), -speed, 0.0, brake, 0.0, to)

    def hold(self, brake=math.inf, end=-1):
        """Lets the winch at an end hold what it has, up to the tension of its brake [N]."""
        engine = self._needEngine("hold")
        brake = values.brake(f"{self.name}.hold: brake", brake)
        engine.setWinch(self._end("hold", end), 0.0, 0.0, brake, 0.0, math.inf)

    def winch(self, end=-1):
        """What an end did in the last step: 'holds', 'draws', 'lets out', 'strains' (its force is not
        enough), 'slips' (its brake) or 'stopped' (at its length).
        """
        return self._needEngine("winch").doing(self._end("winch", end))

    def _end(self, what, end):
        if end not in (0, -1):
            values.refuse(f"{self.name}.{what}: end", end, "must be 0, the first place, or -1")
        return end

    def _least(self):
        """Its length with all rings drawn together [m]."""
        return (len(self.places) - 1) * self.engine.ringRadius

    # ---- reading ---------------------------------------------------------------------------------

    @property
    def length(self):
        """Unstressed length of all spans, without what is on drums [m]."""
        return self._needEngine("length").wholeLength

    @property
    def lengths(self):
        """Unstressed lengths of the spans, (n) numpy [m]."""
        return np.array(self._needEngine("lengths").length)

    @property
    def tensions(self):
        """Tensions of the spans in the last step, (n) numpy [N]."""
        return np.array(self._needEngine("tensions").tension)

    @property
    def flow(self):
        """Speed of the unstressed line through its places towards the last one, (n + 1) numpy [m/s]."""
        return np.array(self._needEngine("flow").flow)

    @property
    def points(self):
        """Where its places are, (n + 1, 3) numpy [m]."""
        return np.array([list(p) for p in self._needEngine("points").points()])

    @property
    def velocities(self):
        """Velocities of its places, (n + 1, 3) numpy [m/s]."""
        engine = self._needEngine("velocities")
        engine.points()  # tells what was erased
        nodes = {e.family: np.array(e.velocity).reshape(3, -1) for e in cableEngines()}
        cables = {e.family: e for e in cableEngines()}
        found = []
        for family, number, offset in zip(engine.families, engine.numbers, engine.offsets):
            if family >= 0:
                found.append(nodes[family][:, cables[family].tied(number)])
            else:
                state = O.bodies[number].state
                found.append(np.array(list(state.vel + state.angVel.cross(state.ori * offset))))
        return np.array(found)

    def energy(self):
        """dict of elastic energy, work of friction at the rings and of the winches on the line so far
        [J]: `winches` less what is stored in the line that they wound up.
        """
        engine = self._needEngine("energy")
        return {"elastic": engine.elastic, "friction": engine.rubbed, "winches": engine.drawn}

    def criticalTimeStep(self):
        """Largest stable step of the line on what it pulls at [s], while spans are not shorter than a
        quarter of what they are; with friction, until rings are drawn together.
        """
        return self._needEngine("criticalTimeStep").criticalTimeStep()

    # ---- pictures --------------------------------------------------------------------------------

    @property
    def spans(self):
        """The line as something that pictures are made of."""
        return [_Path(self)]

    @property
    def radius(self):
        """Half the diameter [m]."""
        return 0.5 * self.diameter

    def contactForces(self):
        """None: it touches nothing."""
        return []


class _Path:
    """Points and values along a line, k for each span and the last place."""

    def __init__(self, line):
        self._line = line

    def _between(self, atPlaces, k):
        """Values between those at the places (n + 1, ...), linearly."""
        atPlaces = np.asarray(atPlaces, float)
        part = (np.arange(k) / k).reshape(1, -1, *[1] * (atPlaces.ndim - 1))
        start, end = atPlaces[:-1, None], atPlaces[1:, None]
        inner = (start + part * (end - start)).reshape(-1, *atPlaces.shape[1:])
        return np.concatenate([inner, atPlaces[-1:]])

    def curve(self, k=8):
        """(k n + 1, 3) [m]."""
        return self._between(self._line.points, k)

    def stations(self, k=8):
        """Shares of the unstressed length, (k n + 1)."""
        lengths = self._line.lengths
        return self._between(np.concatenate([[0.0], np.cumsum(lengths)]) / lengths.sum(), k)

    def tensions(self, k=8):
        """(k n + 1) [N]."""
        tensions = self._line.tensions
        return np.append(np.repeat(tensions, k), tensions[-1])

    def strain(self, s):
        """Engineering strain at s [-]."""
        line = self._line
        ends = np.cumsum(line.lengths) / line.length
        i = min(int(np.searchsorted(ends, s, side="right")), len(ends) - 1)
        return float(line.tensions[i] / line.engine.ea)

    def velocity(self, s):
        """Velocity at s of the way, not of the material that slides along it [m/s], Vector3."""
        ends = np.concatenate([[0.0], np.cumsum(self._line.lengths)]) / self._line.length
        return Vector3(*(np.interp(s, ends, v) for v in self._line.velocities.T))

    def curvatures(self, k=8):
        """(k n + 1): none, but for the rings [1/m]."""
        return np.zeros(k * len(self._line.lengths) + 1)


def lines():
    """The Line objects of the scene, made anew at each call, also after O.load."""
    showLines()
    engines = lineEngines()
    knots = _knots() if engines else {}
    return [_recalled(e, knots) for e in engines]


def _knots():
    """(family, node of the engine) -> (cable or net, knot); of knots that are tied, the first."""
    found = {}
    for one in structures():
        for knot in range(one._layout.knots):
            if not one._wound(knot):
                found.setdefault((one._family, one._node(knot)), (one, knot))
    return found


def _recalled(engine, knots):
    line = object.__new__(Line)
    line.name, line.diameter = engine.name, engine.diameter
    line._number, line._engine = engine.line, engine
    cables = {e.family: e for e in cableEngines()}
    line.places = []
    for family, number, offset in zip(engine.families, engine.numbers, engine.offsets):
        if family < 0:
            line.places.append((number, tuple(offset)))
        else:
            line.places.append(knots[family, cables[family].tied(number)])
    return line


def lineEngines():
    """The LineEngines of O.engines."""
    return [e for e in O.engines if isinstance(e, wrapper.LineEngine)]


_numbers = 0  # given so far: none comes twice, so that no line takes another's engine for its own


def _newNumber():
    global _numbers
    _numbers = max([_numbers, *(e.line for e in lineEngines())]) + 1
    return _numbers


# ---- checks --------------------------------------------------------------------------------------


def _checkedPlaces(name, given):
    places = list(values.sequence(f"{name}.places", given, "places"))
    if len(places) < 2:
        values.refuse(f"{name}.places", given, "a line needs at least two places")
    places = [_place(f"{name}.places[{i}]", p) for i, p in enumerate(places)]
    for i, (one, next_) in enumerate(zip(places, places[1:])):
        if one == next_:
            raise ValueError(
                f"{name}.places[{i}] and [{i + 1}] are the same place: take one of them out"
            )
    return places


def _place(where, given):
    """(structure, knot) or (body id, point in its frame)."""
    if isinstance(given, (int, np.integer)) and not isinstance(given, bool):
        return int(given), (0.0, 0.0, 0.0)
    remedy = "must be (cable or net, knot), the id of a body, or (id, point)"
    if isinstance(given, str) or not hasattr(given, "__len__") or len(given) != 2:
        values.refuse(where, given, remedy, TypeError)
    what, at = given
    if isinstance(what, Structure):
        return what, what.knot(at)
    if not isinstance(what, (int, np.integer)) or isinstance(what, bool):
        values.refuse(where, given, remedy, TypeError)
    return int(what), tuple(float(x) for x in values.vector(f"{where}: point", at))


def _frictions(name, given, n):
    """Coefficients of all places, those of the ends 0."""
    if isinstance(given, str) or not hasattr(given, "__len__"):
        return [0.0, *[values.notNegative(f"{name}.friction", given, "-")] * (n - 2), 0.0]
    if len(given) != n - 2:
        values.refuse(
            f"{name}.friction", given, f"must be a number, or one for each of {n - 2} rings"
        )
    each = [values.notNegative(f"{name}.friction[{i}]", f, "-") for i, f in enumerate(given)]
    return [0.0, *each, 0.0]


def _cut(name, length, slack, tension):
    """(what, value) of that which says how long it is without stress."""
    what, value = oneOf(f"{name}: ", length=length, slack=slack, tension=tension) or ("slack", 0.0)
    unit = {"length": "m", "slack": "-", "tension": "N"}[what]
    check = values.positive if what == "length" else values.notNegative
    return what, check(f"{name}.{what}", value, unit)
