"""Size: cost of a step, time of building and memory of cables and nets of 10 to 100,000 elements.

Run it by `PYTHONPATH=build/python /usr/bin/python3 tests/bench/scaling.py`; PYTHONPATH says which build is
measured. Every scene is a process of its own, with one thread and with two, in turns. A CSV and a
diagram go to docs/images/speed. Times of steps are the least of all batches, as all that the machine
does besides adds to them; with two threads wall time is what counts.
"""

import argparse
import csv
import json
import os
import pathlib
import resource
import statistics
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]

import ancf  # noqa: E402
from machine import here, timed  # noqa: E402
from yade import O, Vector3, wrapper  # noqa: E402

# ---- parameters, SI units ------------------------------------------------------------------------
MATERIAL = dict(young=4.456e8, poisson=0.3, density=1440)
DIAMETER, MESH = 1e-3, 0.08  # [m]
SIZES, FEW = (10, 100, 1000, 10_000, 100_000), (10, 1000)
THREADS = (1, 2)
BATCH, BATCHES = 0.1, 7  # wall time of a batch of steps [s]
ROUNDS = 1  # of processes in turns
SPEED = 1.0  # of all [m/s]
MARK = "result: "
OUT = ROOT / "docs" / "images" / "speed"


def cable(n):
    """A smooth cable that can touch nothing; its engines have no collider."""
    made = ancf.Cable(
        [(0, 0, 0), (n * MESH, 0, 0)],
        n,
        diameter=DIAMETER,
        material="cable",
        contactPoints=0,
        mass="lumped",
    )
    return made, lambda e: not isinstance(e, wrapper.InsertionSortCollider)


def net(n):
    """A square net of one element an edge that could touch itself and others, and does not."""
    meshes = max(1, round((n / 2) ** 0.5 - 0.5))
    made = ancf.Net.square(meshes, MESH, diameter=DIAMETER, material="cable", mass="lumped")
    return made, lambda e: True


SCENES = dict(cable=cable, net=net)


def resident():
    """Memory in use [kB]."""
    pages = int(pathlib.Path("/proc/self/statm").read_text().split()[1])
    return pages * resource.getpagesize() / 1024


def measured(scene, n):
    """Figures of one scene: {name: value}."""
    O.materials.append(ancf.HollarsMat(label="cable", **MATERIAL))
    before, begin = resident(), time.process_time()
    made, kept = SCENES[scene](n)
    O.engines = [e for e in ancf.engines(made) if kept(e)]
    O.run(1, True)
    building, memory = time.process_time() - begin, resident() - before
    made.setVelocity(lambda p: Vector3(0, 0, SPEED))
    elements = len(made.engine.length)
    O.run(20, True)
    steps = 20
    while timed(steps)[1] < BATCH and steps < 10**6:
        steps *= 2
    times = [timed(steps) for _ in range(BATCHES)]
    return dict(
        elements=elements,
        cpu=1e6 * min(t[0] for t in times) / steps,
        wall=1e6 * min(t[1] for t in times) / steps,
        building=building,
        memory=memory / elements,
    )


def child(scene, n):
    print(MARK + json.dumps(measured(scene, n)), flush=True)
    os._exit(0)  # YADE may end badly


def process(scene, n, threads):
    """Figures of a scene in a process of its own; raises RuntimeError with what it said else."""
    done = subprocess.run(
        [sys.executable, __file__, "--child", scene, "--size", str(n)],
        capture_output=True,
        text=True,
        env={**os.environ, "OMP_NUM_THREADS": str(threads)},
    )
    for line in reversed(done.stdout.splitlines()):
        if line.startswith(MARK):
            return json.loads(line[len(MARK) :])
    said = " | ".join((done.stderr + done.stdout).strip().splitlines()[-3:])
    raise RuntimeError(f"{scene} of {n} elements ended with {done.returncode}: {said}")


def rows(quick, counts):
    """One a scene, size and number of threads."""
    for scene in SCENES:
        for n in FEW if quick else SIZES:
            runs = {threads: [] for threads in counts}
            for _ in range(1 if quick else ROUNDS):
                for threads in counts:
                    runs[threads].append(process(scene, n, threads))
            for threads, found in runs.items():
                row = {key: statistics.median(run[key] for run in found) for key in found[0]}
                for least in ("cpu", "wall"):
                    row[least] = min(run[least] for run in found)
                yield dict(scene=scene, threads=threads, **row)


def draw(table, file):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 3, figsize=(12, 4), constrained_layout=True)
    for scene, color in zip(SCENES, ("#c0392b", "#1f6fb2")):
        for threads, line in zip(THREADS, ("o-", "s--")):
            mine = [r for r in table if (r["scene"], r["threads"]) == (scene, threads)]
            if not mine:
                continue
            n = [r["elements"] for r in mine]
            name = f"{scene}, {threads} thread{'s' * (threads > 1)}"
            clock = "cpu" if threads == 1 else "wall"
            axes[0].loglog(n, [r[clock] for r in mine], line, color=color, label=name)
            if threads == 1:
                axes[1].loglog(n, [r["building"] for r in mine], line, color=color, label=scene)
                axes[2].loglog(n, [r["memory"] for r in mine], line, color=color, label=scene)
    labels = (
        "a step [us]: CPU time; of two threads, wall time",
        "building and first step, CPU [s]",
        "memory [kB an element]",
    )
    for ax, label in zip(axes, labels):
        ax.set_xlabel("elements")
        ax.set_ylabel(label)
        ax.grid(alpha=0.3, which="both", lw=0.4)
        ax.legend(fontsize=8)
    figure.savefig(file, dpi=100)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="few sizes; nothing is stored")
    parser.add_argument(
        "--threads", type=int, action="append", help="so many alone; two need two idle cores"
    )
    parser.add_argument("--child", choices=SCENES, help=argparse.SUPPRESS)
    parser.add_argument("--size", type=int, help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.child:
        child(args.child, args.size)
    facts, table = here(), []
    for row in rows(args.quick, args.threads or THREADS):
        table.append(row)
        print(
            "{scene:6}{threads:2} threads {elements:7} elements  {cpu:9.4g} us CPU {wall:9.4g} us wall "
            "a step, built in {building:.3g} s, {memory:.3g} kB an element".format(**row),
            flush=True,
        )
    if args.quick:
        return
    OUT.mkdir(parents=True, exist_ok=True)
    with open(OUT / "scaling.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, [*facts, *table[0]], lineterminator="\n")
        writer.writeheader()
        for row in table:
            shown = {k: f"{v:.4g}" if isinstance(v, float) else v for k, v in row.items()}
            writer.writerow({**facts, **shown})
    draw(table, OUT / "scaling.png")


if __name__ == "__main__":
    main()
