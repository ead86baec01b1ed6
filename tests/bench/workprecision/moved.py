"""A stiff bending cable hangs between two ends, one of which is moved: steps long against its axial waves."""

import math
import time

import numpy as np
from scipy.optimize import brentq
from yade import O, Vector3, utils

import ancf

from .measure import Row, rms, withoutCollider
from .references import reference

# ---- parameters, SI units ------------------------------------------------------------------------
LENGTH, SPAN = 10.0, 8.0  # of the cable, between its ends [m]
STIFFNESS = dict(stiff=2e7, soft=4e5)  # EA [N]
BENDING, RHO_A, GRAVITY = 20.0, 1.2, 9.81  # EI [N m2], [kg/m], [m/s2]
DIAMETER = 0.01
WAY, FREQUENCY = (0.4, 0.3, 0.4), 0.4  # its start goes WAY (cos wt - 1) [m], [Hz]
TIMES = tuple(np.arange(0.5, 5.01, 0.5))  # at which places are compared [s]
PLACES = tuple(k / 8 for k in range(1, 8))  # along the cable
REST = 1e-9  # tolerance of relax()

ELEMENTS, FEW = (8, 16, 24, 32, 48, 64), (16, 32)
STEPS, FEW_STEPS = (2e-2, 1e-2, 5e-3, 2.5e-3, 1.25e-3), (1e-2,)  # of implicit steps [s]
PEER_ELEMENTS = (8, 16, 24, 32, 48)
LEAPFROG, PART = (8, 16, 32), 0.9  # elements, part of the critical step
REFERENCE, CHECK = (96, 2e-4), (64, 2.5e-4)  # elements, step
PEER = ", CableDyn"  # its limit is its own
PEER_REFERENCE, PEER_CHECK = (96, 2.5e-4), (64, 5e-4)
LEAST, REPEATS = 0.3, 3  # runs that take less [s] are made so many times


def arc(n):
    """n + 1 points of a circular arc between the ends, LENGTH long."""
    half = brentq(lambda u: math.sin(u) / u - SPAN / LENGTH, 1e-3, math.pi - 1e-3)
    radius, at = LENGTH / (2 * half), np.linspace(-half, half, n + 1)
    return np.stack(
        [SPAN / 2 + radius * np.sin(at), 0 * at, radius * (math.cos(half) - np.cos(at))], 1
    )


def build(ea, n, integrator, step):
    """The cable at rest and its engines; step: an implicit one [s], or part of the critical one."""
    O.reset()
    area = math.pi * DIAMETER**2 / 4
    O.materials.append(
        ancf.HollarsMat(label="cable", young=ea / area, density=RHO_A / area, poisson=0.3)
    )
    cable = ancf.Cable(
        arc(n),
        elements=1,
        diameter=DIAMETER,
        material="cable",
        bending=BENDING,
        contactPoints=0,
        curvature="exact",
        axialRule="reduced",
    )
    grip = utils.sphere((0, 0, 0), DIAMETER, fixed=True, material="cable")
    grip.bounded = False
    body, guide = O.bodies.append(grip), ancf.GuideEngine()
    cable.follow(0, body)
    cable.fix(-1)
    engines = ancf.engines(cable, gravity=(0, 0, -GRAVITY), integrator=integrator)
    O.engines = withoutCollider(engines[:-1] + [guide] + engines[-1:])
    cable.engine.length = [LENGTH / n] * n  # the curve through the points of the arc is longer
    cable.relax(REST)
    way = Vector3(*WAY)
    turn, size = 2 * math.pi * FREQUENCY, way.norm()
    guide.add(body, direction=way / size, motion=lambda t: size * (math.cos(turn * t) - 1))
    longest = step if integrator == "implicit" else step * cable.criticalTimeStep()
    O.dt = TIMES[0] / math.ceil(TIMES[0] / longest * (1 - 1e-9))
    return cable


def run(*scene):
    """CPU time of the motion [s] and the places (times, places, 3) [m] that it leads to."""
    cable, cpu, found = build(*scene), 0.0, []
    for until in TIMES:
        begin = time.process_time()
        O.run(round((until - O.time) / O.dt), True)
        cpu += time.process_time() - begin
        found.append([cable.point(s) for s in PLACES])
    return cpu, np.array(found, float)


def timed(*scene):
    """As run(), with the median CPU time of a few runs if they are short."""
    times = []
    while not times or (times[0] < LEAST and len(times) < REPEATS):
        cpu, found = run(*scene)
        times.append(cpu)
    return sorted(times)[len(times) // 2], found


def makeReferences():
    """{name: (value, how far a coarser one is from it, how it was made)}."""
    answer = {}
    for name, ea in STIFFNESS.items():
        found = [run(ea, n, "implicit", step)[1] for n, step in (REFERENCE, CHECK)]
        answer[f"moved end {name}"] = found[0], rms(*found), said(REFERENCE, CHECK)
    return answer


def said(fine, coarse):
    """How a reference was made."""
    return "{} elements, implicit, {:g} s; check: {} elements, {:g} s".format(*fine, *coarse)


class Moved:
    """Error: places at all times, RMS [m], against the limit of the same program."""

    def __init__(self, name, ea):
        self.name, self.ea = name, ea

    def rows(self, quick):
        for n in FEW if quick else ELEMENTS:
            for step in FEW_STEPS if quick else STEPS:
                yield self.row("ANCF implicit", n, "implicit", step)
        for n in () if quick else LEAPFROG:
            yield self.row("ANCF consistent", n, "leapfrog", PART)

    def row(self, method, n, integrator, step):
        cpu, found = timed(self.ea, n, integrator, step)
        return Row(method, n, "consistent", integrator, O.dt, cpu, self.off(found))

    def off(self, found, program=""):
        return rms(found, reference(f"{self.name}{program}"))


def forPeers(name, elements=PEER_ELEMENTS, steps=STEPS):
    """A case for peers."""
    return dict(
        ea=CASES[name].ea,
        ei=BENDING,
        rhoA=RHO_A,
        diameter=DIAMETER,
        gravity=GRAVITY,
        length=LENGTH,
        span=SPAN,
        way=WAY,
        frequency=FREQUENCY,
        times=TIMES,
        places=PLACES,
        elements=elements,
        steps=steps,
    )


def peerError(name, found):
    """Error of CableDyn, from its places [m]."""
    return CASES[name].off(found, PEER)


def makePeerReferences(run):
    """As makeReferences(), of CableDyn; run: what gives its runs of a case."""
    answer = {}
    for name in CASES:
        found = []
        for n, step in (PEER_REFERENCE, PEER_CHECK):
            ((*_, places),) = run(forPeers(name, [n], [step]))
            found.append(np.array(places))
        answer[f"{name}{PEER}"] = found[0], rms(*found), said(PEER_REFERENCE, PEER_CHECK)
    return answer


CASES = {f"moved end {name}": Moved(f"moved end {name}", ea) for name, ea in STIFFNESS.items()}
