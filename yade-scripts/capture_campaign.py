"""When does a net catch a ball? Random captures over speed, angle, distance, offset and spin.

`/usr/bin/python3 capture_campaign.py --runs 10000 --workers 2` makes them, and goes on where it was
interrupted; --scheduler takes the workers of a Dask scheduler; --quick is a short form for tests.
Results, maps and sensitivities go to out/capture_campaign/.
"""

import argparse
import csv
import math
import pathlib
import sys

import numpy as np

import ancf
import ball_capture as given
from ancf import campaign
from ancf.campaign import maps, statistics
from ancf.capture import Capture
from yade import O, Vector3, utils

# ---- parameters, SI units; those of cables, bullets and contacts are ball_capture's --------------
VARY = dict(  # about the study's 1.5 m/s, 25 deg, 1 m
    speed=campaign.uniform(0.75, 2.25),  # of the bullets [m/s]
    angle=campaign.uniform(5, 45),  # between their velocity and x [deg]
    distance=campaign.uniform(0.5, 1.5),  # from the net to the ball's centre, along x [m]
    offset=campaign.uniform(0, 0.4),  # of the ball's centre, sideways along y [m]
    spin=campaign.uniform(-20, 20),  # of the ball about z [rad/s]
)
# The study's net has 6 x 6 meshes of 0.08 m and three contact points inside each element. This one is as
# large, and the ball, 0.16 m thick, does not fit through it either; it costs several times less.
MESHES = 4  # a side
MESH_LENGTH = 0.12  # [m]
CONTACT_POINTS = 2  # inside each element
FOLD = 0.65  # size of the folded net as part of the open one: it is half open when it is shot
SAMPLE = 5e-3  # time between two looks at a capture [s]
NEVER = 10**9  # samples between two looks at hull and enclosure, which nobody asks for here
LATEST = 2.5  # end of a capture without one, in times of the bullets' way to the ball
INTERRUPTED = 130  # exit code after Ctrl-C
HALVINGS = 3  # of the step, at most, where the energy does not balance

LABELS = dict(
    speed="speed [m/s]",
    angle="shooting angle [°]",
    distance="distance [m]",
    offset="lateral offset [m]",
    spin="spin [rad/s]",
)
MAPS = [("speed", "angle"), ("distance", "offset"), ("angle", "offset")]
BINS = 6


def build(speed, angle, distance, offset, spin):
    """A net that flies at a ball, which is held in its place and spins. Returns the net and the ball's id."""
    a = given.ASSUMED
    O.reset()
    given.appendMaterials()
    center = (distance, offset, 0)
    ball = O.bodies.append(utils.sphere(center, given.BALL_RADIUS, material="ball", fixed=True))
    net = ancf.Net.square(
        MESHES,
        MESH_LENGTH,
        diameter=a["diameter"],
        material="cable",
        contactPoints=CONTACT_POINTS,
        damping=a["damping"],
        mass=given.MASS,
        normal=(1, 0, 0),
        fold=FOLD,
        selfContact=given.SELF_CONTACT,
    )
    net.addBullets(given.BULLET_MASS, a["bulletRadius"], speed, math.radians(angle))
    O.engines = ancf.engines(net)
    O.bodies[ball].state.angVel = Vector3(0, 0, spin)
    ancf.check()
    return net, ball


def follow(net, ball, until):
    """Steps a capture to its embrace or its end. Returns its results."""
    capture = Capture(net, ball, every=NEVER)
    every = max(1, round(SAMPLE / O.dt))
    while O.time < until and not capture.embraced:
        for _ in range(every):
            O.step()
        capture.sample()
    since = capture.embraced[0] if capture.embraced else math.nan
    return dict(
        embraced=capture.embraced is not None,
        embracedAt=since,  # [s]
        firstContact=math.nan if capture.contact is None else capture.contact,  # [s]
        mouth=float(capture.share[-1]),  # at the end, as part of the largest
        penetration=net.engine.maxPenetration,  # [m]
        steps=O.iter,
    )


def run(speed, angle, distance, offset, spin):
    """One capture, again with half the step where its energy does not balance."""
    until = LATEST * distance / (speed * math.cos(math.radians(angle)))
    for halvings in range(HALVINGS + 1):
        net, ball = build(speed, angle, distance, offset, spin)
        O.dt *= 0.5**halvings
        try:
            return dict(follow(net, ball, until), halvings=halvings)
        except RuntimeError as error:
            if "out of balance" not in str(error) or halvings == HALVINGS:
                raise


# ---- what came out -------------------------------------------------------------------------------


def report(results, folder):
    """Prints and writes probability, sensitivities and maps."""
    runs, finished, failed = results.count()
    columns = results.columns()
    success = columns["embraced"]
    print(f"{finished} of {runs} captures, {failed} failed")
    for error, number in results.errors().items():
        print(f"  {number} x {error}")
    for name, method in (("Wilson", "wilson"), ("Clopper-Pearson", "exact")):
        print(f"embraced, 95 % by {name}: {statistics.probability(success, method=method)}")
    cost = columns["cpuSeconds"]
    print(
        f"cost of a capture: {cost.mean():.3f} s of processor time, {np.median(cost):.3f} s half of them; "
        f"10,000 on two cores: {1e4 * cost.mean() / 2 / 60:.0f} min"
    )
    results.writeCsv(folder / "captures.csv")
    maps.plotMaps(folder / "maps.png", columns, success, MAPS, LABELS, BINS)
    sensitivities({name: columns[name] for name in VARY}, success, folder / "sensitivities.csv")


def sensitivities(parameters, success, file):
    """Writes and prints how much each parameter matters."""
    head = ["parameter", "rank correlation", "odds ratio", "from", "to"]
    head += [f"fifth {k + 1}" for k in range(statistics.GROUPS)] + ["by chance"]
    rows = [
        [s.name, f"{s.rank:.3f}", *(f"{x:.3f}" for x in (s.oddsRatio, s.low, s.high))]
        + [f"{group.share:.3f}" for group in s.groups]
        + [f"{s.chance:.1e}"]
        for s in statistics.sensitivities(parameters, success)
    ]
    with open(file, "w", newline="", encoding="utf-8") as out:
        csv.writer(out).writerows([head, *rows])
    for row in [head, *rows]:
        print("  " + "  ".join(text.ljust(16 if k < 2 else 10) for k, text in enumerate(row)))


def options():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=300, help="captures, %(default)s")
    parser.add_argument("--workers", type=int, default=2, help="processes on this machine")
    parser.add_argument("--scheduler", help="take the workers of this Dask scheduler instead")
    parser.add_argument("--quick", action="store_true", help="24 captures, anew")
    parser.add_argument("--out", type=pathlib.Path, default="out/capture_campaign", help="folder")
    return parser.parse_args()


def main():
    args = options()
    args.out.mkdir(parents=True, exist_ok=True)
    table = campaign.draw(24 if args.quick else args.runs, **VARY)
    file = args.out / "captures.db"
    if args.quick:
        file.unlink(missing_ok=True)
    try:
        campaign.run(__file__, table, file, args.workers, args.scheduler, limit=600).close()
        broken = False
    except KeyboardInterrupt:
        print("\nso far; the same command goes on:")
        broken = True
    if not file.exists():
        return INTERRUPTED
    with campaign.Results(file) as results:
        _, finished, failed = results.count()
        if finished > failed:
            report(results, args.out)
        return INTERRUPTED if broken else int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
