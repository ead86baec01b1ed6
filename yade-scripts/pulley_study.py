"""What the cable on a sheave depends on: points and elements, friction, v_t0, K and n, damping.

A cable is held at one end, pulled at the other and wraps a drum that turns under it; T2/T1 is
compared with exp(mu theta). A second part holds the cable by stiction and compares its creep with
the closed form of Hollars. Run it by `/usr/bin/python3 pulley_study.py`; results go to out/.
"""

import argparse
import csv
import itertools
import math
import pathlib
import warnings

from jobs import addOption, runAll  # first: see there

import ancf
import numpy as np
from ancf import pulleys
from yade import O

# ---- parameters, SI units ----------------------------------------------------------------------
RADIUS = 0.05  # of the cable's centreline [m]
DIAMETER = 2e-3  # [m]
BASE = dict(
    theta=180.0,  # wrap [deg]
    elementAngle=15.0,  # of the wrap that an element takes [deg]
    points=2,  # inside each element
    muStatic=0.3,
    muKinetic=0.3,
    v0=1e-3,  # v_t0 [m/s]
    slip=0.1,  # speed of the drum's rim [m/s]
    stiffness=1e6,  # K
    exponent=1.0,  # n
    dashpot=20.0,  # [N s/m]
    damping=2e-5,  # Kelvin-Voigt time of the cable [s]
    bending=0.0,  # EI [N m2]
    ea=2e4,  # [N]
    rhoA=0.1,  # [kg/m]
    time=0.05,  # simulated [s]
)


