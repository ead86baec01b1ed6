"""ancf.structures(): Cable and Net objects of a scene that was loaded."""

import json
import subprocess
import sys

import numpy as np
import pytest
from helpers import array, material, plane, steps

import ancf
from yade import O


@pytest.fixture
def made(scene, tmp_path):
    """A net with bullets, a tow on a box and a tail on the net; the name of their save."""
    material("cable", young=1e9, density=1000)
    box = plane((0, 0, 1.1), (0.05, 0.05, 0.05), material="cable")
    given = dict(diameter=2e-3, material="cable")
    net = ancf.Net.square(3, 0.1, 2, slack=0.01, **given)
    net.addBullets(0.01, 0.005, 1, 0.1)
    tow = ancf.Cable([(0, 0, 0.3), (0, 0, 1)], 4, label="tow", **given)
    tow.follow(-1, box)
    tail = ancf.Cable([net.knots[5], net.knots[5] + [0.5, 0, 0]], 2, label="tail", **given)
    tail.tie(0, net, 5)
    tail.clamp(1)
    O.engines = ancf.engines(net, tow, tail, gravity=(0, 0, -9.81))
    steps(20)
    save = str(tmp_path / "scene.xml")
    O.save(save)
    return net, tow, tail, save


def facts(structure):
    s = structure
    return {
        "kind": type(s).__name__,
        "name": s.name,
        "held": {int(k): s._claims[k] for k in sorted(s._claims)},
        "bodies": s.bodies,
        "bullets": getattr(s, "bullets", None),
        "knots": s.knots.tolist(),
        "curve": np.asarray(s.curve(3)).tolist(),
        "tension": s.spans[1 % len(s.spans)].tension(0.3),
        "length": s.length,
        "mass": s.mass,
        "energy": s.energy(),
        "mouth": s.mouthArea() if isinstance(s, ancf.Net) else None,
        "normal": list(s.normal) if isinstance(s, ancf.Net) else None,
    }


def test_same_objects_before_and_after_load(made):
    *own, save = made
    before = json.dumps([facts(s) for s in own])
    assert json.dumps([facts(s) for s in ancf.structures()]) == before
    O.load(save)
    assert json.dumps([facts(s) for s in ancf.structures()]) == before


def test_in_another_process(made):
    *own, save = made
    code = (
        "import ancf, json, test_record; from yade import O; O.load(%r); "
        "print('RESULT' + json.dumps([test_record.facts(s) for s in ancf.structures()]))" % save
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        cwd=__file__.rpartition("/")[0],
    )
    result = [line for line in done.stdout.splitlines() if line.startswith("RESULT")]
    assert result, done.stderr
    assert json.loads(result[0][6:]) == json.loads(json.dumps([facts(s) for s in own]))


def test_they_act(made):
    save = made[-1]
    O.load(save)
    net, tow, tail = ancf.structures()
    with pytest.raises(ValueError, match="Net: knot 0 is carrying body .* cannot be fixed"):
        net.fix(0)
    with pytest.raises(ValueError, match="the net has bullets already"):
        net.addBullets(0.01, 0.005, 1, 0.1)
    with pytest.raises(ValueError, match="tail: knot 0 is tied to knot 5 of Net"):
        tail.fix(0)
    tail.release(1)
    assert tail._claims == {0: "tied to knot 5 of Net"}
    assert list(tail.engine.clampedEnds) == []
    before = array(tail.point(1))
    slope = tail.curve(8)[-1] - tail.curve(8)[-2]
    steps(200)
    assert array(tail.point(1))[2] < before[2] - 1e-6  # falls
    assert np.abs(tail.curve(8)[-1] - tail.curve(8)[-2] - slope).max() > 1e-9  # and turns
    more = ancf.Cable([(0, 1, 0), (0, 2, 0)], diameter=2e-3, material="cable", label="more")
    more.append(engine=net.engine)
    assert [s.name for s in ancf.structures()] == ["Net", "tow", "tail", "more"]


def test_names_and_places_are_kept(scene, tmp_path):
    """Labels of cables, nets and lines, and what a line runs through: knots, also tied ones, and points of
    bodies."""
    material("cable", young=1e9, density=1000)
    given = dict(diameter=2e-3, material="cable")
    mesh = ancf.Net.square(2, 0.1, label="mesh", **given)
    rope = ancf.Cable([mesh.knots[2], mesh.knots[2] + [0.5, 0, 0]], label="rope", **given)
    rope.tie(0, mesh, 2)
    box = plane((0, 0, 1), (0.05, 0.05, 0.05), material="cable")
    O.engines = ancf.engines(mesh, rope)
    through = [(mesh, 0), (mesh, 4), (rope, 1), (box, (0.01, 0, -0.05))]
    ancf.Line(through, diameter=1e-3, material="cable", label="pull").append()
    save = str(tmp_path / "scene.xml")
    O.save(save)
    for loaded in (False, True):
        if loaded:
            O.load(save)
        net, cable = ancf.structures()
        assert (type(net), net.name) == (ancf.Net, "mesh")
        assert (type(cable), cable.name) == (ancf.Cable, "rope")
        (line,) = ancf.lines()
        assert line.name == "pull" and line.diameter == 1e-3
        assert [getattr(what, "name", what) for what, _ in line.places] == [
            "mesh",
            "mesh",
            "rope",
            box,
        ]
        assert [at for _, at in line.places] == [0, 4, 1, (0.01, 0, -0.05)]


def test_damaged_record_is_told(made):
    engine = made[0].engine
    engine.note(1, "{")
    with pytest.raises(ValueError, match="CableEngine .*.record.1. = '{': does not describe"):
        ancf.structures()
    with pytest.raises(IndexError, match="number = 9: there are 3"):
        engine.note(9, "")
