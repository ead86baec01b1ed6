"""Stages of a capture: when a net opens, meets a target, embraces it and comes off again; and what is measured
meanwhile.
"""

import math

import numpy as np
from yade import O, Vector3, wrapper

from . import values
from .enclosure import DIRECTIONS, Skin, enclosedShare, everywhere, meshes
from .hulls import hull, indexOf, qualityIndex, targetSize
from .lines import lineEngines
from .nets import areaVector
from .structure import findBody

__all__ = [
    "Capture",
    "Momentum",
    "enclosedShare",
    "hull",
    "meshes",
    "pressing",
    "qualityIndex",
    "targetSize",
]

EVERY = 20  # samples between two looks at what costs most
CLOSED = 0.25  # mouth of a net that embraces, of its largest
HOLD = 0.3  # that it must last [s]
ROUNDING = 1e-9  # of times
NOTHING = 1e-9  # change of a target's speed, or of a net's where that is held, that is no contact yet [m/s]


# ---- contact with the target ---------------------------------------------------------------------


def pressing(net, target):
    """How many elements and bullets of a net pressed on a body in the last step; the net's contacts with itself
    are not among them.
    """
    body = findBody("pressing", target, "target")
    members = body.shape.members.keys() if isinstance(body.shape, wrapper.Clump) else [target]
    ours = {*net.bodies, *net.bullets}
    return sum(
        contact.isReal and not ours.isdisjoint((contact.id1, contact.id2)) and _presses(contact)
        for member in members
        for contact in O.bodies[member].intrs()
    )


def _presses(contact):
    return contact.phys.normalForce.squaredNorm() > 0


class Momentum:
    """Momentum that a target has been given since this was made: given() [kg m/s], gravity's part left out.

    A free body tells it itself; all that pushes it counts. For one that is held it is what the cables of the
    engine and the bodies that they carry have lost, to whatever they touch; nan if something else holds, loads
    or damps them, or a line pulls at them from outside.
    """

    def __init__(self, net, target):
        engine, body = net.engine, findBody("Momentum", target, "target")
        self.engine, self.body = engine, body
        self.free = body.dynamic and body.state.blockedDOFs == ""
        self.mass = body.state.mass
        if not self.free:
            carried = sum(O.bodies[i].state.mass for i in engine.carryIds)
            self.mass = float(np.dot(engine.rhoA, engine.length)) + carried
        self.start, self.time = self._now(), self._when()

    def given(self):
        """The momentum (3) [kg m/s]."""
        engine = self.engine
        if not self.free and self._othersToo():
            return Vector3(math.nan, math.nan, math.nan)
        weight = self.mass * (self._when() - self.time) * engine.gravity
        gained = self._now() - self.start - weight
        return gained if self.free else -gained

    def _othersToo(self):
        """Whether the cables exchange momentum with something else than what they touch."""
        engine = self.engine
        if engine.fixedNodes or engine.followNodes or engine.slideNodes or engine.loadNodes:
            return True
        if any(engine.massDamping):
            return True
        return any({engine.family} < set(line.families) for line in lineEngines())

    def _now(self):
        if self.free:
            return self.body.state.mass * self.body.state.vel
        return self.engine.momentum()[0]

    def _when(self):
        """The time of the velocities: leapfrog's half step before O.time for cables [s]."""
        return O.time if self.free else O.time - 0.5 * self.engine.lastStep


# ---- a whole capture -----------------------------------------------------------------------------


