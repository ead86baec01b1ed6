"""The scene around cables: complete engine lists, time steps, and checks before the first step."""

import math
import warnings

import numpy as np
from yade import O, Vector3, wrapper

from . import values
from .lines import Line, lineEngines
from .structure import ELEMENTS, LUMPED, Structure, anyMaterial, cableEngines, matrix

LAW_OPTIONS = {
    "normal": ("nonlinear", "hertz", "linear"),
    "friction": ("hollars", "coulomb", "none"),
}
FRICTION_RULES = ("min", "max", "mean")


SOLIDS = ("Sphere", "Box", "Facet", "Wall")  # that cables touch, sheaves besides

IMPLICIT_STEP = 1e-3  # [s]
GRAIN_PART = 0.5  # of the time of a sound wave through a grain: a packing is stable with it

# What integrator='auto' goes by, from docs/precision.rst
SUBSTEPS_MOST = 1000
MOST_INSIDE = 40  # steps of leapfrog in an O.dt; more make it no cheaper, and implicit ones are


def engines(
    *structures,
    gravity=(0, 0, 0),
    integrator="leapfrog",
    substeps="auto",
    contact=None,
    speed=None,
    verletDist=None,
):
    """The complete list for O.engines, and sets O.dt.

    structures   cables, nets and lines; those not appended yet are appended, cables and nets to one
                 engine
    gravity      [m/s2]
    integrator   'leapfrog'; 'implicit' for smooth cables that touch nothing (contactPoints=0): O.dt
                 is then a matter of accuracy and set to 1 ms; 'rk4' is a reference; 'auto' takes
                 leapfrog where something may touch, and otherwise what is cheapest, with an O.dt
                 of up to 1 ms: plan() tells what it took, and why
    substeps     of the cables inside O.dt, with contacts in each: 'auto' takes one, more only if
                 O.dt is raised later; a number exactly that many. 3 take 15 to 35 % off the time of
                 a capture; restitution at 10 m/s is then off by 2 %, undamped by up to 7 %
    contact      dict with normal='nonlinear'|'hertz'|'linear', friction='hollars'|'coulomb'|'none',
                 frictionRule='min'|'max'|'mean', by which the coefficients of two materials make
                 one, and frictionPairs={('rope', 'drum'): (0.3, 0.2)}: mu_s and mu_k of pairs of
                 materials, by label or id, that have their own
    speed        at which bodies other than cables are expected to meet [m/s]; None: the fastest motion
                 in the scene, at least 1. Their contact stiffness and so O.dt depend on it, weakly
    verletDist   sweep length of the collider for bodies other than cables [m]; None: an eighth of
                 the shortest element, at least a cable's radius

    Contacts of cables, spheres, boxes, facets and walls of HollarsMat or FrictMat have their
    functors in the list. Raises ValueError, TypeError that name the argument, RuntimeError for a
    scene that cannot work.
    """
    for i, structure in enumerate(structures):
        if not isinstance(structure, (Structure, Line)):
            remedy = "must be a Cable, a Net or a Line"
            values.refuse(f"engines: argument {i}", structure, remedy, TypeError)
    lines = [s for s in structures if isinstance(s, Line)]
    structures = [s for s in structures if isinstance(s, Structure)]
    if not structures:
        raise ValueError("engines(): give at least one Cable or Net")
    gravity = values.vector("engines: gravity", gravity)
    values.choice("engines: integrator", integrator, ("leapfrog", "implicit", "rk4", "auto"))
    steps = (
        0 if substeps == "auto" else values.count("engines: substeps", substeps, 1, SUBSTEPS_MOST)
    )
    law, mixing = _contactOptions(contact)
    if speed is not None:
        values.positive("engines: speed", speed, "m/s")
    if verletDist is None:
        verletDist = min(sweepLength(s) for s in structures)
    verletDist = values.positive("engines: verletDist", verletDist, "m")

    cable = _appendAll(structures)
    for engine in cable:
        chosen, inside = integrator, steps
        if integrator == "auto":
            chosen, best, _ = _choice(engine)
            inside = steps or best
        engine.integrator, engine.substeps = chosen, inside
        for name, value in law.items():
            setattr(engine, name, value)
        engine.checkIntegrator()
    for structure in structures:
        if getattr(structure, "folded", False) and O.iter == 0:
            _checkFolded(structure)
    for line in lines:
        if not line.appended:
            line.append()
    hollars = wrapper.Law2_ScGeom_HollarsPhys_Hollars(**law)
    speed = fastest() if speed is None else speed
    O.dt = timeStep(cable, speed, hollars, [line.engine for line in lines])
    return [
        wrapper.ForceResetter(),
        wrapper.InsertionSortCollider(
            [_new("Bo1_%s_Aabb" % s) for s in (*SOLIDS, "CableElement")],
            verletDist=verletDist,
            sortAxis=_longestAxis(),
            avoidSelfInteractionMask=ELEMENTS,
        ),
        wrapper.InteractionLoop(
            [_new("Ig2_%s_Sphere_ScGeom" % s) for s in SOLIDS]
            + [_new("Ig2_%s_CableElement_CableGeom" % s) for s in SOLIDS]
            + [_new("Ig2_%s_CarriedSphere_CableGeom" % s) for s in SOLIDS],
            [
                mixing(wrapper.Ip2_HollarsMat_HollarsMat_HollarsPhys()),
                mixing(wrapper.Ip2_FrictMat_HollarsMat_HollarsPhys()),
                wrapper.Ip2_FrictMat_FrictMat_FrictPhys(),
            ],
            [
                hollars,
                wrapper.Law2_CableGeom_HollarsPhys_Hollars(),
                wrapper.Law2_ScGeom_FrictPhys_CundallStrack(),
            ],
        ),
        *(line.engine for line in lines),
        *cable,
        _newton(gravity),
    ]


