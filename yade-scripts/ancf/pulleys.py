"""Sheaves, belts and linear drives: how they are made, how cables lie on them, what is read off them.

A cable lies in the plane of its sheaves along straight lines and arcs; R below is the radius of its
centreline, that of the groove's bottom and of the cable together.
"""

import math
import warnings
from dataclasses import dataclass

import numpy as np
from yade import O, Quaternion, Vector3, wrapper

from . import scene, stretch, values
from .cables import Cable
from .laying import curveLength
from .lines import Line
from .structure import MASK, Structure, anyMaterial, findBody

DEEPEST_START = 0.5  # of a cable in a sheave, in radii of the cable; more is refused
COARSE = 0.1  # distance from the arc of a sheave that is warned of, in radii of the cable


# ---- making ------------------------------------------------------------------------------------


def sheave(
    center,
    radius,
    *,
    axis=(0, 1, 0),
    width,
    profile="round",
    material,
    mass=None,
    inertia=None,
    fixed=True,
    mask=1,
    color=(0.5, 0.5, 0.55),
    **groove,
):
    """Puts a sheave into O.bodies and returns its id; add() it to a SheaveEngine to turn it.

    center     [m]
    radius     at the bottom of the groove [m]
    axis       direction about which a positive speed turns it
    width      of the groove between its lips [m]
    profile    'round', 'flat' or 'vee'; groove: further attributes of Sheave (grooveRadius,
               grooveAngle, flangeHeight, flangeThickness)
    material   HollarsMat or FrictMat in O.materials, or its label
    mass       [kg]; None: that of a solid disc up to the lips
    inertia    about the axis [kg m2]; None: that of a disc of this mass
    fixed      False: the axle moves freely (a hanging block), or is carried by a knot
    """
    shape = wrapper.Sheave(
        radius=values.positive("sheave: radius", radius, "m"),
        width=values.positive("sheave: width", width, "m"),
        profile=profile,
        **groove,
    )
    mat = anyMaterial("sheave: material", material)
    if not isinstance(mat, (wrapper.HollarsMat, wrapper.FrictMat)):
        remedy = f"is a {type(mat).__name__}, but sheaves need a HollarsMat or a FrictMat"
        values.refuse("sheave: material", material, remedy, TypeError)
    center = values.vector("sheave: center", center)
    turn = Quaternion()
    turn.setFromTwoVectors(Vector3(0, 0, 1), Vector3(*values.direction("sheave: axis", axis)))
    fixed, mask = values.flag("sheave: fixed", fixed), values.count("sheave: mask", mask, 1, MASK)
    color = values.vector("sheave: color", color)
    if mass is None:
        mass = mat.density * math.pi * shape.rimRadius**2 * shape.overallWidth
    mass = values.positive("sheave: mass", mass, "kg")
    if inertia is None:
        inertia = mass * shape.rimRadius**2 / 2
    inertia = values.notNegative("sheave: inertia", inertia, "kg m2")
    body = wrapper.Body()
    body.shape, body.material, body.mask = shape, mat, mask
    shape.color = Vector3(*color)
    body.state.pos = body.state.refPos = Vector3(*center)
    body.state.ori = body.state.refOri = turn
    body.state.mass = mass
    # It turns about its axis only, whatever direction that is: the same value on all axes.
    body.state.inertia = inertia * Vector3(1, 1, 1)
    body.bounded = True
    body.state.blockedDOFs = "xyzXYZ" if fixed else "XYZ"
    return O.bodies.append(body)


def _sheaveBody(where, sheaveId):
    """The body of a sheave; IndexError if there is none, ValueError if it is something else."""
    body = findBody(where, sheaveId, "sheave id")
    if not isinstance(body.shape, wrapper.Sheave):
        values.refuse(
            f"{where}: sheave id", sheaveId, f"is a {type(body.shape).__name__}, no Sheave"
        )
    return body


def axisOf(sheaveId):
    """Unit vector of a sheave's axis, (3,); exact where it is along an axis of the scene."""
    a = np.array(_sheaveBody("axisOf", sheaveId).state.ori * Vector3(0, 0, 1))
    a[abs(a) < 1e-9] = 0
    return a / np.linalg.norm(a)


