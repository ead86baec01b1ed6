"""Nets: a folded one opens, a flat one meets a ball."""

import math
from dataclasses import replace

import ball_capture as given
import chains
import numpy as np
from yade import O, Vector3, utils, wrapper

import ancf

from .measure import Row, rms, timed
from .references import reference

# ---- parameters, SI units; the rest is ball_capture's ----------------------------------------------
OPENING = (
    0.1  # time that the folded net has to open [s]; later, waves that cables reflect are chaotic
)
FOLD = 0.65  # of the opening net: size as part of the flat one
SPEED, MEETING = 1.5, 0.08  # of the flat net [m/s], time of its run [s]
GAP = 0.02  # between net and ball at the start [m]
ASIDE = (0.013, 0.007)  # of the ball's centre from the net's axis [m]
CHAIN = dict(young=given.YOUNG, radius=0.5e-3, density=given.ASSUMED["density"])
SOFT = 0.7  # of the critical step of chains, with the contact's stiffness
LOOKS = 100  # at the energy in a run
DAMPINGS = (0.02, 0.05, 0.1)  # of MuJoCo's edges [N s/m]

ELEMENTS, CONSISTENT = (1, 2, 3), (1, 2)
PARTS = (0.8, 0.4, 0.2)  # of the critical step
LINKS, FEW_LINKS = (1, 2, 4), (2, 4)  # of chains, an edge
CHAINS = dict(grid="YADE grid chain", spheres="YADE sphere chain", wire="YADE wire chain")
REFERENCE_ELEMENTS, CHECK_ELEMENTS = 3, 2  # consistent, at REFERENCE_PART of the critical step
REFERENCE_PART = 0.7


def net(n, mass, fold=None, model="ancf", touches=True):
    """The net in z = 0, its bullets going down; n elements or springs an edge."""
    parts = dict(midPoints=n - 1) if model == "springs" else dict(elements=n, mass=mass)
    made = ancf.Net.square(
        given.MESHES,
        given.MESH_LENGTH,
        diameter=given.ASSUMED["diameter"],
        material="cable",
        contactPoints=given.CONTACT_POINTS if touches else 0,
        damping=given.ASSUMED["damping"],
        normal=(0, 0, -1),
        fold=fold,
        model=model,
        **parts,
    )
    angle = math.radians(given.BULLET_ANGLE) if fold else 0.0
    made.addBullets(given.BULLET_MASS, given.ASSUMED["bulletRadius"], SPEED, angle)
    return made


def materials():
    O.reset()
    O.materials.append(given.material("cable", given.YOUNG, given.POISSON, CHAIN["density"]))
    a = given.ASSUMED
    O.materials.append(given.material("ball", a["ballYoung"], a["ballPoisson"], 2700))


def ball(material):
    center = Vector3(*ASIDE, -GAP - given.BALL_RADIUS)
    return O.bodies.append(utils.sphere(center, given.BALL_RADIUS, material=material, fixed=True))


# ---- ours ----------------------------------------------------------------------------------------


def opening(n, mass, part, model="ancf"):
    materials()
    made = net(n, mass, FOLD, model, touches=False)
    O.engines = ancf.engines(made)
    O.dt = part * made.criticalTimeStep()
    return made


def meeting(n, mass, part, model="ancf"):
    materials()
    ball("ball")
    made = net(n, mass, model=model)
    made.setVelocity(lambda p: Vector3(0, 0, -SPEED))
    O.engines = ancf.engines(made, contact=dict(friction="none"))
    O.dt = part * made.criticalTimeStep()
    return made


def pushed(made):
    """Impulse of the ball on our net so far [N s]."""
    whole = made.mass + 4 * given.BULLET_MASS
    return whole * SPEED + made.engine.momentum()[0][2]


def energyOff(n, mass, part, model):
    """How far the sum of all energies is from that of the start at the most, as part of it."""
    meeting(n, mass, part, model)
    O.trackEnergy = True
    O.step()
    start, worst = O.energy.total(), 0.0
    while O.time < MEETING:
        for _ in range(math.ceil(MEETING / O.dt / LOOKS)):
            O.step()
        worst = max(worst, abs(O.energy.total() / start - 1))
    O.trackEnergy = False
    return worst


def makeReferences():
    """{name: (value, how far a coarser one is from it, how it was made)}."""
    opened, met = [], []
    for n in (REFERENCE_ELEMENTS, CHECK_ELEMENTS):
        found = []
        timed(lambda: found.append(opening(n, "consistent", REFERENCE_PART)), OPENING)
        opened.append(found[0].knots)
        found = []
        timed(lambda: found.append(meeting(n, "consistent", REFERENCE_PART)), MEETING)
        met.append(pushed(found[0]))
    how = (
        f"{REFERENCE_ELEMENTS} elements an edge, consistent mass, {REFERENCE_PART} of the critical step; "
        f"check: {CHECK_ELEMENTS} elements"
    )
    return {
        "net opens": (opened[0], rms(*opened), how),
        "net on ball": (met[0], abs(met[1] / met[0] - 1), how),
    }


# ---- YADE's own ----------------------------------------------------------------------------------


def links(parts, fold):
    """Points of our net at the start (its knots come first) and pairs of them, `parts` links an edge;
    the corners.
    """
    materials()
    made = net(1, "lumped", fold, touches=False)
    knots = np.array(made.knots)
    points, pairs = list(knots), []
    for edge in made.edges:
        curve = edge.curve(parts)
        first, last = (int(np.argmin(np.linalg.norm(knots - p, axis=1))) for p in curve[[0, -1]])
        inner = range(len(points), len(points) + parts - 1)
        points += list(curve[1:-1])
        row = [first, *inner, last]
        pairs += list(zip(row, row[1:]))
    flat = np.abs(knots[:, :2])
    return points, pairs, [int(k) for k in np.flatnonzero((flat > 0.99 * flat.max()).all(axis=1))]