def _newton(gravity):
    """Moves bodies, undamped, and aspherical ones so that they keep their angular momentum to the
    last bit: as YADE 2023.02a does always, and newer ones by this algorithm.
    """
    newton = wrapper.CableNewton(damping=0, gravity=Vector3(*gravity))
    if hasattr(newton, "rotAlgorithm"):
        newton.rotAlgorithm = "Fincham1992"
    return newton


def _choice(engine):
    """Integrator, sub-steps (0: automatic) and the reason, for an engine as it is now."""
    if any(i >= 0 for i in engine.elementIds) or engine.coupled:
        return "leapfrog", 0, "something may touch, or hangs off its centre or on a guide"
    inside = IMPLICIT_STEP / engine.criticalTimeStep()
    smooth = any(n >= 0 for n in engine.next) and any(ei > 0 for ei in engine.ei)
    if smooth and inside > MOST_INSIDE:
        return (
            "implicit",
            0,
            f"nothing touches, and {IMPLICIT_STEP:g} s would take {inside:.0f} steps of leapfrog",
        )
    inside = int(min(max(1, inside), MOST_INSIDE))
    return "leapfrog", inside, "nothing touches, and its steps cost less than those of YADE's loop"


def plan():
    """What the CableEngines in O.engines do in a step, and what integrator='auto' would choose, as
    text, a line each.
    """
    lines = []
    for engine in cableEngines():
        lumped, stable = sum(bool(kind & LUMPED) for kind in engine.kind), engine.criticalTimeStep()
        inside = 1
        if engine.integrator == "leapfrog":
            inside = engine.substeps or max(1, math.ceil(O.dt / stable - 1e-9))
        chosen, most, why = _choice(engine)
        if chosen == "leapfrog":
            chosen += f" with {most or 1} in an O.dt"
        lines.append(
            f"CableEngine {engine.family}: {engine.nElements} elements, {lumped} with lumped mass; "
            f"{engine.integrator}, {inside} of its steps in O.dt = {O.dt:g} s, each stable up to {stable:.3g} s "
            f"with leapfrog; 'auto' would take {chosen}: {why}"
        )
    return "\n".join(lines)


def _new(name):
    return getattr(wrapper, name)()


def _longestAxis():
    """Axis along which bodies are spread most: sorted along it, fewest overlap when the collider
    starts. Those of a flat net do so all along its normal.
    """
    places = np.array([list(b.state.pos) for b in O.bodies] or [[0, 0, 0]])
    return int(np.argmax(places.std(axis=0)))


