"""Exactness: a saved scene that is loaded in another process goes on bit for bit as the uninterrupted run.

    PYTHONPATH=build/python /usr/bin/python3 tests/yade/exactness.py [--only WORD] [--short] [--out FOLDER]

saves every scene at random steps in every type of file, with 1, 2 and 3 threads, with elements asleep
where they may be, all awake, and moved by YADE's own NewtonIntegrator; loads each file in another process
and compares all that moves at the end. Scenes without a cable tell what YADE itself does. Prints the table
and writes it to FOLDER/exactness.csv; returns 1 if a scene of cables differs where YADE alone does not.
"""

import argparse
import csv
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(HERE), str(ROOT / "yade-scripts")]

import ancf  # noqa: E402
from helpers import ball, bodyEngines, material, plane, squareNet, steps  # noqa: E402
from yade import O, Vector3, utils, wrapper  # noqa: E402

OUT = ROOT / "docs" / "images" / "robustness"
FILES = ("xml", "xml.bz2", "yade", "yade.gz")
THREADS = (1, 2, 3)
VARIANTS = ("asleep", "awake", "NewtonIntegrator")
STEPS, SAVES = 1500, 1


# ---- scenes --------------------------------------------------------------------------------------


def net():
    material("cable")
    flying = squareNet(2, 0.06, fold=0.8, damping=5e-5, selfContact=True)
    flying.addBullets(0.05, 0.008, 3, math.radians(-15))
    O.engines = ancf.engines(flying, gravity=(0, 0, -9.81))


def netAndBall():
    material("cable", impactDamping=0.2)
    ball((0.05, 0.004, 0.002), 0.04, mass=0.3, material="cable")
    flying = squareNet(2, 0.06, fold=0.8, damping=5e-5, center=(-0.01, 0, 0))
    flying.addBullets(0.05, 0.008, 3, math.radians(15))
    O.engines = ancf.engines(flying)


