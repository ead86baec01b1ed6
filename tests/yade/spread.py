"""A scene for test_mpi.py, in one process or spread: `yade -n -x spread.py PROCESSES STEPS FILE`.

A rope with a ball at its end falls on two stacks of balls and a single one, which lie on a floor.
"""

import json
import sys

import ancf
from yade import O, Vector3, utils, wrapper

processes, steps, result = int(sys.argv[1]), int(sys.argv[2]), sys.argv[3]
O.materials.append(ancf.HollarsMat(label="m", young=1e7, density=1000))
line = [(0, 0, 0), (1, 0, 0)]
rope = ancf.Cable(line, 8, diameter=4e-3, material="m", damping=1e-5, mass="lumped")
rope.setVelocity(lambda p: Vector3(0, 0, -4))
rope.carry(-1, O.bodies.append(utils.sphere((1, 0, 0), 0.02, material="m")))
places = [(x, 0, z) for x in (0.3, 0.7) for z in (-0.082, -0.185)] + [(1, 0.01, -0.1)]
balls = O.bodies.append([utils.sphere(p, 0.05, material="m") for p in places])
O.bodies.append(utils.wall(-0.236, 2, material="m"))
for i in balls:
    O.bodies[i].state.vel = (0.1 * (i % 2), 0.05 * i, 0)
O.engines = ancf.engines(rope, gravity=(0, 0, -9.81))
O.dt = 5e-5


def cables():
    return [rope.knots.tolist(), rope.energy(), rope.engine.energyOff, rope.engine.energyScale]


def bodies():
    states = [O.bodies[i].state for i in balls]
    return [[*s.pos, *s.vel, *s.angVel] for s in states]


if processes == 1:
    gravity = O.engines[-1].gravity
    O.engines = [*O.engines[:-1], wrapper.NewtonIntegrator(gravity=gravity, damping=0)]
    O.run(steps, True)
    found = dict(cables=cables(), bodies=bodies())
    master = True
else:
    from ancf import mpi
    from yade import mpy

    mpy.MERGE_W_INTERACTIONS = mpy.ERASE_REMOTE_MASTER = False
    for i in balls:
        O.bodies[i].subdomain = 2 if i in (balls[0], balls[1], balls[4]) else 1
    mpi.spread(rank=1)
    mpy.mpirun(steps, processes, True)
    found = dict(cables=mpi.ask(cables), bodies=bodies())
    master = mpy.rank == 0
    if master:
        try:
            O.run(1, True)
            found["afterwards"] = "ran"
        except RuntimeError as error:
            found["afterwards"] = str(error)
        mpy.disconnect()
if master:
    with open(result, "w", encoding="utf-8") as file:
        json.dump(found, file)
