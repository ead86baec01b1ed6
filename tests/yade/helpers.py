"""Materials, engines and measures that several tests use."""

import math

import numpy as np

import ancf
from yade import O, Vector3, utils
from yade.wrapper import (
    Bo1_Box_Aabb,
    Bo1_Sphere_Aabb,
    ForceResetter,
    Ig2_Box_Sphere_ScGeom,
    Ig2_Sphere_Sphere_ScGeom,
    InsertionSortCollider,
    InteractionLoop,
    NewtonIntegrator,
)


def material(label, **values):
    """A HollarsMat in O.materials, that of the net study where nothing else is said."""
    given = dict(young=4.456e8, poisson=0.3, density=1440)
    O.materials.append(ancf.HollarsMat(label=label, **{**given, **values}))
    return label


def bodyEngines(gravity=(0, 0, 0), **law):
    """Engines for spheres and boxes of HollarsMat, no cable."""
    return [
        ForceResetter(),
        InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Box_Aabb()], verletDist=0.01),
        InteractionLoop(
            [Ig2_Sphere_Sphere_ScGeom(), Ig2_Box_Sphere_ScGeom()],
            [ancf.Ip2_HollarsMat_HollarsMat_HollarsPhys()],
            [ancf.Law2_ScGeom_HollarsPhys_Hollars(**law)],
        ),
        NewtonIntegrator(damping=0, gravity=gravity),
    ]


def hertz(radius, young1, poisson1, young2, poisson2):
    """Stiffness [N/m^1.5], Eq. 8-9 of Shan, Guo, Gill 2019: k = 4 sqrt(r)/(3 pi (h1 + h2))."""
    h = (1 - poisson1**2) / (math.pi * young1) + (1 - poisson2**2) / (math.pi * young2)
    return 4 * math.sqrt(radius) / (3 * math.pi * h)


def steps(n):
    """n steps, without the waiting of O.run."""
    for _ in range(n):
        O.step()


def runTo(time):
    steps(max(0, round((time - O.time) / O.dt)))


def array(v):
    return np.array(list(v))


def momenta(engine, bodies):
    """Linear and angular momentum of cables, carried bodies' spin, and of free bodies.

    bodies: {id: True if its translation is in the engine already (carried)}.
    Also returns the sums of the absolute values of the terms.
    """
    linear, angular = (array(v) for v in engine.momentum())
    terms = []
    for i, carried in bodies.items():
        s = O.bodies[i].state
        spin = array(s.inertia) * array(s.angVel)  # spheres: the same about all axes
        angular = angular + spin
        if not carried:
            p = s.mass * array(s.vel)
            linear, angular = linear + p, angular + np.cross(array(s.pos), p)
            terms.append(p)
    return linear, angular


def squareNet(meshes=2, meshLength=0.08, **options):
    given = dict(diameter=1e-3, material="cable", normal=(1, 0, 0))
    return ancf.Net.square(meshes, meshLength, **{**given, **options})


def ball(center, radius, mass=None, **options):
    """A sphere; mass None: fixed. Returns its id."""
    body = utils.sphere(Vector3(*center), radius, fixed=mass is None, **options)
    if mass is not None:
        body.state.mass = mass
        body.state.inertia = 0.4 * mass * radius**2 * Vector3(1, 1, 1)
    return O.bodies.append(body)


def plane(center, extents, **options):
    """A fixed box. Returns its id."""
    return O.bodies.append(utils.box(Vector3(*center), extents, fixed=True, **options))
