"""A belt over two sheaves: one driven at a speed, the other braked by a load torque that grows until
the belt slips.

Run it by `/usr/bin/python3 belt.py`; --help tells the options. Results go to out/.
"""

import argparse
import math
import pathlib

import numpy as np

import ancf
from ancf import pulleys, render
from yade import O, Vector3

# ---- parameters, SI units ----------------------------------------------------------------------
RADIUS = 0.05  # of both sheaves, to the centreline of the belt [m]
DISTANCE = 0.2  # of the axles [m]
DIAMETER = 2e-3  # of the belt [m]
EA = 5e3  # [N]
RHO_A = 0.02  # [kg/m]
PRETENSION = 20.0  # [N]
MU = 0.3
TRANSITION_VELOCITY = 1e-4  # v_t0 [m/s]
SPEED = 2.0  # of the driver's rim [m/s]
ELEMENT_ANGLE = 15.0  # of the wrap that an element takes [deg]
LOAD = 1.2  # largest torque [N m]
INERTIA = 2e-4  # of a sheave [kg m2]
DURATION = 1.0  # [s]


def growing(t):
    """Torque of the load at a time [N m]."""
    return -LOAD * min(1.0, t / DURATION)


def build(
    elementAngle=ELEMENT_ANGLE, distance=DISTANCE, transition=TRANSITION_VELOCITY, torque=None
):
    """The scene; (cable, sheave ids, SheaveEngine). torque: of the load [N m]; None: it grows."""
    O.reset()
    O.materials.append(
        ancf.ropeMaterial(
            DIAMETER,
            EA,
            RHO_A,
            label="belt",
            staticFriction=MU,
            kineticFriction=MU,
            transitionVelocity=transition,
            normalStiffness=3e5,
            normalExponent=1.0,
            dashpot=3.0,
        )
    )
    ids = [
        pulleys.sheave(
            (x, 0, 0), RADIUS - DIAMETER / 2, width=0.012, material="belt", inertia=INERTIA
        )
        for x in (0, distance)
    ]
    path = pulleys.Path([(i, 1) for i in ids], diameter=DIAMETER)
    cable = pulleys.lay(
        path,
        round(path.length / (RADIUS * math.radians(elementAngle))),
        diameter=DIAMETER,
        material="belt",
        bending=0.0,
        contactPoints=2,
        damping=5e-6,
        mass="lumped",
        tension=PRETENSION,
    )
    cable.setVelocity(path.flow(SPEED))
    engine = ancf.SheaveEngine()
    for i in ids:
        O.bodies[i].state.angVel = Vector3(0, SPEED / RADIUS, 0)
    engine.add(ids[0], speed=SPEED / RADIUS)
    engine.add(ids[1], torque=growing if torque is None else torque)
    O.engines = pulleys.engines(cable, engine, contact=dict(normal="linear"), substeps=1)
    O.dt = 0.8 * cable.criticalTimeStep()
    return cable, ids, engine


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--duration", type=float, default=DURATION, help="simulated time [s]")
    parser.add_argument("--out", default="out")
    args = parser.parse_args()
    folder = pathlib.Path(args.out)
    folder.mkdir(parents=True, exist_ok=True)
    cable, ids, engine = build()
    rows = []
    for _ in ancf.progress(args.duration, 2e-3, "belt"):
        wrap = pulleys.wrap(cable, ids[1])
        if wrap is None or O.bodies[ids[1]].state.angVel[1] < 0:
            break
        driven = O.bodies[ids[1]].state.angVel[1] * RADIUS
        rows.append((O.time, -engine.torque[1], wrap.entry, wrap.exit, driven))
    t, load, one, two, driven = np.array(rows).T
    limit = (np.maximum(one, two) - RHO_A * SPEED**2) * (1 - math.exp(-MU * math.pi)) * RADIUS
    slips = np.flatnonzero(driven < 0.9 * SPEED)
    if len(slips):
        print(
            f"slips from {load[slips[0]]:.3f} N m on; Eytelwein at these tensions: {limit[slips[0]]:.3f} N m"
        )
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(2, 1, figsize=(7, 6), sharex=True, constrained_layout=True)
    axes[0].plot(load, one, label="before the driven sheave")
    axes[0].plot(load, two, label="behind it")
    axes[0].set_ylabel("tension [N]")
    axes[0].legend()
    axes[1].semilogy(load, np.maximum(1 - driven / SPEED, 1e-6), label="slip")
    axes[1].semilogy(load, np.maximum(abs(one - two) / EA, 1e-6), "--", label="(T1 - T2)/EA")
    axes[1].set_ylabel("loss of speed [-]")
    axes[1].set_xlabel("load torque [N m]")
    axes[1].legend()
    figure.savefig(folder / "belt.png", dpi=150)
    view = render.View(direction=(-0.35, 1, -0.35))
    render.picture(folder / "belt-scene.png", [cable], view=view, size=(1080, 600))
    np.savetxt(
        folder / "belt.csv",
        np.array(rows),
        delimiter=",",
        header="t,load,entry,exit,driven_rim_speed",
        comments="",
    )


if __name__ == "__main__":
    main()