def grains(kind, clumps=False):
    """18 spheres, or as many clumps of two, a little apart and at random speeds, with a large ball above
    them, between walls that no cable meets.
    """
    if kind == "HollarsMat":
        material("grain", young=1e7, density=1000, impactDamping=0.2)
    else:
        O.materials.append(
            utils.FrictMat(label="grain", young=1e7, poisson=0.3, density=1000, frictionAngle=0.4)
        )
    random = np.random.default_rng(3)
    for k in range(18):
        wide = 0.018 if clumps else 0.0135
        at = [wide * (k % 3 - 1), 0.0135 * (k // 3 % 3 - 1), 0.008 + 0.0135 * (k // 9)]
        at += 5e-4 * random.uniform(-1, 1, 3)
        parts = [
            utils.sphere(Vector3(*at + [offset, 0, 0]), 0.006, material="grain", mask=3)
            for offset in ((0, 0.004) if clumps else (0,))
        ]
        number = O.bodies.appendClumped(parts)[0] if clumps else O.bodies.append(parts[0])
        O.bodies[number].state.vel = Vector3(*random.uniform(-1, 1, 2), -1)
    large = utils.sphere(Vector3(0.001, 0.002, 0.062), 0.03, material="grain", mask=3)
    large.state.vel = Vector3(0, 0, -1)
    O.bodies.append(large)
    for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        plane((0.04 * x, 0.04 * y, 0.03), (0.01, 0.05, 0.05) if x else (0.05, 0.01, 0.05), mask=2)
        O.bodies[-1].material = O.materials["grain"]


def inNet(kind, clumps=False):
    grains(kind, clumps)
    material("cable", young=1e7, impactDamping=0.2)
    below = squareNet(6, 0.012, normal=(0, 0, 1), damping=1e-4, mass="lumped")
    for corner in below.corners:
        below.fix(corner)
    O.engines = ancf.engines(below, gravity=(0, 0, -9.81))


def onFloor(kind, clumps=False):
    """The same grains without a cable, in engines of YADE's own where they are of FrictMat."""
    grains(kind, clumps)
    plane((0, 0, -0.0105), (0.2, 0.2, 0.01), material="grain", mask=2)
    O.engines = bodyEngines(gravity=(0, 0, -9.81))
    if kind == "FrictMat":
        loop = O.engines[2]
        loop.physDispatcher.functors = [wrapper.Ip2_FrictMat_FrictMat_FrictPhys()]
        loop.lawDispatcher.functors = [wrapper.Law2_ScGeom_FrictPhys_CundallStrack()]
    O.dt = 4e-5


def pulley():
    from test_pulley import onSheave, turned

    cable, sheave, _, _ = onSheave(180, 0.3)
    cable.fix(-1)
    turned(cable, sheave, -2.0)


def belt():
    import belt as script

    script.build(torque=-0.5)


CABLES = {
    "net alone": net,
    "net and free ball": netAndBall,
    "FrictMat grains in a net": lambda: inNet("FrictMat"),
    "HollarsMat grains in a net": lambda: inNet("HollarsMat"),
    "clumps in a net": lambda: inNet("HollarsMat", clumps=True),
    "pulley": pulley,
    "belt": belt,
}
ALONE = {
    "FrictMat grains, no cable": lambda: onFloor("FrictMat"),
    "HollarsMat grains, no cable": lambda: onFloor("HollarsMat"),
    "clumps, no cable": lambda: onFloor("HollarsMat", clumps=True),
}
SCENES = {**CABLES, **ALONE}
# What shows the same without a cable.
LIKE = dict(zip(list(CABLES)[2:5], ALONE))


# ---- in processes of their own -----------------------------------------------------------------------


def use(variant):
    """Elements asleep or awake, or all moved by YADE's own integrator."""
    engines = list(O.engines)
    for engine in engines:
        if isinstance(engine, ancf.CableEngine):
            engine.sleep = variant == "asleep"
    if variant == "NewtonIntegrator":  # as CableNewton is set
        for i, e in enumerate(engines):
            if isinstance(e, wrapper.CableNewton):
                engines[i] = wrapper.NewtonIntegrator(damping=0, gravity=e.gravity)
        O.engines = engines


def state():
    """Places and speeds of all that moves; bodies of elements stand where the collider last saw them."""
    cable = [e for e in O.engines if isinstance(e, ancf.CableEngine)]
    bodies = [b for b in O.bodies if b and not isinstance(b.shape, ancf.CableElement)]
    moving = [
        [*b.state.pos, *b.state.vel, *b.state.ori, *b.state.angVel] for b in bodies
    ]  # 3 + 3 + 4 + 3
    parts = [np.ravel(moving), *(e.position for e in cable), *(e.velocity for e in cable)]
    return np.concatenate([np.ravel(p) for p in parts])


def touching():
    """Pairs that touch, and places of cables that press."""
    cables = [e.contacts for e in O.engines if isinstance(e, ancf.CableEngine)]
    return sum(cables) + sum(i.isReal for i in O.interactions)


def names(only):
    return [name for name in SCENES if only in name]


def variants(scene, short):
    return VARIANTS[:1] if scene in ALONE else VARIANTS[:2] if short else VARIANTS


def plan(only, length, saves, short):
    """(number, scene, variant, steps at which it is saved) of all runs."""
    random = np.random.default_rng(7)
    made = []
    for scene in names(only):
        for variant in variants(scene, short):
            at = sorted(int(n) for n in random.integers(1, length - 1, saves))
            made.append((len(made), scene, variant, at))
    return made


def save(folder, only, length, saves, short):
    for number, scene, variant, at in plan(only, length, saves, short):
        O.reset()
        SCENES[scene]()
        use(variant)
        met = 0
        for n in (*at, length):
            while O.iter < n:
                steps(min(25, n - O.iter))
                met = max(met, touching())
            for kind in FILES if n < length else ():
                O.save(f"{folder}/{number}-{n}.{kind}")
        np.save(f"{folder}/{number}.npy", state())
        pathlib.Path(f"{folder}/{number}.met").write_text(str(met))


def load(folder, only, length, saves, short):
    """Writes loaded.json: [number, step, kind of file, whether all bits are equal, largest difference]."""
    told = []
    for number, _, _, at in plan(only, length, saves, short):
        whole = np.load(f"{folder}/{number}.npy")
        for n in at:
            for kind in FILES:
                O.load(f"{folder}/{number}-{n}.{kind}")
                steps(length - O.iter)
                now = state()
                told.append(
                    [
                        number,
                        n,
                        kind,
                        now.tobytes() == whole.tobytes(),
                        float(abs(now - whole).max()),
                    ]
                )
    pathlib.Path(f"{folder}/loaded.json").write_text(json.dumps(told))


def process(act, threads, *arguments):
    """Calls save or load in `yade -j threads`."""
    folder = pathlib.Path(arguments[0])
    script = folder / f"{act}.py"
    script.write_text(
        f"import sys\nsys.path.insert(0, {str(HERE)!r})\nimport exactness\nexactness.{act}(*{arguments!r})\n"
    )
    env = {k: v for k, v in os.environ.items() if k != "OMP_NUM_THREADS"}
    env.setdefault("PYTHONPATH", str(ROOT / "build" / "python"))
    env["OMP_WAIT_POLICY"] = "passive"
    command = ["yade", f"-j{threads}", "-n", "-x", str(script)]
    done = subprocess.run(command, env=env, capture_output=True, text=True, timeout=3600)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]


def run(only="", length=STEPS, saves=SAVES, threads=THREADS, short=False):
    """Rows of the table: a scene with a number of threads each."""
    runs, table, first = plan(only, length, saves, short), [], {}
    for count in threads:
        with tempfile.TemporaryDirectory() as folder:
            arguments = (folder, only, length, saves, short)
            process("save", count, *arguments)
            process("load", count, *arguments)
            told = json.loads(pathlib.Path(f"{folder}/loaded.json").read_text())
            ends = [np.load(f"{folder}/{number}.npy") for number, *_ in runs]
            met = [int(pathlib.Path(f"{folder}/{number}.met").read_text()) for number, *_ in runs]
        for scene in names(only):
            mine = [number for number, which, *_ in runs if which == scene]
            cells = [t for t in told if t[0] in mine]
            first.setdefault(scene, ends[mine[0]])  # with the fewest threads, asleep
            apart = [float(abs(ends[i] - first[scene]).max()) for i in mine]
            same = sum(ends[i].tobytes() == first[scene].tobytes() for i in mine)
            table.append(
                {
                    "scene": scene,
                    "threads": count,
                    "contacts": max(met[i] for i in mine),
                    "files loaded": len(cells),
                    "bit for bit": sum(t[3] for t in cells),
                    "largest difference": f"{max(t[4] for t in cells):.1e}",
                    "runs": len(mine),
                    "as with one thread": same,
                    "largest difference of runs": f"{max(apart):.1e}",
                }
            )
    return table


def differs(row):
    """Whether a row has anything that is not bit for bit the same: (loaded, between runs)."""
    return row["bit for bit"] < row["files loaded"], row["as with one thread"] < row["runs"]


def faults(table):
    """Rows of cables that differ where the same without a cable does not."""
    bad = []
    for row in table:
        if row["scene"] in ALONE:
            continue
        like = [r for r in table if r["scene"] == LIKE.get(row["scene"])]
        excused = [
            any(flags)
            for flags in zip(*(differs(r) for r in like if r["threads"] == row["threads"]))
        ] or [False, False]
        if any(found and not known for found, known in zip(differs(row), excused)):
            bad.append(row)
    return bad


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--only", default="", help="scenes whose name has this in it")
    parser.add_argument("--short", action="store_true", help="fewer steps and variants")
    parser.add_argument("--out", default=OUT, help="folder of the CSV file")
    args = parser.parse_args()
    table = run(args.only, 400, 1, THREADS[:2], True) if args.short else run(args.only)
    folder = pathlib.Path(args.out)
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / "exactness.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, table[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)
    for row in table:
        print(*row.values(), sep=", ")
    return int(bool(faults(table)))


if __name__ == "__main__":
    sys.exit(main())
