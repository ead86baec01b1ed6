"""Cables over sheaves: a capstan, and a belt drive below its slip."""

import builtins
import math

import belt as drive
import chains
import numpy as np
import pulley_study
from yade import O, Vector3, utils, wrapper

from .measure import Row, timed

# ---- parameters, SI units; the rest is that of pulley_study.py and belt.py ---------------------------
CAPSTAN = pulley_study.BASE
RADIUS, DIAMETER = pulley_study.RADIUS, pulley_study.DIAMETER
MU, WRAP = CAPSTAN["muStatic"], math.radians(CAPSTAN["theta"])
SPAN = 0.04  # of chains on either side [m]
LOAD = 1.0  # on the loose end [N]
PULL, MEAN = 0.04, 0.5  # time of a run [s], part of it at whose end the tension is averaged
SAMPLES = 200

BELT = dict(distance=0.16, transition=1e-5, torque=-0.3)  # [m], [m/s], [N m]
RUN = 0.16  # [s]; creep is that of its second half

ANGLES = (30.0, 20.0, 15.0, 10.0)  # of wrap that an element takes [deg]
BELT_ANGLES, FEW_BELT_ANGLES = (20.0, 15.0, 12.0), (30.0,)
PARTS = (0.8, 0.4)  # of the critical step
LINKS, FEW_LINKS = (10.0, 5.0, 2.5), (10.0, 5.0)  # of wrap that a link of a chain takes [deg]
SETTLE = 0.3  # NewtonIntegrator.damping of chains, that rest but for their ringing
SOFT = 0.5  # of the critical step of chains, with the stiffness of a contact
DRUM_YOUNG = 1e8  # of the ball that they run over [Pa]
CHAINS = dict(grid="YADE grid chain", spheres="YADE sphere chain")


def recorded(duration, read):
    """Lets read() be called SAMPLES times in a run of a duration [s]; the rows it will leave."""
    rows = builtins._precisionRows = []
    builtins._precisionRead = read
    command = "import builtins; builtins._precisionRows.append(builtins._precisionRead())"
    every = max(1, int(duration / O.dt / SAMPLES))
    O.engines = O.engines + [wrapper.PyRunner(command=command, iterPeriod=every, initRun=False)]
    return rows


# ---- capstan -------------------------------------------------------------------------------------


def exact():
    """T2/T1 by Eytelwein's equation."""
    return math.exp(MU * WRAP)


def capstan(angle, part):
    """The held cable over a drum that turns under it; rows of its pull, number of elements."""
    pulls = {**CAPSTAN, "elementAngle": angle}
    cable, drum, _ = pulley_study.scene(LOAD, lambda phi: math.exp(0.8 * MU * phi), **pulls)
    cable.fix(-1)
    pulley_study.turn(cable, drum, -CAPSTAN["slip"] / RADIUS)
    O.dt = part * cable.criticalTimeStep()
    return recorded(PULL, lambda: cable.reaction(-1).norm()), len(cable.engine.length)