def _smooth(x):
    """Step from 0 to 1 with two continuous derivatives, and its slope and integral."""
    x = min(max(x, 0.0), 1.0)
    return (
        x**3 * (10 - 15 * x + 6 * x * x),
        30 * (x * (1 - x)) ** 2,
        x**4 * (2.5 - 3 * x + x * x),
    )


class Ramp:
    """Motion for a linear drive, x(t) [m]: from rest at 0 to rest at `distance` within `duration`.

    Speed and acceleration are continuous. `speed(t)` [m/s].
    """

    def __init__(self, distance, duration, start=0.0):
        self.distance = values.finite("Ramp: distance", distance, "m")
        self.duration = values.positive("Ramp: duration", duration, "s")
        self.start = values.finite("Ramp: start", start, "s")

    def __call__(self, t):
        return self.distance * _smooth((t - self.start) / self.duration)[0]

    def speed(self, t):
        return self.distance / self.duration * _smooth((t - self.start) / self.duration)[1]


class SpeedUp:
    """Motion x(t) [m] that comes smoothly from rest to a constant speed within `duration`.

    Its `speed(t)` [m/s] serves a SheaveEngine too, in rad and rad/s.
    """

    def __init__(self, speed, duration, start=0.0):
        self.final = values.finite("SpeedUp: speed", speed, "m/s")
        self.duration = values.positive("SpeedUp: duration", duration, "s")
        self.start = values.finite("SpeedUp: start", start, "s")

    def __call__(self, t):
        x = (t - self.start) / self.duration
        return self.final * self.duration * (_smooth(x)[2] + max(0.0, x - 1))

    def speed(self, t):
        return self.final * _smooth((t - self.start) / self.duration)[0]


class BackAndForth:
    """Motion x(t) [m]: 0 to `distance` and back in every period, x = distance (1 - cos(phase))/2.

    The phase is 2 pi t/period but in the first quarter, where it starts from rest, so that the
    acceleration does so, too. `speed(t)` [m/s].
    """

    def __init__(self, distance, period):
        self.distance = values.finite("BackAndForth: distance", distance, "m")
        self.period = values.positive("BackAndForth: period", period, "s")

    def _phase(self, t):
        """Phase [rad] and its rate: in the first quarter the quartic that leaves rest and comes into
        the even run with two continuous derivatives.
        """
        x, w = max(0.0, 4 * t / self.period), 2 * math.pi / self.period
        if x >= 1:
            return w * t, w
        return math.pi / 2 * x**2 * (3 - 3 * x + x**2), w * x * (6 - 9 * x + 4 * x**2)

    def __call__(self, t):
        return self.distance * (1 - math.cos(self._phase(t)[0])) / 2

    def speed(self, t):
        phase, rate = self._phase(t)
        return self.distance * math.sin(phase) / 2 * rate


# ---- laying ------------------------------------------------------------------------------------


def _right(u):
    return np.array([u[1], -u[0]])


@dataclass
class _Piece:
    """A straight line (radius 0) from `begin` along `way`, or an arc about `begin`."""

    length: float
    begin: np.ndarray  # (2,)
    way: np.ndarray  # (2,) direction at its start
    radius: float = 0.0
    sign: int = 1  # 1: counterclockwise

    def at(self, s):
        """Point and direction at s [m] from its start."""
        if self.radius == 0:
            return self.begin + s * self.way, self.way
        turned = self.sign * s / self.radius
        c, n = math.cos(turned), math.sin(turned)
        u = np.array([c * self.way[0] - n * self.way[1], n * self.way[0] + c * self.way[1]])
        return self.begin + self.sign * self.radius * _right(u), u


