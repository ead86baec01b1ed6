"""The same cable and net of YADE's built-in elements and of ours: hanging, swinging, bending, caught.

Grid connections, cohesive sphere chains and wire links, made by YADE's own functions, run the same
tests as ours: error against wall time. Run it by `/usr/bin/python3 chains.py`; results go to out/chains/.
"""

import argparse
import csv
import math
import pathlib
import time

import numpy as np
from scipy.integrate import solve_bvp, solve_ivp
from scipy.optimize import brentq

import ancf
import ball_capture as given
from ancf.plots import plt
from yade import O, Vector3, gridpfacet, utils, wrapper

# ---- parameters, SI units ----------------------------------------------------------------------
GRAVITY = 9.81
SPAN, LENGTH = 1.0, 1.2  # of the hanging cable
HANGING = dict(young=1e8, radius=0.5e-3, density=8000)
PENDULUM = dict(young=1.6e6, radius=math.sqrt(25e-6 / math.pi), density=320)
PENDULUM_GRAVITY = 9.8
# Tip at 1 s: limits of two codes by others, one with Green strain, one with engineering strain.
PENDULUM_GREEN = (0.653008, 0.046209, 0.659919)
PENDULUM_ENGINEERING = (0.652736, 0.046231, 0.659748)
CANTILEVER = dict(young=2.07e11, radius=0.05, density=7850)
CANTILEVER_LENGTH, CANTILEVER_LOAD = 2.0, 3.0  # [m], tip load in E I/L^2
NET = dict(
    young=given.YOUNG,
    radius=given.ASSUMED["diameter"] / 2,
    density=given.ASSUMED["density"],
)
MESHES, MESH = given.MESHES, given.MESH_LENGTH
BALL, DROP, FALL = given.BALL_RADIUS, 0.02, 0.25  # radius, height [m], time simulated [s]
SETTLE = 0.4  # NewtonIntegrator.damping on the way to rest
RELAX = 1e-6  # tolerance of relax()
RESERVE = 0.7  # of the critical step
STRONG = 1e40  # cohesion [Pa]

COLORS = {
    "grid": "#1f6fb2",
    "spheres": "#e08e0b",
    "wire": "#7d5ba6",
    "ours": "#c0392b",
    "ours, springs": "#d98880",
}
NAMES = {
    "grid": "GridNode, GridConnection",
    "spheres": "cohesive spheres (CohFrictMat)",
    "wire": "WireMat links",
    "ours": "ours, ANCF",
    "ours, springs": "ours, springs",
}
BENDS = ("grid", "spheres", "ours")


def section(cable):
    """EA [N], EI [N m2], mass per length [kg/m]."""
    area = math.pi * cable["radius"] ** 2
    inertia = math.pi * cable["radius"] ** 4 / 4
    return cable["young"] * area, cable["young"] * inertia, cable["density"] * area


# ---- YADE's own chains ---------------------------------------------------------------------------