def scene(load, profile, theta, elementAngle, points, **p):
    """A cable on a sheave, knot 0 pulled by `load` [N]; (cable, sheave id, direction at the end)."""
    O.reset()
    O.materials.append(
        ancf.ropeMaterial(
            DIAMETER,
            p["ea"],
            p["rhoA"],
            label="cable",
            staticFriction=p["muStatic"],
            kineticFriction=p["muKinetic"],
            transitionVelocity=p["v0"],
            normalStiffness=p["stiffness"],
            normalExponent=p["exponent"],
            dashpot=p["dashpot"],
        )
    )
    sheave = pulleys.sheave((0, 0, 0), RADIUS - DIAMETER / 2, width=6 * DIAMETER, material="cable")
    angle = math.radians(theta)
    span = 3 * RADIUS * math.radians(elementAngle)
    e1, e2 = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
    u = -math.sin(angle) * e1 + math.cos(angle) * e2
    path = pulleys.Path(
        [(sheave, 1, int(theta // 360))],
        diameter=DIAMETER,
        start=RADIUS * e1 - span * e2,
        end=RADIUS * (math.cos(angle) * e1 + math.sin(angle) * e2) + span * u,
    )
    cable = pulleys.lay(
        path,
        round(path.length / (RADIUS * math.radians(elementAngle))),
        diameter=DIAMETER,
        material="cable",
        bending=p["bending"],
        contactPoints=points,
        damping=p["damping"],
        mass="lumped",
        tension=lambda s: profile(min(max(s - span, 0) / RADIUS, angle)),
    )
    cable.load(0, -load * e2)
    return cable, sheave, u


def turn(cable, sheave, speed):
    engine = ancf.SheaveEngine()
    engine.add(sheave, speed=speed)
    normal = "linear" if O.materials["cable"].normalExponent == 1 else "hertz"
    O.engines = pulleys.engines(cable, engine, contact=dict(normal=normal), substeps=1)
    O.dt = 0.8 * cable.criticalTimeStep()


def average(read, duration):
    """Mean of read() over the second half of a run."""
    values = []
    for _ in range(100):
        for _ in range(max(1, round(duration / 100 / O.dt))):
            O.step()
        values.append(read())
    return np.mean(values[50:], axis=0)


def capstan(**changes):
    """(T2/T1 as measured, its relative error)."""
    p = {**BASE, **changes}
    ratio = (p["slip"] / p["v0"]) ** 2
    mu = p["muKinetic"] + 2 * (p["muStatic"] - p["muKinetic"]) / (1 + ratio)  # Eq. 11
    cable, sheave, _ = scene(1.0, lambda phi: math.exp(0.8 * mu * phi), **p)
    cable.fix(-1)
    turn(cable, sheave, -p["slip"] / RADIUS)
    got = average(lambda: cable.reaction(-1).norm(), p["time"])
    return got, got / math.exp(mu * math.radians(p["theta"])) - 1


def creep(**changes):
    """(speed of a cable that stiction holds at half of its limit [m/s], relative error)."""
    p = {**BASE, **changes}
    mu = p["muStatic"] / 2
    cable, sheave, u = scene(1.0, lambda phi: math.exp(mu * phi), **p)
    cable.load(-1, math.exp(mu * math.radians(p["theta"])) * u)
    turn(cable, sheave, 0.0)
    low, high = 0.0, p["v0"]
    for _ in range(60):  # mu(v) of Eq. 11 on its rising branch
        v = (low + high) / 2
        s = v / p["v0"]
        rises = s * (p["muKinetic"] + 2 * (p["muStatic"] - p["muKinetic"]) / (1 + s * s)) < mu
        low, high = (v, high) if rises else (low, v)
    got = average(lambda: float(np.dot(cable.velocity(1.0), u)), p["time"])
    return got, got / v - 1


def studies(quick):
    """Cases: (name of the study, function, changes)."""
    angles, counts = ((30.0, 15.0), (1, 2)) if quick else ((60.0, 30.0, 15.0, 7.5), (1, 2, 4))
    grid = [dict(elementAngle=a, points=k) for a, k in itertools.product(angles, counts)]
    wraps = [
        dict(theta=t, muStatic=m, muKinetic=m, time=0.03 if t < 200 else 0.15)
        for t in ((90.0, 180.0) if quick else (90.0, 180.0, 270.0, 540.0))
        for m in (0.1, 0.3, 0.5)
    ]
    all_ = [
        ("elements and points", capstan, grid),
        ("wrap and friction", capstan, wraps),
        ("v_t0, slipping", capstan, [dict(v0=v, muKinetic=0.2) for v in (1e-2, 3e-3, 1e-3)]),
        ("v_t0, holding", creep, [dict(v0=v) for v in (1e-2, 1e-3, 1e-4)]),
        ("K", capstan, [dict(stiffness=k) for k in (1e5, 3e5, 1e6)]),
        (
            "n",
            capstan,
            [dict(exponent=n, stiffness=k) for n, k in ((1.0, 1e6), (1.5, 3e8), (2.0, 1e11))],
        ),
        ("damping of the cable", capstan, [dict(damping=d) for d in (5e-6, 2e-5, 5e-5)]),
        ("EI", capstan, [dict(bending=b) for b in (0.0, 1e-5, 1e-4)]),
    ]
    return [(name, measure, changes) for name, measure, cases in all_ for changes in cases]


def measured(case):
    """(value, relative error, "") of a case, or (None, None, why there is none)."""
    name, measure, changes = case
    warnings.simplefilter("ignore")
    try:
        return *measure(**changes), ""
    except RuntimeError as told:
        return None, None, str(told)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--quick", action="store_true", help="coarser and shorter")
    addOption(parser)
    parser.add_argument("--out", default="out")
    args = parser.parse_args()
    folder = pathlib.Path(args.out)
    folder.mkdir(parents=True, exist_ok=True)
    cases, rows = studies(args.quick), []
    for (name, _, changes), (value, error, why) in zip(
        cases, runAll(measured, cases, args.workers, "cases")
    ):
        print(f"{name}: {changes}: ", end="")
        if why:
            print(why)
            continue
        print(f"{value:.5g}, error {100 * error:+.3f} %")
        rows.append((name, changes, value, error))
    with open(folder / "pulley_study.csv", "w", newline="") as f:
        writer = csv.writer(f)
        writer.writerow(("study", "changes", "value", "error"))
        writer.writerows(rows)
    plot(rows, folder)


def plot(rows, folder):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, ax = plt.subplots(figsize=(7, 5), constrained_layout=True)
    first = [(c, e) for name, c, _, e in rows if name == "elements and points"]
    for points in sorted({c["points"] for c, _ in first}):
        line = [(c["elementAngle"], 100 * abs(e)) for c, e in first if c["points"] == points]
        ax.loglog(*zip(*line), "o-", label=f"{points} points inside an element")
    ax.axhline(1, color="grey", lw=0.8)
    ax.set_xlabel("wrap that an element takes [deg]")
    ax.set_ylabel("error of T2/T1 [%]")
    ax.legend()
    figure.savefig(folder / "pulley_study.png", dpi=150)
    plt.close(figure)


if __name__ == "__main__":
    main()