class Path:
    """The way of a cable round sheaves, in the plane of the first one.

    stops     list of (sheave id, direction) or (sheave id, direction, further turns); direction 1
              where the cable goes round as its sheave turns with a positive speed, -1 the other way
    start, end  points [m] of an open path, projected on the plane; both None: a closed one, a belt
    diameter  of the cable [m]
    gap       of the cable from the bottom of the groove at the start [m]; < 0: it lies in it

    length [m], closed, angles: wrap at each stop [rad].
    """

    def __init__(self, stops, *, diameter, start=None, end=None, gap=0.0):
        stops = [
            values.sequence(f"Path: stops[{i}]", stop, "a sheave id, a direction and further turns")
            for i, stop in enumerate(
                values.sequence("Path: stops", stops, "(sheave id, direction)")
            )
        ]
        if not stops:
            raise ValueError("Path: stops is empty: give at least one (sheave id, direction)")
        self.closed = start is None and end is None
        if not self.closed and (start is None or end is None):
            raise ValueError(
                "Path: start and end must both be given, or neither for a belt, whose ends meet"
            )
        if not self.closed:
            start, end = values.vector("Path: start", start), values.vector("Path: end", end)
            if (start == end).all():
                raise ValueError("Path: start and end are one point: leave both out for a belt")
        for i, stop in enumerate(stops):
            if not 2 <= len(stop) <= 3:
                remedy = "must be (sheave id, direction) or (sheave id, direction, further turns)"
                values.refuse(f"Path: stops[{i}]", tuple(stop), remedy)
        self._frame(stops[0][0])
        r = 0.5 * values.positive("Path: diameter", diameter, "m")
        r += values.finite("Path: gap", gap, "m")
        rounds = [self._circle(stop, r) for stop in stops]
        ends = [] if self.closed else [(self._flat(p), 0.0, 1, 0) for p in (start, end)]
        circles = rounds + rounds[:1] if self.closed else [ends[0], *rounds, ends[1]]
        lines = [self._line(a, b) for a, b in zip(circles[:-1], circles[1:])]
        self.pieces, self.angles = [], []
        between = range(len(rounds)) if self.closed else range(1, len(circles) - 1)
        if not self.closed:
            self.pieces.append(lines[0])
        for i in between:
            into, out = lines[i - 1], lines[i]
            arc = self._arc(circles[i], into.way, out.way)
            self.angles.append(arc.length / arc.radius)
            self.pieces += [arc, out]
        self.length = sum(p.length for p in self.pieces)
        if not math.isfinite(self.length):
            raise ValueError(
                f"Path: its length is {self.length}: start, end or sheaves are too far"
            )

    def _frame(self, sheaveId):
        axis = axisOf(sheaveId)
        k = int(np.argmax(abs(axis)))
        e = np.zeros(3)
        e[(k + 1) % 3] = 1
        e -= np.dot(e, axis) * axis
        self.e1 = e / np.linalg.norm(e)
        self.e2 = np.cross(axis, self.e1)
        self.axis, self.origin = axis, np.array(O.bodies[sheaveId].state.pos)

    def _flat(self, p):
        d = values.vector("Path", p) - self.origin
        return np.array([d @ self.e1, d @ self.e2])

    def _circle(self, stop, r):
        sheaveId, sign, turns = *stop, *[0] * (3 - len(stop))
        body = _sheaveBody("Path", sheaveId)
        turns = values.count(f"Path: further turns at sheave {sheaveId}", turns, 0)
        if body.shape.radius + r <= 0:
            remedy = f"puts the cable inside the axle of sheave {sheaveId}, whose radius is {body.shape.radius:g} m"
            values.refuse("Path: gap", r, remedy)
        if sign not in (1, -1):
            values.refuse(f"Path: direction at sheave {sheaveId}", sign, "must be 1 or -1")
        along = float(axisOf(sheaveId) @ self.axis)
        if abs(along) < 1 - 1e-9:
            raise ValueError(
                f"Path: the axis of sheave {sheaveId} is not that of the first: lay the cable by "
                "points of your own"
            )
        turned = sign * (1 if along > 0 else -1)
        return self._flat(body.state.pos), body.shape.radius + r, turned, turns

    def _line(self, a, b):
        (c1, r1, d1, _), (c2, r2, d2, _) = a, b
        away = c2 - c1
        distance = np.linalg.norm(away)
        sine = (d1 * r1 - d2 * r2) / distance if distance > 0 else 2.0
        if abs(sine) >= 1:
            raise ValueError(
                f"Path: no straight line goes from {self._space(c1)} to {self._space(c2)}: a point "
                "lies inside a sheave, or two sheaves are too close for this way round"
            )
        unit = away / distance
        u = unit * math.sqrt(1 - sine**2) - _right(unit) * sine
        begin, end = c1 + d1 * r1 * _right(u), c2 + d2 * r2 * _right(u)
        return _Piece(float(np.linalg.norm(end - begin)), begin, u)

    def _arc(self, circle, into, out):
        center, radius, sign, turns = circle
        angle = sign * math.atan2(into[0] * out[1] - into[1] * out[0], into @ out)
        if angle < -1e-12:
            angle += 2 * math.pi
        return _Piece(radius * (max(angle, 0) + 2 * math.pi * turns), center, into, radius, sign)

    def _space(self, p):
        q = self.origin + p[0] * self.e1 + p[1] * self.e2
        return np.round(q, 15) + 0.0

    def at(self, s):
        """Point (3,) and unit tangent (3,) at s [m] from the start."""
        for piece in self.pieces:
            if s <= piece.length or piece is self.pieces[-1]:
                p, u = piece.at(min(s, piece.length))
                return (
                    self.origin + p[0] * self.e1 + p[1] * self.e2,
                    u[0] * self.e1 + u[1] * self.e2,
                )
            s -= piece.length

    def flow(self, speed):
        """Velocity field f(p) [m/s] of a cable that runs along the path, for Cable.setVelocity."""
        way = np.array([self.at(s)[0] for s in np.linspace(0, self.length, 2000)])
        at = np.linspace(0, self.length, 2000)

        def f(p):
            near = at[int(np.argmin(((way - np.array(p)) ** 2).sum(1)))]
            s = near
            for piece in self.pieces:
                if s <= piece.length or piece is self.pieces[-1]:
                    break
                s -= piece.length
            q = self._flat(p)
            u = piece.way
            if piece.radius:
                u = -piece.sign * _right(q - piece.begin) / piece.radius
            return Vector3(*(speed * (u[0] * self.e1 + u[1] * self.e2)))

        return f