def chainNet(kind, parts, fold):
    points, pairs, corners = links(parts, fold)
    made = chains.BuiltIn(kind, CHAIN, points, pairs, gravity=(0, 0, 0))
    angle = math.radians(given.BULLET_ANGLE) if fold else 0.0
    for k in corners:
        state = O.bodies[made.ids[k]].state
        state.mass += given.BULLET_MASS
        out = Vector3(state.pos[0], state.pos[1], 0).normalized()
        state.vel = SPEED * (math.sin(angle) * out - math.cos(angle) * Vector3.UnitZ)
    return made


def openingChain(kind, parts):
    return chainNet(kind, parts, FOLD)


def meetingChain(kind, parts):
    made = chainNet(kind, parts, None)
    made.setVelocity(lambda p: Vector3(0, 0, -SPEED))
    if "outside" not in [m.label for m in O.materials]:
        values = dict(young=CHAIN["young"], poisson=0.3, density=1, frictionAngle=0.0)
        O.materials.append(wrapper.FrictMat(label="outside", **values))
    for m in O.materials:
        m.frictionAngle = 0.0
    ball("outside")
    if kind == "grid":
        O.engines[1].lawDispatcher.functors += [wrapper.Law2_ScGeom_FrictPhys_CundallStrack()]
    bounds = [wrapper.Bo1_Sphere_Aabb(), wrapper.Bo1_GridConnection_Aabb()]
    collider = wrapper.InsertionSortCollider(
        bounds, verletDist=0.25 * made.length, avoidSelfInteractionMask=2
    )
    O.engines = [O.engines[0], collider, *O.engines[1:]]
    radius = O.bodies[made.ids[0]].shape.radius
    both = (CHAIN["young"] * radius, CHAIN["young"] * given.BALL_RADIUS)
    O.dt = SOFT * made.critical(2 * both[0] * both[1] / sum(both))
    return made


def chainMomentum(made):
    return sum(O.bodies[i].state.mass * O.bodies[i].state.vel[2] for i in made.ids)


# ---- the sweeps ----------------------------------------------------------------------------------


class Opening:
    """Error: RMS of the knots at the end [m]."""

    def rows(self, quick):
        yield from _ours(self, quick, ("springs",))
        for kind in CHAINS:
            for parts in FEW_LINKS if quick else LINKS:
                made = []
                cpu = timed(lambda: made.append(openingChain(kind, parts)), OPENING)
                off = self.off(made[-1].nodes[: len(reference("net opens"))])
                yield Row(CHAINS[kind], parts, "lumped", "leapfrog", O.dt, cpu, off)

    @staticmethod
    def off(knots):
        return rms(knots, reference("net opens"))

    def row(self, method, n, mass, part, model="ancf"):
        made = []
        cpu = timed(lambda: made.append(opening(n, mass, part, model)), OPENING)
        return Row(method, n, mass, "leapfrog", O.dt, cpu, self.off(made[-1].knots))


class Meeting:
    """Error: impulse on the ball, relative. Second: energy."""

    def rows(self, quick):
        yield from _ours(self, quick, ("springs",))
        for kind in CHAINS:
            for parts in FEW_LINKS[:1] if quick else LINKS:
                made, before = [], []

                def build():
                    made.append(meetingChain(kind, parts))
                    before.append(chainMomentum(made[-1]))

                cpu = timed(build, MEETING)
                impulse = chainMomentum(made[-1]) - before[-1]
                yield Row(CHAINS[kind], parts, "lumped", "leapfrog", O.dt, cpu, self.off(impulse))

    @staticmethod
    def off(impulse):
        return abs(impulse / float(reference("net on ball")) - 1)

    def row(self, method, n, mass, part, model="ancf"):
        made = []
        cpu = timed(lambda: made.append(meeting(n, mass, part, model)), MEETING)
        found = Row(method, n, mass, "leapfrog", O.dt, cpu, self.off(pushed(made[-1])))
        return replace(found, second=energyOff(n, mass, part, model))


def _ours(case, quick, others):
    parts = PARTS[:1] if quick else PARTS
    for n in ELEMENTS[:2] if quick else ELEMENTS:
        for part in parts:
            yield case.row("ANCF lumped", n, "lumped", part)
    if quick:
        return
    for n in CONSISTENT:
        for part in PARTS[:2] if n == 1 else PARTS[:1]:
            yield case.row("ANCF consistent", n, "consistent", part)
    for n in LINKS[1:]:
        yield case.row("springs", n, "lumped", PARTS[0], "springs")


def peerError(name, impulse):
    """Error of another program, from the impulse on the ball [N s]."""
    return CASES[name].off(impulse)


def forPeers(name):
    """The flat net for peers: points, pairs, bullets, ball, and so on."""
    answer = {}
    for parts in LINKS:
        points, pairs, corners = links(parts, None)
        answer[parts] = dict(
            points=np.asarray(points).tolist(),
            pairs=[[int(a), int(b)] for a, b in pairs],
            corners=corners,
        )
    ea, _, rhoA = chains.section(CHAIN)
    return dict(
        nets=answer,
        ea=ea,
        rhoA=rhoA,
        edge=given.MESH_LENGTH,
        bullet=given.BULLET_MASS,
        radius=CHAIN["radius"],
        ballRadius=given.BALL_RADIUS,
        ball=[*ASIDE, -GAP - given.BALL_RADIUS],
        speed=SPEED,
        duration=MEETING,
        dampings=DAMPINGS,
    )


CASES = {"net opens": Opening(), "net on ball": Meeting()}
