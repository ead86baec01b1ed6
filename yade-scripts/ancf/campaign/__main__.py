"""Runs a scene over a table of parameters or over random ones.

The scene script has a function `run`, whose arguments are the parameters and which returns a dict of
results. These go into an SQLite file, a row a run. The same command goes on where it was interrupted.
"""

import argparse
import os
import pathlib
import sys

from . import running, tables


def options():
    parser = argparse.ArgumentParser(
        prog="python3 -m ancf.campaign",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("scene", type=pathlib.Path, help="script with a function run()")
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument(
        "--table", metavar="CSV", help="parameters: names in the first line, a run in each other"
    )
    what.add_argument(
        "--random",
        type=int,
        metavar="N",
        help="N runs of random parameters, as VARY in the scene says",
    )
    parser.add_argument("--seed", type=int, default=1, help="of random parameters")
    parser.add_argument(
        "--results", type=pathlib.Path, help="SQLite file; otherwise named like the scene, .db"
    )
    parser.add_argument(
        "--workers",
        type=int,
        default=os.cpu_count(),
        help="processes on this machine; otherwise one a core",
    )
    parser.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="take the workers of this Dask scheduler instead, tcp://host:8786",
    )
    parser.add_argument(
        "--limit", type=float, default=running.LIMIT, help="of a run [s], %(default)g"
    )
    parser.add_argument("--again", action="store_true", help="make failed runs again")
    parser.add_argument("--csv", type=pathlib.Path, help="write finished runs into this file, too")
    return parser.parse_args()


def tell(results):
    runs, finished, failed = results.count()
    print(f"{results.path}: {finished} of {runs} runs finished, {failed} of them failed")
    for error, number in list(results.errors().items())[:3]:
        print(f"  {number} x {error}")


def main():
    args = options()
    results = args.results or pathlib.Path(args.scene.stem + ".db")
    try:
        if args.table:
            table = tables.read(args.table)
        else:
            table = running.drawn(args.scene, args.random, args.seed)
        kept = running.run(
            args.scene, table, results, args.workers, args.scheduler, args.limit, args.again
        )
    except KeyboardInterrupt:
        print(f"\n{results}: finished runs are kept; the same command goes on", file=sys.stderr)
        return 130
    except (OSError, RuntimeError, TypeError, ValueError) as error:
        print(f"campaign: {error}", file=sys.stderr)
        return 1
    with kept:
        tell(kept)
        if args.csv:
            kept.writeCsv(args.csv)
    return 0


if __name__ == "__main__":
    sys.exit(main())
