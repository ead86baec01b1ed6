"""Runs the cases of a study in several processes.

It is imported before numpy, whose own threads would else take the cores of the other processes: `import ancf` gives
it one thread.
"""

import multiprocessing
import sys

from tqdm import tqdm

import ancf  # noqa: F401


def addOption(parser):
    parser.add_argument("--workers", type=int, default=2, help="processes")


def runAll(make, jobs, workers, title):
    """make(job) of all jobs, in their order, with a bar."""
    if workers == 1:
        return [make(job) for job in tqdm(jobs, desc=title, file=sys.stdout, leave=False)]
    with multiprocessing.get_context("fork").Pool(workers, maxtasksperchild=8) as pool:
        done = pool.imap(make, jobs, chunksize=1)
        return list(tqdm(done, total=len(jobs), desc=title, file=sys.stdout, leave=False))


def insist(make, job):
    """make(*job, smaller=...) with half the step, and a quarter ..., if the engine refuses one that has become too
    long.
    """
    for again in range(4):
        try:
            return make(*job, smaller=0.5**again)
        except RuntimeError as told:
            print(f"{job}: {told}; again with half the step", flush=True)
    raise RuntimeError(f"{job}: no step is short enough")
