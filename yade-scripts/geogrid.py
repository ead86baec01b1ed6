"""A geogrid is pulled out of a bed of grains: force against displacement, beside YADE's own grid.

Grains fill a box with smooth walls, a grid lies half-way up, and a lid presses on them. The grid's front row is
drawn out through the front wall at a constant speed. The grid is a net of ANCF cables, or of YADE's GridNode and
GridConnection of the same ribs. Run it by `/usr/bin/python3 geogrid.py`; --help tells the options. Results go to
out/.
"""

import csv
import sys
import time

import numpy as np

import ancf
import grains
from yade import O, Vector3, gridpfacet, utils, wrapper

# ---- parameters, SI units ----------------------------------------------------------------------
GRAVITY = 9.81
BOX = (0.42, 0.28)  # inside, x and y [m]
RIBS = (7, 5)  # knots along x and y; the front row is outside
MESH = 0.06  # [m]
RIB = 4e-3  # diameter [m]
RIB_YOUNG = 2e8  # a tenth of polypropylene's, so that steps are long: ribs strain by 1 or 2 % [Pa]
RIB_DENSITY = 950  # [kg/m3]
RIB_DAMPING = 1e-5  # Kelvin-Voigt time [s]
RADIUS, SPREAD = 0.018, 0.2  # of grains: the smallest [m], how much larger the largest are
GRAIN_YOUNG = 2e7  # so that grains give way by some 0.1 % of their radius [Pa]
GRAIN_DENSITY = 2600  # [kg/m3]
FRICTION = 0.5  # between grains, and of grains on ribs
COUNT = 240  # grains below the grid, and as many above
PRESSURES = (1e3, 4e3)  # of the lid [Pa]
SPEED, WAY = 0.08, 0.03  # of the front row [m/s], [m]
DAMPING = 0.3  # of grains: the pull is meant to be slow
SETTLE = 0.25  # time that half a bed takes [s]
SAMPLE = 1e-3  # [s]
GRID, GRAINS, WALLS = 1, 3, 2  # masks: the grid goes through the walls
RIBS_APART = 4  # bit of GridConnections' mask: they do not meet each other


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
            contactPoints=2,
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


def main():
    import warnings
    warnings.simplefilter("ignore")
    kind={"c":Cables,"g":Grid}[sys.argv[1]]; P=float(sys.argv[2])
    O.reset(); materials(); front,back=walls()
    t0=time.process_time()
    low=bed(0.0, 1)
    bare=[wrapper.ForceResetter(), wrapper.InsertionSortCollider([wrapper.Bo1_Sphere_Aabb(),wrapper.Bo1_Box_Aabb()],verletDist=.2*RADIUS),
      wrapper.InteractionLoop([wrapper.Ig2_Sphere_Sphere_ScGeom(),wrapper.Ig2_Box_Sphere_ScGeom()],[wrapper.Ip2_FrictMat_FrictMat_FrictPhys()],[wrapper.Law2_ScGeom_FrictPhys_CundallStrack()]),
      wrapper.NewtonIntegrator(damping=.4,gravity=(0,0,-9.81))]
    O.engines=bare; O.dt=.5*RADIUS*np.sqrt(GRAIN_DENSITY/GRAIN_YOUNG)
    while O.time<.8: O.step()
    z=grains.places(low)[:,2]
    top=max(z)+RADIUS*1.2
    print("low settled",time.process_time()-t0,z.max(),utils.kineticEnergy(), O.iter)
    grid=kind(top+RIB/2)
    up=bed(top+RIB,2)
    lid=utils.box((BOX[0]/2,BOX[1]/2,max(grains.places(up)[:,2])+RADIUS*1.2+.02),(BOX[0]/2,BOX[1]/2,.02),material="smooth",mask=WALLS)
    lid.state.mass=P*BOX[0]*BOX[1]/9.81; lid.state.blockedDOFs="xyXYZ"
    lid=O.bodies.append(lid)
    O.engines=grid.engines() if kind is Cables else O.engines; O.dt=grid.step()
    print("dt",O.dt, len(O.bodies))
    O.engines[-1].damping=DAMPING
    t1=O.time; t0=time.process_time()
    while O.time<t1+.6:
        t=O.time+.05
        while O.time<t: O.step()
        print("%.2f %.1f lid %.4f ke %.4f F %.1f"%(O.time,time.process_time()-t0,O.bodies[lid].state.pos[2],utils.kineticEnergy(),grid.force()), O.forces.f(front)[0],O.forces.f(back)[0], grid.knots()[:,2].min().round(4),grid.knots()[:,2].max().round(4),flush=True)
    O.engines[-1].damping=0
    grid.pull(SPEED)
    t1=O.time; F=[]; W=[]
    while O.time<t1+WAY/SPEED:
        t=O.time+.02; F=[];W=[]
        while O.time<t: O.step(); F.append(grid.force()); W.append([O.forces.f(front)[0],O.forces.f(back)[0]])
        print("%.4f mm %.1f lid %.4f F %.1f"%(1e3*SPEED*(O.time-t1),time.process_time()-t0,O.bodies[lid].state.pos[2],np.mean(F)), np.mean(W,axis=0), (grid.knots()[-1]-grid.knots()[0])[0],flush=True)
    from ancf import render
    render.picture("geo%s.png"%sys.argv[1],[grid.net] if kind is Cables else [],{i:"#a79b85" for i in low},render.View(direction=(.5,.8,-.5)))


def bed(low,seed):
    rng=np.random.default_rng(seed); pitch=2*RADIUS*(1+SPREAD)+.005
    nx,ny=int(BOX[0]/pitch),int(BOX[1]/pitch); ids=[]
    for k in range(COUNT):
        layer,place=divmod(k,nx*ny); i,j=divmod(place,ny)
        r=RADIUS*(1+SPREAD*rng.uniform())
        ids.append(O.bodies.append(utils.sphere(((i+.5)*BOX[0]/nx+.004*rng.uniform(-1,1),(j+.5)*BOX[1]/ny+.004*rng.uniform(-1,1),low+pitch*(layer+.5)),r,material="grain",mask=GRAINS)))
    return ids


if __name__ == "__main__":
    sys.exit(main())
