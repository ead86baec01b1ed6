"""YADE's own 3D view, in the real program on a screen in memory."""

import contextlib
import os
import pathlib
import subprocess

import numpy as np
import pytest
from PIL import Image

from ancf import render

SCENE = """
import os
import time

import ancf
from ancf import pulleys
from yade import O, Vector3, qt, utils
from PyQt5.QtWidgets import QApplication

O.materials.append(ancf.HollarsMat(young=4.456e8, poisson=0.3, density=1440, label="cable"))
net = ancf.Net.square(4, 0.1, diameter=8e-3, material="cable", bending=0.0, normal=(0, 1, 0))
for corner in net.corners:
    net.fix(corner)
pulleys.sheave((0.5, 0, 0), 0.1, width=0.05, material="cable", axis=(0, 1, 0))
O.engines = pulleys.engines(net, gravity=(0, 0, -9.81))
O.bodies.append(utils.sphere((-0.5, 0, 0), 0.1, material="cable", fixed=True, color=(0, 1, 0)))
O.run(200, True)
"""

LINES = """
import os
import time

import ancf
from yade import O, Vector3, qt, utils
from yade.wrapper import ForceResetter, NewtonIntegrator
from PyQt5.QtWidgets import QApplication

O.materials.append(ancf.HollarsMat(young=1e9, density=1000, label="cable"))
ends = [
    O.bodies.append(utils.sphere(p, 0.01, material="cable", fixed=True, color=(0, 1, 0)))
    for p in ((-0.5, 0, -0.2), (0, 0, 0.25), (0.5, 0, -0.2), (-0.5, 0, -0.3), (0.5, 0, -0.3))
]
O.engines = [ForceResetter(), NewtonIntegrator()]
ancf.Line(ends[:3], diameter=0.02, ringRadius=0.06, tension=50, material="cable").append()
ancf.Line(ends[3:], diameter=0.02, slack=0.1, material="cable", label="slack").append()
O.dt = 1e-5
O.run(2, True)
"""

SNAPSHOT = """
view = qt.View()
qt.Renderer().bgColor = Vector3(1, 1, 1)
view.axes = False
view.screenSize = (600, 400)
view.viewDir, view.upVector = Vector3(0, 1, 0), Vector3(0, 0, 1)
view.center(False)
{more}
end = time.time() + 120
view.saveSnapshot("view.png")
while time.time() < end:
    QApplication.processEvents()
    time.sleep(0.05)
    if os.path.exists("view.png") and os.path.getsize("view.png") > 0:
        break
print("done", flush=True)
O.exitNoBacktrace()
"""


@pytest.fixture
def screen():
    """A screen in memory."""
    with contextlib.ExitStack() as opened:
        try:
            opened.enter_context(render.screen())
        except RuntimeError as told:
            pytest.skip(str(told))
        yield


def snapshot(folder, scene=SCENE, more=""):
    """The view of a scene as an array (height, width, 3)."""
    (folder / "scene.py").write_text(scene + SNAPSHOT.replace("{more}", more))
    package = pathlib.Path(render.__file__).parents[1]
    done = subprocess.run(
        ["yade", "-x", "scene.py"],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(package)},
        capture_output=True,
        text=True,
        timeout=400,
    )
    assert "done" in done.stdout and done.returncode == 0, done.stdout + done.stderr
    return np.asarray(Image.open(folder / "view.png").convert("RGB")).astype(int)


def test_net_and_sheave_in_the_view(screen, tmp_path):
    """The view was made ready before our shapes were there, and draws them none the less."""
    shot = snapshot(tmp_path)
    away = np.abs(shot - shot[2, 2]).max(axis=2) > 40
    thirds = np.array_split(away, 3, axis=1)
    assert all(part.sum() > 500 for part in thirds)
    bluish = (shot[..., 2] > shot[..., 0] + 30) & away
    assert bluish.sum() > 200
    # The near side of the sheave is one flat disc: seen from outside, not into it.
    disc = shot[:, 400:][away[:, 400:]]
    usual = np.median(disc, axis=0)
    assert (np.abs(disc - usual).max(axis=1) < 12).mean() > 0.7


def test_view_of_a_running_scene(screen, tmp_path):
    """Drawn while O.run goes on in its thread."""
    shot = snapshot(tmp_path, more="O.run()")
    assert (np.abs(shot - shot[2, 2]).max(axis=2) > 40).sum() > 1500


def test_lines_and_rings_in_the_view(screen, tmp_path):
    """A taut line through a ring is red, a slack one dark blue; no cable is there."""
    shot = snapshot(tmp_path, LINES)
    red, green, blue = np.moveaxis(shot, -1, 0)
    taut = (red > 120) & (green < 90) & (blue < 90)
    slack = (blue > red + 30) & (blue > green + 15) & (red < 90)
    ring = (abs(red - green) < 12) & (abs(red - blue) < 12) & (red < 140)
    rows = {name: np.argwhere(seen)[:, 0] for name, seen in (("taut", taut), ("slack", slack))}
    for half in np.array_split(taut, 2, axis=1) + np.array_split(slack, 2, axis=1):
        assert half.sum() > 200
    assert rows["taut"].max() < rows["slack"].min() + 5  # it is above the other
    middle = ring[:, 250:350]
    assert middle.sum() > 60
    assert (
        np.argwhere(middle)[:, 0].mean() < rows["taut"].mean()
    )  # where the line turns, at the top