def _contactOptions(contact):
    """Options of the laws, and what tells a functor how friction of two materials mixes."""
    if contact is not None and not isinstance(contact, dict):
        remedy = "must be a dict such as dict(normal='hertz', frictionRule='mean'), or None"
        values.refuse("engines: contact", contact, remedy, TypeError)
    options = dict(contact or {})
    rule, pairs = options.pop("frictionRule", "min"), options.pop("frictionPairs", {})
    values.choice("engines: contact['frictionRule']", rule, FRICTION_RULES)
    known = [_frictionPair(pair, friction) for pair, friction in _pairs(pairs)]
    for key, value in options.items():
        values.choice("engines: contact key", key, (*LAW_OPTIONS, "frictionRule", "frictionPairs"))
        values.choice(f"engines: contact['{key}']", value, LAW_OPTIONS[key])

    def mixing(functor):
        functor.frictionRule = rule
        for first, second, friction in known:
            functor.setFriction(first, second, *friction)
        return functor

    return options, mixing


def _pairs(pairs):
    if not isinstance(pairs, dict):
        remedy = "must be a dict such as {('rope', 'drum'): (0.3, 0.2)}"
        values.refuse("engines: contact['frictionPairs']", pairs, remedy, TypeError)
    return pairs.items()


def _frictionPair(pair, friction):
    """Ids of two materials in O.materials, and (mu_s, mu_k) of their contacts."""
    where = f"engines: contact['frictionPairs'][{pair!r}]"
    if not isinstance(pair, tuple) or len(pair) != 2:
        values.refuse(where, friction, "must be for a pair of materials, by label or id")
    ids = []
    for each in pair:
        material = anyMaterial(where, each)
        if material.id < 0:
            values.refuse(where, each, "append this material to O.materials first")
        ids.append(material.id)
    both = values.sequence(where, friction, "two coefficients, static and kinetic")
    if len(both) != 2:
        values.refuse(where, friction, "must be two coefficients, static and kinetic")
    return *ids, [values.notNegative(where, mu, "-") for mu in both]


def _appendAll(structures):
    """Appends what is not yet; returns the engines of all, each once."""
    shared = next((s.engine for s in structures if s.appended), None)
    for structure in structures:
        if not structure.appended:
            structure.append(engine=shared)
            shared = structure.engine
    return list({s.engine.family: s.engine for s in structures}.values())


def sweepLength(structure):
    """Sweep length that lets the collider rest for many steps [m]."""
    return max(structure.radius, 0.125 * float(structure._layout.length.min()))


def fastest():
    """Highest speed of bodies and cables in the scene, at least 1 m/s. ValueError for one that is
    not finite.
    """
    speeds = [1.0]
    for body in O.bodies:
        speed = body.state.vel.norm()
        if not math.isfinite(speed):
            values.refuse(
                f"O.bodies[{body.id}].state.vel", tuple(body.state.vel), "must be finite [m/s]"
            )
        speeds.append(speed)
    for engine in cableEngines():
        v = np.array(engine.velocity).reshape(3, -1)[:, : engine.nNodes]
        speeds.append(float(np.sqrt((v**2).sum(axis=0).max(initial=0))))
    return max(speeds)


