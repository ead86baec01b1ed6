"""3D pictures and films: what is drawn, where, and in which colour."""

import colorsys
import math
import os
import subprocess

import matplotlib.colors
import numpy as np
import pytest
from PIL import Image, ImageSequence

from ancf.render import CABLE, COLORS, SKY, Film, Frame, View, picture, sheet
from helpers import O, Vector3, ancf, ball, material, plane, steps, utils

RED, GREEN = "#d01010", "#10b020"


def read(path):
    return np.asarray(Image.open(path).convert("RGB"))


def like(pixels, color, off=0.04):
    """Where a picture has the hue of a colour, in whatever light; (height, width) bool."""
    hue, saturation, _ = colorsys.rgb_to_hsv(*matplotlib.colors.to_rgb(color))
    hsv = matplotlib.colors.rgb_to_hsv(pixels / 255)
    apart = np.abs((hsv[..., 0] - hue + 0.5) % 1 - 0.5)
    return (apart < off) & (np.abs(hsv[..., 1] - saturation) < 0.3) & (hsv[..., 1] > 0.3)


def bounds(mask):
    """First and last row, first and last column of what is marked."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    return rows[0], rows[-1], columns[0], columns[-1]


def seen(view, eye, middle, size, point):
    """Column and row of a point in a picture, by the central projection."""
    away = (np.array(middle) - eye) / np.linalg.norm(np.array(middle) - eye)
    right = np.cross(away, view.up) / np.linalg.norm(np.cross(away, view.up))
    over = np.cross(right, away)
    rel = np.array(point) - eye
    scale = size[1] / 2 / math.tan(math.radians(view.angle) / 2) / (rel @ away)
    return size[0] / 2 + scale * (rel @ right), size[1] / 2 - scale * (rel @ over)


def test_sphere_has_its_size(scene, tmp_path):
    """A ball is seen under the angle asin(r/D), so as a disc of f tan(asin(r/D)) pixels."""
    radius, size = 0.3, (640, 480)
    ids = {ball((1, 2, 3), radius): RED}
    view = View(direction=(1, 1, -0.5), zoom=0.4, scale=False)
    eye, _ = view.place(np.array([[1.0, 2, 3]]), np.array([radius]), size[0] / size[1])
    picture(tmp_path / "ball.png", [], ids, view, size)
    distance = np.linalg.norm(eye - [1, 2, 3])
    f = size[1] / 2 / math.tan(math.radians(view.angle) / 2)
    wanted = 2 * f * math.tan(math.asin(radius / distance))
    top, bottom, left, right = bounds(like(read(tmp_path / "ball.png"), RED))
    assert 100 < wanted < 300
    assert bottom - top + 1 == pytest.approx(wanted, abs=2.5)
    assert right - left + 1 == pytest.approx(wanted, abs=2.5)
    assert (left + right) / 2 == pytest.approx(size[0] / 2, abs=1.5)


@pytest.mark.parametrize("direction", [(1, 0, 0), (0.3, -1, -0.6)])
def test_fits_without_waste(scene, tmp_path, direction):
    """What is shown reaches the margin on two sides, and no farther on any."""
    ids = {ball((0, 0, 0), 0.1): RED, ball((1, 0.4, 0.7), 0.2): RED}
    picture(tmp_path / "a.png", [], ids, View(direction=direction, scale=False), (600, 400))
    top, bottom, left, right = bounds(like(read(tmp_path / "a.png"), RED))
    free = [top, 399 - bottom, left, 599 - right]
    assert min(free) > 8
    assert min(free[0] / 400, free[2] / 600) == pytest.approx(0.07, abs=0.01)
    assert abs(free[0] - free[1]) < 4 and abs(free[2] - free[3]) < 4


def test_cable_is_where_it_must_be(scene, tmp_path):
    """Every point of a curved cable is coloured in the picture, and a thick one is as wide as it is."""
    material("cable")
    points = [(0, 0, 0), (0.5, 0, 0.2), (1, 0, 0), (1.5, 0.3, -0.1)]
    cable = ancf.Cable(points, elements=4, diameter=0.05, material="cable")
    cable.append()
    view, size = View(direction=(0, 1, -0.2), cables=GREEN, scale=False), (700, 500)
    frame = Frame([cable])
    eye, middle = view.place(*frame.extent(), size[0] / size[1])
    picture(tmp_path / "c.png", [cable], view=view, size=size)
    green = like(read(tmp_path / "c.png"), GREEN, 0.06)
    for point in cable.curve(20)[3:-3]:
        column, row = seen(view, eye, middle, size, point)
        assert green[int(row), int(column)]
    column = int(seen(view, eye, middle, size, points[1])[0])
    depth = np.linalg.norm(eye - points[1])
    f = size[1] / 2 / math.tan(math.radians(view.angle) / 2)
    assert green[:, column].sum() == pytest.approx(f * 0.05 / depth, rel=0.12)


def test_thin_cable_can_be_seen(scene, tmp_path):
    """1 mm in 5 m would be a fifth of a pixel."""
    material("cable")
    cable = ancf.Cable([(0, 0, 0), (5, 0, 0)], diameter=1e-3, material="cable")
    cable.append()
    picture(tmp_path / "thin.png", [cable], view=View((0, 1, 0), cables=RED, scale=False))
    shot = read(tmp_path / "thin.png").astype(int)
    sky = 255 * np.array(matplotlib.colors.to_rgb(SKY))
    inked = np.abs(shot - sky).max(axis=2) > 60
    left, right = bounds(inked)[2:]
    assert right - left > 1000
    assert inked[:, left + 5 : right - 5].any(axis=0).all()  # without gaps
    assert inked.sum(axis=0).max() <= 4


def test_tension_is_colour(scene, tmp_path):
    """A cable at the upper end of the bar is red; one that nothing pulls is dark."""
    material("cable", young=1e7)
    pulled = ancf.Cable([(0, 0, 1), (1, 0, 1)], 4, diameter=0.02, material="cable")
    slack = ancf.Cable([(0, 0, 0), (1, 0, 0)], 4, diameter=0.02, material="cable")
    for cable in (pulled, slack):
        cable.fix(0)
    high = 200.0
    pulled.load(-1, (high, 0, 0))
    O.engines = ancf.engines(pulled, slack)
    pulled.relax()
    assert pulled.tension(0.5) == pytest.approx(high, rel=1e-3)
    view = View((0, 1, 0), tension=(0, high), scale=False)
    picture(tmp_path / "t.png", [pulled, slack], view=view, size=(600, 600))
    shot = read(tmp_path / "t.png")[:, :600]  # without the bar
    reds, darks = like(shot, "#d7301f"), like(shot, CABLE, 0.06)
    assert reds[:300].sum() > 1000 and reds[300:].sum() == 0
    assert darks[300:].sum() > 1000 and darks[:300].sum() == 0


def test_bodies_of_all_shapes(scene, tmp_path):
    """Each shape that YADE knows here, and members of a clump, each in its colour."""
    from ancf import pulleys

    material("m")
    colors = ["#d01010", "#10b020", "#1040d0", "#c010c0", "#d0a000"]
    ids = [
        plane((0, 0, 0), (0.2, 0.1, 0.1), material="m"),
        O.bodies.append(utils.facet([(1, 0, -0.2), (1.4, 0, -0.2), (1.2, 0, 0.3)], material="m")),
        pulleys.sheave((2, 0, 0), 0.2, width=0.1, material="m", axis=(0, 1, 0)),
        O.bodies.append(utils.sphere((3, 0, 0), 0.2, material="m")),
    ]
    clump, _ = O.bodies.appendClumped(
        [utils.sphere((4, 0, 0), 0.15, material="m"), utils.sphere((4.2, 0, 0), 0.15, material="m")]
    )
    view = View((0, 1, 0), scale=False)
    picture(tmp_path / "s.png", [], dict(zip([*ids, clump], colors)), view, (1000, 300))
    shot = read(tmp_path / "s.png")
    places = [np.argwhere(like(shot, c)).mean(axis=0)[1] for c in colors]
    assert (np.diff(places) > 100).all()
    disc = like(shot, colors[2])
    rim = O.bodies[ids[2]].shape.rimRadius
    top, bottom, left, right = bounds(disc)
    ballTop, ballBottom, *_ = bounds(like(shot, colors[3]))
    assert (bottom - top) / (ballBottom - ballTop) == pytest.approx(rim / 0.2, rel=0.06)


def test_many_grains(scene, tmp_path):
    places = np.random.default_rng(1).uniform(-1, 1, (2000, 3))
    ids = {O.bodies.append(utils.sphere(Vector3(*p), 0.03)): RED for p in places}
    picture(tmp_path / "g.png", [], ids, size=(500, 500))
    assert like(read(tmp_path / "g.png"), RED, 0.06).mean() > 0.1


def test_walls_and_ground_do_not_shrink_the_rest(scene, tmp_path):
    ids = {ball((0, 0, 0), 0.1): RED}
    wall = O.bodies.append(utils.wall(-0.12, 2))
    view, grounded = (View(scale=False, zoom=0.3, ground=g) for g in (None, -0.1))
    picture(tmp_path / "no.png", [], ids, view, (400, 400))
    picture(tmp_path / "wall.png", [], {**ids, wall: None}, view, (400, 400))
    picture(tmp_path / "ground.png", [], ids, grounded, (400, 400))
    without, wall, ground = (read(tmp_path / f"{n}.png") for n in ("no", "wall", "ground"))
    assert abs(int(like(wall, RED).sum()) - int(like(without, RED).sum())) < 200
    sky = (255 * np.array(matplotlib.colors.to_rgb(SKY))).round()
    assert (without == sky).all(axis=2).mean() > (wall == sky).all(axis=2).mean() + 0.02
    assert (without == sky).all(axis=2).mean() > (ground == sky).all(axis=2).mean() + 0.02


@pytest.mark.parametrize("name", ["film.mp4", "film.gif"])
def test_film(net, tmp_path, name):
    made, target, box = net
    film = Film([made], [target, box])
    for _ in range(3):
        steps(50)
        film.take()
    film.strip(tmp_path / "strip.png", [0, O.time])
    strip = read(tmp_path / "strip.png")
    left, right = strip[:, :560], strip[:, 560:1120]
    for half in (left, right):
        assert like(half, COLORS["bullet"]).sum() > 50
        assert like(half, CABLE, 0.08).sum() > 200
    assert (left != right).any()
    written = film.animate(tmp_path / name, view=View(cables=GREEN))
    frames = framesOf(tmp_path / written, tmp_path)
    assert len(frames) == 3
    assert all(f.shape == (540, 960, 3) for f in frames)
    assert all(like(f, GREEN, 0.08).sum() > 200 for f in frames)
    assert len({f.tobytes() for f in frames}) == 3


def test_film_that_follows_what_flies_far(tmp_path):
    """A ball that flies a thousand radii is as large as at the start, and in the middle; else a speck."""
    O.reset()
    ball = O.bodies.append(utils.sphere((0, 0, 0), 0.1, color=(1, 0, 0)))
    film = Film([], {ball: "#c00000"})
    for x in (0, 50, 100):
        O.bodies[ball].state.pos = (x, 0, 0)
        film.take()

    def shown(follow):
        film.animate(tmp_path / "far.mp4", follow=follow)
        red = [
            (f[:, :, 0] > 100) & (f[:, :, 1] < 60) for f in framesOf(tmp_path / "far.mp4", tmp_path)
        ]
        return [r.sum() for r in red], [np.argwhere(r).mean(axis=0) for r in red if r.any()]

    sizes, middles = shown(True)
    assert min(sizes) > 20000 and max(sizes) < 1.05 * min(sizes)
    assert np.ptp(middles, axis=0).max() < 2
    assert max(shown(False)[0]) < 100
    with pytest.raises(ValueError, match="view.focus = .*must be None with follow=True"):
        film.animate(tmp_path / "far.mp4", view=View(focus=(0, 0, 0)), follow=True)


def framesOf(path, folder):
    """Frames of a film as pictures."""
    if path.suffix == ".gif":
        return [np.asarray(f.convert("RGB")) for f in ImageSequence.Iterator(Image.open(path))]
    command = ["ffmpeg", "-v", "error", "-i", path, folder / "frame%d.png"]
    subprocess.run(command, check=True)
    return [read(f) for f in sorted(folder.glob("frame*.png"))]


def test_leaves_the_screen_alone(net, tmp_path, monkeypatch):
    """The user's DISPLAY is not used, and stands afterwards; the screen in memory is gone."""
    monkeypatch.setenv("DISPLAY", ":no such screen")
    picture(tmp_path / "a.png", [net[0]])
    assert os.environ["DISPLAY"] == ":no such screen"
    children = subprocess.run(
        ["ps", "--ppid", str(os.getpid()), "-o", "comm="], capture_output=True, text=True
    )
    assert "Xvfb" not in children.stdout


def test_refusals(net, tmp_path, monkeypatch):
    made, target, _ = net
    with pytest.raises(ValueError, match="View.up .* along direction"):
        View(direction=(0, 0, -1))
    with pytest.raises(ValueError, match="View.zoom = 0"):
        View(zoom=0)
    with pytest.raises(ValueError, match="View.cables = 'redd'"):
        View(cables="redd")
    with pytest.raises(ValueError, match=r"View.tension = \(2, 1\)"):
        View(tension=(2, 1))
    with pytest.raises(ValueError, match="no body 999"):
        Frame([made], [999])
    with pytest.raises(OSError, match="nowhere"):
        sheet(tmp_path / "nowhere" / "a.png", [[Frame([made])]])
    film = Film([made], [target])
    film.take()
    with pytest.raises(RuntimeError, match="ffmpeg could not write"):
        film.animate(tmp_path / "nowhere" / "a.mp4")
    monkeypatch.setenv("PATH", "/nowhere")
    with pytest.raises(RuntimeError, match="apt install xvfb"):
        picture(tmp_path / "a.png", [made])
