"""A linear drive pulls a body through a fibre over a sheave: system B of the cable-and-pulley study.

The authors of the study compare with an experiment whose data is not published: there is nothing
here to compare with, only what the model says. Run it by `/usr/bin/python3 drive_rig.py`; --help tells
the options. Results go to out/.
"""

import argparse
import csv
import math
import pathlib
import time

import numpy as np

import ancf
from ancf import pulleys, render
from yade import O, Vector3, utils

# ---- parameters, SI units ----------------------------------------------------------------------
LENGTH = 2.0  # of the fibre [m]
EA = 5e4  # [N]
RHO_A = 5e-3  # [kg/m]
SHEAVE_RADIUS = 0.05  # at the bottom of the groove [m]
TRANSITION_VELOCITY = 1e-3  # v_t0 [m/s]
ELEMENTS = 20
CONTACT_POINTS = 4  # inside each element

# Not given by the study: chosen here, and printed as assumed.
ASSUMED = dict(
    diameter=2e-3,  # of the fibre [m]
    bending=1e-3,  # EI [N m2]
    body=1.0,  # mass that is pulled [kg]
    staticFriction=0.3,
    kineticFriction=0.2,
    stiffness=1e6,  # K of F = K d^n [N/m^n]
    exponent=1.0,  # n
    dashpot=5.0,  # of the contact [N s/m]
    damping=5e-7,  # Kelvin-Voigt time of the fibre [s]
    inertia=1e-4,  # of the sheave [kg m2]
    viscous=1e-5,  # of its bearing [N m s]
    dry=1e-3,  # of its bearing [N m]
    stroke=0.2,  # of the drive [m]
    period=2.0,  # of its motion [s]
    gravity=9.81,  # [m/s2]
    friction=0.0,  # of the body in its guide
)
DURATION = 5.0  # [s]


def build(elements=ELEMENTS, points=CONTACT_POINTS, **changes):
    """The scene; (cable, sheave id, SheaveEngine, GuideEngine, drive id, body id)."""
    a = {**ASSUMED, **changes}
    O.reset()
    O.materials.append(
        ancf.ropeMaterial(
            a["diameter"],
            EA,
            RHO_A,
            label="fibre",
            staticFriction=a["staticFriction"],
            kineticFriction=a["kineticFriction"],
            transitionVelocity=a.get("transitionVelocity", TRANSITION_VELOCITY),
            normalStiffness=a["stiffness"],
            normalExponent=a["exponent"],
            dashpot=a["dashpot"],
            impactDamping=a.get("impactDamping", 0.0),
        )
    )
    sheave = pulleys.sheave(
        (0, 0, 0), SHEAVE_RADIUS, width=0.01, material="fibre", inertia=a["inertia"]
    )
    r = SHEAVE_RADIUS + a["diameter"] / 2
    arc = math.pi / 2 * r
    half = (LENGTH - arc) / 2
    # The body hangs on the left, the drive pulls to the right.
    for gap in np.linspace(0, 0.2 * r, 41):  # coarse elements bulge: lay them clear of the sheave
        path = pulleys.Path(
            [(sheave, 1)],
            diameter=a["diameter"],
            start=(-r - gap, 0, -half),
            end=(half, 0, r + gap),
            gap=gap,
        )
        cable = pulleys.lay(
            path,
            elements,
            diameter=a["diameter"],
            material="fibre",
            bending=a["bending"],
            contactPoints=points,
            damping=a["damping"],
            mass="lumped",
            tension=a["body"] * a["gravity"],
        )
        try:
            pulleys.check(cable)
            break
        except ValueError:
            continue
    guide = ancf.GuideEngine()
    ids = []
    for knot in (0, -1):
        ball = utils.sphere(Vector3(*cable.knots[knot]), 0.02, mask=0)
        ball.state.mass = a["body"]
        ball.state.inertia = 0.4 * a["body"] * 0.02**2 * Vector3(1, 1, 1)
        ids.append(O.bodies.append(ball))
    body, drive = ids
    guide.add(body, direction=(0, 0, 1), friction=a["friction"])
    cable.carry(0, body)
    motion = pulleys.BackAndForth(a["stroke"], a["period"])
    guide.add(drive, direction=(1, 0, 0))  # its motion is set below, so that it can carry
    cable.carry(-1, drive)
    engine = ancf.SheaveEngine()
    engine.add(sheave, viscous=a["viscous"], dry=a["dry"])
    O.engines = pulleys.engines(
        cable,
        engine,
        guide,
        gravity=(0, 0, -a["gravity"]),
        contact=dict(normal=a.get("normal", "linear")),
        substeps=1,
        verletDist=0.01,
    )
    O.dt = 0.95 * cable.criticalTimeStep()
    guide.setMotion(drive, lambda t: 0.0)
    pulleys.settle(cable, 0.2)
    guide.setMotion(drive, motion)
    return cable, sheave, engine, guide, drive, body


