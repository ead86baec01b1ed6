"""A geogrid is pulled out of a bed of grains: force against displacement, beside YADE's own grid.

Grains fill a box with smooth walls, a grid lies half-way up, and a lid presses on them. The grid's front row is
drawn out through the front wall at a constant speed. The grid is a net of ANCF cables, or of YADE's GridNode and
GridConnection of the same ribs, and each lies in several beds, as one bed tells little of the next. Run it by `/usr/bin/python3 geogrid.py`; --help tells the options. Results go to
out/.
"""

import argparse
import csv
import sys

from jobs import addOption, runAll  # first: see there

import ancf
import grains
import numpy as np
from yade import O, Vector3, gridpfacet, utils, wrapper

# ---- parameters, SI units ----------------------------------------------------------------------
GRAVITY = 9.81
BOX = (0.42, 0.28)  # inside, x and y [m]
RIBS = (7, 5)  # knots along x and y; the front row is outside
MESH = 0.06  # [m]
RIB = 4e-3  # diameter [m]
RIB_YOUNG = 5e8  # a third of polypropylene's, so that steps are long: ribs strain by 2 % [Pa]
RIB_DENSITY = 950  # [kg/m3]
RIB_DAMPING = 1e-5  # Kelvin-Voigt time [s]
RADIUS, SPREAD = 0.018, 0.2  # of grains: the smallest [m], how much larger the largest are
GRAIN_YOUNG = 2e7  # so that grains give way by some 0.1 % of their radius [Pa]
GRAIN_DENSITY = 2600  # [kg/m3]
FRICTION = 0.5  # between grains, and of grains on ribs
COUNT = 200  # grains below the grid, and as many above
PRESSURES = (1e3, 4e3)  # of the lid [Pa]
BEDS = 3  # that differ by chance
SPEED, WAY = 0.1, 0.015  # of the front row [m/s], [m]
QUICK_COUNT, QUICK_WAY = 54, 0.003
DAMPING = 0.1  # NewtonIntegrator.damping while the bed comes to rest; with more of it, it sinks for longer
REST = 0.05 * SPEED  # of grains at rest, root mean square [m/s]
SETTLE = 0.1, 1.5  # time that each half of the bed takes to come to rest, at least and at most [s]
SAMPLE = 1e-3  # [s]
# Masks: the grid goes through the walls, and so does the lid; GridConnections do not meet each other.
GRID, WALLS, LID, RIBS_APART = 1, 2, 8, 4
GRAINS = GRID | WALLS | LID


def walls():
    """The box without a lid: ids of front, back, and all others."""
    x, y = BOX
    t, high = 0.02, 0.4

    def wall(center, half):
        body = utils.box(center, half, material="smooth", fixed=True, mask=WALLS)
        return O.bodies.append(body)

    front = wall((-t, y / 2, high / 2), (t, y / 2 + 2 * t, high / 2))
    back = wall((x + t, y / 2, high / 2), (t, y / 2 + 2 * t, high / 2))
    wall((x / 2, -t, high / 2), (x / 2, t, high / 2))
    wall((x / 2, y + t, high / 2), (x / 2, t, high / 2))
    wall((x / 2, y / 2, -t), (x / 2, y / 2, t))
    return front, back


def materials():
    for label, friction in (("grain", FRICTION), ("smooth", 0.0)):
        O.materials.append(
            wrapper.FrictMat(
                label=label,
                young=GRAIN_YOUNG,
                poisson=0.3,
                density=GRAIN_DENSITY,
                frictionAngle=float(np.arctan(friction)),
            )
        )


def points(height):
    """Knots of the grid, row by row from the front, and pairs of them."""
    n, w = RIBS
    side = 0.5 * (BOX[1] - (w - 1) * MESH)
    knots = [((i - 0.5) * MESH, side + j * MESH, height) for i in range(n) for j in range(w)]
    pairs = [(w * i + j, w * i + j + w) for i in range(n - 1) for j in range(w)]
    pairs += [(w * i + j, w * i + j + 1) for i in range(n) for j in range(w - 1)]
    return knots, pairs


class Cables:
    """The grid as a net of ANCF cables, each rib an element."""

    name = "ANCF net"

    def __init__(self, height):
        O.materials.append(
            ancf.HollarsMat(
                label="rib",
                young=RIB_YOUNG,
                poisson=0.3,
                density=RIB_DENSITY,
                staticFriction=FRICTION,
                kineticFriction=FRICTION,
                transitionVelocity=1e-3,
            )
        )
        knots, pairs = points(height)
        self.net = ancf.Net(
            knots,
            pairs,
            diameter=RIB,
            material="rib",
            damping=RIB_DAMPING,
            mass="lumped",
            contactPoints=1,
            mask=GRID,
        )
        self.crane = grains.Crane(self.net, range(RIBS[1]))

    def engines(self):
        return ancf.engines(self.net, gravity=(0, 0, -GRAVITY))

    def step(self):
        return ancf.timeStep(speed=1.0)

    def pull(self, speed):
        self.crane.move((-speed, 0, 0))

    def force(self):
        return -self.crane.force()[0]

    def knots(self):
        return self.net.knots


