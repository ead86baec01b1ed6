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


def snapshot(folder, more=""):
    """The view of a scene as an array (height, width, 3)."""
    (folder / "scene.py").write_text(SCENE.replace("{more}", more))
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