def reader(cable, sheave, engine, guide, body):
    """Function that reads one row of the history."""
    names = "t x_drive f_drive x_body v_body w_sheave torque entry exit wrap slip_power".split()

    def read():
        wrap = pulleys.wrap(cable, sheave)
        state = O.bodies[body].state
        return dict(
            zip(
                names,
                (
                    O.time,
                    guide.position(guide.ids[1]),
                    guide.driveForce[1],
                    guide.position(body),
                    state.vel[2],
                    O.bodies[sheave].state.angVel[1],
                    engine.contactTorque[0],
                    wrap.entry if wrap else math.nan,
                    wrap.exit if wrap else math.nan,
                    wrap.wrapAngle if wrap else 0.0,
                    wrap.slipPower if wrap else 0.0,
                ),
            )
        )

    return read


class Balance:
    """Energy balance from now on, by O.energy."""

    def __init__(self):
        O.trackEnergy = True
        for _ in range(2):  # energies at half steps need the step before
            O.step()
        self.start = O.energy.total()

    def error(self):
        """What is missing, as part of the work that was turned over."""
        turned = max(abs(v) for _, v in O.energy.items())
        return (O.energy.total() - self.start) / turned


def plot(rows, folder):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    column = {k: np.array([row[k] for row in rows]) for k in rows[0]}
    figure, axes = plt.subplots(4, 1, figsize=(7, 9), sharex=True, constrained_layout=True)
    t = column["t"]
    axes[0].plot(t, column["x_drive"], label="drive")
    axes[0].plot(t, column["x_body"], "--", label="body")
    axes[0].set_ylabel("way [m]")
    axes[1].plot(t, column["entry"], label="body side")
    axes[1].plot(t, column["exit"], label="drive side")
    axes[1].set_ylabel("tension [N]")
    axes[2].plot(t, column["w_sheave"])
    axes[2].set_ylabel("sheave [rad/s]")
    axes[3].plot(t, np.degrees(column["wrap"]))
    axes[3].set_ylabel("wrap [deg]")
    axes[3].set_xlabel("t [s]")
    for ax in axes[:2]:
        ax.legend()
    figure.savefig(folder / "drive_rig.png", dpi=150)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--duration", type=float, default=DURATION, help="simulated time [s]")
    parser.add_argument("--elements", type=int, default=ELEMENTS)
    parser.add_argument("--points", type=int, default=CONTACT_POINTS, help="inside each element")
    parser.add_argument("--out", default="out")
    args = parser.parse_args()
    folder = pathlib.Path(args.out)
    folder.mkdir(parents=True, exist_ok=True)
    cable, sheave, engine, guide, drive, body = build(args.elements, args.points)
    print("assumed:", ", ".join(f"{k} = {v:g}" for k, v in ASSUMED.items()))
    balance = Balance()
    read = reader(cable, sheave, engine, guide, body)
    rows, wall, before = [], 0.0, O.iter
    begin = time.perf_counter()
    for _ in ancf.progress(args.duration, 0.01, "drive rig"):
        wall += time.perf_counter() - begin
        rows.append(read())
        begin = time.perf_counter()
    steps = O.iter - before
    print(
        f"step {O.dt:.3g} s, {wall / steps * 1e6:.1f} us a step, {wall / O.time:.2f} s wall for 1 s"
    )
    print(f"energy balance off by {balance.error():.2e} of the largest energy turned over:")
    for name, value in sorted(O.energy.items()):
        print(f"    {name:16s} {value:12.5g} J")
    with open(folder / "drive_rig.csv", "w", newline="") as f:
        writer = csv.DictWriter(f, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    plot(rows, folder)
    view = render.View(direction=(-0.4, 1, -0.3))
    render.picture(folder / "drive_rig-scene.png", [cable], view=view, size=(900, 800))


if __name__ == "__main__":
    main()