class Grid:
    """The grid as GridNodes and GridConnections."""

    name = "GridNode, GridConnection"

    def __init__(self, height):
        O.materials.append(
            wrapper.CohFrictMat(
                label="node",
                young=RIB_YOUNG,
                poisson=0.3,
                density=RIB_DENSITY,
                frictionAngle=float(np.arctan(FRICTION)),
                normalCohesion=1e12,
                shearCohesion=1e12,
                momentRotationLaw=True,
            )
        )
        O.materials.append(
            wrapper.FrictMat(
                label="rib",
                young=RIB_YOUNG,
                poisson=0.3,
                density=RIB_DENSITY,
                frictionAngle=float(np.arctan(FRICTION)),
            )
        )
        knots, self.pairs = points(height)
        O.engines = self.engines()  # they make what joins the nodes
        r = RIB / 2
        self.nodes = [O.bodies.append(gridpfacet.gridNode(p, r, material="node")) for p in knots]
        for a, b in self.pairs:
            rib = gridpfacet.gridConnection(
                self.nodes[a], self.nodes[b], r, material="rib", mask=GRID | RIBS_APART
            )
            O.bodies.append(rib)
        self.front = self.nodes[: RIBS[1]]
        for node in self.front:
            O.bodies[node].state.blockedDOFs = "xyzXYZ"

    def engines(self):
        bounds = [getattr(wrapper, f"Bo1_{s}_Aabb")() for s in ("Sphere", "Box", "GridConnection")]
        return [
            wrapper.ForceResetter(),
            wrapper.InsertionSortCollider(
                bounds, verletDist=0.2 * RADIUS, avoidSelfInteractionMask=RIBS_APART
            ),
            wrapper.InteractionLoop(
                [
                    wrapper.Ig2_Sphere_Sphere_ScGeom(),
                    wrapper.Ig2_Box_Sphere_ScGeom(),
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
                    wrapper.Law2_ScGeom_FrictPhys_CundallStrack(),
                    wrapper.Law2_ScGeom6D_CohFrictPhys_CohesionMoment(),
                    wrapper.Law2_ScGridCoGeom_FrictPhys_CundallStrack(),
                ],
            ),
            wrapper.NewtonIntegrator(damping=0, gravity=Vector3(0, 0, -GRAVITY)),
        ]

    def step(self):
        """0.7 of what node and grain allow [s]."""
        ea, length = RIB_YOUNG * np.pi * RIB**2 / 4, MESH
        node = O.bodies[self.nodes[RIBS[1] + 1]].state
        bend = RIB_YOUNG * np.pi * RIB**4 / 64 * 4 / length
        w2 = max(8 * ea / length / node.mass, 8 * bend / node.inertia[0])
        grain = RADIUS * np.sqrt(GRAIN_DENSITY / GRAIN_YOUNG)
        return 0.7 * min(2 / np.sqrt(w2), grain)

    def pull(self, speed):
        for node in self.front:
            O.bodies[node].state.vel = Vector3(-speed, 0, 0)

    def force(self):
        return sum(O.forces.f(node)[0] for node in self.front)

    def knots(self):
        return grains.places(self.nodes)


