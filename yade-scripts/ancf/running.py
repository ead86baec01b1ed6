"""Runs a scene: for a time, telling how far it is, or until it is at rest."""

import itertools
import math
from dataclasses import dataclass

import numpy as np
from yade import O, Vector3, wrapper

from . import values
from .needs import needed
from .structure import cableEngines


def progress(duration, every, title="run"):
    """Steps the scene on for `duration` [s] of its time and yields after every `every` [s], and at the end.
    A terminal shows a bar meanwhile, with the time that is left.

        for _ in ancf.progress(1.5, 5e-3):
            history.sample()

    Raises ValueError, TypeError that name the argument.
    """
    duration = values.positive("progress: duration", duration, "s")
    every = values.positive("progress: every", every, "s")
    return _steps(duration, every, title)


def _steps(duration, every, title):
    with needed("python3-tqdm"):  # only where something is shown
        from tqdm import tqdm

    form = "{desc} {percentage:3.0f}% |{bar}| {n:.3g} of {total:.3g} s simulated, {remaining} left"
    start = O.time
    with tqdm(
        total=duration, desc=title, leave=False, bar_format=form, mininterval=0.3, disable=None
    ) as bar:
        for k in range(1, math.ceil(duration / every * (1 - 1e-12)) + 1):
            stop = start + min(k * every, duration)
            if O.time >= stop - 0.5 * O.dt:
                continue  # `every` is shorter than a step
            while O.time < stop - 0.5 * O.dt:
                O.step()
            bar.update(min(O.time - start, duration) - bar.n)
            yield


# ---- to rest -------------------------------------------------------------------------------------

ALL = Vector3(1, 1, 1)


@dataclass
class _Mover:
    """A body that settle() may stop: 1 along the axes in which nothing leads it, else 0."""

    state: object
    free: Vector3
    turns: Vector3

    def kinetic(self):
        """Of what is free [J]."""
        s = self.state
        velocity, spin = _times(self.free, s.vel), s.ori.conjugate() * _times(self.turns, s.angVel)
        return 0.5 * (s.mass * velocity.squaredNorm() + s.inertia.dot(_times(spin, spin)))

    def stop(self):
        self.state.vel = _times(ALL - self.free, self.state.vel)
        self.state.angVel = _times(ALL - self.turns, self.state.angVel)
        self.state.angMom = _times(ALL - self.turns, self.state.angMom)


def _times(a, b):
    return Vector3(a[0] * b[0], a[1] * b[1], a[2] * b[2])


def _movers():
    """The bodies of the scene that something may still move, clumps as one."""
    carried = {i for engine in cableEngines() for i in engine.carryIds}
    loose, guided = set(), set()  # what drives leave free
    for engine in O.engines:
        if isinstance(engine, wrapper.SheaveEngine):
            free = zip(engine.ids, engine.speed, engine.scripted)
            loose |= {i for i, speed, scripted in free if math.isnan(speed) and scripted != 1}
        if isinstance(engine, wrapper.GuideEngine):
            guided |= {i for i, driven in zip(engine.ids, engine.driven) if not driven}
    found = []
    for body in O.bodies:
        if body.isClumpMember or body.state.mass <= 0 or not body.dynamic:
            continue
        blocked, moved = body.state.blockedDOFs, body.id in carried or body.id in guided
        free = Vector3(*(float(moved or axis not in blocked) for axis in "xyz"))
        turns = Vector3(*(float(body.id in loose or axis not in blocked) for axis in "XYZ"))
        if free.norm() or turns.norm():
            found.append(_Mover(body.state, free, turns))
    return found


def _kinetic(movers):
    """Energy of all that moves freely, and its mass [J], [kg]."""
    energy = mass = 0.0
    for engine in cableEngines():
        energy += engine.energy(0, engine.nElements)["kinetic"]
        mass += float(np.dot(engine.rhoA, engine.length))
    for mover in movers:
        energy += mover.kinetic()
        mass += mover.state.mass
    return energy, mass


def stop():
    """Takes all speeds out: of cables, and of bodies in all directions in which nothing leads them."""
    _stop(_movers())


def _stop(movers):
    for engine in cableEngines():
        engine.velocity = [0.0] * len(engine.velocity)
    for mover in movers:
        mover.stop()


def settle(tolerance=5e-3, limit=10.0, every=1e-3):
    """Lets the whole scene come to rest, cables and bodies with their contacts and friction: whenever
    the kinetic energy has begun to fall, all speeds are taken out (stop), until no more come up. Some
    stops follow soon, for what rings, some late, for what swings slowly.

    tolerance   acceleration that still comes up after a stop, on the mean over all mass and 64
                `every`, as part of gravity, or of the largest so far where there is none. Hollars
                friction holds by creeping: what leans on it does not come below a thousandth or so
    limit       time of the scene after which it gives up [s]: RuntimeError
    every       how often it looks [s]

    Returns the time of the scene that it took [s]; O.time has gone on by it. What leads bodies or
    knots goes on leading them. Energies that O.trackEnergy counts do not balance over it: speeds are
    taken out.
    """
    tolerance = values.positive("settle: tolerance", tolerance, "-")
    limit = values.positive("settle: limit", limit, "s")
    steps, start, largest = stepsOf(every), O.time, _gravity()
    for stopped, speed, time in calming(steps, WAITS):
        if not _gravity():
            largest = max(largest, speed / time)
        long = time > (WAITS[-1] - 0.5) * steps * O.dt
        if stopped and long and speed <= tolerance * largest * time:
            return O.time - start
        if O.time - start >= limit:
            raise RuntimeError(
                f"settle: after {limit:g} s the scene still comes up to {speed:.3g} m/s on the mean: "
                "something is led, slides on or falls; raise limit or tolerance, or hold it"
            )


WAITS = (1, 2, 4, 8, 16, 32, 64)  # looks from one stop to the next at least, in turn


def stepsOf(every):
    """Steps in a time that settle is told, at least one."""
    return max(1, round(values.positive("settle: every", every, "s") / O.dt))


def calming(steps, waits=(1,)):
    """Steps the scene on for ever, and takes all speeds out whenever kinetic energy has begun to fall.
    Yields after every so many steps whether they were taken out, the largest mean speed [m/s] since
    they were taken out before, and the time since then [s].

    waits: so many looks pass from one stop to the next at least, in turn
    """
    movers = _movers()
    for wait in itertools.cycle(waits):
        before, reached, looks, stopped = 0.0, 0.0, 0, False
        while not stopped:
            for _ in range(steps):
                O.step()
            energy, mass = _kinetic(movers)
            speed = math.sqrt(2 * energy / mass) if mass > 0 else 0.0
            looks += 1
            reached = max(reached, speed)
            stopped = looks >= wait and (speed < before or speed == 0)
            if stopped:
                _stop(movers)
            yield stopped, reached, looks * steps * O.dt
            before = speed


def _gravity():
    """What NewtonIntegrator lets fall [m/s2]."""
    return max(
        (e.gravity.norm() for e in O.engines if isinstance(e, wrapper.NewtonIntegrator)),
        default=0.0,
    )