class Capture:
    """Stages and measures of a net's capture of a body. Make it before the run, sample() each few
    milliseconds, then read its attributes, or row(): a dict with all of them.

        capture = Capture(net, ball)
        for _ in ancf.progress(1.5, 5e-3):
            capture.sample()
        print(capture.row())

    target      id of the body
    closed      mouth, as part of its largest so far, below which the net embraces the target if all its bullets
                (corners, where it has none) are beyond the target's centre as well, along net.normal
    hold        how long it must do so without a break to count [s]
    every       samples between two looks at enclosure and hull, which cost most
    also        {name: function()} of further measures to sample, such as the length left of a line that
                draws the mouth shut; row() has their last values
    directions  as for enclosedShare

    All times are those of samples. A contact shorter than the time between them is not missed: the time of first
    contact is read from the target's momentum (see Momentum).
    """

    def __init__(
        self,
        net,
        target,
        closed=CLOSED,
        hold=HOLD,
        every=EVERY,
        also=None,
        directions=DIRECTIONS,
    ):
        if not net.appended:
            raise RuntimeError(f"Capture: append {net.name} first")
        findBody("Capture", target, "target")
        net.mouthArea()  # refuses a net without a rim
        if not (net.bullets or net.corners):
            remedy = "name the knots that are to get beyond the target, or use addBullets"
            values.refuse(f"{net.name}.corners", net.corners, remedy)
        self.net, self.target = net, target
        self.closed = values.positive("Capture: closed", closed, "-", 1)
        self.hold = values.notNegative("Capture: hold", hold, "s")
        self.every = values.count("Capture: every", every, 1)
        self.also = dict(also or {})
        self._momentum = Momentum(net, target)
        self._size, self._skin = targetSize(target), Skin(net)
        self._rim, self._normal = np.array(net.rim), Vector3(*net.normal)
        self._directions = everywhere(values.count("Capture: directions", directions, 1))
        self.time, self.mouth, self.beyond, self.contacts = [], [], [], []
        self.momentum, self.tension = [], []
        self.looked = []  # numbers of the samples in which these were looked at
        self.enclosed, self.hull, self.quality = [], [], []
        self.more = {name: [] for name in self.also}

    def sample(self):
        """Keeps the present state."""
        nodes = self.net._state()[0]
        self.time.append(O.time)
        area = areaVector(nodes[self._rim])
        self.mouth.append(math.sqrt(area @ area))
        self.beyond.append(self._beyond(nodes))
        self.contacts.append(pressing(self.net, self.target))
        self.momentum.append(self._momentum.given().norm())
        self.tension.append(self._tension())
        for name, measure in self.also.items():
            self.more[name].append(measure())
        if (len(self.time) - 1) % self.every == 0:
            self.look()

    def look(self):
        """Looks at enclosure and hull in the last sample, if it has not been done."""
        if self.looked and self.looked[-1] == len(self.time) - 1:
            return
        nodes, center = self.net._state()[0], np.array(list(O.bodies[self.target].state.pos))
        self.looked.append(len(self.time) - 1)
        made = hull(nodes)
        self.enclosed.append(float(self._skin.blocked(nodes, center, self._directions).mean()))
        self.hull.append(made.volume / self._size[0])
        self.quality.append(indexOf(made, self._size, center))

    def _beyond(self, nodes):
        """Share of the bullets beyond the target's centre."""
        net, n = self.net, self._normal
        ahead = [O.bodies[i].state.pos for i in net.bullets]
        ahead = ahead or [Vector3(*nodes[k]) for k in net.corners]
        least = O.bodies[self.target].state.pos.dot(n)
        return sum(p.dot(n) > least for p in ahead) / len(ahead)

    def _tension(self):
        """Largest in the middles of the net's elements [N]."""
        engine, first = self._momentum.engine, self.net._first[1]
        return max(engine.tension(first + k, 0.5) for k in range(self.net.elementCount))

    # ---- stages; times are None where it did not come so far

    @property
    def _met(self):
        """Number of the first sample with the target touched, or None."""
        met = np.array(self.contacts) > 0
        met |= np.array(self.momentum) > NOTHING * self._momentum.mass  # never where it is nan
        return int(np.argmax(met)) if met.any() else None

    @property
    def open(self):
        """Time of the largest mouth before the first contact [s]."""
        return self.time[int(np.argmax(self.mouth[: self._met or None]))]

    @property
    def contact(self):
        """Time of the first contact with the target [s]."""
        return None if self._met is None else self.time[self._met]

    @property
    def share(self):
        """Mouth as part of its largest so far, of all samples, numpy [-]."""
        return np.array(self.mouth) / np.maximum.accumulate(self.mouth)

    @property
    def embracing(self):
        """Whether the net embraced the target, of all samples, numpy."""
        return (self.share < self.closed) & (np.array(self.beyond) == 1)

    @property
    def _held(self):
        """First and last sample of the longest time in which the net embraced the target, or None where it did not
        for `hold`.
        """
        edges = np.flatnonzero(np.diff(self.embracing, prepend=False, append=False))
        lasting = {
            (a, b - 1): self.time[b - 1] - self.time[a] for a, b in zip(edges[::2], edges[1::2])
        }
        longest = max(lasting, key=lasting.get, default=None)
        return None if longest is None or lasting[longest] < (1 - ROUNDING) * self.hold else longest

    @property
    def embraced(self):
        """(from, until): the longest time in which the net embraced the target, if for `hold` [s]."""
        return self._held and tuple(self.time[k] for k in self._held)

    @property
    def tightest(self):
        """Time of the smallest mouth in that time [s]."""
        if self._held is None:
            return None
        first, last = self._held
        return self.time[first + int(np.argmin(self.share[first : last + 1]))]

    @property
    def recoil(self):
        """Time at which it came off its target again [s]; None as well if it embraced it to the last sample."""
        if self._held is None or self._held[1] == len(self.time) - 1:
            return None
        return self.time[self._held[1] + 1]

    @property
    def lock(self):
        """Time from which on it embraced the target to the last sample, for `hold` at least [s]."""
        if self._held is None or self._held[1] < len(self.time) - 1:
            return None
        return self.time[self._held[0]]

    def row(self):
        """Stages and measures, one row of a table: {name with unit: value}, times None as above."""
        if not self.time:
            raise RuntimeError("Capture.row: there are no samples yet; sample() first")
        self.look()
        since, until = self.embraced or (None, None)
        share = self.share
        tight = None if since is None else float(share[self.time.index(self.tightest)])
        own = {
            "open_s": self.open,
            "mouth_open_m2": self.mouth[self.time.index(self.open)],
            "contact_s": self.contact,
            "embraced_from_s": since,
            "embraced_until_s": until,
            "tightest_s": self.tightest,
            "mouth_tightest": tight,
            "recoil_s": self.recoil,
            "lock_s": self.lock,
            "mouth_end": float(share[-1]),
            "beyond_end": self.beyond[-1],
            "enclosed_most": max(self.enclosed),
            "enclosed_end": self.enclosed[-1],
            "quality_best": min(self.quality),
            "quality_end": self.quality[-1],
            "hull_end": self.hull[-1],
            "tension_most_N": max(self.tension),
            "momentum_most_Ns": max(self.momentum),
            "momentum_end_Ns": self.momentum[-1],
        }
        for name in own.keys() & self.also.keys():
            values.refuse("Capture: also", name, "is a measure already: choose another name")
        return own | {name: series[-1] for name, series in self.more.items()}
