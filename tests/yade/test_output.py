"""Pictures, films, tables and ParaView files of a scene."""

import math
import subprocess

import matplotlib.colors
import numpy as np
import pytest
from PIL import Image, ImageSequence

from helpers import O, ancf, ball, material, plane, squareNet, steps


@pytest.fixture
def net(scene):
    """A net with bullets, a ball and a box, after some steps."""
    material("cable")
    target = ball((0.3, 0, 0), 0.05, material="cable")
    box = plane((0.3, 0.2, 0), (0.05, 0.04, 0.03), material="cable")
    made = squareNet(2, 0.06, fold=0.8, mass="lumped")
    made.addBullets(0.05, 0.008, 1.5, math.radians(15))
    O.engines = ancf.engines(made)
    steps(20)
    return made, target, box


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


@pytest.mark.parametrize("name", ["film.mp4", "film.gif"])
def test_film(net, tmp_path, name):
    from ancf.plots import CABLE, COLORS, Film

    made, target, box = net
    film = Film([made], [target, box])
    for _ in range(3):
        steps(50)
        film.take()
    film.strip(tmp_path / "strip.png", [0, O.time])
    written = film.animate(tmp_path / name)
    strip = Image.open(tmp_path / "strip.png").convert("RGB")
    left = strip.crop((0, 0, strip.width // 2, strip.height))
    right = strip.crop((strip.width - strip.width // 2, 0, strip.width, strip.height))
    for half in (left, right):
        assert drawn(half, CABLE) > 200 and drawn(half, COLORS["bullet"]) > 50
    assert left.tobytes() != right.tobytes()
    frames = framesOf(tmp_path / written, tmp_path)
    assert len(frames) == 3
    assert all(drawn(f, CABLE, 60) > 200 for f in frames)
    assert len({f.tobytes() for f in frames}) == 3


def drawn(picture, color, off=12):
    """Pixels of a colour, near enough."""
    wanted = 255 * np.array(matplotlib.colors.to_rgb(color))
    return int((np.abs(np.asarray(picture, float) - wanted).max(axis=-1) < off).sum())


def framesOf(path, folder):
    """Frames of a film as pictures."""
    if path.suffix == ".gif":
        return [f.convert("RGB") for f in ImageSequence.Iterator(Image.open(path))]
    command = ["ffmpeg", "-v", "error", "-i", path, folder / "frame%d.png"]
    subprocess.run(command, check=True)
    return [Image.open(f).convert("RGB") for f in sorted(folder.glob("frame*.png"))]


def test_camera(scene):
    """What is nearer to the eye has the larger depth; at the target's distance, lengths are true."""
    from ancf.plots import Camera

    camera = Camera((0, 0, 0), azimuth=0, elevation=0, distance=2)
    flat, depth = camera.project(np.array([[0.3, 0, 0], [0.0, 0.1, 0.2]]))
    assert depth[0] > depth[1]
    assert flat[1] == pytest.approx([0.1, 0.2])


def test_paraview_files(net, tmp_path):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    from ancf.vtk import VtkRecorder

    made, target, box = net
    recorder = VtkRecorder(tmp_path / "scene-", [made], [target, box], perElement=4)
    recorder.save()
    steps(10)
    recorder.save()

    def read(name):
        reader = vtkXMLPolyDataReader()
        reader.SetFileName(str(tmp_path / name))
        reader.Update()
        return reader.GetOutput()

    cables, bodies = read("scene-cables-0001.vtp"), read("scene-bodies-0001.vtp")
    edges = len(made.edges)
    assert cables.GetNumberOfCells() == edges
    points = vtk_to_numpy(cables.GetPoints().GetData()).reshape(edges, 5, 3)
    assert np.allclose(points, made.curve(4), atol=1e-6)
    speed = vtk_to_numpy(cables.GetPointData().GetArray("speed"))
    assert speed[0] == pytest.approx(O.bodies[made.bullets[0]].state.vel.norm(), rel=1e-2)
    tension = vtk_to_numpy(cables.GetPointData().GetArray("tension")).reshape(edges, 5)
    there = np.array([edge.tensions(4) for edge in made.edges])
    assert np.abs(there).max() > 1e-3
    assert np.allclose(tension, there, rtol=1e-6)
    assert np.allclose(bodies.GetBounds()[:2], (0.25, 0.35), atol=1e-3)
    assert (tmp_path / "scene-cables.pvd").read_text().count("DataSet") == 2
