"""Scenes that yade.mpy spreads over processes: grains on all of them, the cables on one.

mpy shows each process the bodies of the others that come near, moves its own, and exchanges places
and velocities. That is enough for contacts whose forces both sides can compute. Contacts of cables
are solved together with the cable, by its process alone: so, in every step, it is told the forces on
the others' bodies that are near before it solves, and tells forces and velocities back afterwards.
"""

import sys

from yade import O, wrapper

from . import values
from .structure import cableEngines

OWN = 1 << 28  # bit of groupMask by which bodies of cables meet others, instead of SHARED
SHARED = 1  # that of the bodies by which mpy finds out what is near
STATE = ("pos", "ori", "vel", "angVel", "angMom")
FORCES, STATES = 8701, 8702  # tags of messages
DRIVES = (wrapper.SheaveEngine, wrapper.GuideEngine, wrapper.LineEngine)

_rank = None  # of the cables


def spread(rank=1):
    """Puts all cables, and the bodies that their knots carry or follow, on one process of
    yade.mpy.mpirun. Call it in every process, once the scene is complete and body.subdomain says
    where the other bodies are.

    rank         of the cables, from 1 on: mpy keeps 0 for what does not move

    Sets the engines to what mpy knows: NewtonIntegrator instead of CableNewton, and one of
    them before and one behind the CableEngine, which exchange forces. Raises ValueError, TypeError or
    RuntimeError that name what cannot be spread.
    """
    global _rank
    rank = values.count("mpi.spread: rank", rank, 1)
    cables = cableEngines()
    own = _bodiesOf(cables)
    _check(cables, own)
    _rank = rank
    for body in O.bodies:
        if body.id in own:
            body.subdomain = rank
            body.mask = body.mask & ~SHARED | OWN if body.mask & SHARED else body.mask
        elif body.mask & SHARED:
            body.mask |= OWN
    O.engines = _engines()


def ask(read):
    """What a function without arguments returns in the process of the cables, such as
    `lambda: rope.point(0.5)`, for all processes. Call it in all, after mpirun.
    """
    mpy = sys.modules["yade.mpy"]
    if not callable(read):
        values.refuse("mpi.ask: read", read, "must be a function without arguments", TypeError)
    return mpy.comm.bcast(read() if mpy.rank == _rank else None, root=_rank)


def _check(cables, own):
    if not cables:
        raise RuntimeError("mpi.spread: O.engines has no CableEngine: set O.engines first")
    if "yade.mpy" not in sys.modules:
        raise RuntimeError("mpi.spread: `from yade import mpy` first, and mpy.mpirun afterwards")
    for engine in O.engines:
        if isinstance(engine, DRIVES):
            raise RuntimeError(
                f"mpi.spread: O.engines has a {type(engine).__name__}, which cannot be spread over "
                "processes: take O.run and threads (yade -j)"
            )
    for body in O.bodies:
        if body.isClump or body.isClumpMember:
            raise RuntimeError(
                f"mpi.spread: body {body.id} belongs to a clump, which cannot be spread over "
                "processes: take O.run and threads (yade -j)"
            )
        if body.subdomain == 0 and body.dynamic and body.id not in own:
            values.refuse(
                f"O.bodies[{body.id}].subdomain",
                0,
                "it may move, and mpy moves nothing on rank 0: give it another, from 1 on",
            )
        if body.mask & OWN:
            values.refuse(f"O.bodies[{body.id}].mask", body.mask, f"has bit 28 ({OWN}), taken here")


def _isElement(body):
    return isinstance(body.shape, wrapper.CableElement)


def _bodiesOf(cables):
    """Ids of elements, and of bodies that knots carry or follow."""
    own = {body.id for body in O.bodies if _isElement(body)}
    for engine in cables:
        own |= {*engine.carryIds, *engine.followIds}
    return own


def _engines():
    engines = list(O.engines)
    for k, engine in enumerate(engines):
        if isinstance(engine, wrapper.InsertionSortCollider):
            engine.label = "collider"  # mpy's name for it
        elif isinstance(engine, wrapper.CableNewton):
            kept = {name: engine.dict()[name] for name in ("gravity", "damping", "label")}
            engines[k] = wrapper.NewtonIntegrator(**kept)
    places = [k for k, engine in enumerate(engines) if isinstance(engine, wrapper.CableEngine)]
    first, last = places[0], places[-1]
    return [
        *engines[:first],
        _runner("before"),
        *engines[first : last + 1],
        _runner("after"),
        *engines[last + 1 :],
    ]


def _runner(name):
    command = f"import sys; sys.modules['ancf.mpi'].{name}()"
    return wrapper.PyRunner(command=command, iterPeriod=1, initRun=True)


# ---- in every step ---------------------------------------------------------------------------------


def _near(mpy):
    """Ranks whose bodies are near to ours."""
    return [rank for rank in O.subD.intersections[mpy.rank] if rank]


def _forces(ids):
    return [(O.forces.f(i, True), O.forces.t(i, True)) for i in ids]


def _setForces(ids, forces):
    for i, (force, torque) in zip(ids, forces):
        O.forces.addF(i, force - O.forces.f(i, True))
        O.forces.addT(i, torque - O.forces.t(i, True))


def before():
    """The cables' process gets the forces on the others' bodies, as their own processes know them."""
    mpy = sys.modules["yade.mpy"]
    if not getattr(O, "splitted", False):
        raise RuntimeError(
            f"the cables are on rank {_rank} of yade.mpy: run this scene by mpy.mpirun, and read it by "
            "ancf.mpi.ask"
        )
    for engine in cableEngines():
        engine.dead = mpy.rank != _rank
    if mpy.rank == 0:
        return
    if mpy.rank == _rank:
        for rank in _near(mpy):
            _setForces(O.subD.mirrorIntersections[rank], mpy.comm.recv(source=rank, tag=FORCES))
    elif _rank in _near(mpy):
        mpy.comm.send(_forces(O.subD.intersections[_rank]), dest=_rank, tag=FORCES)


def after():
    """The others get what cables did to their bodies."""
    mpy = sys.modules["yade.mpy"]
    if mpy.rank == 0:
        return
    if mpy.rank == _rank:
        for rank in _near(mpy):
            ids = O.subD.mirrorIntersections[rank]
            states = [[getattr(O.bodies[i].state, name) for name in STATE] for i in ids]
            mpy.comm.send((_forces(ids), states), dest=rank, tag=STATES)
    elif _rank in _near(mpy):
        ids = O.subD.intersections[_rank]
        forces, states = mpy.comm.recv(source=_rank, tag=STATES)
        _setForces(ids, forces)
        for i, state in zip(ids, states):
            for name, value in zip(STATE, state):
                setattr(O.bodies[i].state, name, value)