class BuiltIn:
    """Nodes at points and links between pairs of them, of one of YADE's own elements."""

    def __init__(
        self, kind, cable, points, pairs, hinged=(), clamped=(), damping=0.0, gravity=None
    ):
        O.reset()
        self.kind, self.cable = kind, cable
        self.points = np.asarray(points, float)
        self.pairs = list(pairs)
        self.length = np.linalg.norm(self.points[self.pairs[0][0]] - self.points[self.pairs[0][1]])
        gravity = Vector3(*(gravity or (0, 0, -GRAVITY)))
        newton = wrapper.NewtonIntegrator(damping=damping, gravity=gravity)
        self.newton = newton
        O.engines = [wrapper.ForceResetter(), self._loop(), newton]
        self.ids = getattr(self, f"_{kind}")()
        for i in hinged:
            O.bodies[self.ids[i]].state.blockedDOFs = "xyz"
        for i in clamped:
            O.bodies[self.ids[i]].state.blockedDOFs = "xyzXYZ"
        O.dt = RESERVE * self.critical()

    def _loop(self):
        made = {
            "grid": (
                [
                    wrapper.Ig2_GridNode_GridNode_GridNodeGeom6D(),
                    wrapper.Ig2_Sphere_GridConnection_ScGridCoGeom(),
                ],
                [
                    wrapper.Ip2_CohFrictMat_CohFrictMat_CohFrictPhys(
                        setCohesionNow=True, setCohesionOnNewContacts=False
                    ),
                    wrapper.Ip2_FrictMat_FrictMat_FrictPhys(),
                ],
                [
                    wrapper.Law2_ScGeom6D_CohFrictPhys_CohesionMoment(),
                    wrapper.Law2_ScGridCoGeom_FrictPhys_CundallStrack(),
                ],
            ),
            "spheres": (
                [wrapper.Ig2_Sphere_Sphere_ScGeom6D()],
                [
                    wrapper.Ip2_CohFrictMat_CohFrictMat_CohFrictPhys(
                        setCohesionNow=True, setCohesionOnNewContacts=False
                    ),
                    wrapper.Ip2_FrictMat_FrictMat_FrictPhys(),
                ],
                [
                    wrapper.Law2_ScGeom6D_CohFrictPhys_CohesionMoment(),
                    wrapper.Law2_ScGeom_FrictPhys_CundallStrack(),
                ],
            ),
            "wire": (
                [wrapper.Ig2_Sphere_Sphere_ScGeom()],
                [
                    wrapper.Ip2_WireMat_WireMat_WirePhys(linkThresholdIteration=1),
                    wrapper.Ip2_FrictMat_FrictMat_FrictPhys(),
                ],
                [
                    wrapper.Law2_ScGeom_WirePhys_WirePM(linkThresholdIteration=1),
                    wrapper.Law2_ScGeom_FrictPhys_CundallStrack(),
                ],
            ),
        }[self.kind]
        return wrapper.InteractionLoop(*made)

    def _grid(self):
        mat = wrapper.CohFrictMat(
            young=self.cable["young"],
            poisson=0.3,
            density=self.cable["density"],
            frictionAngle=0.3,
            normalCohesion=STRONG,
            shearCohesion=STRONG,
            momentRotationLaw=True,
            label="cable",
        )
        outside = wrapper.FrictMat(
            young=self.cable["young"], poisson=0.3, density=1, frictionAngle=0.3, label="outside"
        )
        O.materials.append(mat)
        O.materials.append(outside)
        r = self.cable["radius"]
        ids = [O.bodies.append(gridpfacet.gridNode(p, r, material="cable")) for p in self.points]
        for a, b in self.pairs:
            link = gridpfacet.gridConnection(ids[a], ids[b], r, material="outside", mask=3)
            O.bodies.append(link)
        self.links = [O.interactions[ids[a], ids[b]] for a, b in self.pairs]
        return ids

    def _balls(self, radius):
        """Spheres that together have the cable's mass, half a link's from each link that meets."""
        rhoA = section(self.cable)[2]
        ids = [O.bodies.append(utils.sphere(p, radius, material="cable")) for p in self.points]
        mass = np.zeros(len(ids))
        for a, b in self.pairs:
            mass[[a, b]] += 0.5 * rhoA * self.length
        for i, m in zip(ids, mass):
            state = O.bodies[i].state
            state.mass, state.inertia = float(m), 0.4 * float(m) * radius**2 * Vector3(1, 1, 1)
        return ids

    def _spheres(self):
        ea, ei, _ = section(self.cable)
        l, r = self.length, 0.5 * self.length
        kn, ks = ea / l, 12 * ei / l**3
        mat = wrapper.CohFrictMat(
            young=kn / r,
            poisson=ks / kn,
            density=1,
            frictionAngle=0.3,
            normalCohesion=STRONG,
            shearCohesion=STRONG,
            momentRotationLaw=True,
            alphaKr=ei / l / (r * r * ks),
            alphaKtw=ei / l / (r * r * ks),
            label="cable",
        )
        mat.etaRoll = mat.etaTwist = -1.0
        O.materials.append(mat)
        ids = self._balls(r)
        self.links = [utils.createInteraction(ids[a], ids[b]) for a, b in self.pairs]
        for link in self.links:
            link.phys.unp = link.geom.penetrationDepth
        return ids

    def _wire(self):
        young = self.cable["young"]
        mat = wrapper.WireMat(
            young=young,
            poisson=0.3,
            density=1,
            frictionAngle=0.3,
            diameter=2 * self.cable["radius"],
            strainStressValues=[(1.0, young), (2.0, 2 * young)],
            label="cable",
        )
        O.materials.append(mat)
        ids = self._balls(self.cable["radius"])
        self.links = [utils.createInteraction(ids[a], ids[b]) for a, b in self.pairs]
        return ids

    def critical(self, contact=0.0):
        """Critical step [s], from stiffness over mass of every node and its neighbours; contact:
        stiffness of a contact besides [N/m].
        """
        ea, ei, _ = section(self.cable)
        l, meet = self.length, np.bincount(np.ravel(self.pairs), minlength=len(self.ids))
        states = [O.bodies[i].state for i in self.ids]
        w2 = (2 * meet * ea / l + contact) / np.array([s.mass for s in states])
        if self.kind in BENDS:
            turning = 2 * meet * (ei / l + 12 * ei / l**3 * l**2 / 4)
            w2 = np.maximum(w2, turning / np.array([s.inertia[0] for s in states]))
        return 2 / math.sqrt(w2.max())

    def load(self, node, force):
        O.forces.setPermF(self.ids[node], Vector3(*force))

    def setVelocity(self, f):
        for i in self.ids:
            state = O.bodies[i].state
            state.vel = f(state.pos)

    @property
    def nodes(self):
        return np.array([list(O.bodies[i].state.pos) for i in self.ids])

    def tension(self, link):
        phys, geom = self.links[link].phys, self.links[link].geom
        return -phys.normalForce.dot(geom.normal)


