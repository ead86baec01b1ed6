"""Winches that pay out cables with their mass, and haul them in."""

import math

import numpy as np
from yade import Vector3

from . import values
from .cables import Cable
from .record import structures
from .structure import Span


class Winch:
    """A drum at an end of a cable of springs, from which it is paid out and onto which it is hauled in.

    cable     a Cable of model='springs', open, not appended yet: as laid it is what is outside at the
              start
    stored    unstressed length that is on the drum besides [m]; it becomes elements as long as the
              one at the drum, as nearly as may be
    end       0: the drum is at the cable's first knot, -1: at its last
    inertia   moment of inertia of the drum [kg m2]; 0: it follows its motor and its brake at once
    radius    of the drum [m]; needed with an inertia

    The knot at the drum is where the cable comes out. It may be fixed, follow a body, or carry one at
    its centre, which then feels the tension, the mass on the drum, and the momentum of what leaves.
    The drum holds until haul() or payOut().
    """

    def __init__(self, cable, stored, end=0, *, inertia=0.0, radius=None):
        if not isinstance(cable, Cable):
            values.refuse("Winch: cable", cable, "must be a Cable", TypeError)
        where = f"Winch of {cable.name}"
        if cable._stored is not None:
            raise ValueError(f"{where}: the cable has a winch already, and may have only one")
        if cable.appended:
            raise RuntimeError(f"{where}: make it before the cable is appended, and its engines()")
        if not cable.section.spring:
            raise ValueError(
                f"{where}: model='ancf' has slopes, and consistent mass, which cannot be paid out: use "
                "model='springs' with midPoints="
            )
        if cable.section.massDamping > 0:
            values.refuse(
                f"{where}: massDamping",
                cable.section.massDamping,
                "must be 0 [1/s], as it would brake what is wound; use damping",
            )
        layout = cable._layout
        if len(layout.edges) == len(np.unique(layout.edges)):
            raise ValueError(f"{where}: a closed cable has no end")
        if end not in (0, -1):
            values.refuse(f"{where}: end", end, "must be 0, the first knot, or -1, the last")
        stored = values.positive(f"{where}: stored", stored, "m", values.FARTHEST)
        inertia = values.notNegative(f"{where}: inertia", inertia, "kg m2")
        if inertia > 0 and radius is None:
            raise ValueError(
                f"{where}: an inertia of {inertia:g} kg m2 needs the drum's radius as well"
            )
        if radius is not None:
            inertia /= values.positive(f"{where}: radius", radius, "m") ** 2
        self.cable, self.end = cable, end
        count = max(1, round(stored / layout.length[end]))
        layout.wind(end, count, stored / count)
        cable.spans = [Span(cable, run) for run in layout.runs]
        cable._stored = (end, count)
        cable._later.append((lambda: self._wind(count, inertia), lambda: None))

    def _wind(self, count, inertia):
        drum, far = self._row
        self.cable.engine.wind(drum, far, count, inertia)

    @property
    def _row(self):
        """Elements of the engine at its drum and at the far end."""
        first = self.cable._first[1]
        row = first, first + self.cable.elementCount - 1
        return row if self.end == 0 else row[::-1]

    def _found(self, what):
        """The engine, and our number in it."""
        engine = self.cable.engine
        if engine is None:
            raise RuntimeError(f"{self.name}.{what}: append the cable first")
        return engine, list(engine.winchRows[::2]).index(self._row[0])

    @property
    def name(self):
        """In messages."""
        return f"Winch of {self.cable.name}"

    # ---- what it does ----------------------------------------------------------------------------

    def haul(self, speed, force, to=None, brake=math.inf):
        """Draws the cable in from now on.

        speed   unstressed length a time [m/s], or a function of the time; where it is below 0, the
                winch lets out
        force   of its motor at most [N]: beyond, it draws more slowly, or strains without moving
        to      unstressed length outside at which it stops to draw in [m]; None: half an element
        brake   tension above which its drum slips and lets out [N]

        ValueError if there is nothing left to draw in.
        """
        known = self._reading("haul")
        to = self._length("haul", known["least"] if to is None else to, known)
        force = values.positive(f"{self.name}.haul: force", force, "N")
        if not callable(speed):
            speed = values.positive(f"{self.name}.haul: speed", speed, "m/s")
            if to >= known["outside"]:
                values.refuse(
                    f"{self.name}.haul: to",
                    to,
                    f"there are {known['outside']:.6g} m outside: there is nothing to draw in",
                )
        brake = values.brake(f"{self.name}.haul: brake", brake, force)
        self._set("haul", speed, force, brake, to, known["most"])

    def payOut(self, speed, to=None, brake=math.inf):
        """Lets the cable out from now on.

        speed   unstressed length a time [m/s], or a function of the time; where it is below 0, nothing
                moves
        to      unstressed length outside at which it stops [m]; None: until half an element is left
        brake   tension above which its drum slips and lets out faster [N]

        ValueError if so much is outside already.
        """
        known = self._reading("payOut")
        to = self._length("payOut", known["most"] if to is None else to, known)
        if callable(speed):
            given = speed
            speed = lambda t: min(0.0, -given(t))  # noqa: E731
        else:
            speed = -values.positive(f"{self.name}.payOut: speed", speed, "m/s")
            if to <= known["outside"]:
                values.refuse(
                    f"{self.name}.payOut: to",
                    to,
                    f"there are {known['outside']:.6g} m outside already",
                )
        brake = values.brake(f"{self.name}.payOut: brake", brake)
        self._set("payOut", speed, 0.0, brake, known["least"], to)

    def hold(self, brake=math.inf):
        """Holds what it has, up to the tension of its brake [N]."""
        known = self._reading("hold")
        brake = values.brake(f"{self.name}.hold: brake", brake)
        self._set("hold", 0.0, 0.0, brake, known["least"], known["most"])

    def _set(self, what, *law):
        engine, number = self._found(what)
        engine.setWinch(number, *law)

    def _length(self, what, to, known):
        to = values.positive(f"{self.name}.{what}: to", to, "m")
        least, most = known["least"], known["most"]
        if not least * (1 - 1e-9) <= to <= most * (1 + 1e-9):
            remedy = f"must be {least:.6g} to {most:.6g} m: half an element stays on either side"
            values.refuse(f"{self.name}.{what}: to", to, remedy)
        return min(max(to, least), most)

    # ---- reading ---------------------------------------------------------------------------------

    def _reading(self, what):
        engine, number = self._found(what)
        return engine.winch(number)

    def state(self):
        """What it did in the last step: 'holds', 'draws', 'lets out', 'strains' (its force is not
        enough), 'slips' (its brake) or 'stopped' (at its length).
        """
        return self._reading("state")["does"]

    @property
    def length(self):
        """Unstressed length outside [m]."""
        return self._reading("length")["outside"]

    @property
    def stored(self):
        """Unstressed length on the drum [m]."""
        return self._reading("stored")["wound"]

    @property
    def rate(self):
        """Rate at which the length outside grew in the last step [m/s]."""
        return self._reading("rate")["rate"]

    @property
    def tension(self):
        """Tension where the cable comes out, in the last step [N]."""
        return self._reading("tension")["tension"]

    @property
    def point(self):
        """Where the cable comes out [m], Vector3."""
        return Vector3(*self.cable._knotAt(self.cable.knot(self.end)))

    def energy(self):
        """dict of the drum's work on the cable so far, and what nodes gave that came and went [J]."""
        known = self._reading("energy")
        return {"work": known["work"], "nodes": known["knotted"]}


def winches():
    """The Winch objects of the scene, made anew at each call, also after O.load."""
    return [_recalled(s) for s in structures() if getattr(s, "_stored", None) is not None]


def _recalled(cable):
    winch = object.__new__(Winch)
    winch.cable, winch.end = cable, cable._stored[0]
    return winch
