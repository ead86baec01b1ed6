"""Error against CPU time: cables, nets, sheaves and a floor, beside YADE's own chains and other programs.

Run it by `PYTHONPATH=build/python /usr/bin/python3 tests/bench/precision.py`; PYTHONPATH says which build is
measured. --peers PYTHON takes a Python that has the other programs (pip install exudyn pyelastica
mujoco cabledyn==0.3.0) and runs their parts in turns with ours. A CSV and a diagram for each case
go to docs/images/precision. Every case is a process of its own with one thread. Times are CPU times
without the scene being built, medians of the rounds; compare them within one run.
"""

import argparse
import csv
import functools
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import asdict, replace

os.environ["OMP_NUM_THREADS"] = "1"
ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "yade-scripts"), str(ROOT / "tests" / "bench")]

import numpy as np  # noqa: E402

import ancf  # noqa: E402, F401  YADE's classes, before its modules
from machine import here  # noqa: E402
from workprecision import (
    diagram,
    floor,
    moved,
    nets,
    references,
    sheaves,
    smooth,
    startup,
)  # noqa: E402
from workprecision.measure import Row  # noqa: E402

MODULES = (smooth, moved, nets, sheaves, startup, floor)
CASES = {name: case for module in MODULES for name, case in module.CASES.items()}
# Title, what is off, and the stored reference that says how well the truth is known.
SHOWN = {
    "pendulum": ("Flexible pendulum, 1 s", "the tip [m]", None),
    "string": ("Plucked string, 3.3 periods", "nodes, RMS / amplitude", None),
    "cantilever": ("Cantilever, let go", "the tip [m]", "cantilever"),
    "moved end stiff": ("Moved end, EA = 2e7 N", "places, RMS [m]", "moved end stiff"),
    "moved end soft": ("Moved end, EA = 4e5 N", "places, RMS [m]", "moved end soft"),
    "net opens": ("Folded net, 0.1 s after the shot", "knots, RMS [m]", "net opens"),
    "net on ball": ("Flat net on a ball", "the impulse, relative", "net on ball"),
    "capstan": ("Capstan, half a turn", "T2/T1, relative", None),
    "belt": ("Belt drive below slip", "the creep, relative", None),
    "belt starts": ("Belt drive, 2.45 s from its start", "the ratio of speeds, relative", None),
    "catenary on a floor": ("Cable partly on a floor", "nodes, RMS [m]", None),
}
PEERS = {
    "pendulum": ("exudyn", "elastica", "mujoco"),
    "string": ("exudyn",),  # thin sections of Cosserat rods would need 5e5 steps
    "cantilever": ("exudyn", "elastica", "mujoco"),
    "moved end stiff": ("cabledyn",),  # it starts from rest alone: nothing that is let go
    "moved end soft": ("cabledyn",),
    "net on ball": ("mujoco",),
    "belt starts": ("exudyn",),
    "catenary on a floor": ("cabledyn",),
}
LIMIT = 1800  # a process may take [s]
LONG = 100  # a case whose first round takes longer has no other [s]
MARK = "result: "
OUT = ROOT / "docs" / "images" / "precision"


def process(command, text=""):
    """What a process leaves in its last line; raises RuntimeError with what it said else."""
    with tempfile.TemporaryDirectory() as folder:  # some programs leave logs where they run
        done = subprocess.run(
            command, input=text, capture_output=True, text=True, timeout=LIMIT, cwd=folder
        )
    for line in reversed(done.stdout.splitlines()):
        if line.startswith(MARK):
            return json.loads(line[len(MARK) :])
    said = " | ".join((done.stderr + done.stdout).strip().splitlines()[-3:])
    raise RuntimeError(f"{command[1:4]} ended with {done.returncode}: {said}")


def child(name, quick):
    """One case, in this process; its rows go to the last line of stdout."""
    rows = []
    for row in CASES[name].rows(quick):
        print(row, file=sys.stderr, flush=True)
        rows.append(asdict(row))
    print(MARK + json.dumps(rows), flush=True)
    os._exit(0)  # YADE may end badly


def ours(name, quick):
    command = [sys.executable, str(pathlib.Path(__file__).resolve()), "--child", name] + [
        "--quick"
    ] * quick
    return [Row(**row) for row in process(command)]


def runs(python, program, given):
    """What another program made of a case."""
    script = str(ROOT / "tests" / "bench" / "workprecision" / "peers.py")
    return process([python, script, program], json.dumps(given))


def theirs(python, program, name):
    """Rows of another program."""
    module = next(m for m in MODULES if name in m.CASES)
    rows = []
    for method, n, integrator, step, cpu, value in runs(python, program, module.forPeers(name)):
        errors = np.atleast_1d(module.peerError(name, value))
        rows.append(Row(method, n, "", integrator, step, cpu, *map(float, errors)))
    return rows


def together(rounds):
    """Rows with the median CPU time of all rounds."""
    return [
        replace(each[0], cpu=statistics.median(row.cpu for row in each)) for each in zip(*rounds)
    ]


def save(name, rows, facts):
    OUT.mkdir(parents=True, exist_ok=True)
    file = OUT / f"{name.replace(' ', '-')}.csv"
    with open(file, "w", newline="") as out:
        writer = csv.DictWriter(out, [*facts, *asdict(rows[0])], lineterminator="\n")
        writer.writeheader()
        for row in rows:
            shown = {k: f"{v:.4g}" if isinstance(v, float) else v for k, v in asdict(row).items()}
            writer.writerow({**facts, **shown})
    title, label, known = SHOWN[name]
    check = references.check(known) if known else None
    diagram.draw(rows, title, label, check, file.with_suffix(".png"))


def options():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="few settings; nothing is stored")
    parser.add_argument("--only", choices=CASES, action="append", help="this case; may be repeated")
    parser.add_argument("--peers", metavar="PYTHON", help="a Python that has the other programs")
    parser.add_argument("--rounds", type=int, default=3, help="of all programs in turns, at most")
    parser.add_argument("--references", action="store_true", help="make the references again first")
    parser.add_argument("--child", choices=CASES, help=argparse.SUPPRESS)
    return parser.parse_args()


def main():
    args = options()
    if args.child:
        child(args.child, args.quick)
    facts = here()
    if args.references:
        for module in (smooth, moved, nets):
            references.store(module.makeReferences())
        if args.peers:
            run = functools.partial(runs, args.peers, "cabledyn")
            references.store(moved.makePeerReferences(run))
    for name in args.only or CASES:
        programs = PEERS.get(name, ()) if args.peers and not args.quick else ()
        rounds, begin = [], time.monotonic()
        while len(rounds) < (1 if args.quick else args.rounds):
            if rounds and time.monotonic() - begin > LONG:
                break
            rounds.append(ours(name, args.quick))
            for program in programs:
                rounds[-1] += theirs(args.peers, program, name)
        rows = together(rounds)
        for row in rows:
            print(
                f"{name:20}{row.method:30}{row.elements:4}  {row.integrator:13}{row.mass:11}"
                f"{row.step:10.3g} s{row.cpu:10.4g} s  error {row.error:9.3g} {row.second:9.3g}",
                flush=True,
            )
        if not args.quick:
            save(name, rows, facts)


if __name__ == "__main__":
    main()
