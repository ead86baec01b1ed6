"""Finds YADE, makes sure that it is the one this package was built for, and loads our classes into it."""

import glob
import importlib
import os
import platform
import re
import sys

try:
    from . import _built
except ImportError:
    raise ImportError(
        "ancf: its compiled part is not here; build it by `cmake --preset default && cmake --build "
        "--preset default`, then run with PYTHONPATH=build/python, or `cmake --install build`"
    ) from None

NEEDED_BITS = 64
NEEDED_FEATURES = ("OPENMP", "MPI", "FEMLIKE")  # each changes the layout of YADE's classes
NEEDED_MACHINE = "x86_64"


def _folderFromScript(script):
    """The folder that the `yade` script itself puts on sys.path."""
    try:
        with open(script, encoding="utf-8") as f:
            found = re.search(r"sys\.path\.insert\(\d,\s*'([^']+)'", f.read())
    except OSError:
        return None
    return found and found.group(1)


def _yadeFolders():
    """Folders that may hold the Python package `yade`, best first."""
    prefix = os.environ.get("YADE_PREFIX", "/usr")
    fromScript = _folderFromScript(os.path.join(prefix, "bin", "yade"))
    folders = [fromScript] if fromScript else []
    return folders + sorted(glob.glob(os.path.join(prefix, "lib", "*", "yade-double", "py")))


def _require(good, what, found, needed):
    if not good:
        raise ImportError(
            f"ancf was built for {what} {needed}, found {found}; run it there, or build it here again: "
            "cmake --preset default --fresh && cmake --build --preset default"
        )


def _checkPython():
    python = ".".join(map(str, sys.version_info[:2]))
    _require(python == _built.PYTHON, "Python", platform.python_version(), _built.PYTHON)
    _require(
        platform.machine() == NEEDED_MACHINE,
        "a machine of type",
        platform.machine(),
        NEEDED_MACHINE,
    )


def _importYade():
    """`yade`, imported if this is plain Python."""
    if "yade" in sys.modules:
        return sys.modules["yade"]
    for folder in _yadeFolders():
        if os.path.isfile(os.path.join(folder, "yade", "__init__.py")):
            sys.path.insert(1, folder)
            break
    os.environ.setdefault("OMP_NUM_THREADS", "1")  # as `yade` without -j
    try:
        import yade
    except ImportError as e:
        raise ImportError(
            f"ancf needs YADE {_built.YADE}, which was in {_built.YADE_FOLDER} (Debian: apt install yade): {e}"
        ) from e
    return yade


def _checkYade(config):
    _require(config.version == _built.YADE, "YADE", config.version, _built.YADE)
    bits = config.highPrecisionBits
    _require(bits == NEEDED_BITS, "a YADE with highPrecisionBits", bits, NEEDED_BITS)
    for feature in NEEDED_FEATURES:
        _require(
            feature in config.features,
            "a YADE with the feature",
            " ".join(config.features),
            feature,
        )


def _refreshDispatchers(engines):
    """Dispatchers size their tables when functors are added; those made before our classes must do it again."""
    for engine in engines:
        for name in ("boundDispatcher", "geomDispatcher", "physDispatcher", "lawDispatcher"):
            dispatcher = getattr(engine, name, None)
            if dispatcher is not None:
                dispatcher.functors = dispatcher.functors


def showLines():
    """Lets YADE's 3D view, if there is one, draw lines, which are no bodies."""
    from yade import wrapper

    if "yade.qt" not in sys.modules:
        return
    view = sys.modules["yade.qt"].Renderer()
    if not any(isinstance(one, wrapper.GlExtra_Lines) for one in view.extraDrawers):
        view.extraDrawers = [*view.extraDrawers, wrapper.GlExtra_Lines()]


def _load():
    _checkPython()
    yade = _importYade()
    from yade import config, wrapper

    _checkYade(config)
    omega = wrapper.Omega()
    if omega.running:
        raise ImportError("ancf cannot be loaded while a simulation runs: O.pause() first")
    _ancf = importlib.import_module("._ancf", __package__)
    _refreshDispatchers(omega.engines)
    if "yade.qt" in sys.modules:  # as `yade` without -n
        _ancf._refreshView(sys.modules["yade.qt"].Renderer())
        showLines()
    return {name: getattr(wrapper, name) for name in _ancf.classNames}


classes = _load()