def lay(path, elements, *, length=None, slack=None, tension=None, **cable):
    """A Cable along a Path, `elements` of equal length.

    tension          [N] that it has from the start: a number, or a function of the place along the
                     path [m]; friction at sheaves holds what differs
    length, slack    in its place, as for Cable
    cable            arguments of Cable (diameter, material, contactPoints, damping, ...)
    """
    if not isinstance(path, Path):
        values.refuse("lay: path", path, "must be a Path", TypeError)
    elements = values.count("lay: elements", elements, 3)
    count = elements if path.closed else elements + 1
    places = np.arange(count) * path.length / elements
    points, tangents = (np.array(x) for x in zip(*[path.at(s) for s in places]))
    made = Cable(points, 1, closed=path.closed, **cable)
    section, layout = made.section, made._layout
    if section.spring:
        raise ValueError("lay: model='springs' lies on no arc; use model='ancf'")

    middles = (np.arange(elements) + 0.5) * path.length / elements
    i, j = layout.ends.T
    laid = curveLength(points[i], tangents[i], points[j], tangents[j])

    def ratios(at):
        pull = [tension(s) for s in at] if callable(tension) else tension
        return stretch.ratios("lay: ", section, np.full(len(at), laid.sum()), length, slack, pull)

    layout.length = laid / ratios(middles)
    slopes = ratios(places)[:, None] * tangents
    layout.slopes = np.stack([slopes[i], slopes[j]], axis=1).reshape(-1, 3)
    return made


# ---- engines and checks ------------------------------------------------------------------------


def engines(*parts, **options):
    """As ancf.engines, with sheaves: `parts` are cables, nets, lines, SheaveEngines and
    GuideEngines.

    Raises ValueError for a cable that starts inside a sheave or does not fit its groove; warns of
    elements or contact points that are too coarse for an arc.
    """
    structures = [p for p in parts if isinstance(p, Structure)]
    lines = [p for p in parts if isinstance(p, Line)]
    drives = [p for p in parts if isinstance(p, (wrapper.SheaveEngine, wrapper.GuideEngine))]
    for i, part in enumerate(parts):
        if all(part not in known for known in (structures, lines, drives)):
            values.refuse(
                f"engines: argument {i}",
                part,
                "must be a Cable, a Net, a Line, a SheaveEngine or a GuideEngine",
                TypeError,
            )
    check(*structures)
    made = scene.engines(*structures, *lines, **options)
    for engine in made:
        if isinstance(engine, wrapper.InsertionSortCollider):
            bounds = engine.boundDispatcher.functors
            if not any(isinstance(f, wrapper.Bo1_Sheave_Aabb) for f in bounds):
                engine.boundDispatcher.functors = [*bounds, wrapper.Bo1_Sheave_Aabb()]
        if isinstance(engine, wrapper.InteractionLoop):
            pairs = engine.geomDispatcher.functors
            if not any(isinstance(f, wrapper.Ig2_Sheave_Sphere_ScGeom) for f in pairs):
                engine.geomDispatcher.functors = [
                    *pairs,
                    wrapper.Ig2_Sheave_Sphere_ScGeom(),
                    wrapper.Ig2_Sheave_CableElement_CableGeom(),
                    wrapper.Ig2_Sheave_CarriedSphere_CableGeom(),
                ]
    return made[:-1] + drives + made[-1:]


