"""A belt drive that starts up and is then loaded: the one of Exudyn's example beltDriveReevingSystem."""

import math
import time

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq
from yade import O

import ancf
from ancf import pulleys

from .measure import FIRST, Row

# ---- parameters, SI units ------------------------------------------------------------------------
RADIUS, DISTANCE = (
    0.1,
    0.1 * math.pi,
)  # of the belt's centreline on both sheaves, of their axles [m]
EA, RHO_A, PRETENSION, MU = 8e3, 0.8288, 400.0, 0.5  # [N], [kg/m], [N], -
INERTIA, VISCOUS, GRAVITY = 0.25, 2.0, 9.81  # of a sheave [kg m2], of the driven [N m s], [m/s2]
SPEED, SPEEDING = 12.0, (0.05, 0.6)  # of the driver [rad/s], from when to when it gets there [s]
TORQUE, LOADING = 25.0, (1.0, 1.5)  # of the load [N m], from when to when it grows [s]
END, STEADY = 2.45, 2.0  # of the run, from when on results are averaged [s]

DIAMETER = 2e-3  # of our belt, that only contact knows
POINTS = 1  # joints of its segments inside an element
STIFFNESS, DASHPOT, TRANSITION = 4e5, 20.0, 2e-3  # of a contact [N/m], [N s/m]; v_t0 [m/s]
DAMPING = 5e-6  # Kelvin-Voigt time of the belt [s]
PART = 0.8  # of the critical step
EVERY = 0.01  # looks at the scene [s]
ELEMENTS, FEW = (36, 48, 60, 120), (36,)
PEER_ELEMENTS, PEER_STEPS = (120,), (1e-4,)  # of 60 it finds no equilibrium


# ---- theory --------------------------------------------------------------------------------------


def green(tension):
    """Stretch at a tension, Green strain."""
    return brentq(lambda x: EA * (x * x - 1) / 2 * x - tension, 0.5, 2.0)


def engineering(tension):
    """The same of engineering strain, counted from the stretch at the pretension."""
    return 1 + (tension - PRETENSION) / EA


def creep(stretch, natural, pull, radius):
    """Tensions of the tight and the slack span [N] and the speed of the driven sheave in that of the
    driver, of a belt of a natural length that pulls with `pull` [N]: each sheave has an arc of rest
    behind the entry and one of slip before the exit, where T less its centrifugal part grows as
    exp(mu phi); what runs through in a unit of time is the same everywhere.
    """
    hoop = RHO_A * (SPEED * RADIUS) ** 2

    def excess(slack):
        tight = slack + pull
        angle = math.log((tight - hoop) / (slack - hoop)) / MU
        slips, _ = quad(lambda a: 1 / stretch(hoop + (slack - hoop) * math.exp(MU * a)), 0, angle)
        rests = DISTANCE + radius * (math.pi - angle)
        return (1 / stretch(tight) + 1 / stretch(slack)) * rests + 2 * radius * slips - natural

    least = hoop + pull / (math.exp(MU * math.pi) - 1)
    slack = brentq(excess, least * 1.0001, 10 * PRETENSION)
    return slack + pull, slack, stretch(slack) / stretch(slack + pull)


def off(speeds, spans, stretch, pretension, radius=RADIUS):
    """How far the ratio of speeds, and the tension that is off most, are from the theory, relative; at
    the pull that the spans have. stretch, pretension [N]: of the belt as it is laid, on a radius.
    """
    length = 2 * (DISTANCE + math.pi * radius)
    tight, slack, ratio = creep(
        stretch, length / stretch(pretension), abs(spans[0] - spans[1]), radius
    )
    tensions = max(abs(max(spans) / tight - 1), abs(min(spans) / slack - 1))
    return abs(speeds[1] / speeds[0] / ratio - 1), tensions


# ---- ours ----------------------------------------------------------------------------------------


def rise(t, start, end):
    """From 0 to 1, half a cosine."""
    return 0.5 - 0.5 * math.cos(math.pi * min(1.0, max(0.0, (t - start) / (end - start))))


