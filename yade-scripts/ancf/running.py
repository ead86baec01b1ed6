"""Runs a scene, and tells how far it is."""

import math

from yade import O

from . import values


def progress(duration, every, title="run"):
    """Steps the scene on for `duration` [s] of its time and yields after every `every` [s], and at the end.
    A terminal shows a bar meanwhile, with the time that is left.

        for _ in ancf.progress(1.5, 5e-3):
            history.sample()

    Raises ValueError, TypeError that name the argument.
    """
    duration = values.positive("progress: duration", duration, "s")
    every = values.positive("progress: every", every, "s")
    return _steps(duration, every, title)


def _steps(duration, every, title):
    from tqdm import tqdm  # only where something is shown

    form = "{desc} {percentage:3.0f}% |{bar}| {n:.3g} of {total:.3g} s simulated, {remaining} left"
    start = O.time
    with tqdm(
        total=duration, desc=title, leave=False, bar_format=form, mininterval=0.3, disable=None
    ) as bar:
        for k in range(1, math.ceil(duration / every * (1 - 1e-12)) + 1):
            stop = start + min(k * every, duration)
            if O.time >= stop - 0.5 * O.dt:
                continue  # `every` is shorter than a step
            while O.time < stop - 0.5 * O.dt:
                O.step()
            bar.update(min(O.time - start, duration) - bar.n)
            yield