def capstanChain(kind, angle):
    """A chain over the equator of a ball that turns: YADE has no sheave. Rows of its pull."""
    step = math.radians(angle)
    n, straight = round(WRAP / step), max(1, round(SPAN / (RADIUS * step)))
    # Spheres as thick as links are long lie outside by half their thickness.
    chord = 2 * RADIUS * math.sin(step / 2)
    a = np.linspace(math.pi, 0, n + 1)
    arc = np.stack([RADIUS * np.cos(a), 0 * a, RADIUS * np.sin(a)], 1)
    down = chord * np.arange(straight, 0, -1)[:, None]
    points = np.concatenate(
        [arc[0] - down * [0, 0, 1], arc, arc[-1] - down[::-1] * [0, 0, 1]],
    )
    area = math.pi * DIAMETER**2 / 4
    cable = dict(young=CAPSTAN["ea"] / area, radius=DIAMETER / 2, density=CAPSTAN["rhoA"] / area)
    made = chains.BuiltIn(
        kind,
        cable,
        points,
        chains.chainPairs(len(points) - 1),
        hinged=(len(points) - 1,),
        damping=SETTLE,
        gravity=(0, 0, 0),
    )
    own = O.bodies[made.ids[0]].shape.radius
    if "outside" not in [m.label for m in O.materials]:
        O.materials.append(wrapper.FrictMat(label="outside", poisson=0.3, density=1))
    O.materials["outside"].young = DRUM_YOUNG
    for m in O.materials:
        m.frictionAngle = math.atan(MU)
    ball = utils.sphere((0, 0, 0), RADIUS - own, material="outside", fixed=True)
    ball.state.angVel = Vector3(0, -CAPSTAN["slip"] / RADIUS, 0)
    O.bodies.append(ball)
    made.load(0, (0, 0, -LOAD))
    if kind == "grid":
        O.engines[1].lawDispatcher.functors += [wrapper.Law2_ScGeom_FrictPhys_CundallStrack()]
    bounds = [wrapper.Bo1_Sphere_Aabb(), wrapper.Bo1_GridConnection_Aabb()]
    collider = wrapper.InsertionSortCollider(
        bounds, verletDist=0.25 * made.length, avoidSelfInteractionMask=2
    )
    for i in made.ids[:-1]:  # it would slide off the equator
        O.bodies[i].state.blockedDOFs = "y"
    O.engines = [O.engines[0], collider, *O.engines[1:]]
    both = DRUM_YOUNG * (RADIUS - own), cable["young"] * own
    O.dt = SOFT * made.critical(2 * both[0] * both[1] / sum(both))
    last = len(made.links) - 1
    return recorded(PULL, lambda: made.tension(last))


# ---- belt ----------------------------------------------------------------------------------------


def belt(angle, part):
    """A belt on two sheaves, one led at a speed, one braked; rows of tensions and angles, number of
    elements.
    """
    cable, _, engine = drive.build(elementAngle=angle, **BELT)
    O.dt = part * cable.criticalTimeStep()
    rows = recorded(RUN, lambda: (O.time, *engine.angle, *spanTensions(cable, **BELT)))
    return rows, len(cable.engine.length)


def spanTensions(cable, distance, **rest):
    """Mean tensions of the free spans above and below [N]."""
    points, tensions = cable.curve(2), cable.tensions(2)
    free = (points[:, 0] > 0.25 * distance) & (points[:, 0] < 0.75 * distance)
    return [tensions[free & (side * points[:, 2] > 0.6 * drive.RADIUS)].mean() for side in (1, -1)]


def creepOff(rows):
    """Speed lost between the sheaves against v (T1 - T2)/EA, relative."""
    t, driver, driven, above, below = np.array(rows[len(rows) // 2 :]).T
    lost = (np.polyfit(t, driver, 1)[0] - np.polyfit(t, driven, 1)[0]) * drive.RADIUS
    return abs(lost / (drive.SPEED * abs(above.mean() - below.mean()) / drive.EA) - 1)


# ---- the sweeps ----------------------------------------------------------------------------------


class Capstan:
    """Error: T2/T1, relative."""

    def rows(self, quick):
        for angle in (30.0, 15.0) if quick else ANGLES:
            for part in PARTS[:1] if quick or angle < 15 else PARTS:
                made = []
                cpu = timed(lambda: made.append(capstan(angle, part)), PULL)
                rows, n = made[-1]
                yield Row("ANCF lumped", n, "lumped", "leapfrog", O.dt, cpu, self.off(rows))
        for kind in CHAINS:
            for angle in FEW_LINKS[:1] if quick else LINKS:
                made = []
                cpu = timed(lambda: made.append(capstanChain(kind, angle)), PULL)
                n = round((math.pi * RADIUS + 2 * SPAN) / (RADIUS * math.radians(angle)))
                yield Row(CHAINS[kind], n, "lumped", "leapfrog", O.dt, cpu, self.off(made[-1]))

    @staticmethod
    def off(rows):
        return abs(np.mean(rows[int((1 - MEAN) * len(rows)) :]) / LOAD / exact() - 1)


class Belt:
    """Error: creep, relative."""

    def rows(self, quick):
        for angle in FEW_BELT_ANGLES if quick else BELT_ANGLES:
            made = []
            cpu = timed(lambda: made.append(belt(angle, PARTS[0])), RUN)
            rows, n = made[-1]
            yield Row("ANCF lumped", n, "lumped", "leapfrog", O.dt, cpu, creepOff(rows))


CASES = {"capstan": Capstan(), "belt": Belt()}
