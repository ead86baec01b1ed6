#!/usr/bin/python3
"""Breaks one term of the physics at a time and sees whether the tests notice.

Each entry of mutations.toml names a file, a text that stands in it exactly once, what it becomes, and the tests that
should fail: "c:law" is the program tests/c/test_law.c, anything else arguments of pytest in tests/yade. All is built in a
copy of the sources, in a folder of its own. Each test is run once unbroken, then with the change, until one notices it.
What none notices is listed at the end, and the script ends with 1; as it does where a text is not found any more.

    tests/mutate.py [-k word] [--folder build/mutate] [--check]
"""

import argparse
import os
import pathlib
import shlex
import shutil
import subprocess
import sys
import time
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[1]
SOURCES = (
    "CMakeLists.txt",
    "CMakePresets.json",
    "LICENSE",
    "README.md",
    "packaging",
    "plugin",
    "tests",
    "yade-scripts",
)
PYTHON = os.environ.get("PYTHON", "/usr/bin/python3")
TIME = 1200  # that tests may take until they count as failed [s]


def table(word):
    with open(ROOT / "tests" / "mutations.toml", "rb") as file:
        entries = tomllib.load(file)["mutation"]
    missing = []
    for entry in entries:
        found = (ROOT / entry["file"]).read_text().count(entry["text"])
        if found != 1:
            missing.append(f"{entry['file']}: stands there {found} times: {entry['text']!r}")
        if entry["text"] == entry["becomes"]:
            missing.append(f"{entry['file']}: changes nothing: {entry['text']!r}")
    if missing:
        sys.exit("mutations.toml does not fit the sources any more:\n" + "\n".join(missing))
    return [e for e in entries if word in e["what"] or word in e["file"]]


class Copy:
    """Sources and build in a folder of their own; what has not changed is not copied again."""

    def __init__(self, folder):
        self.source, self.build = folder, folder / "build"
        self.source.mkdir(parents=True, exist_ok=True)
        for name in SOURCES:
            self._update(pathlib.Path(name))
        cache = [f"-DCMAKE_{x}_COMPILER_LAUNCHER=ccache" for x in ("C", "CXX")]
        cache = cache if shutil.which("ccache") else []
        command = ["cmake", "-G", "Ninja", "-S", self.source, "-B", self.build, *cache]
        run([*command, "-DCMAKE_BUILD_TYPE=RelWithDebInfo"], "configure", must=True)

    def _update(self, name):
        there, here = ROOT / name, self.source / name
        if there.is_file():
            if not here.exists() or here.read_bytes() != there.read_bytes():
                shutil.copyfile(there, here)
            return
        here.mkdir(exist_ok=True)
        names = {p.name for p in there.iterdir() if p.name != "__pycache__"}
        for old in {p.name for p in here.iterdir()} - names:
            gone = here / old
            shutil.rmtree(gone) if gone.is_dir() else gone.unlink()
        for each in sorted(names):
            self._update(name / each)

    def make(self, tests, must=False):
        targets = [f"test_{t[2:]}" for t in tests if t.startswith("c:")]
        targets += ["_ancf"] if len(targets) < len(tests) else []
        return run(["cmake", "--build", self.build, "--target", *targets], "build", must)

    def passes(self, test, must=False):
        """Whether a test passes. A C program is run as it is, pytest stops at the first failure."""
        if test.startswith("c:"):
            return run([self.build / "tests" / "c" / f"test_{test[2:]}"], test, must)
        environment = {"OMP_WAIT_POLICY": "passive", **os.environ}  # other work goes on beside
        environment["PYTHONPATH"] = str(self.build / "python")
        command = [PYTHON, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", *shlex.split(test)]
        return run(command, test, must, cwd=self.source / "tests" / "yade", env=environment)


def run(command, what, must=False, **options):
    """Whether a command ends with 0 in time."""
    try:
        done = subprocess.run(
            [str(c) for c in command], capture_output=True, text=True, timeout=TIME, **options
        )
    except subprocess.TimeoutExpired:
        if must:
            sys.exit(f"{what} takes more than {TIME} s without any change")
        return False
    if must and done.returncode:
        sys.exit(f"{what} fails without any change:\n{done.stdout[-4000:]}{done.stderr[-4000:]}")
    return done.returncode == 0


def verdict(copy, entry, sound):
    """What the first test that notices a change is, or that there is none. sound: tests that pass unbroken."""
    path = copy.source / entry["file"]
    good = path.read_text()
    for test in entry["tests"]:
        if test not in sound:
            copy.make([test], must=True)
            copy.passes(test, must=True)
            sound.add(test)
        path.write_text(good.replace(entry["text"], entry["becomes"]))
        try:
            if not copy.make([test]):
                return "does not build"
            if not copy.passes(test):
                return f"noticed by {test}"
        finally:
            path.write_text(good)
    return "SURVIVES"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("-k", default="", help="only entries with this word in what or file")
    parser.add_argument("--folder", default=ROOT / "build" / "mutate", type=pathlib.Path)
    parser.add_argument("--check", action="store_true", help="only whether the texts are there")
    args = parser.parse_args()
    entries = table(args.k)
    print(f"{len(entries)} entries fit the sources", flush=True)
    if args.check:
        return
    copy, sound, survivors = Copy(args.folder), set(), []
    for entry in entries:
        start = time.monotonic()
        result = verdict(copy, entry, sound)
        print(f"{entry['what']:60s} {result:32s} {time.monotonic() - start:5.0f} s", flush=True)
        if not result.startswith("noticed"):
            survivors.append(f"{entry['what']} ({entry['file']}): {result}")
    print(f"{len(entries) - len(survivors)} of {len(entries)} noticed")
    sys.exit("\n".join(["survivors:", *survivors]) if survivors else 0)


if __name__ == "__main__":
    main()