def settle(cable, time, every=1e-3):
    """Lets a scene come to rest for `time` [s] and sets O.time to 0: whenever kinetic energy has
    begun to fall, all speeds of cables and of bodies that nothing leads are taken out.
    """
    time = values.positive("settle: time", time, "s")
    every = values.positive("settle: every", every, "s")
    free = [k for k, what in cable._claims.items() if what.startswith("carrying")]
    carried = [b for k, b in cable._attached if k in free]
    engines = [e for e in O.engines if isinstance(e, wrapper.SheaveEngine)]
    loose = [i for e in engines for i, w in zip(e.ids, e.speed) if math.isnan(w)]
    last, steps = 0.0, max(1, round(every / O.dt))
    for _ in range(max(1, round(time / (steps * O.dt)))):
        for _ in range(steps):
            O.step()
        states = [O.bodies[b].state for b in carried]
        kinetic = cable.energy()["kinetic"] + sum(
            0.5 * s.mass * s.vel.squaredNorm() for s in states
        )
        if kinetic < last:
            cable.engine.velocity = [0.0] * len(cable.engine.velocity)
            for s in states:
                s.vel = s.angVel = Vector3.Zero
            for i in loose:
                O.bodies[i].state.angVel = Vector3.Zero
            kinetic = 0.0
        last = kinetic
    O.resetTime()


def sheaves():
    """Ids of all sheaves in O.bodies."""
    return [b.id for b in O.bodies if b and isinstance(b.shape, wrapper.Sheave)]


def check(*structures):
    """Raises ValueError, or warns, where cables do not fit the sheaves of the scene."""
    for structure in structures:
        if not structure._contactPoints and not structure.bodies:
            continue
        for sheaveId in sheaves():
            _checkStart(structure, sheaveId)


def _checkStart(structure, sheaveId):
    body = O.bodies[sheaveId]
    shape, r = body.shape, structure.radius
    back = body.state.ori.conjugate()
    near = False
    for span in structure.spans:
        for p, s in zip(span.curve(4), span.stations(4)):
            depth = shape.touch(back * (Vector3(*p) - body.state.pos), r)[0]
            near = near or depth > -2 * r
            if depth > DEEPEST_START * r:
                raise ValueError(
                    f"{structure.name} starts {depth:.3g} m inside sheave {sheaveId} at s = {s:.4f} "
                    f"(its radius is {r:g} m): lay it further out, or with more elements"
                )
    if not near:
        return
    if shape.fillet and shape.fillet < r:
        raise ValueError(
            f"the groove of sheave {sheaveId} (radius {shape.fillet:g} m) is narrower than "
            f"{structure.name} (radius {r:g} m): make grooveRadius at least {r:g}"
        )
    what, error, remedy = _coarseness(structure, shape.radius + r)
    if error > COARSE * r:
        warnings.warn(
            f"{structure.name}: {what} on sheave {sheaveId} of radius {shape.radius:g} m can stray from its arc by "
            f"{error:.2g} m, {error / r:.0%} of the cable's radius; more {remedy} make it smaller",
            stacklevel=4,
        )


def _coarseness(structure, radius):
    """What keeps a cable from an arc of a radius [m], by how much [m], and more of what mends it."""
    length = float(structure._layout.length.max())
    if structure.section.spring:
        return f"straight springs of {length:.3g} m", length**2 / (8 * radius), "midPoints"
    if structure.contact == "points":  # what lies between them sinks in
        spacing = length / structure._segments
        return (
            f"contact points {spacing:.3g} m apart",
            spacing**2 / (8 * radius),
            "elements or contactPoints",
        )
    # a cubic with the arc's tangents at its ends, in its middle
    return f"elements of {length:.3g} m", length**4 / (384 * radius**3), "elements"


# ---- reading -----------------------------------------------------------------------------------


