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
from ancf.capture import CLOSED, HOLD
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
LATEST = 2.5  # end of a capture without one, in times of the bullets' way to the ball
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
    """A net that flies at a ball, which is held in its place and spins. Returns the net."""
    a = given.ASSUMED
    O.reset()
    O.materials.append(given.material("cable", given.YOUNG, given.POISSON, a["density"]))
    O.materials.append(given.material("ball", a["ballYoung"], a["ballPoisson"], 2700))
    center = (distance, offset, 0)
    ball = utils.sphere(center, given.BALL_RADIUS, material="ball", fixed=True)
    O.bodies.append(ball)
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
        selfContact=True,
    )
    net.addBullets(given.BULLET_MASS, a["bulletRadius"], speed, math.radians(angle))
    O.engines = ancf.engines(net)
    ball.state.angVel = Vector3(0, 0, spin)
    ancf.check()
    return net


class Embrace:
    """Looks whether a net embraces a ball: its four bullets are beyond the ball's centre, and its mouth
    is below CLOSED of its largest area, for HOLD at least, as in ancf.capture.
    """

    def __init__(self, net, distance):
        self.net, self.distance = net, distance
        self.largest, self.start, self.longest = 0.0, None, 0.0

    def sample(self):
        area = self.net.mouthArea()
        self.largest = max(self.largest, area)
        self.mouth = area / self.largest
        beyond = all(O.bodies[i].state.pos[0] > self.distance for i in self.net.bullets)
        if not (beyond and self.mouth < CLOSED):
            self.start = None
            return
        self.start = O.time if self.start is None else self.start
        self.longest = max(self.longest, O.time - self.start)

    @property
    def held(self):
        return self.longest >= HOLD


def capture(net, distance, until):
    """Steps a capture to its embrace or its end. Returns its results."""
    embrace, touched = Embrace(net, distance), math.nan
    every = max(1, round(SAMPLE / O.dt))
    while O.time < until and not embrace.held:
        for _ in range(every):
            O.step()
        embrace.sample()
        if math.isnan(touched) and net.engine.contacts:
            touched = O.time
    return dict(
        embraced=embrace.held,
        embracedAt=embrace.start if embrace.held else math.nan,  # [s]
        longest=embrace.longest,  # time for which it was embraced [s]
        firstContact=touched,  # [s]
        mouth=embrace.mouth,  # at the end, as part of the largest
        penetration=net.engine.maxPenetration,  # [m]
        steps=O.iter,
    )


def run(speed, angle, distance, offset, spin):
    """One capture, again with half the step where its energy does not balance."""
    until = LATEST * distance / (speed * math.cos(math.radians(angle)))
    for halvings in range(HALVINGS + 1):
        net = build(speed, angle, distance, offset, spin)
        O.dt *= 0.5**halvings
        try:
            return dict(capture(net, distance, until), halvings=halvings)
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
    parser.add_argument("--runs", type=int, default=10000)
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
    except KeyboardInterrupt:
        print("\nso far; the same command goes on:")
    with campaign.Results(file) as results:
        report(results, args.out)
        return 1 if results.count()[2] else 0


if __name__ == "__main__":
    sys.exit(main())
