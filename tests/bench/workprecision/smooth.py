"""Single cables that touch nothing: pendulum, plucked string, cantilever that is let go."""

import math
from dataclasses import dataclass

import chains
import numpy as np
from yade import O, Vector3

import ancf

from .measure import INSIDE, Row, rms, timed, withoutCollider
from .references import reference
from .textbook import Rod

# ---- parameters, SI units ------------------------------------------------------------------------
PENDULUM, PENDULUM_GRAVITY = chains.PENDULUM, (0, -chains.PENDULUM_GRAVITY, 0)
TURN = 4.0  # rate of the pendulum at the start [rad/s]
SWING = 1.0  # [s]
STRING = dict(young=1e9, radius=1e-4, density=1000)  # 1 m long as it is held
STRAIN = 0.01  # that holds it, in the measure of each model
PLUCK, MODES = 3e-5, (1, 3, 5)  # amplitude [m], modes of a string plucked in its middle
PERIODS = 3.3  # of the lowest mode
CANTILEVER = dict(young=2.5e7, radius=0.01, density=1000)
CANTILEVER_GRAVITY = (0, 0, -9.81)
FALL = 0.4  # [s]

# Tip at SWING of 64 undamped elements with Green strain and fast curvature, confirmed on 8 elements by DOP853 to
# 1e-6. With exact curvature, as textbook elements have it, the limit is 7.7e-5 m away.
LIMIT = (0.652800, 0.046069, 0.660242)
REFERENCE_ELEMENTS, CHECK_ELEMENTS = 32, 24

ELEMENTS, FEW = (2, 4, 8, 16), (4, 8)
PARTS = (0.9, 0.45, 0.225)  # of the critical step
STEPS = (8e-3, 4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4)  # of implicit steps, in seconds of the pendulum
LINKS, FEW_LINKS = (8, 16, 32), (16, 32)  # of chains
CHAINS = dict(grid="YADE grid chain", spheres="YADE sphere chain", wire="YADE wire chain")


def rod(cable, n, gravity, strain):
    return Rod(n, 1.0, *chains.section(cable), gravity, strain)


# ---- references ----------------------------------------------------------------------------------


def swung(n, strain):
    """Tip of the pendulum, n textbook elements (3) [m]."""
    made = rod(PENDULUM, n, PENDULUM_GRAVITY, strain)
    rates = np.zeros_like(made.start)
    rates[::2, 2], rates[1::2, 2] = -TURN * made.start[::2, 0], -TURN
    return made.run(SWING, rates, held=[0])[-1]


def fallen(n):
    """Tip of the cantilever, n textbook elements (3) [m]."""
    made = rod(CANTILEVER, n, CANTILEVER_GRAVITY, "green")
    return made.run(FALL, np.zeros_like(made.start), held=[0, 1])[-1]


def makeReferences():
    """{name: (value, how far a coarser one is from it, how it was made)}."""
    how = f"{REFERENCE_ELEMENTS} textbook elements in numpy, DOP853 of scipy, tolerance 1e-9"
    answer = {}
    for name, make in (
        ("pendulum, exact curvature", lambda n: swung(n, "green")),
        ("pendulum, engineering strain", lambda n: swung(n, "engineering")),
        ("cantilever", fallen),
    ):
        fine, coarse = make(REFERENCE_ELEMENTS), make(CHECK_ELEMENTS)
        off = rms([fine], [coarse])
        answer[name] = (fine, off, f"{how}; check: {CHECK_ELEMENTS} elements")
    return answer


def stringRate(strain):
    """Lowest angular frequency of the string [rad/s]: y_tt = S/rhoA y_ss in unstressed arc length s,
    S = EA times the strain (Green) or T over the stretch (engineering), small vibrations.
    """
    ea, _, rhoA = chains.section(STRING)
    if strain == "green":
        pull, length = ea * STRAIN, 1 / math.sqrt(1 + 2 * STRAIN)
    else:
        pull, length = ea * STRAIN / (1 + STRAIN), 1 / (1 + STRAIN)
    return math.pi / length * math.sqrt(pull / rhoA)


