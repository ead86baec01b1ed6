"""A cable that hangs from one end and lies partly on a smooth floor."""

import math
import time

import chains
import numpy as np
from scipy.optimize import brentq
from yade import O, Vector3, utils, wrapper

import ancf

from .measure import Row

# ---- parameters, SI units ------------------------------------------------------------------------
CABLE = dict(young=3e7, radius=1e-3, density=4000)
LENGTH, ACROSS, HEIGHT = 2.0, 1.6, 0.8  # of the cable, between its ends [m]
GRAVITY = 9.81
FLOOR_YOUNG = 1e7  # [Pa]
TOLERANCE = 1e-6  # of relax()
ELEMENTS, FEW = (8, 16, 32, 64), (8, 16)
LINKS, FEW_LINKS = (16, 32, 64), (16,)  # of chains
SETTLE, SETTLING, PIECE = 0.4, 4.0, 0.1  # NewtonIntegrator.damping of chains, time, its pieces [s]


def exact():
    """Horizontal tension [N] and suspended length [m]: an elastic catenary that starts level where it
    leaves the floor, and a straight part of the same tension, held at its end.
    """
    ea, _, rhoA = chains.section(CABLE)
    w = rhoA * GRAVITY

    def suspended(h):
        """Length whose end is at HEIGHT: w s^2/(2 EA) + (hypot(H, w s) - H)/w."""
        return brentq(
            lambda s: w * s * s / (2 * ea) + (math.hypot(h, w * s) - h) / w - HEIGHT, 1e-6, 1e3
        )

    def across(h):
        s = suspended(h)
        return (LENGTH - s) * (1 + h / ea) + h * s / ea + h / w * math.asinh(w * s / h) - ACROSS

    h = brentq(across, 1e-3 * w, 2 * w)
    return h, suspended(h)


def shape(s):
    """Points of the exact curve at unstressed arc lengths s from the held end on the floor (n, 2)."""
    ea, _, rhoA = chains.section(CABLE)
    w = rhoA * GRAVITY
    h, hanging = exact()
    up = np.maximum(0, s - (LENGTH - hanging))
    x = (
        np.minimum(s, LENGTH - hanging) * (1 + h / ea)
        + h * up / ea
        + h / w * np.arcsinh(w * up / h)
    )
    return np.stack([x, w * up**2 / (2 * ea) + (np.hypot(h, w * up) - h) / w], 1)


def start(n):
    """n + 1 points of the cable at its start: level, then straight up to its end, LENGTH long."""
    rise = brentq(lambda a: a + math.hypot(ACROSS - a, HEIGHT) - LENGTH, 0, ACROSS)
    s = np.linspace(0, LENGTH, n + 1)
    way = np.array([ACROSS - rise, HEIGHT]) / math.hypot(ACROSS - rise, HEIGHT)
    flat = np.stack([np.minimum(s, rise), 0 * s], 1) + np.maximum(0, s - rise)[:, None] * way
    return np.stack([flat[:, 0], 0 * s, flat[:, 1]], 1)


def off(points):
    """RMS distance of nodes, evenly along the cable, from the exact curve [m]."""
    points = np.asarray(points)
    exactly = shape(np.linspace(0, LENGTH, len(points)))
    return float(np.sqrt(((points[:, [0, 2]] - exactly) ** 2).sum(axis=1).mean()))


def ours(n):
    """CPU time of relax() [s], errors of places [m] and of the pull at the floor's end."""
    O.reset()
    for label, young in (("cable", CABLE["young"]), ("floor", FLOOR_YOUNG)):
        values = dict(young=young, poisson=0.3, density=CABLE["density"])
        O.materials.append(
            ancf.HollarsMat(label=label, staticFriction=0, kineticFriction=0, **values)
        )
    floor = utils.box((1, 0, -0.1 - CABLE["radius"]), (3, 1, 0.1), material="floor", fixed=True)
    O.bodies.append(floor)
    made = ancf.Cable(
        start(n),
        diameter=2 * CABLE["radius"],
        material="cable",
        bending=0.0,
        mass="lumped",
    )
    made.fix(0)
    made.fix(-1)
    O.engines = ancf.engines(made, gravity=(0, 0, -GRAVITY))
    made.engine.length = [LENGTH / n] * n  # the curve through the kink of the start is longer
    begin = time.process_time()
    made.relax(TOLERANCE)
    cpu = time.process_time() - begin
    pull = exact()[0]
    return cpu, off(made.knots), abs(made.tension(0.1) / pull - 1)


def chain(n):
    """CPU time until a chain of spheres lies as it will at the end [s], and its errors."""
    made = chains.BuiltIn(
        "spheres", CABLE, start(n), chains.chainPairs(n), hinged=(0, n), damping=SETTLE
    )
    O.materials.append(
        wrapper.FrictMat(label="floor", young=FLOOR_YOUNG, poisson=0.3, density=1, frictionAngle=0)
    )
    radius = O.bodies[made.ids[0]].shape.radius
    floor = O.bodies.append(utils.wall(Vector3(0, 0, -radius), 2, sense=1, material="floor"))
    loop = O.engines[1]
    loop.geomDispatcher.functors += [wrapper.Ig2_Wall_Sphere_ScGeom()]
    bounds = [wrapper.Bo1_Sphere_Aabb(), wrapper.Bo1_Wall_Aabb()]
    collider = wrapper.InsertionSortCollider(bounds, verletDist=0.25 * made.length)
    for i in made.ids:  # the wall alone
        O.bodies[i].groupMask = 2
    O.bodies[floor].groupMask = 3
    collider.avoidSelfInteractionMask = 2
    O.engines = [O.engines[0], collider, *O.engines[1:]]
    stiffness = 2 * FLOOR_YOUNG * radius
    O.dt = 0.7 * made.critical(stiffness)

    def measure():
        return np.array([off(made.nodes), made.tension(n // 10) / exact()[0] - 1])

    def step():
        O.step()

    return chains.settle(step, measure, SETTLING, PIECE)


class Lying:
    """Error: RMS of nodes [m]. Second: tension on the floor, relative."""

    def rows(self, quick):
        for n in FEW if quick else ELEMENTS:
            cpu, place, pull = ours(n)
            yield Row("ANCF, relax", n, "lumped", "relax", 0.0, cpu, place, pull)
        for n in FEW_LINKS if quick else LINKS:
            cpu, (place, pull) = chain(n)
            yield Row("YADE sphere chain", n, "lumped", "leapfrog", O.dt, cpu, place, pull)


def forPeers(name):
    """The case for peers."""
    ea, _, rhoA = chains.section(CABLE)
    return dict(
        ea=ea,
        ei=0.0,
        rhoA=rhoA,
        diameter=2 * CABLE["radius"],
        gravity=GRAVITY,
        length=LENGTH,
        ends=[(0, 0, 0), (ACROSS, 0, HEIGHT)],
        floor=FLOOR_YOUNG,
        elements=ELEMENTS,
    )


def peerError(name, points):
    """Error of another program, from its nodes along the cable."""
    return off(points)


CASES = {"catenary on a floor": Lying()}
