"""What becomes of scenes: each in a process of its own, its energy summed up as it runs."""

import argparse
import collections
import functools
import math
import multiprocessing
import multiprocessing.connection
import os
import time
import warnings

os.environ.setdefault("OMP_NUM_THREADS", "1")

import ancf  # noqa: E402, F401  loads the classes
from yade import O  # noqa: E402

BETWEEN = 10  # steps between two looks at O.energy
SOUND, LATE = 0.02, 0.05  # share of the largest energy so far
SLOWEST = 300.0  # [s] a scene may take
STORED = ("kinetic", "cableKinetic", "cableElastic", "contactElastic")

# What became of a scene; those of FAULTS must not happen.
FAULTS = ("silent", "late", "not finite", "hang", "signal")


def driftOfYade():
    """What O.energy loses in a step [J]: NewtonIntegrator counts the work of gravity at velocities after its
    kick alone, not at the mean of those before and after, so m g^2 dt^2/2 for each free body.
    """
    mass = sum(
        b.state.mass for b in O.bodies if b.dynamic and b.isStandalone and b.state.blockedDOFs == ""
    )
    return mass * O.engines[-1].gravity.squaredNorm() * O.dt**2 / 2


def rounding():
    """What the last digits of places make of energy [J]: strains of 1e-12 in all cables."""
    cables = [e for e in O.engines if hasattr(e, "nElements")]
    return sum(ea * length for e in cables for ea, length in zip(e.ea, e.length)) * 1e-24


def run(steps, work=lambda: 0.0, first=1):
    """Runs the scene in O. Returns what became of it, the worst share of the largest energy by
    which it was out of balance, contacts under way included, and what was told. What counts is the
    share at the end, or at the stop.

    work: called after every step, tells what was done on the scene so far by what O.energy does not
    know of [J]. first: step whose energies all others are compared with; what contacts store is known
    from the second step on.
    """
    start, most, share, worst = None, rounding(), 0.0, 0.0
    drift = driftOfYade()
    try:
        while O.iter < steps:
            O.step()
            done = work()
            if O.iter < first or (O.iter % BETWEEN and start is not None):
                continue
            items = dict(O.energy.items())
            now = sum(items.values()) + O.iter * drift - done
            most = max(most, sum(items.get(name, 0.0) for name in STORED))
            start = now if start is None else start
            if not math.isfinite(now):
                return "not finite", math.inf, f"iteration {O.iter}"
            share = abs(now - start) / most
            worst = max(worst, share)
    except (RuntimeError, ValueError) as error:
        told = " ".join(str(error).split())
        kind = "stopped by the watch" if "out of balance" in told else "stopped by name"
        return (kind if share < LATE else "late"), worst, told
    return ("sound" if share < SOUND else "silent"), worst, ""


def outcome(build, ride):
    """(what became of it, worst share, what was told) of a scene that `build` sets up, whose result
    `ride` takes and runs.
    """
    warnings.simplefilter("ignore")
    O.reset()
    O.trackEnergy = True
    try:
        built = build()
    except (RuntimeError, ValueError) as error:
        return "refused", 0.0, " ".join(str(error).split())
    return ride(built)


def _child(act, case, pipe):
    pipe.send(act(case))
    pipe.close()
    os._exit(0)  # nothing of YADE's is left to end


def each(act, cases, jobs, slowest=SLOWEST):
    """Yields (case, *act(case)) for each, as they end, in forks of this process; what takes longer
    than `slowest` [s] hangs.
    """
    context = multiprocessing.get_context("fork")
    waiting, running = list(cases)[::-1], {}
    while waiting or running:
        while waiting and len(running) < jobs:
            case = waiting.pop()
            here, there = context.Pipe(duplex=False)
            process = context.Process(target=_child, args=(act, case, there))
            process.start()
            there.close()
            running[process] = case, here, time.monotonic()
        multiprocessing.connection.wait([pipe for _, pipe, _ in running.values()], timeout=1.0)
        for process, (case, pipe, began) in list(running.items()):
            if pipe.poll():
                try:
                    result = pipe.recv()
                except EOFError:
                    process.join()
                    result = "signal", math.inf, f"exit code {process.exitcode}"
            elif time.monotonic() - began > slowest:
                process.kill()
                result = "hang", math.inf, f"{slowest:g} s"
            else:
                continue
            process.join()
            pipe.close()
            del running[process]
            yield (case, *result)


def command(doc, scene, steps, **more):
    """What a script of random scenes does by its command line; its exit code.

    doc      of the script; the first line is told by --help
    scene    (seed, steps=, ...) -> (what became of it, worst share, what was told)
    steps    of a scene, if --steps says nothing else
    more     further options, each as what argparse takes, which `scene` knows by their names
    """
    parser = argparse.ArgumentParser(description=doc.split("\n")[0])
    parser.add_argument("count", nargs="?", type=int, default=100)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--steps", type=int, default=steps)
    parser.add_argument("--seed", type=int, help="this one alone, in this process")
    for name, option in more.items():
        parser.add_argument(f"--{name}", **option)
    args = parser.parse_args()
    one = functools.partial(scene, **{name: getattr(args, name) for name in ("steps", *more)})
    if args.seed is not None:
        print(args.seed, *one(args.seed))
        print(dict(O.energy.items()))
        return 0
    counts, worst = collections.Counter(), 0.0
    for seed, end, share, told in each(one, range(args.first, args.first + args.count), args.jobs):
        print(f"{seed} {end} {share:.1e} {told}", flush=True)
        counts[end] += 1
        worst = max(worst, share) if end == "sound" else worst
    print(
        ", ".join(f"{end} {n}" for end, n in counts.most_common()),
        f"; worst of sound ones {worst:.1e}",
    )
    return int(any(counts[fault] for fault in FAULTS))
