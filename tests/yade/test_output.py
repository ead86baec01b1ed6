"""Tables, curves over time and ParaView files of a scene, and how far it is."""

import math

import numpy as np
import pytest
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

from ancf.vtk import VtkRecorder
from helpers import O, ancf, material, plane, steps, utils


def test_history(net, tmp_path):
    from ancf.plots import History

    made, _, _ = net
    history = History(made)
    history.sample()
    steps(100)
    history.sample()
    history.save(tmp_path / "h.csv")
    history.plot(tmp_path / "h.png", {"now": O.time})
    rows = np.genfromtxt(tmp_path / "h.csv", delimiter=",", names=True)
    moved = history.displacement[-1, 0]
    assert rows["displacement1_m"][-1] == pytest.approx(moved)
    assert moved == pytest.approx(1.5 * 100 * O.dt, rel=2e-2)
    assert rows["mouth_area_m2"][0] == pytest.approx((0.12 * 0.8) ** 2, rel=5e-2)


def read(path):
    """vtkPolyData of a file, and its arrays as numpy by name."""
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    data = reader.GetOutput()
    arrays = {}
    for part in (data.GetPointData(), data.GetCellData()):
        for i in range(part.GetNumberOfArrays()):
            arrays[part.GetArrayName(i)] = vtk_to_numpy(part.GetArray(i))
    return data, arrays


def test_paraview_files(net, tmp_path):
    made, target, box = net
    recorder = VtkRecorder(tmp_path / "scene-", [made], [target, box], perElement=4)
    recorder.save()
    steps(10)
    recorder.save()
    cables, of = read(tmp_path / "scene-cables-0001.vtp")
    bodies, _ = read(tmp_path / "scene-bodies-0001.vtp")
    edges, engine = len(made.edges), made.engine
    assert cables.GetNumberOfCells() == edges
    points = vtk_to_numpy(cables.GetPoints().GetData()).reshape(edges, 5, 3)
    assert np.allclose(points, made.curve(4), atol=1e-12)
    assert of["speed"][0] == pytest.approx(O.bodies[made.bullets[0]].state.vel.norm(), rel=1e-2)
    assert np.abs(of["tension"]).max() > 1e-3
    for name in ("tension", "strain"):  # one element an edge, as the engine tells it
        there = [[getattr(engine, name)(e, k / 4) for k in range(5)] for e in range(edges)]
        assert np.array_equal(of[name].reshape(edges, 5), there)
    there = [[list(engine.pointVelocity(e, k / 4)) for k in range(5)] for e in range(edges)]
    assert np.array_equal(of["velocity"].reshape(edges, 5, 3), there)
    assert np.all(of["radius"] == made.radius)
    assert np.allclose(bodies.GetBounds()[:2], (0.25, 0.35), atol=1e-3)
    assert (tmp_path / "scene-cables.pvd").read_text().count("DataSet") == 2


def test_paraview_curvature_of_a_circle(scene, tmp_path):
    """1/R, of springs none. The cubic through a circle's points and tangents is off by the square of
    the angle that an element takes, here of 360/24 deg.
    """
    material("cable")
    radius, angle = 0.7, np.linspace(0, 2 * math.pi, 25)
    points = radius * np.stack([np.cos(angle), np.sin(angle), 0 * angle], 1)
    made = [
        ancf.Cable(points, diameter=1e-2, material="cable"),
        ancf.Cable(points[:3], diameter=1e-2, material="cable", model="springs"),
    ]
    for cable in made:
        cable.append()
    VtkRecorder(tmp_path / "c-", made).save()
    _, of = read(tmp_path / "c-cables-0000.vtp")
    bent = of["curvature"][: 24 * 8 + 1]
    assert bent == pytest.approx(1 / radius, rel=(2 * math.pi / 24) ** 2)
    assert np.all(of["curvature"][24 * 8 + 1 :] == 0)


def test_paraview_contact_forces(scene, tmp_path):
    """A straight cable that lies on a box: what carries its weight adds up to it, and stands where
    they touch.
    """
    material("cable", young=1e7)
    plane((0.25, 0, -0.1), (0.25, 0.1, 0.1), material="cable")
    low = 5e-3 - 1e-6
    cable = ancf.Cable([(0.05, 0, low), (0.45, 0, low)], 4, diameter=0.01, material="cable")
    O.engines = ancf.engines(cable, gravity=(0, 0, -9.81))
    cable.relax()
    steps(1)
    VtkRecorder(tmp_path / "l-", [cable]).save()
    data, of = read(tmp_path / "l-cables-0000.vtp")
    force = of["contactForce"]
    assert force[:, 2].sum() == pytest.approx(9.81 * cable.mass, rel=2e-2)
    assert np.abs(force[:, :2]).max() < 1e-3 * force[:, 2].sum()
    assert np.count_nonzero(force[:, 2]) > 4