def chainPairs(n):
    return [(i, i + 1) for i in range(n)]


def ours(model, cable, points, elements=1, **options):
    """The same as an ancf.Cable, appended; engines without a collider."""
    O.reset()
    O.materials.append(
        ancf.HollarsMat(label="cable", young=cable["young"], poisson=0.3, density=cable["density"])
    )
    made = ancf.Cable(
        points,
        elements,
        diameter=2 * cable["radius"],
        material="cable",
        model=model,
        contactPoints=0,
        **options,
    )
    return made


def start(made, gravity):
    O.engines = [
        e
        for e in ancf.engines(made, gravity=gravity)
        if not isinstance(e, wrapper.InsertionSortCollider)
    ]


# ---- hanging cable -------------------------------------------------------------------------------


def slackPolygon(n):
    """n chords of LENGTH/n on a circular arc over SPAN: n + 1 points."""

    def over(angle):
        return n * math.sin(angle / 2) / math.sin(n * angle / 2) - LENGTH / SPAN

    angle = brentq(over, 1e-6, 2 * math.pi / n - 1e-6)
    radius = LENGTH / n / (2 * math.sin(angle / 2))
    a = (np.arange(n + 1) - n / 2) * angle
    return np.stack([radius * np.sin(a), 0 * a, -radius * (np.cos(a) - math.cos(a[0]))], 1)


def slackArc(n):
    """n + 1 points on a circular arc of length LENGTH over SPAN."""
    half = brentq(lambda a: math.sin(a) / a - SPAN / LENGTH, 1e-6, math.pi - 1e-6)
    radius, a = LENGTH / (2 * half), np.linspace(-half, half, n + 1)
    return np.stack([radius * np.sin(a), 0 * a, -radius * (np.cos(a) - math.cos(half))], 1)