def timeStep(engines=None, speed=None, law=None, lines=None):
    """The step for O.dt [s]: what the cables and lines allow, in the sub-steps they are told to take,
    what contacts of HollarsMat between other bodies allow that meet at a speed [m/s], and half the time
    that a sound wave takes through the smallest grain of another FrictMat (half of
    utils.PWaveTimeStep). Contacts of cables take sub-steps of their own inside it.

    Infinite if there are neither cables nor bodies that can meet.

    engines: CableEngines, lines: LineEngines, None: all in O.engines. law: a
    Law2_ScGeom_HollarsPhys_Hollars, None: that in O.engines.
    """
    engines = cableEngines() if engines is None else engines
    for i, engine in enumerate(values.sequence("timeStep: engines", engines, "CableEngines")):
        if not isinstance(engine, wrapper.CableEngine):
            values.refuse(f"timeStep: engines[{i}]", engine, "must be a CableEngine", TypeError)
    speed = fastest() if speed is None else values.positive("timeStep: speed", speed, "m/s")
    steps = [(law or _hollarsLaw()).contactTimeStep(speed), GRAIN_PART * _throughGrains()]
    stable = {engine.family: engine.criticalTimeStep() for engine in engines}
    for engine in engines:
        if engine.integrator == "implicit":
            steps.append(IMPLICIT_STEP)
            continue
        divides = engine.integrator == "leapfrog" and not engine.coupled
        inside = max(1, engine.substeps) if divides else 1
        steps.append(inside * stable[engine.family])
    lines = lineEngines() if lines is None else lines
    for line in lines:
        own = line.criticalTimeStep([*engines, *lines])
        pulled = [step for family, step in stable.items() if family in line.families]
        rate2 = sum(1 / step**2 for step in [own, *pulled])  # frequencies add up
        steps.append(rate2**-0.5 if rate2 else math.inf)
    return min(steps)


def _throughGrains():
    """Time of a sound wave through the smallest sphere of a FrictMat that is no HollarsMat and can
    meet another body of one [s].
    """

    def ofYade(body):
        mat = body.material
        return isinstance(mat, wrapper.FrictMat) and not isinstance(mat, wrapper.HollarsMat)

    grains = [b for b in O.bodies if b.shape and ofYade(b)]
    if len({b.clumpId if b.isClumpMember else b.id for b in grains}) < 2:
        return math.inf
    return min(
        (
            b.shape.radius * math.sqrt(b.material.density / b.material.young)
            for b in grains
            if isinstance(b.shape, wrapper.Sphere) and (b.dynamic or b.isClumpMember)
        ),
        default=math.inf,
    )


def _hollarsLaw():
    """The law of contacts between bodies in O.engines, or as it is by default."""
    for place in _place("InteractionLoop"):
        for functor in O.engines[place].lawDispatcher.functors:
            if isinstance(functor, wrapper.Law2_ScGeom_HollarsPhys_Hollars):
                return functor
    return wrapper.Law2_ScGeom_HollarsPhys_Hollars()


# ---- checks --------------------------------------------------------------------------------------


def check():
    """Raises RuntimeError or ValueError if the scene, as it is now, would fail silently or end
    YADE.

    Looks at periodicity, order of engines, collider settings, materials, what cables can meet
    (CableEngine.check), the functors of all pairs of bodies that can meet, and at the start at what
    overlaps. Warns of what is legal but hardly meant.
    """
    engines = cableEngines()
    if not engines:
        raise RuntimeError(
            "O.engines has no CableEngine: use ancf.engines(), or append a cable or net"
        )
    for engine in engines:
        engine.check()


def _checkFolded(net):
    """Warns of a body that lies in the folded net and does not belong to it."""
    low, high = net.knots.min(axis=0) - net.radius, net.knots.max(axis=0) + net.radius
    own = {number for _, number in net._attached}
    for body in _solids():
        reach = _halfSize(body)
        center = np.array(list(body.state.pos))
        if body.id not in own and (center + reach > low).all() and (center - reach < high).all():
            warnings.warn(
                f"{net.name}: {_name(body)} at {tuple(map(float, center))} reaches into the folded net, "
                "which unfolds inside it unless relax() or a move takes one of them away before the "
                "first step",
                stacklevel=3,
            )


def _solids():
    """Spheres and boxes."""
    return [b for b in O.bodies if isinstance(b.shape, (wrapper.Sphere, wrapper.Box))]


def _halfSize(body):
    """Half the sides of a body's bounding box (3) [m]."""
    if isinstance(body.shape, wrapper.Sphere):
        return np.full(3, body.shape.radius)
    return np.abs(matrix(body.state.ori)) @ np.array(list(body.shape.extents))


def _place(kind):
    """Places in O.engines of engines of a class."""
    return [i for i, e in enumerate(O.engines) if isinstance(e, getattr(wrapper, kind))]


def _name(body):
    label = f" {body.material.label!r}" if body.material and body.material.label else ""
    shape, material = type(body.shape).__name__, type(body.material).__name__
    return f"body {body.id} ({shape}, {material}{label})"
