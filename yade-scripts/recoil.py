"""What damping of its cables changes in a net's capture of a ball, and in the recoil that opens it again.

The capture of ball_capture, perturbed, with Kelvin-Voigt times from 0.4 to 4 times its own. Run it by
`/usr/bin/python3 recoil.py`; results go to out/recoil/.
"""

import argparse
import pathlib
from dataclasses import dataclass

from jobs import addOption, insist, runAll  # first: see there

import ball_capture as given
import numpy as np
from ancf.capture import CLOSED
from net_study import of, spread, writeTable
from yade import O

# ---- parameters, SI units; the rest is ball_capture's --------------------------------------------
DAMPINGS = (2e-5, 5e-5, 1e-4, 2e-4)  # Kelvin-Voigt times [s]
RUNS = 4  # of each, the first as it is and the others perturbed
SHOWN = ("#1f6fb2", "#2e8b57", "#e08e0b", "#c0392b")


@dataclass
class Recoil:
    """What is kept of a run: time [s], mouth as part of its largest, speed of the bullets along x [m/s], and
    Capture.row().
    """

    damping: float
    time: np.ndarray
    share: np.ndarray
    ahead: np.ndarray
    embraced: bool
    row: dict


def capture(job):
    return insist(recoil, job)


def recoil(damping, number, duration, smaller):
    nudge = given.nudges(number) if number else np.zeros(4)
    run = given.Run(nudge, False, duration, f"damping {damping:g} s", damping=damping)
    O.dt *= smaller
    run.run()
    ahead = np.array(run.history.velocity)[:, :, 0].mean(axis=1)
    time, share = np.array(run.history.time), run.capture.share
    return Recoil(damping, time, share, ahead, run.embraced, run.capture.row())


def plot(runs, file):
    """runs: {damping: [Recoil, ...]}."""
    from ancf.plots import plt

    figure, axes = plt.subplots(1, 2, figsize=(13, 4.6))
    for (damping, all_), color in zip(runs.items(), SHOWN):
        for k, run in enumerate(all_):
            style = dict(color=color, lw=0.5 if k else 1.8, alpha=0.5 if k else 1)
            label = None if k else f"{damping:g} s"
            axes[0].plot(run.time, run.share, label=label, **style)
            axes[1].plot(run.time, run.ahead, label=label, **style)
    axes[0].axhline(CLOSED, color="k", lw=0.8, ls=":")
    axes[0].set_ylabel("mouth, as part of its largest so far")
    axes[1].axhline(0, color="k", lw=0.8, ls=":")
    axes[1].set_ylabel("mean speed of the bullets along x [m/s]")
    for ax in axes:
        ax.set_xlim(0.45, None)
        ax.set_xlabel("time [s]")
        ax.grid(alpha=0.3)
    axes[0].legend(fontsize=9, title="Kelvin-Voigt time")
    figure.tight_layout()
    figure.savefig(file, dpi=90)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="short form")
    parser.add_argument("--runs", type=int, default=RUNS, help="of each damping")
    addOption(parser)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/recoil"))
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    dampings, count = (DAMPINGS[1:2], 1) if args.quick else (DAMPINGS, args.runs)
    jobs = [(d, k, given.DURATION) for d in dampings for k in range(count)]
    done = runAll(capture, jobs, args.workers, "dampings")
    runs = {d: [r for r in done if r.damping == d] for d in dampings}
    head = (
        "Kelvin-Voigt time [s],open [s],mouth then [m2],embraced from [s],until [s],"
        "mouth at the tightest [%],bullets back at [m/s],largest tension [N],embraced"
    ).split(",")
    rows = [
        [
            f"{damping:g}",
            spread(of(all_, "open_s"), 2),
            spread(of(all_, "mouth_open_m2"), 3),
            spread(of(all_, "embraced_from_s"), 2),
            spread(of(all_, "embraced_until_s"), 2),
            spread(of(all_, "mouth_tightest", 100), 0),
            spread([-r.ahead.min() for r in all_], 2),
            spread(of(all_, "tension_most_N"), 1),
            f"{sum(r.embraced for r in all_)} of {len(all_)}",
        ]
        for damping, all_ in runs.items()
    ]
    writeTable(args.out / "recoil.csv", head, rows)
    plot(runs, args.out / "recoil.png")
    print(f"figures: {args.out}/recoil.png")


if __name__ == "__main__":
    main()