class Pullout:
    """One pull-out and what is measured in it; kind is Cables or Grid, bed a number."""

    def __init__(self, kind, pressure, bed=0, quick=False):
        count = QUICK_COUNT if quick else COUNT
        O.reset()
        materials()
        front, back = walls()
        low = self.low = grainsIn(0.0, count, (bed, 1))
        settleBed(low)
        self.grid = kind(grains.places(low)[:, 2].max() + 1.2 * RADIUS + RIB / 2)
        floor = grains.places(low)[:, 2].max() + 1.2 * RADIUS + RIB
        self.high = grainsIn(floor, count, (bed, 2))
        self.lid = lid(grains.places(self.high)[:, 2].max() + 1.2 * RADIUS, pressure)
        self.above = GRAVITY * (grains.mass(self.high) + O.bodies[self.lid].state.mass)
        self.kind, self.pressure, self.walls = kind, pressure, (front, back)
        if kind is Cables:
            O.engines = self.grid.engines()
        O.dt = self.grid.step()
        self.moving = settle([*low, *self.high])
        self.way, self.force, self.wall = [], [], []

    def run(self, way):
        """Draws the front row out for a way [m]; forces are means over SAMPLE."""
        self.grid.pull(SPEED)
        O.trackEnergy = True
        O.step()
        self.energy, self.work, since = O.energy.total(), 0.0, O.time
        lifted = O.energy["gravWork"]
        cost, every = grains.Cost(), max(1, round(SAMPLE / O.dt))
        while O.time < since + way / SPEED:
            pull, bear = 0.0, 0.0
            for _ in range(every):
                O.step()
                pull += self.grid.force() / every
                bear -= sum(grains.force(w)[0] for w in self.walls) / every
            self.work += pull * SPEED * every * O.dt
            self.way.append(SPEED * (O.time - since))
            self.force.append(pull)
            self.wall.append(bear)
        self.cost = cost.stop()
        self.gained = O.energy.total() - self.energy
        self.turnover = self.work + abs(O.energy["gravWork"] - lifted)
        return self

    @property
    def late(self):
        """Mean force over the last third [N]."""
        return float(np.mean(self.force[2 * len(self.force) // 3 :]))

    @property
    def share(self):
        """Mean force of the last third over twice the weight above the grid."""
        return self.late / (2 * self.above)

    @property
    def wallsBear(self):
        """The same mean of what both walls bear along [N]: in a slow pull nothing else does."""
        return float(np.mean(self.wall[2 * len(self.wall) // 3 :]))


def grainsIn(low, count, seed):
    """Loose layers of grains above z = low; returns their ids."""
    rng, pitch = np.random.default_rng(seed), 2.1 * RADIUS * (1 + SPREAD)
    nx, ny = (int(side / pitch) for side in BOX)
    ids = []
    for k in range(count):
        layer, place = divmod(k, nx * ny)
        i, j = divmod(place, ny)
        p = np.array(
            [(i + 0.5) * BOX[0] / nx, (j + 0.5) * BOX[1] / ny, low + pitch * (layer + 0.5)]
        )
        p += 0.05 * RADIUS * rng.uniform(-1, 1, 3)
        r = RADIUS * (1 + SPREAD * rng.uniform())
        ids.append(O.bodies.append(utils.sphere(p, r, material="grain", mask=GRAINS)))
    return ids


def settle(bodies):
    """Lets grains come to rest; returns their speed then [m/s]."""
    least, most = SETTLE
    start = O.time
    with grains.damped(DAMPING):
        while O.time < start + least or (speed(bodies) > REST and O.time < start + most):
            for _ in range(round(0.02 / O.dt)):
                O.step()
    return speed(bodies)


def speed(bodies):
    """Root of the mean square of bodies' speeds, by mass [m/s]."""
    states = [O.bodies[i].state for i in bodies]
    return np.sqrt(sum(s.mass * s.vel.squaredNorm() for s in states) / grains.mass(bodies))


def settleBed(bodies):
    """Lets the lower half of the bed come to rest."""
    O.engines = [
        wrapper.ForceResetter(),
        wrapper.InsertionSortCollider(
            [wrapper.Bo1_Sphere_Aabb(), wrapper.Bo1_Box_Aabb()], verletDist=0.2 * RADIUS
        ),
        wrapper.InteractionLoop(
            [wrapper.Ig2_Sphere_Sphere_ScGeom(), wrapper.Ig2_Box_Sphere_ScGeom()],
            [wrapper.Ip2_FrictMat_FrictMat_FrictPhys()],
            [wrapper.Law2_ScGeom_FrictPhys_CundallStrack()],
        ),
        wrapper.NewtonIntegrator(damping=0, gravity=(0, 0, -GRAVITY)),
    ]
    O.dt = 0.5 * RADIUS * np.sqrt(GRAIN_DENSITY / GRAIN_YOUNG)
    settle(bodies)


def lid(height, pressure):
    """A plate that only goes up and down; returns its id."""
    half = (BOX[0] / 2, BOX[1] / 2, 0.02)
    plate = utils.box((*half[:2], height + 0.02), half, material="smooth", mask=LID)
    plate.state.mass = pressure * BOX[0] * BOX[1] / GRAVITY
    plate.state.blockedDOFs = "xyXYZ"
    return O.bodies.append(plate)


def pulled(job):
    """The Pullout of (kind, pressure, bed, quick, way, picture); picture: where one of the net goes, or None."""
    kind, pressure, bed, quick, way, shown = job
    run = Pullout(kind, pressure, bed, quick).run(way)
    if shown:
        picture(run, shown)
    del run.grid  # belongs to the scene, and stays in its process
    return run


def study(quick=False, shown=None, workers=1):
    """Runs all; returns {(kind, pressure): [Pullout, ...]} and the Summary. shown: a picture of the net after the
    first pull.
    """
    way, pressures, beds = (QUICK_WAY, PRESSURES[:1], 1) if quick else (WAY, PRESSURES, BEDS)
    cases = [(kind, pressure) for kind in (Cables, Grid) for pressure in pressures]
    jobs = [(*case, bed, quick, way, None) for case in cases for bed in range(beds)]
    jobs[0] = (*jobs[0][:-1], shown)
    done, out = runAll(pulled, jobs, workers, "pulls"), grains.Summary()
    runs = {case: [r for r in done if (r.kind, r.pressure) == case] for case in cases}
    for (kind, pressure), all_ in runs.items():
        tell(out, f"{kind.name}, {1e-3 * pressure:g} kPa", kind, all_)
    if not quick:
        for kind in (Cables, Grid):
            low, high = (runs[kind, p] for p in PRESSURES)
            trends = [b.late / a.late / (b.above / a.above) for a, b in zip(low, high)]
            print(f"{kind.name}: beds from {min(trends):.2f} to {max(trends):.2f}")
            # YADE's own grid is there to be compared with, not to be judged.
            bounds = dict(least=0.7, most=1.3) if kind is Cables else {}
            out.tell("more pull over more weight above, mean", np.mean(trends), **bounds)
    return runs, out


def tell(out, title, kind, runs):
    """Adds the figures of the beds of one case to a Summary."""
    pulls, shares = np.array([r.late for r in runs]), [r.share for r in runs]
    print(f"{title}, {runs[0].above:.0f} N above the grid, {len(runs)} beds")
    out.tell(
        "speed of grains before the pull, most",
        max(r.moving for r in runs),
        "m/s",
        most=REST,
    )
    out.tell("pull, mean", pulls.mean(), "N", least=0.0)
    out.tell("pull, standard deviation", pulls.std(), "N")
    out.tell("over twice the weight above it, mean", np.mean(shares))
    out.tell("the same, most", max(shares), most=FRICTION)
    out.tell("the walls bear of it, mean", np.mean([r.wallsBear / r.late for r in runs]))
    if kind is Cables:
        off = max(abs((r.gained - r.work) / r.turnover) for r in runs)
        out.tell("energy, most off by", off, most=0.03)
    runs[0].cost.report("cost of a pull")


def picture(run, path):
    """The net on the lower half of the bed."""
    from ancf.render import View
    from ancf.render import picture as draw

    low = dict.fromkeys(run.low, "#a79b85")
    draw(path, [run.grid.net], low, View((0.5, 0.75, -0.6)), size=(900, 560))


def plot(runs, path):
    from ancf.plots import plt

    figure, ax = plt.subplots(figsize=(6, 3.8), constrained_layout=True)
    for (kind, pressure), all_ in runs.items():
        style = dict(color="#1f6fb2" if kind is Cables else "#d1651a")
        style["ls"] = "--" if pressure == PRESSURES[0] else "-"
        count = min(len(run.way) for run in all_)
        forces = np.array([run.force[:count] for run in all_])
        way = 1e3 * np.array(all_[0].way[:count])
        ax.plot(way, forces.T, lw=0.5, alpha=0.5, **style)
        label = f"{kind.name}, {1e-3 * pressure:g} kPa"
        ax.plot(way, forces.mean(axis=0), label=label, lw=1.6, **style)
    ours = [max(run.force) for (kind, _), all_ in runs.items() if kind is Cables for run in all_]
    ax.set_ylim(
        0, 1.5 * max(ours)
    )  # a grain that snaps through YADE's grid takes kilonewtons for a moment
    ax.set_xlabel("displacement of the front row [mm]")
    ax.set_ylabel("pull [N]")
    ax.legend(fontsize=8)
    ax.grid(alpha=0.3)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="smaller and shorter")
    addOption(parser)
    args = grains.options(parser)
    shown = None if args.no_pictures else args.out / "geogrid_net.png"
    runs, out = study(args.quick, shown, args.workers)
    with open(args.out / "geogrid.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(("grid", "lid_Pa", "bed", "displacement_m", "pull_N", "walls_N"))
        for (kind, pressure), all_ in runs.items():
            for bed, run in enumerate(all_):
                rows = zip(run.way, run.force, run.wall)
                start = (kind.name, pressure, bed)
                writer.writerows((*start, *(f"{v:.6g}" for v in row)) for row in rows)
    if not args.no_pictures:
        plot(runs, args.out / "geogrid.png")
    return out.code


if __name__ == "__main__":
    sys.exit(main())
