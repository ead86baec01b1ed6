"""What is measured, on what, and by which clock."""

import datetime
import os
import pathlib
import platform
import re
import subprocess
import time

import ancf
from yade import O, config


def machine():
    """Model, vector units and cores of this machine."""
    try:
        info = pathlib.Path("/proc/cpuinfo").read_text()
    except OSError:
        info = ""
    fields = dict(re.findall(r"^(model name|cpu family|model|flags)\s*: (.*)$", info, re.M))
    flags = fields.get("flags", "").split()
    units = [shown for flag, shown in (("avx2", "AVX2"), ("avx512f", "AVX-512")) if flag in flags]
    family = f"family {fields.get('cpu family', '?')} model {fields.get('model', '?')}"
    name = f"{fields.get('model name', 'unknown')} ({family})"
    return f"{name}, {' '.join(units) or 'no AVX2'}, {os.cpu_count()} cores"


def code():
    """Commit of the tree in which the measured build lies, with + where it was changed since."""
    folder = pathlib.Path(ancf.__file__).resolve().parent

    def git(*words):
        done = subprocess.run(["git", "-C", folder, *words], capture_output=True, text=True)
        return done.stdout.strip() if done.returncode == 0 else ""

    return (git("rev-parse", "--short", "HEAD") or "unknown") + (
        "+" if git("status", "--porcelain") else ""
    )


def here():
    """What every row of a CSV says besides its figures: date, commit, versions, machine; printed, too."""
    facts = dict(
        date=datetime.date.today().isoformat(),
        commit=code(),
        yade=config.version,
        python=platform.python_version(),
        machine=machine(),
    )
    print("\n".join(f"{key:10}{value}" for key, value in facts.items()), flush=True)
    return facts


def timed(steps):
    """CPU and wall time of O.run(steps) [s], looked at every ms; O.run(steps, True) looks every 40."""
    wall, cpu, last = time.perf_counter(), time.process_time(), O.iter + steps
    O.run(steps)
    while O.running:
        time.sleep(1e-3)
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    if O.iter < last:
        O.run(1, True)  # raises what stopped it
        raise RuntimeError(f"the run stopped {last - O.iter} steps before its end")
    return cpu, wall