def test_paraview_shapes(scene, tmp_path):
    """Facets, walls, sheaves and members of clumps, where they are."""
    from ancf import pulleys

    material("m")
    corners = [(1, 0, -0.2), (1.4, 0.1, -0.2), (1.2, 0, 0.3)]
    facet = O.bodies.append(utils.facet(corners, material="m"))
    wall = O.bodies.append(utils.wall(-0.5, 2, material="m"))
    sheave = pulleys.sheave((2, 0, 0), 0.2, width=0.1, material="m", axis=(0, 1, 0))
    clump, members = O.bodies.appendClumped([utils.sphere((x, 0, 0), 0.2) for x in (4, 4.3)])
    VtkRecorder(tmp_path / "b-", []).save()
    data, of = read(tmp_path / "b-bodies-0000.vtp")
    assert set(of["id"]) == {facet, wall, sheave, *members}
    points = vtk_to_numpy(data.GetPoints().GetData())
    corner = []
    for i in range(data.GetNumberOfCells()):
        cell = data.GetCell(i)
        corner.append({cell.GetPointId(k) for k in range(cell.GetNumberOfPoints())})

    def places(i):
        return points[sorted(set().union(*(c for c, n in zip(corner, of["id"]) if n == i)))]

    assert np.allclose(sorted(map(tuple, places(facet))), sorted(corners))
    assert np.all(places(wall)[:, 2] == -0.5)
    assert np.all(places(wall).min(axis=0)[:2] < points[:, :2].min(axis=0) + 1e-9)
    round_ = places(sheave) - (2, 0, 0)
    shape = O.bodies[sheave].shape
    assert np.hypot(round_[:, 0], round_[:, 2]).max() == pytest.approx(shape.rimRadius)
    assert np.ptp(round_[:, 1]) == pytest.approx(shape.overallWidth)
    groove = np.abs(round_[:, 1]) < 1e-9
    assert np.hypot(round_[groove, 0], round_[groove, 2]) == pytest.approx(shape.radius)
    for member, x in zip(members, (4, 4.3)):
        away = np.linalg.norm(places(member) - (x, 0, 0), axis=1)
        assert away == pytest.approx(0.2)


def test_progress(net):
    """Runs as long as it is told, in even parts."""
    start, times = O.time, []
    for _ in ancf.progress(100 * O.dt, 30 * O.dt):
        times.append(O.time - start)
    assert np.allclose(times, [n * O.dt for n in (30, 60, 90, 100)])
    start, times = O.time, []  # parts that are no whole number of steps do not drift
    for _ in ancf.progress(52 * O.dt, 10.4 * O.dt):
        times.append(O.time - start)
    assert np.allclose(times, [n * O.dt for n in (10, 21, 31, 42, 52)])
    start, times = O.time, []  # nor is anything told twice where parts are shorter than a step
    for _ in ancf.progress(3 * O.dt, 0.3 * O.dt):
        times.append(O.time - start)
    assert np.allclose(times, [n * O.dt for n in (1, 2, 3)])
    with pytest.raises(ValueError, match="progress: every = 0"):
        ancf.progress(1, 0)


def test_times_of_a_step(net):
    """O.timingEnabled shows the parts of a step of the engine; they add up to its time. Without it
    nothing is counted.
    """
    from yade import timing

    engine = net[0].engine
    assert engine.timingDeltas.data == []
    O.timingEnabled = True
    try:
        timing.reset()
        steps(200)
    finally:
        O.timingEnabled = False
    times = {label: (nsec, count) for label, nsec, count in engine.timingDeltas.data}
    assert list(times) == ["gather", "elastic", "contact", "scatter", "energy"]
    assert all(count >= 200 for _, count in times.values())
    whole = sum(nsec for nsec, _ in times.values())
    assert 0.5 * engine.execTime < whole <= engine.execTime
    assert times["contact"][0] > 0
    steps(10)
    assert sum(d[1] for d in engine.timingDeltas.data) == whole
    timing.stats()