def sunk(n):
    """How deep contacts carry the pretension [m]."""
    return PRETENSION / RADIUS * (DISTANCE + math.pi * RADIUS) * 2 / n / (POINTS + 1) / STIFFNESS


def build(n):
    """The belt of n elements at rest under its pretension, as deep in its sheaves as they carry it."""
    O.reset()
    area = math.pi * DIAMETER**2 / 4
    O.materials.append(
        ancf.HollarsMat(
            label="belt",
            young=EA / area,
            density=RHO_A / area,
            poisson=0.3,
            staticFriction=MU,
            kineticFriction=MU,
            transitionVelocity=TRANSITION,
            normalStiffness=STIFFNESS,
            normalExponent=1.0,
            dashpot=DASHPOT,
        )
    )
    ids = [
        pulleys.sheave(
            (x, 0, 0), RADIUS - DIAMETER / 2, width=0.012, material="belt", inertia=INERTIA
        )
        for x in (0, DISTANCE)
    ]
    path = pulleys.Path([(i, 1) for i in ids], diameter=DIAMETER, gap=-sunk(n))
    cable = pulleys.lay(
        path,
        n,
        diameter=DIAMETER,
        material="belt",
        bending=0.0,
        contactPoints=POINTS,
        damping=DAMPING,
        mass="lumped",
        tension=PRETENSION,
    )
    engine = ancf.SheaveEngine()
    start, end = SPEEDING
    engine.add(ids[0], speed=lambda t: SPEED * min(1.0, max(0.0, (t - start) / (end - start))))
    engine.add(ids[1], torque=lambda t: -TORQUE * rise(t, *LOADING), viscous=VISCOUS)
    O.engines = pulleys.engines(
        cable, engine, gravity=(0, 0, -GRAVITY), contact=dict(normal="linear"), substeps=1
    )
    O.dt = PART * cable.criticalTimeStep()
    return cable, engine


def spans(cable):
    """Mean tensions of the free spans above and below [N]."""
    points, tensions = cable.curve(2), cable.tensions(2)
    free = (points[:, 0] > 0.25 * DISTANCE) & (points[:, 0] < 0.75 * DISTANCE)
    return [tensions[free & (side * points[:, 2] > 0.6 * RADIUS)].mean() for side in (1, -1)]


def run(n, end=END):
    """CPU time [s], speeds of the sheaves [rad/s] and tensions of the spans [N]."""
    cable, engine = build(n)
    O.run(FIRST, True)
    cpu, rows, steps = 0.0, [], max(1, round(EVERY / O.dt))
    while O.time < end:
        begin = time.process_time()
        O.run(steps, True)
        cpu += time.process_time() - begin
        if O.time > STEADY * end / END:
            rows.append((O.time, *engine.angle, *spans(cable)))
    t, *turned, above, below = np.array(rows).T
    return cpu, [np.polyfit(t, angle, 1)[0] for angle in turned], (above.mean(), below.mean())


class Starting:
    """Error: ratio of the sheaves' speeds, relative. Second: tension of the spans, relative."""

    def rows(self, quick):
        for n in FEW if quick else ELEMENTS:
            cpu, *found = run(n)
            error, tension = off(*found, green, PRETENSION, RADIUS - sunk(n))
            yield Row("ANCF lumped", n, "lumped", "leapfrog", O.dt, cpu, error, tension)


def forPeers(name):
    """The belt for peers."""
    return dict(
        radius=RADIUS,
        distance=DISTANCE,
        ea=EA,
        rhoA=RHO_A,
        strain=PRETENSION / EA,
        friction=MU,
        inertia=INERTIA,
        viscous=VISCOUS,
        gravity=GRAVITY,
        speed=SPEED,
        speeding=SPEEDING,
        torque=TORQUE,
        loading=LOADING,
        duration=END,
        steady=STEADY,
        elements=PEER_ELEMENTS,
        steps=PEER_STEPS,
    )


def peerError(name, found):
    """Errors of another program, from its speeds [rad/s] and tensions [N]."""
    return off(*found, engineering, PRETENSION)


CASES = {"belt starts": Starting()}
