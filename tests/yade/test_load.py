"""Loading the plugin into YADE: where it works, what it refuses, and that YADE lives on."""

import os
import pathlib
import subprocess
import sys
import sysconfig
import textwrap

import pytest

import ancf  # noqa: F401, finds YADE
from yade import config

ROOT = pathlib.Path(__file__).resolve().parents[2]
PYTHON = [sys.executable]
YADE = ["yade", "-n", "-x"]
YADE_VERSION = config.version
YADE_2_THREADS = ["yade", "-j2", "-n", "-x"]


def run(code, tmp_path, program=YADE):
    """Output of a script in a fresh process, which must succeed."""
    script = tmp_path / "script.py"
    script.write_text(textwrap.dedent(code))
    env = dict(os.environ)
    env.setdefault("PYTHONPATH", str(ROOT / "build" / "python"))
    done = subprocess.run(
        [*program, str(script)], env=env, capture_output=True, text=True, timeout=120, cwd=tmp_path
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


def refusal(before, tmp_path):
    """The message of the ImportError that `import ancf` gives after some preparation; YADE must still step."""
    code = textwrap.dedent(before) + textwrap.dedent(
        """
        from yade import O
        try:
            import ancf
        except ImportError as e:
            print("REFUSED:", e)
        O.step()
        assert O.iter == 1
        """
    )
    lines = [line for line in run(code, tmp_path).splitlines() if line.startswith("REFUSED:")]
    assert lines, "import ancf was not refused"
    return lines[0]


@pytest.mark.parametrize("program", [PYTHON, YADE, YADE_2_THREADS])
def test_import(program, tmp_path):
    out = run("import ancf; print('young =', ancf.HollarsMat(young=2e9).young)", tmp_path, program)
    assert "young = 2000000000.0" in out


@pytest.mark.parametrize("program", [PYTHON, YADE, YADE_2_THREADS])
def test_default_engines_step_after_import(program, tmp_path):
    code = """
        import ancf
        from yade import O, utils
        from yade.wrapper import *
        names = [e.__class__.__name__ for e in O.engines]
        assert "InteractionLoop" in names
        O.materials.append(ancf.HollarsMat(label="h"))
        O.materials.append(FrictMat(label="f"))
        O.bodies.append([utils.sphere((0, 0, 0), 1, material="f"), utils.sphere((0, 0, 1.9), 1, material="f")])
        O.bodies.append(utils.sphere((9, 0, 0), 1, material="h"))
        O.step()
        assert O.interactions[0, 1].isReal
        O.run(9, True)
        assert O.iter == 10
    """
    run(code, tmp_path, program)


def test_layout_check_passes_and_fails_by_name(tmp_path):
    code = """
        from ancf import _ancf
        assert _ancf._checkLayout() > 100
        wrong = {"Sphere.radius": 88, "sizeof Shape": 88, "vtable Sphere": 216, "Scene.bodies": 616, "Body.shape": 56,
                 "slot Engine::action": 12, "slot Law2_ScGeom_FrictPhys_CundallStrack::go": 4, "State.mass": 160}
        for name, number in wrong.items():
            try:
                _ancf._checkLayout({name: number})
            except ImportError as e:
                assert name in str(e) and str(number) in str(e), e
            else:
                raise AssertionError(name)
        try:
            _ancf._checkLayout({"Sphere.nonsense": 1})
        except ValueError as e:
            assert "Sphere.nonsense" in str(e)
        else:
            raise AssertionError("unknown fact accepted")
    """
    run(code, tmp_path, PYTHON)


@pytest.mark.parametrize(
    "before, named",
    [
        (
            "from yade import config; config.version = '2020.01a'",
            ["2020.01a", YADE_VERSION, "build it"],
        ),
        (
            "from yade import config; config.highPrecisionBits = 80",
            ["highPrecisionBits", "80", "64"],
        ),
        ("from yade import config; config.features.remove('MPI')", ["MPI"]),
        ("from yade import config; config.features.remove('OPENMP')", ["OPENMP"]),
        ("from yade import config; config.features.remove('FEMLIKE')", ["FEMLIKE"]),
        ("import platform; platform.machine = lambda: 'riscv64'", ["riscv64", "x86_64"]),
        ("import yade.wrapper; yade.wrapper.HollarsMat = object", ["HollarsMat", "already"]),
    ],
)
def test_refused(before, named, tmp_path):
    message = refusal(before, tmp_path)
    for word in named:
        assert word in message


@pytest.mark.parametrize(
    "missing, package, code",
    [
        ("scipy", "python3-scipy", "import ancf.capture"),
        ("scipy", "python3-scipy", "from ancf.campaign import statistics"),
        ("scipy", "python3-scipy", "from ancf import campaign; campaign.uniform(0, 1)"),
        ("scipy", "python3-scipy", "from ancf import campaign; campaign.normal(0, 1)"),
        ("vtkmodules", "python3-vtk9", "import ancf.capture"),
        ("vtkmodules", "python3-vtk9", "import ancf.render"),
        ("vtkmodules", "python3-vtk9", "import ancf.vtk"),
        ("matplotlib", "python3-matplotlib", "import ancf.plots"),
        ("tqdm", "python3-tqdm", "next(ancf.progress(1, 1))"),
    ],
)
def test_missing_packages_are_named(missing, package, code, tmp_path):
    """Only by what needs them: ancf and its campaigns are there without."""
    script = f"""
        import sys

        sys.modules["{missing}"] = None
        import ancf
        import ancf.campaign
        import ancf.mpi

        try:
            {code}
        except ImportError as e:
            assert "apt install {package}" in str(e) and e.name.startswith("{missing}"), e
        else:
            raise AssertionError("not needed")
    """
    run(script, tmp_path, PYTHON)


def test_refused_while_running(tmp_path):
    code = """
        from yade import O
        O.dt = 1e-9
        O.engines = [e for e in O.engines if e.__class__.__name__ == "ForceResetter"]
        O.run()
        try:
            import ancf
        except ImportError as e:
            assert "O.pause()" in str(e)
        else:
            raise AssertionError("loaded while running")
        O.pause()
        import ancf
    """
    run(code, tmp_path)


@pytest.mark.parametrize("name", ["scene.xml", "scene.xml.bz2", "scene.yade"])
def test_save_and_load(name, tmp_path):
    code = f"""
        import ancf
        from yade import O
        given = dict(label="m", young=4.456e8, poisson=.3, density=1440., staticFriction=.4, kineticFriction=.1,
                     transitionVelocity=2e-3, impactDamping=.1, normalStiffness=3e7, normalExponent=1.25)
        O.materials.append(ancf.HollarsMat(**given))
        O.save("{name}")
        O.reset()
        O.load("{name}")
        assert isinstance(O.materials["m"], ancf.HollarsMat)
        found = O.materials["m"].dict()
        assert {{k: found[k] for k in given}} == given, found
        O.saveTmp()
        O.materials["m"].staticFriction = .9
        O.loadTmp()
        assert O.materials["m"].staticFriction == .4
    """
    run(code, tmp_path)


def test_bad_values_are_refused_by_name(tmp_path):
    code = """
        import ancf
        nan, inf = float("nan"), float("inf")
        bad = dict(young=[0, -1, nan, inf], poisson=[-1, .51, nan], density=[0, -1, nan, inf],
                   staticFriction=[-.1, nan, inf], kineticFriction=[-.1, nan, inf], transitionVelocity=[0, -1, nan, inf],
                   impactDamping=[-.1, nan, inf], normalStiffness=[0, -1, inf], normalExponent=[0, .5, nan, inf])

        def refused(act, name):
            try:
                act()
            except ValueError as e:
                assert "HollarsMat." + name in str(e), e
            else:
                raise AssertionError(name)

        for name, values in bad.items():
            for value in values:
                refused(lambda: ancf.HollarsMat(**{name: value}), name)
                m = ancf.HollarsMat()
                old = getattr(m, name)
                refused(lambda: setattr(m, name, value), name)
                assert getattr(m, name) == old or old != old  # the old value stays
                refused(lambda: ancf.HollarsMat().updateAttrs({name: value}), name)
    """
    run(code, tmp_path, PYTHON)


def test_kinetic_above_static_friction_warns(tmp_path):
    code = """
        import warnings
        import ancf
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            m = ancf.HollarsMat(staticFriction=.1, kineticFriction=.2)
        assert m.kineticFriction == .2
        assert any("kineticFriction" in str(w.message) for w in caught)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            ancf.HollarsMat(staticFriction=.2, kineticFriction=.2)
    """
    run(code, tmp_path, PYTHON)


def test_dispatch_hierarchy_and_documentation(tmp_path):
    code = """
        import ancf
        m = ancf.HollarsMat()
        assert m.dispHierarchy() == ["HollarsMat", "ElastMat", "Material"]
        assert "Eq. 10" in ancf.HollarsMat.__doc__
        for name in m.dict():
            if name not in ("id", "label"):
                assert "[" in getattr(ancf.HollarsMat, name).__doc__, name  # a unit
    """
    run(code, tmp_path, PYTHON)


def test_no_class_of_yade_is_defined_twice():
    """Its vtable and typeinfo stay in YADE's libraries."""
    library = (
        ROOT / "build" / "python" / "ancf" / ("_ancf" + sysconfig.get_config_var("EXT_SUFFIX"))
    )
    symbols = subprocess.run(
        ["nm", "-D", "--defined-only", library], capture_output=True, text=True, check=True
    ).stdout
    names = [line.split()[-1] for line in symbols.splitlines()]
    libraries = "/usr/lib/x86_64-linux-gnu/yade-double"
    theirs = set()
    for name in ("libyade.so", "libpkg_common.so", "libpkg_dem.so"):
        out = subprocess.run(
            ["nm", "-D", "--defined-only", f"{libraries}/{name}"],
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        found = {line.split()[-1] for line in out.splitlines()}
        assert "_ZTVN4yade11InteractionE" in found or name != "libyade.so"
        theirs |= found
    assert len(theirs) > 1000
    doubled = [n for n in names if n.startswith(("_ZTVN4yade", "_ZTIN4yade")) and n in theirs]
    assert not doubled
