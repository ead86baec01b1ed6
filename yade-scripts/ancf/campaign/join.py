"""Joins this machine to a Dask scheduler, as a worker for campaigns.

    python3 -m ancf.campaign.join tcp://host:8786 --workers 4

Each of the workers has a process of YADE of its own.
"""

import argparse
import asyncio
import os
import signal
import sys

from . import running, worker

GRACE = 60  # for a scheduler that starts at the same time [s]


async def join(address, workers):
    """Works until the scheduler ends, or SIGTERM or SIGINT tells to."""
    from distributed import Worker

    stop = asyncio.Event()
    for signalled in (signal.SIGTERM, signal.SIGINT):
        asyncio.get_running_loop().add_signal_handler(signalled, stop.set)
    async with Worker(address, nthreads=workers, death_timeout=GRACE) as member:
        print(f"{member.address} works for {address}, {workers} at a time", flush=True)
        stopped, finished = (asyncio.create_task(x) for x in (stop.wait(), member.finished()))
        await asyncio.wait([stopped, finished], return_when=asyncio.FIRST_COMPLETED)
        worker.endAll()


def main():
    parser = argparse.ArgumentParser(
        prog="python3 -m ancf.campaign.join", description=__doc__.splitlines()[0]
    )
    parser.add_argument("scheduler", help="address that `dask-scheduler` prints, tcp://host:8786")
    parser.add_argument(
        "--workers", type=int, default=os.cpu_count(), help="processes; otherwise one a core"
    )
    args = parser.parse_args()
    try:
        asyncio.run(join(args.scheduler, args.workers))
    except (ImportError, OSError, ValueError, asyncio.TimeoutError) as error:
        print(f"join: {running.noScheduler(args.scheduler, error)}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