@dataclass
class Wrap:
    """A cable on a sheave as it is now; arrays along the cable, one value a place of contact."""

    arc: np.ndarray  # place along the unstressed cable [m]
    angle: np.ndarray  # turned through along the wrap [rad], from 0
    normal: np.ndarray  # normal force [N]
    friction: np.ndarray  # friction on the cable along it [N]
    slip: np.ndarray  # speed of the cable relative to the sheave, along the cable [m/s]
    sticks: np.ndarray  # slower than v_t0
    entry: float  # mean tension of the element before the wrap [N]
    exit: float  # and behind it [N]

    @property
    def wrapAngle(self):
        """[rad]. Between where the normal force, summed up from either end, starts as it goes on
        over the sixth of the wrap there: single places share the force unevenly.
        """
        if len(self.angle) < 3:
            return float(self.angle[-1])
        middle = np.cumsum(self.normal) - self.normal / 2
        left = self._start(self.angle, middle)
        right = self._start(self.angle[-1] - self.angle[::-1], self.normal.sum() - middle[::-1])
        return float(self.angle[-1] - left - right)

    @staticmethod
    def _start(angle, force):
        """Where a line through the first sixth of a summed force is 0 [rad]; 3 places at least."""
        n = max(3, np.count_nonzero(angle <= angle[-1] / 6))
        slope, offset = np.polyfit(angle[:n], force[:n], 1)
        return -offset / slope

    @property
    def frictionSum(self):
        """Sum of friction along the cable [N]: on a massless one the difference of tensions."""
        return float(self.friction.sum())

    @property
    def slipPower(self):
        """Power that slip takes out [W]."""
        return float(-(self.friction * self.slip).sum())


def wrap(cable, sheaveId):
    """Reads the Wrap of a cable on a sheave, or None where it touches nowhere."""
    body = _sheaveBody("wrap", sheaveId)
    engine, span = cable._needEngine("wrap"), cable.spans[0]
    axis = axisOf(sheaveId)
    center, vel = np.array(body.state.pos), np.array(body.state.vel)
    spin = np.array(body.state.angVel)
    own = set(cable.bodies)
    rows = []
    for contact in body.intrs():
        if contact.id2 not in own or not contact.isReal:
            continue
        found, slow = contact.geom, contact.phys.transitionVelocity
        number = O.bodies[contact.id2].shape.element
        e = number - cable._first[1]
        for xi, force, friction in zip(found.xi, found.force, found.friction):
            if force == 0:
                continue
            ahead = engine.point(number, min(1.0, xi + 1e-3))
            t = np.array(ahead - engine.point(number, max(0.0, xi - 1e-3)))
            t /= np.linalg.norm(t)
            out = np.array(engine.point(number, xi)) - center
            slip = np.array(engine.pointVelocity(number, xi)) - vel - np.cross(spin, out)
            speed = np.linalg.norm(slip - (slip @ axis) * axis)
            arc = span._arc[e] + xi * (span._arc[e + 1] - span._arc[e])
            rows.append((arc, out, force, np.dot(friction, t), slip @ t, speed < slow))
    if not rows:
        return None
    rows.sort(key=lambda row: row[0])
    closed = cable._layout.ends[-1][1] == cable._layout.ends[0][0]
    if closed:  # begin behind the longest way without contact
        arcs = np.array([row[0] for row in rows])
        gaps = np.diff(np.append(arcs, arcs[0] + span.length))
        first = (int(np.argmax(gaps)) + 1) % len(rows)
        rows = rows[first:] + rows[:first]
    out = np.array([row[1] for row in rows])
    flat = out - np.outer(out @ axis, axis)
    steps = [
        math.atan2(abs(float(np.cross(a, b) @ axis)), float(a @ b)) for a, b in zip(flat, flat[1:])
    ]
    columns = [np.array([row[i] for row in rows]) for i in (0, 2, 3, 4, 5)]
    count = span._run.count

    def mean(arc, step):
        k = int(np.clip(np.searchsorted(span._arc, arc, side="right") - 1, 0, count - 1)) + step
        k = k % count if closed else min(max(k, 0), count - 1)
        x, w = np.polynomial.legendre.leggauss(3)
        e = cable._first[1] + k
        return float(sum(0.5 * b * engine.tension(e, 0.5 * (a + 1)) for a, b in zip(x, w)))

    return Wrap(
        columns[0],
        np.concatenate([[0.0], np.cumsum(steps)]),
        *columns[1:],
        mean(columns[0][0], -1),
        mean(columns[0][-1], 1),
    )