def plucked(x, phase=0.0):
    """Shape of the string at x in [0, 1] m [m], and its slope; phase of the lowest mode [rad]."""
    z, slope = np.zeros_like(x), np.zeros_like(x)
    for k in MODES:
        a = PLUCK * (-1) ** ((k - 1) // 2) / k**2 * math.cos(k * phase)
        z += a * np.sin(k * math.pi * x)
        slope += a * k * math.pi * np.cos(k * math.pi * x)
    return z, slope


def stringTime():
    return PERIODS * 2 * math.pi / stringRate("green")


def stringError(x, z, strain):
    """RMS of nodes, as part of the amplitude."""
    exact, _ = plucked(np.asarray(x), stringRate(strain) * stringTime())
    return float(np.sqrt(np.mean((np.asarray(z) - exact) ** 2))) / PLUCK


# ---- ours ----------------------------------------------------------------------------------------


def single(cable, model, n, mass, **options):
    """A cable of the case, 1 m along x."""
    points = [(0, 0, 0), (1, 0, 0)]
    if model == "springs":
        return chains.ours(model, cable, points, midPoints=n - 1)
    return chains.ours(model, cable, points, n, mass=mass, axialRule="reduced", **options)


def engines(cable, gravity, integrator, step, inside=INSIDE):
    """Engines and O.dt; step: part of the critical one, or an implicit one [s]."""
    O.engines = withoutCollider(ancf.engines(cable, gravity=gravity, integrator=integrator))
    if integrator == "implicit":
        O.dt = step
    else:
        cable.engine.substeps = inside
        O.dt = inside * step * cable.criticalTimeStep()


def pendulum(model, n, mass, integrator, step, inside=INSIDE):
    made = single(PENDULUM, model, n, mass)
    made.fix(0)
    made.setVelocity(lambda p: Vector3(0, 0, -TURN * p[0]))
    engines(made, PENDULUM_GRAVITY, integrator, step, inside)
    return made


def pendulumError(tip, strain):
    known = LIMIT if strain == "green" else reference("pendulum, engineering strain")
    return rms(tip, [known])


def string(model, n, mass, integrator, step, inside=INSIDE):
    made = single(STRING, model, n, mass, bending=0.0)
    made.fix(0)
    made.fix(-1)
    made.append()
    engine = made.engine
    green = model != "springs"
    stretch = math.sqrt(1 + 2 * STRAIN) if green else 1 + STRAIN
    engine.length = [1 / n / stretch] * n
    state = np.array(engine.position).reshape(3, -1)
    x = state[0, : engine.nNodes].copy()
    state[2, : engine.nNodes] = plucked(x)[0]
    for end in (0, 1):
        at = x[list(engine.ends)[end::2]]
        block = slice(engine.nNodes + end * n, engine.nNodes + end * n + n)
        state[0, block] = stretch
        state[2, block] = stretch * plucked(at)[1]
    engine.position = state.ravel().tolist()
    engines(made, (0, 0, 0), integrator, step, inside)
    return made


def cantilever(model, n, mass, integrator, step, inside=INSIDE):
    made = single(CANTILEVER, model, n, mass, curvature="exact")
    made.clamp(0)
    engines(made, CANTILEVER_GRAVITY, integrator, step, inside)
    return made


def nodesOf(made):
    """Nodes in their order along a cable with two knots, which come first in the engine (n, 3)."""
    engine = made.engine
    nodes = np.array(engine.position).reshape(3, -1)[:, : engine.nNodes].T
    return np.concatenate([nodes[:1], nodes[2:], nodes[1:2]])


# ---- YADE's own ----------------------------------------------------------------------------------


def line(n):
    return np.stack([np.linspace(0, 1, n + 1), np.zeros(n + 1), np.zeros(n + 1)], 1)


def pendulumChain(kind, n):
    made = chains.BuiltIn(
        kind, PENDULUM, line(n), chains.chainPairs(n), hinged=(0,), gravity=PENDULUM_GRAVITY
    )
    made.setVelocity(lambda p: Vector3(0, 0, -TURN * p[0]))
    if kind != "wire":
        for i in made.ids:
            O.bodies[i].state.angVel = Vector3(0, TURN, 0)
    return made


def stringChain(kind, n):
    points = line(n)
    points[:, 2] = plucked(points[:, 0])[0]
    made = chains.BuiltIn(
        kind, STRING, points, chains.chainPairs(n), hinged=(0, n), gravity=(0, 0, 0)
    )
    for link in made.links:  # as if each were longer than it is at rest
        link.phys.unp += made.length * STRAIN / (1 + STRAIN)
        link.phys.kn *= 1 + STRAIN
    for i in made.ids:  # masses as unstretched links have them
        O.bodies[i].state.mass /= 1 + STRAIN
    return made


def cantileverChain(kind, n):
    return chains.BuiltIn(
        kind, CANTILEVER, line(n), chains.chainPairs(n), clamped=(0,), gravity=CANTILEVER_GRAVITY
    )


# ---- the sweeps ----------------------------------------------------------------------------------


@dataclass
class Smooth:
    """A case: how its scenes are built, and what is off at their end."""

    build: object  # of ours: (model, elements, mass, integrator, step, inside) -> Cable
    chain: object  # of YADE's: (kind, links) -> BuiltIn
    duration: float  # [s]
    error: object  # (nodes along the cable, strain measure) -> error
    kinds: tuple  # of YADE's chains that can do it
    springs: bool  # whether a chain of springs can
    pace: float  # implicit steps in those of the pendulum

    def rows(self, quick):
        elements, parts = (FEW, PARTS[:1]) if quick else (ELEMENTS, PARTS)
        for mass in ("lumped", "consistent"):
            for n in elements:
                for part in parts:
                    yield self.row(f"ANCF {mass}", "ancf", n, mass, "leapfrog", part)
        for n in elements[-1:] if quick else elements[1:]:
            yield self.row("ANCF lumped, one step in O.dt", "ancf", n, "lumped", "leapfrog", 0.9, 1)
        for n in elements[-1:] if quick else (*elements[1:], 2 * elements[-1]):
            for step in STEPS[2:4] if quick else STEPS:
                step *= self.pace
                yield self.row("ANCF implicit", "ancf", n, "consistent", "implicit", step)
        if self.springs:
            for n in FEW_LINKS if quick else LINKS:
                yield self.row("springs", "springs", n, "lumped", "leapfrog", 0.9)
        for kind in self.kinds:
            for n in FEW_LINKS if quick else LINKS:
                yield self.chainRow(kind, n)

    def row(self, method, model, n, mass, integrator, step, inside=INSIDE):
        made = []
        cpu = timed(
            lambda: made.append(self.build(model, n, mass, integrator, step, inside)), self.duration
        )
        strain = "engineering" if model == "springs" else "green"
        length = O.dt / (1 if integrator == "implicit" else inside)
        error = self.error(nodesOf(made[-1]), strain)
        return Row(method, n, mass, integrator, length, cpu, error)

    def chainRow(self, kind, n):
        made = []
        cpu = timed(lambda: made.append(self.chain(kind, n)), self.duration)
        error = self.error(made[-1].nodes, "engineering")
        return Row(CHAINS[kind], n, "lumped", "leapfrog", O.dt, cpu, error)


CASES = {
    "pendulum": Smooth(
        pendulum,
        pendulumChain,
        SWING,
        lambda nodes, strain: pendulumError(nodes[-1:], strain),
        ("grid", "spheres", "wire"),
        True,
        1.0,
    ),
    "string": Smooth(
        string,
        stringChain,
        stringTime(),
        lambda nodes, strain: stringError(nodes[:, 0], nodes[:, 2], strain),
        ("grid", "spheres"),
        True,
        0.05,
    ),
    "cantilever": Smooth(
        cantilever,
        cantileverChain,
        FALL,
        lambda nodes, strain: rms(nodes[-1:], reference("cantilever")),
        ("grid", "spheres"),
        False,
        1.0,
    ),
}


def peerError(name, nodes):
    """Error of another program, from its nodes along the cable (a tip alone does for free ends)."""
    return CASES[name].error(np.asarray(nodes, float), "engineering")


def forPeers(name):
    """A case for peers."""
    x = np.linspace(0, 1, 321)
    cable, gravity, turn, held = {
        "pendulum": (PENDULUM, PENDULUM_GRAVITY, -TURN, (3, 0)),
        "string": (STRING, (0, 0, 0), 0.0, (3, 3)),
        "cantilever": (CANTILEVER, CANTILEVER_GRAVITY, 0.0, (6, 0)),
    }[name]
    isString = name == "string"
    z, slope = plucked(x) if isString else (0 * x, 0 * x)
    ea, ei, rhoA = chains.section(cable)
    return dict(
        **cable,
        ea=ea,
        ei=0.0 if isString else ei,
        rhoA=rhoA,
        gravity=gravity,
        turn=turn,
        held=held,  # coordinates of each end that do not move: 3 hinged, 6 clamped
        stretch=1 + STRAIN if isString else 1.0,
        x=x.tolist(),
        z=z.tolist(),
        slope=slope.tolist(),
        duration=CASES[name].duration,
        elements=(4, 8, 16),
        segments=(16, 32),
        steps=[step * CASES[name].pace for step in STEPS[1:5]],
    )
