"""A cable over a sheave with a weight on each side: system A of the cable-and-pulley study.

Run it by `/usr/bin/python3 pulley.py`; --help tells the options. Results go to out/.
"""

import argparse
import math
import pathlib

import numpy as np

import ancf
from ancf import pulleys, render
from yade import O, Vector3, utils

# ---- parameters, SI units ----------------------------------------------------------------------
RADIUS = 0.1  # of the cable's centreline on the sheave [m]
DIAMETER = 2e-3  # of the cable [m]
EA = 2e4  # [N]
RHO_A = 1e-3  # [kg/m]
WEIGHTS = (1.0, 1.2)  # [kg]
INERTIA = 0.02  # of the sheave [kg m2]
MU_STATIC, MU_KINETIC = 0.5, 0.5
TRANSITION_VELOCITY = 1e-3  # v_t0 [m/s]
STIFFNESS, EXPONENT = 1e5, 1.0  # K and n of F = K d^n
DASHPOT = 0.3  # [N s/m]
DAMPING = 5e-7  # Kelvin-Voigt time of the cable [s]
VISCOUS, DRY = 0.0, 0.0  # friction of the bearing [N m s], [N m]
ELEMENT_ANGLE = 15.0  # of the wrap that an element takes [deg]
POINTS = 2  # joints of its segments inside an element
SPAN = 0.3  # of the cable on each side [m]
GRAVITY = 9.81  # [m/s2]
DURATION = 0.5  # [s]


def build():
    """The scene; (cable, sheave id, SheaveEngine, ids of the weights)."""
    O.reset()
    O.materials.append(
        ancf.ropeMaterial(
            DIAMETER,
            EA,
            RHO_A,
            label="cable",
            staticFriction=MU_STATIC,
            kineticFriction=MU_KINETIC,
            transitionVelocity=TRANSITION_VELOCITY,
            normalStiffness=STIFFNESS,
            normalExponent=EXPONENT,
            dashpot=DASHPOT,
        )
    )
    sheave = pulleys.sheave(
        (0, 0, 0), RADIUS - DIAMETER / 2, width=6 * DIAMETER, material="cable", inertia=INERTIA
    )
    m1, m2 = WEIGHTS
    a = (m2 - m1) * GRAVITY / (m1 + m2 + INERTIA / RADIUS**2)
    t1, t2 = m1 * (GRAVITY + a), m2 * (GRAVITY - a)
    spacing = math.radians(ELEMENT_ANGLE) / (POINTS + 1)
    depth = ((t1 + t2) / 2 * spacing / STIFFNESS) ** (1 / EXPONENT)
    path = pulleys.Path(
        [(sheave, 1)],
        diameter=DIAMETER,
        start=(-RADIUS, 0, -SPAN),
        end=(RADIUS, 0, -SPAN),
        gap=-depth,
    )
    cable = pulleys.lay(
        path,
        round(path.length / (RADIUS * math.radians(ELEMENT_ANGLE))),
        diameter=DIAMETER,
        material="cable",
        bending=0.0,
        contactPoints=POINTS,
        damping=DAMPING,
        mass="lumped",
        tension=lambda s: t1 + (t2 - t1) * min(max((s - SPAN) / (math.pi * RADIUS), 0), 1),
    )
    weights = []
    for knot, mass in ((0, m1), (-1, m2)):
        ball = utils.sphere(Vector3(*cable.knots[knot]), 0.02, mask=0)
        ball.state.mass, ball.state.inertia = mass, 0.4 * mass * 0.02**2 * Vector3(1, 1, 1)
        weights.append(O.bodies.append(ball))
        cable.carry(knot, weights[-1])
    engine = ancf.SheaveEngine()
    engine.add(sheave, viscous=VISCOUS, dry=DRY)
    O.engines = pulleys.engines(
        cable, engine, gravity=(0, 0, -GRAVITY), contact=dict(normal="linear"), substeps=1
    )
    O.dt = 0.8 * cable.criticalTimeStep()
    return cable, sheave, engine, weights


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--duration", type=float, default=DURATION, help="simulated time [s]")
    parser.add_argument("--out", default="out")
    args = parser.parse_args()
    folder = pathlib.Path(args.out)
    folder.mkdir(parents=True, exist_ok=True)
    cable, sheave, engine, weights = build()
    rows = []
    for _ in ancf.progress(args.duration, 2e-3, "pulley"):
        wrap = pulleys.wrap(cable, sheave)
        one, two = (O.bodies[i].state.vel[2] for i in weights)
        spin = O.bodies[sheave].state.angVel[1]
        rows.append((O.time, one, -two, spin * RADIUS, wrap.entry, wrap.exit, wrap.wrapAngle))
    t, one, two, rim, entry, leaving, angle = np.array(rows).T
    m1, m2 = WEIGHTS
    a = (m2 - m1) * GRAVITY / (m1 + m2 + INERTIA / RADIUS**2)
    print(f"acceleration of the rim {np.polyfit(t, rim, 1)[0]:.5f} m/s2; without slip {a:.5f}")
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(3, 1, figsize=(7, 9), constrained_layout=True)
    axes[0].plot(t, one, label="light weight")
    axes[0].plot(t, two, "--", label="heavy weight")
    axes[0].plot(t, rim, ":", label="rim of the sheave")
    axes[0].set_xlabel("t [s]")
    axes[0].set_ylabel("speed [m/s]")
    axes[1].plot(t, entry, label="light side")
    axes[1].plot(t, leaving, label="heavy side")
    axes[1].set_xlabel("t [s]")
    axes[1].set_ylabel("tension [N]")
    axes[2].plot(np.degrees(wrap.angle), wrap.normal, ".-", label="normal force")
    axes[2].plot(np.degrees(wrap.angle), wrap.friction, ".-", label="friction")
    axes[2].set_xlabel("along the wrap [deg], at the end")
    axes[2].set_ylabel("force on a place of contact [N]")
    for ax in axes:
        ax.legend()
    figure.savefig(folder / "pulley.png", dpi=150)
    view = render.View(direction=(-0.5, 1, -0.3))
    render.picture(folder / "pulley-scene.png", [cable], view=view, size=(600, 900))
    header = "t,v_light,v_heavy,v_rim,entry,exit,wrap_angle"
    np.savetxt(folder / "pulley.csv", np.array(rows), delimiter=",", header=header, comments="")


if __name__ == "__main__":
    main()