def catenary(bends):
    """Sag and tension(s) of an elastic cable between two hinges of one height, s from its middle."""
    ea, ei, rhoA = section(HANGING)
    w, half = rhoA * GRAVITY, 0.5 * LENGTH

    def width(h):
        return h * LENGTH / ea + 2 * h / w * math.asinh(w * half / h) - SPAN

    h = brentq(width, 1e-4 * w, 1e3 * w)
    sag = (w * half) ** 2 / (2 * ea * w) + (math.hypot(h, w * half) - h) / w
    if not bends:
        return sag, lambda s: math.hypot(h, w * s)
    # With bending: theta' = M/EI, M' = H sin(theta) - V cos(theta), V = w s, stretched by T/EA.
    s = np.linspace(0, half, 200)

    def slope(s, y, p):
        theta, moment = y[0], y[1]
        pull = p[0] * np.cos(theta) + w * s * np.sin(theta)
        stretch = 1 + pull / ea
        return np.array(
            [
                moment / ei,
                stretch * (p[0] * np.sin(theta) - w * s * np.cos(theta)),
                stretch * np.cos(theta),
                stretch * np.sin(theta),
            ]
        )

    def ends(a, b, p):
        return np.array([a[0], a[2], a[3], b[1], b[2] - SPAN / 2])

    theta = np.arctan2(w * s, h)
    guess = np.array(
        [theta, ei * np.gradient(theta, s), h / w * np.arcsinh(w * s / h), s * theta / 2]
    )
    done = solve_bvp(slope, ends, s, guess, p=[h], tol=1e-9, max_nodes=100_000)
    h, z = done.p[0], done.sol(half)[3]
    return z, lambda s: h * math.cos(done.sol(abs(s))[0]) + w * abs(s) * math.sin(
        done.sol(abs(s))[0]
    )


def settle(step, measure, limit, chunk):
    """Steps in chunks until `limit` s simulated; returns wall time after which the error stays
    within a tenth of its last value, and that error.
    """
    wall, walls, errors = 0.0, [], []
    while O.time < limit:
        begin = time.process_time()
        for _ in range(max(1, round(chunk / O.dt))):
            step()
        wall += time.process_time() - begin
        walls.append(wall)
        errors.append(measure())
    errors = np.array(errors)
    late = np.abs(errors - errors[-1]) > 0.1 * np.abs(errors[-1])
    last = np.flatnonzero(late.any(axis=1))
    first = min(last[-1] + 1, len(errors) - 1) if len(last) else 0
    return walls[first], np.abs(errors[first])


def hangBuiltIn(kind, n, limit=4.0):
    chain = BuiltIn(kind, HANGING, slackPolygon(n), chainPairs(n), hinged=(0, n), damping=SETTLE)
    sag, tension = catenary(kind in BENDS)
    s = 0.5 * LENGTH / n

    def measure():
        low = -chain.nodes[n // 2][2]
        return np.array([low / sag - 1, chain.tension(n // 2) / tension(s) - 1])

    wall, error = settle(O.step, measure, limit, 0.05)
    return wall, error


def hangOurs(model, n):
    bends = model == "ancf"
    sag, tension = catenary(bends)
    more = dict(axialRule="reduced", curvature="exact") if bends else {}
    cable = ours(model, HANGING, slackArc(n) if bends else slackPolygon(n), **more)
    cable.fix(0)
    cable.fix(-1)
    start(cable, (0, 0, -GRAVITY))
    begin = time.process_time()
    cable.relax(RELAX)
    wall = time.process_time() - begin
    O.step()  # for the reaction
    pull = abs(cable.reaction(0)[0])
    return wall, np.abs([-cable.curve(1)[n // 2][2] / sag - 1, pull / tension(0) - 1])


# ---- pendulum ------------------------------------------------------------------------------------


def swing(n, tip, exact, duration):
    """Wall time and tip error [m] after `duration` with the time step that is set."""
    steps = math.ceil(duration / O.dt)
    O.dt = duration / steps
    begin = time.process_time()
    for _ in range(steps):
        O.step()
    wall = time.process_time() - begin
    return wall, np.array([np.linalg.norm(tip() - np.array(exact))])


def swingBuiltIn(kind, n, duration=1.0):
    points = np.stack([np.linspace(0, 1, n + 1), np.zeros(n + 1), np.zeros(n + 1)], 1)
    gravity = (0, -PENDULUM_GRAVITY, 0)
    chain = BuiltIn(kind, PENDULUM, points, chainPairs(n), hinged=(0,), gravity=gravity)
    chain.setVelocity(lambda p: Vector3(0, 0, -4 * p[0]))
    if kind != "wire":
        for i in chain.ids:
            O.bodies[i].state.angVel = Vector3(0, 4, 0)
    return swing(n, lambda: chain.nodes[-1], PENDULUM_ENGINEERING, duration)


def swingOurs(model, n, duration=1.0):
    ancfModel = model == "ancf"
    points = [(0, 0, 0), (1, 0, 0)]
    if ancfModel:
        cable = ours("ancf", PENDULUM, points, n, axialRule="reduced")
    else:
        cable = ours("springs", PENDULUM, points, midPoints=n - 1)
    cable.fix(0)
    cable.setVelocity(lambda p: Vector3(0, 0, -4 * p[0]))
    start(cable, (0, -PENDULUM_GRAVITY, 0))
    O.dt = cable.criticalTimeStep()
    exact = PENDULUM_GREEN if ancfModel else PENDULUM_ENGINEERING
    return swing(n, lambda: cable.knots[1], exact, duration)


# ---- cantilever ----------------------------------------------------------------------------------


def cantilever():
    """Tip's fall of an extensible, unshearable elastica under a dead tip load, by shooting [m]."""
    ea, ei, _ = section(CANTILEVER)
    load, length = CANTILEVER_LOAD * ei / CANTILEVER_LENGTH**2, CANTILEVER_LENGTH

    def shot(moment):
        def slope(s, y):
            stretch = 1 + load * math.sin(y[0]) / ea
            return [
                y[1] / ei,
                -load * math.cos(y[0]) * stretch,
                stretch * math.cos(y[0]),
                stretch * math.sin(y[0]),
            ]

        return solve_ivp(slope, (0, length), [0, moment, 0, 0], rtol=1e-11, atol=1e-12).y[:, -1]

    moment = brentq(lambda m: shot(m)[1], 0, 2 * load * length)
    return shot(moment)[3]


def bendBuiltIn(kind, n, limit=1.0):
    points = np.stack([np.linspace(0, 2, n + 1), np.zeros(n + 1), np.zeros(n + 1)], 1)
    gravity = (0, 0, 0)
    chain = BuiltIn(
        kind, CANTILEVER, points, chainPairs(n), clamped=(0,), damping=SETTLE, gravity=gravity
    )
    ei = section(CANTILEVER)[1]
    chain.load(n, (0, 0, -CANTILEVER_LOAD * ei / CANTILEVER_LENGTH**2))
    exact = cantilever()
    return settle(O.step, lambda: np.array([-chain.nodes[-1][2] / exact - 1]), limit, 0.01)


def bendOurs(n):
    ei = section(CANTILEVER)[1]
    cable = ours(
        "ancf",
        CANTILEVER,
        [(0, 0, 0), (CANTILEVER_LENGTH, 0, 0)],
        n,
        axialRule="reduced",
        curvature="exact",
    )
    cable.clamp(0)
    cable.load(-1, (0, 0, -CANTILEVER_LOAD * ei / CANTILEVER_LENGTH**2))
    start(cable, (0, 0, 0))
    begin = time.process_time()
    cable.relax(RELAX)
    wall = time.process_time() - begin
    return wall, np.abs([-cable.knots[1][2] / cantilever() - 1])


# ---- a net dropped on a ball ---------------------------------------------------------------------


def square(parts):
    """Points and pairs of a flat square net above the ball, every edge in `parts` links."""
    n, half = MESHES + 1, 0.5 * MESHES * MESH
    z = BALL + DROP
    points = [(i * MESH - half, j * MESH - half, z) for i in range(n) for j in range(n)]
    edges = [(n * i + j, n * i + j + 1) for i in range(n) for j in range(n - 1)]
    edges += [(n * i + j, n * i + j + n) for i in range(n - 1) for j in range(n)]
    pairs = []
    for a, b in edges:
        chain = [a]
        for k in range(1, parts):
            chain.append(len(points))
            points.append(
                tuple(np.array(points[a]) * (1 - k / parts) + np.array(points[b]) * k / parts)
            )
        pairs += list(zip(chain, chain[1:] + [b]))
    return points, pairs


def onTarget(shape):
    body = (
        utils.sphere((0, 0, 0), BALL, material="outside", fixed=True)
        if shape == "ball"
        else utils.box((0, 0, 0), (BALL, BALL, BALL), material="outside", fixed=True)
    )
    return O.bodies.append(body)


def runDrop(curves, radius, shape, duration):
    """Runs the drop; returns wall time, us a step, deepest penetration [cable diameters]."""
    deepest, wall = 0.0, 0.0
    while O.time < duration:
        begin = time.process_time()
        for _ in range(max(1, round(5e-3 / O.dt))):
            O.step()
        wall += time.process_time() - begin
        p = curves()
        if shape == "ball":
            depth = BALL + radius - np.linalg.norm(p, axis=1)
        else:
            beyond = np.abs(p) - BALL
            outside = np.linalg.norm(np.maximum(beyond, 0), axis=1)
            depth = radius - outside - np.minimum(beyond.max(axis=1), 0)
        deepest = max(deepest, depth.max())
    return wall, 1e6 * wall / O.iter, deepest / (2 * radius)


def dropBuiltIn(kind, parts, shape="ball", duration=FALL):
    points, pairs = square(parts)
    chain = BuiltIn(kind, NET, points, pairs)
    if "outside" not in [m.label for m in O.materials]:
        O.materials.append(
            wrapper.FrictMat(
                young=NET["young"], poisson=0.3, density=1, frictionAngle=0.3, label="outside"
            )
        )
    onTarget(shape)
    loop = O.engines[1]
    loop.geomDispatcher.functors += [wrapper.Ig2_Box_Sphere_ScGeom()]
    if kind == "grid":  # else YADE ends at the first contact of a box
        loop.lawDispatcher.functors += [wrapper.Law2_ScGeom_FrictPhys_CundallStrack()]
    if kind == "spheres":
        loop.geomDispatcher.functors = [
            wrapper.Ig2_Sphere_Sphere_ScGeom6D(),
            wrapper.Ig2_Box_Sphere_ScGeom6D(),
        ]
    bounds = [wrapper.Bo1_Sphere_Aabb(), wrapper.Bo1_Box_Aabb(), wrapper.Bo1_GridConnection_Aabb()]
    collider = wrapper.InsertionSortCollider(
        bounds, verletDist=0.25 * MESH / parts, avoidSelfInteractionMask=2
    )
    O.engines = [O.engines[0], collider, *O.engines[1:]]
    ends = np.array(chain.pairs)
    at = np.linspace(0, 1, 9)[:, None, None]
    radius = O.bodies[chain.ids[0]].shape.radius

    def curves():
        x = chain.nodes
        return ((1 - at) * x[ends[:, 0]] + at * x[ends[:, 1]]).reshape(-1, 3)

    both = (NET["young"] * radius, NET["young"] * BALL)
    O.dt = RESERVE * chain.critical(2 * both[0] * both[1] / sum(both))
    wall, each, deep = runDrop(curves, radius, shape, duration)
    return wall, each, deep * radius / NET["radius"], len(chain.ids)


def dropOurs(model, parts, shape="ball", duration=FALL):
    O.reset()
    for label in ("cable", "outside"):
        O.materials.append(
            given.material(label, NET["young"], density=NET["density"], kineticFriction=0.3)
        )
    onTarget(shape)
    springs = model == "springs"
    net = ancf.Net.square(
        MESHES,
        MESH,
        diameter=2 * NET["radius"],
        material="cable",
        center=(0, 0, BALL + DROP),
        normal=(0, 0, 1),
        damping=5e-5,
        **(
            dict(model="springs", midPoints=parts - 1) if springs else dict(contactPoints=parts - 1)
        ),
        **({} if springs else dict(mass="lumped")),
    )
    O.engines = ancf.engines(net, gravity=(0, 0, -GRAVITY))
    k = 8 if springs else 8 * parts
    done = runDrop(lambda: net.curve(k).reshape(-1, 3), NET["radius"], shape, duration)
    return *done, net.nodeCount


# ---- all of it -----------------------------------------------------------------------------------

TESTS = {
    "hanging cable": (hangBuiltIn, lambda m, n: hangOurs(m, n), ("sag", "tension")),
    "pendulum": (swingBuiltIn, lambda m, n: swingOurs(m, n), ("tip [m]",)),
    "cantilever": (bendBuiltIn, lambda m, n: bendOurs(n), ("tip deflection",)),
}
SIZES = {
    "hanging cable": ((8, 16, 32, 64), (4, 8, 16, 32, 64)),
    "pendulum": ((8, 16, 32, 64), (2, 4, 6, 8, 16)),
    "cantilever": ((5, 10, 20), (2, 4, 8, 16)),
}
KINDS = {
    "hanging cable": ("grid", "spheres", "wire", "ours", "ours, springs"),
    "pendulum": ("grid", "spheres", "wire", "ours", "ours, springs"),
    "cantilever": ("grid", "spheres", "ours"),
}


def measureAll(quick):
    """[(test, kind, elements, wall [s], error, ...)]."""
    rows = []
    for test, (builtIn, own, _) in TESTS.items():
        for kind in KINDS[test]:
            isOurs = kind.startswith("ours")
            sizes = SIZES[test][isOurs]
            for n in sizes[:2] if quick and not isOurs else sizes:
                if isOurs:
                    wall, error = own("springs" if "springs" in kind else "ancf", n)
                else:
                    wall, error = builtIn(kind, n)
                rows.append((test, kind, n, wall, *error))
                shown = ", ".join(f"{e:.2e}" for e in error)
                print(f"  {test}: {NAMES[kind]}, {n}: error {shown}, {wall:.4f} s", flush=True)
    return rows


def factors(rows):
    """{test: [(wall [s], best built-in, its error, ours, factor), ...]}: the least error of any built-in
    that takes no longer than `wall`, and of ours, at the wall times of the built-ins.
    """
    answer = {}
    for test in TESTS:
        all_ = [(r[3], max(r[4:]), r[1]) for r in rows if r[0] == test]
        own = [r for r in all_ if r[2] == "ours"]
        other = sorted(r for r in all_ if not r[2].startswith("ours"))
        answer[test] = []
        for wall, _, _ in other:
            best = min((r for r in other if r[0] <= wall), key=lambda r: r[1])
            mine = [r[1] for r in own if r[0] <= wall]
            if mine:
                answer[test].append((wall, best[2], best[1], min(mine), best[1] / min(mine)))
    return answer


def dropAll(quick):
    """Rows of the net dropped on a ball, and on a box."""
    rows = []
    cases = [("grid", 1), ("grid", 4), ("spheres", 4), ("wire", 1), ("wire", 4)]
    cases += [("ours", 4), ("ours, springs", 4)]
    for shape in ("ball", "box"):
        for kind, parts in cases[1::3] if quick else cases:
            if kind.startswith("ours"):
                done = dropOurs("springs" if "springs" in kind else "ancf", parts, shape)
            else:
                done = dropBuiltIn(kind, parts, shape)
            wall, each, deep, nodes = done
            rows.append((shape, kind, parts, nodes, wall, each, deep))
            print(
                f"  net on a {shape}: {NAMES[kind]}, {parts} a cable: {wall:.2f} s, {each:.1f} us a step, "
                f"{deep:.2f} diameters deep",
                flush=True,
            )
    return rows


CANNOT = (
    (
        "GridNode, GridConnection",
        "touch a box, facet or wall: Box and node's sphere meet, the cable falls through without a word",
    ),
    ("GridNode, GridConnection", "slack without bending: links are beams, and push"),
    ("cohesive spheres (CohFrictMat)", "be thin: touching spheres are as thick as links are long"),
    ("WireMat links", "bend: a cantilever falls down"),
    ("WireMat links", "touch anything between its spheres"),
    ("all three", "tell their elastic energy, or the step that is stable"),
)


def plot(rows, drops, file):
    panels = [
        ("hanging cable", 4, "error of sag"),
        ("hanging cable", 5, "error of tension"),
        ("pendulum", 4, "error of the tip after 1 s [m]"),
        ("cantilever", 4, "error of the tip"),
    ]
    figure, axes = plt.subplots(1, 5, figsize=(21, 4.6))
    for ax, (test, column, title) in zip(axes, panels):
        for kind in KINDS[test]:
            some = [r for r in rows if r[0] == test and r[1] == kind]
            ax.loglog(
                [r[3] for r in some],
                [r[column] for r in some],
                "o-",
                color=COLORS[kind],
                lw=1.4,
                ms=4,
                label=NAMES[kind],
            )
            for r in some:
                ax.annotate(
                    f"{r[2]}", (r[3], r[column]), (3, 3), textcoords="offset points", fontsize=7
                )
        ax.set_title(f"{test}: {title}", fontsize=10)
        ax.set_xlabel("wall time [s]")
        ax.grid(alpha=0.3, which="both", lw=0.4)
    axes[2].legend(fontsize=7)
    ax = axes[4]
    for shape, kind, parts, _, wall, _, deep in drops:
        marker = "o" if shape == "ball" else "s"
        ax.loglog([wall], [max(deep, 1e-2)], marker, color=COLORS[kind], ms=6)
        ax.annotate(
            f"{parts}", (wall, max(deep, 1e-2)), (4, 3), textcoords="offset points", fontsize=7
        )
    ax.axhline(1, color="k", lw=0.8, ls=":")
    ax.set_title("net dropped on a ball (o), a box (□): penetration", fontsize=10)
    ax.set_xlabel(f"wall time for {FALL} s [s]")
    ax.set_ylabel("deepest, in diameters of the cable")
    ax.grid(alpha=0.3, which="both", lw=0.4)
    figure.tight_layout()
    figure.savefig(file, dpi=90)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="short form")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/chains"))
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    rows = measureAll(args.quick)
    drops = dropAll(args.quick)
    with open(args.out / "chains.csv", "w", newline="", encoding="utf-8") as file:
        out = csv.writer(file)
        out.writerow(["test", "element", "elements", "wall_s", "error", "error_of_tension"])
        out.writerows([r[0], NAMES[r[1]], *(f"{x:.4g}" for x in r[2:])] for r in rows)
        out.writerow(
            [
                "net on",
                "element",
                "links a cable",
                "nodes",
                "wall_s",
                "us_a_step",
                "deepest_diameters",
            ]
        )
        out.writerows([r[0], NAMES[r[1]], *(f"{x:.4g}" for x in r[2:])] for r in drops)
        out.writerow(["element", "cannot"])
        out.writerows(CANNOT)
    plot(rows, drops, args.out / "chains.png")
    for test, found in factors(rows).items():
        least = min(found, key=lambda f: f[4])
        for (wall, kind, theirs, mine, factor), what in ((least, "least"), (found[-1], "last")):
            print(
                f"{test}, {what}: within {wall:.2g} s {NAMES[kind]} {theirs:.1e}, ours {mine:.1e}: "
                f"{factor:.1f} times less"
            )
    for who, what in CANNOT:
        print(f"  {who} cannot {what}")
    print(f"figures: {args.out}/chains.png")


if __name__ == "__main__":
    main()
