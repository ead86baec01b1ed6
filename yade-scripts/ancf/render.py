"""Pictures and films of cables, nets and bodies, drawn by VTK on a screen in memory."""

import contextlib
import math
import os
import shutil
import subprocess
from dataclasses import dataclass

import numpy as np
from yade import O, wrapper

from . import values
from .needs import needed

with needed("python3-matplotlib"):
    import matplotlib.colors
with needed("python3-vtk9"):
    import vtkmodules.vtkRenderingFreeType  # noqa: F401  draws text
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkLookupTable
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
    from vtkmodules.vtkFiltersCore import vtkAppendPolyData, vtkPolyDataNormals, vtkTubeFilter
    from vtkmodules.vtkIOImage import vtkPNGWriter
    from vtkmodules.vtkRenderingAnnotation import vtkScalarBarActor
    from vtkmodules.vtkRenderingCore import (
        vtkActor,
        vtkActor2D,
        vtkGlyph3DMapper,
        vtkLight,
        vtkPolyDataMapper,
        vtkPolyDataMapper2D,
        vtkRenderer,
        vtkTextActor,
        vtkWindowToImageFilter,
    )
    from vtkmodules.vtkRenderingOpenGL2 import vtkXOpenGLRenderWindow

from .surfaces import addField, polyData, solids, sphere, surfaces, vtkPointsOf

SKY = "#f4f6f8"
INK = "#26323d"  # of text
CABLE = "#1f3b57"
COLORS = {
    "bullet": "#c0392b",
    "Sphere": "#c9a227",
    "Box": "#8c9aa6",
    "Facet": "#9fb0bd",
    "Wall": "#9fb0bd",
    "Sheave": "#7d8b97",
    "ground": "#dfe4e8",
}
TENSION = (CABLE, "#2b8cbe", "#d99a1c", "#d7301f")  # from slack to the end of the bar
THINNEST = 1.6  # width of a cable in a picture at least [pixels]
BAR = 120  # width of the bar's column [pixels]
SIDE = 36  # width of the column of titles beside rows [pixels]


@dataclass(frozen=True)
class View:
    """From where a scene is looked at, and what of it is shown.

    direction   in which the eye looks, of any length
    up          what is up in the picture
    focus       point in the middle of the picture [m]; None: all that is shown fills the picture
    zoom        how much larger than what just fits
    angle       of view, from bottom to top [deg]
    cables      'tension': coloured by it, with a bar; or a colour
    tension     ends of the bar (low, high) [N]; what is beyond has the colour of the end. None: from 0 to
                what all but a twentieth of the places have
    ground      height of a plane across `up` through it [m]; None: there is none
    scale       a bar that shows lengths at the distance of the middle

    Raises ValueError, TypeError that name the attribute.
    """

    direction: tuple = (-0.44, 0.83, -0.34)
    up: tuple = (0, 0, 1)
    focus: tuple = None
    zoom: float = 1.0
    angle: float = 24.0
    cables: str = "tension"
    tension: tuple = None
    ground: float = None
    scale: bool = True

    def __post_init__(self):
        for name in ("direction", "up"):
            if not np.any(values.vector(f"View.{name}", getattr(self, name))):
                values.refuse(f"View.{name}", getattr(self, name), "must not be zero")
        if np.linalg.norm(np.cross(self.back, _unit(self.up))) < 1e-6:
            values.refuse("View.up", self.up, "must not be along direction")
        if self.focus is not None:
            values.vector("View.focus", self.focus)
        values.positive("View.zoom", self.zoom, "-")
        values.positive("View.angle", self.angle, "deg", 120)
        if self.cables != "tension":
            _color("View.cables", self.cables)
        if self.tension is not None:
            low, high = (values.finite("View.tension", t, "N") for t in self.tension)
            if not low < high:
                values.refuse("View.tension", self.tension, "must rise [N]")
        if self.ground is not None:
            values.finite("View.ground", self.ground, "m")

    @property
    def back(self):
        """From what is looked at to the eye, of length 1."""
        return -_unit(self.direction)

    @property
    def right(self):
        return _unit(np.cross(self.up, self.back))

    def place(self, points, radius, aspect):
        """Eye (3) and middle of the picture (3) [m], from which balls around points (n, 3) [m] of radius
        (n) [m] fit into a picture `aspect` times as wide as high.
        """
        over = np.cross(self.back, self.right)
        center = 0.5 * (points.min(axis=0) + points.max(axis=0))
        center = np.array(self.focus, float) if self.focus is not None else center
        x, y, z = ((points - center) @ axis for axis in (self.right, over, self.back))
        half = 0.86 * math.tan(math.radians(self.angle) / 2)  # leaves a margin
        away = []
        for q, edge in ((x, half * aspect), (y, half)):
            # A ball touches the plane through the eye with this slope at distance
            # z + (+-q + r sqrt(1 + edge^2))/edge; the middle is free to go aside.
            reach = z + radius * math.hypot(1, edge) / edge
            one, other = (reach + q / edge).max(), (reach - q / edge).max()
            away.append((one + other) / 2 if self.focus is None else max(one, other))
        distance = max(away)
        if self.focus is None:
            depth = distance - z
            center = center + _middle(x, depth, radius) * self.right
            center = center + _middle(y, depth, radius) * over
        return center + distance / self.zoom * self.back, center


def _middle(q, depth, radius):
    """Where balls at q (n) across and depth (n) ahead of the eye [m] reach as far to either side."""
    low, high = (q - radius).min(), (q + radius).max()
    for _ in range(50):
        at = 0.5 * (low + high)
        angle = np.arctan2(q - at, depth)
        wide = np.arcsin(np.minimum(1, radius / np.hypot(q - at, depth)))
        if (angle + wide).max() > -(angle - wide).min():
            low = at
        else:
            high = at
    return 0.5 * (low + high)


def _unit(v):
    return np.array(v, float) / np.linalg.norm(v)


def _color(where, color):
    """(3) from 0 to 1, of what matplotlib takes for a colour."""
    try:
        return np.array(matplotlib.colors.to_rgb(color))
    except ValueError:
        values.refuse(where, color, "must be a colour, such as 'red' or '#1f3b57'")


class Frame:
    """Cables and bodies as they are at one time, kept to be drawn later.

    structures   cables and nets
    bodies       ids, or {id: colour}; None: all that are no elements of cables. Bullets of the nets are
                 always shown
    perElement   pieces that a cable element is drawn with
    """

    def __init__(self, structures, bodies=None, perElement=8):
        self.time = O.time
        self.cables = [
            (span.curve(perElement), _tensions(s, span, perElement), s.radius)
            for s in structures
            for span in s.spans
        ]
        colors = dict(bodies) if isinstance(bodies, dict) else {}
        bullets = [i for s in structures for i in getattr(s, "bullets", [])]
        for i in bullets:
            colors.setdefault(i, COLORS["bullet"])
        ids = solids(None if bodies is None else [*bodies, *bullets])
        shapes = {i: O.bodies[i].shape for i in ids}
        colors = {i: self._colorOf(i, shape, colors) for i, shape in shapes.items()}
        round_ = [i for i in ids if isinstance(shapes[i], wrapper.Sphere)]
        self.centers = np.array([list(O.bodies[i].state.pos) for i in round_]).reshape(-1, 3)
        self.radii = np.array([shapes[i].radius for i in round_])
        self.colors = np.array([colors[i] for i in round_]).reshape(-1, 3)
        self.surfaces, self.walls = [], []
        points, radii = self.extent()
        reach = np.concatenate([points - radii[:, None], points + radii[:, None]])
        flat = surfaces([i for i in ids if i not in set(round_)], reach)
        self.surfaces = [(p, f, colors[i]) for i, p, f in flat if not _endless(shapes[i])]
        self.walls = [(p, f, colors[i]) for i, p, f in flat if _endless(shapes[i])]

    def _colorOf(self, i, shape, colors):
        clump = O.bodies[i].clumpId
        kind = "Sphere" if isinstance(shape, wrapper.Sphere) else type(shape).__name__
        color = colors.get(i) or colors.get(clump) or COLORS.get(kind, INK)
        return _color(f"bodies[{i}]", color)

    def extent(self):
        """Points (n, 3) and radii (n) [m] of balls that hold all that must be in the picture."""
        points = [c for c, _, _ in self.cables] + [self.centers]
        radii = [np.full(len(c), r) for c, _, r in self.cables] + [self.radii]
        others = self.surfaces
        if not (self.cables or len(self.radii) or others):
            others = self.walls
        for p, _, _ in others:
            points.append(p)
            radii.append(np.zeros(len(p)))
        return np.concatenate(points), np.concatenate(radii)


def _tensions(structure, span, perElement):
    if not structure.appended:
        return np.zeros(len(span.curve(perElement)))
    return span.tensions(perElement)


def _endless(shape):
    return isinstance(shape, wrapper.Wall)


# ---- drawing -------------------------------------------------------------------------------------


@contextlib.contextmanager
def screen():
    """An X server in memory, as DISPLAY, for as long as something is drawn: VTK needs one, and leaves the
    user's alone. RuntimeError where Xvfb is not installed, or does not start.
    """
    if shutil.which("Xvfb") is None:
        raise RuntimeError("pictures need Xvfb, which is not installed: apt install xvfb")
    reading, writing = os.pipe()
    command = ["Xvfb", "-displayfd", str(writing), "-screen", "0", "64x64x24", "-nolisten", "tcp"]
    server = subprocess.Popen(
        command, pass_fds=[writing], stderr=subprocess.PIPE, start_new_session=True
    )
    os.close(writing)
    before = os.environ.get("DISPLAY")
    try:
        with open(reading) as answer:
            number = answer.readline().strip()  # once it is ready
        if not number:
            told = server.stderr.read().decode(errors="replace").strip()
            raise RuntimeError(f"pictures need Xvfb, which did not start: {told}")
        os.environ["DISPLAY"] = f":{number}"
        yield
    finally:
        if before is None:
            os.environ.pop("DISPLAY", None)
        else:
            os.environ["DISPLAY"] = before
        server.terminate()
        server.wait()
        server.stderr.close()


class _Sheet:
    """A window of rows x columns of cells, each with its renderer, a column for titles beside the rows and
    one for the bar.
    """

    def __init__(self, rows, columns, cell, side, bar):
        self.window = vtkXOpenGLRenderWindow()
        self.window.SetOffScreenRendering(True)
        self.window.SetMultiSamples(4)
        first = SIDE if side else 0
        width, height = first + columns * cell[0] + (BAR if bar else 0), rows * cell[1]
        self.window.SetSize(width, height)
        self.cells = []
        for k in range(rows * columns):
            row, column = divmod(k, columns)
            left, right = ((first + c * cell[0]) / width for c in (column, column + 1))
            self.cells.append(self._add(left, 1 - (row + 1) / rows, right, 1 - row / rows))
        self.side = self._add(0, 0, first / width, 1) if side else None
        self.bar = self._add(1 - BAR / width, 0, 1, 1) if bar else None

    def _add(self, *viewport):
        renderer = vtkRenderer()
        renderer.SetViewport(*viewport)
        renderer.SetBackground(*matplotlib.colors.to_rgb(SKY))
        renderer.AutomaticLightCreationOff()
        light = vtkLight()
        light.SetLightTypeToCameraLight()
        light.SetPosition(-0.5, 0.8, 1.0)
        renderer.AddLight(light)
        self.window.AddRenderer(renderer)
        return renderer

    def picture(self):
        """Draws, and returns vtkImageData."""
        self.window.Render()
        grab = vtkWindowToImageFilter()
        grab.SetInput(self.window)
        grab.SetInputBufferTypeToRGB()
        grab.ReadFrontBufferOff()
        grab.ShouldRerenderOff()
        grab.Update()
        return grab.GetOutput()

    def save(self, path):
        writer = vtkPNGWriter()
        writer.SetFileName(str(path))
        writer.SetInputData(self.picture())
        writer.Write()
        if writer.GetErrorCode():
            raise OSError(f"{path} could not be written")

    def pixels(self):
        """(height, width, 3) bytes."""
        image = self.picture()
        width, height, _ = image.GetDimensions()
        flat = vtk_to_numpy(image.GetPointData().GetScalars())
        return np.ascontiguousarray(flat.reshape(height, width, 3)[::-1])


@contextlib.contextmanager
def _sheet(*layout):
    with screen():
        made = _Sheet(*layout)
        try:
            yield made
        finally:
            made.window.Finalize()


def _draw(renderer, frame, view, eye, middle, size, colors):
    """Fills a renderer of so many pixels (width, height) with a frame."""
    renderer.RemoveAllViewProps()
    camera = renderer.GetActiveCamera()
    camera.SetPosition(*eye)
    camera.SetFocalPoint(*middle)
    camera.SetViewUp(*view.up)
    camera.SetViewAngle(view.angle)
    perPixel = 2 * math.tan(math.radians(view.angle) / 2) / size[1]  # at 1 m
    if frame.cables:
        renderer.AddActor(_tubes(frame.cables, view, eye, perPixel, colors))
    if len(frame.radii):
        renderer.AddActor(_balls(frame))
    if frame.surfaces:
        renderer.AddActor(_faces(frame.surfaces))
    if frame.walls:
        wall = _faces(frame.walls)
        wall.GetProperty().SetOpacity(0.4)
        renderer.AddActor(wall)
    if view.ground is not None:
        renderer.AddActor(_ground(frame, view))
    if view.scale:
        _addScale(renderer, perPixel * np.linalg.norm(eye - middle), size)
    renderer.ResetCameraClippingRange()


def _tubes(cables, view, eye, perPixel, colors):
    points = np.concatenate([c for c, _, _ in cables])
    radius = np.concatenate([np.full(len(c), r) for c, _, r in cables])
    depth = (eye - points) @ view.back
    data = vtkPolyData()
    data.SetPoints(vtkPointsOf(points))
    data.SetLines(_lines([len(c) for c, _, _ in cables]))
    wide = addField(
        data.GetPointData(), "wide", np.maximum(radius, 0.5 * THINNEST * perPixel * depth)
    )
    data.GetPointData().SetScalars(wide)
    addField(data.GetPointData(), "tension", np.concatenate([t for _, t, _ in cables]))
    tube = vtkTubeFilter()
    tube.SetInputData(data)
    tube.SetNumberOfSides(12)
    tube.SetVaryRadiusToVaryRadiusByAbsoluteScalar()
    tube.CappingOn()
    mapper = vtkPolyDataMapper()
    mapper.SetInputConnection(tube.GetOutputPort())
    actor = _actor(mapper, 0.45)
    if colors is None:
        mapper.ScalarVisibilityOff()
        actor.GetProperty().SetColor(*matplotlib.colors.to_rgb(view.cables))
    else:
        mapper.SetScalarModeToUsePointFieldData()
        mapper.SelectColorArray("tension")
        mapper.SetLookupTable(colors)
        mapper.UseLookupTableScalarRangeOn()
    return actor


def _lines(counts):
    """Lines of so many points each, one after the other."""
    lines, first = vtkCellArray(), 0
    for n in counts:
        lines.InsertNextCell(n)
        for i in range(first, first + n):
            lines.InsertCellPoint(i)
        first += n
    return lines


def _balls(frame):
    n = len(frame.radii)
    data = vtkPolyData()
    data.SetPoints(vtkPointsOf(frame.centers))
    addField(data.GetPointData(), "radius", frame.radii)
    addField(data.GetPointData(), "color", _bytes(frame.colors))
    mapper = vtkGlyph3DMapper()
    mapper.SetInputData(data)
    mapper.SetSourceData(_ball(64 if n < 100 else 32 if n < 3000 else 16))
    mapper.SetScaleModeToScaleByMagnitude()
    mapper.SetScaleArray("radius")
    mapper.SetColorModeToDirectScalars()
    mapper.SetScalarModeToUsePointFieldData()
    mapper.SelectColorArray("color")
    return _actor(mapper)


def _ball(across):
    """The unit sphere, lit smoothly."""
    points, faces = sphere(across)
    data = polyData(points, faces)
    data.GetPointData().SetNormals(addField(data.GetPointData(), "normals", points))
    return data


def _faces(parts):
    append = vtkAppendPolyData()
    for points, faces, color in parts:
        data = polyData(points, faces)
        addField(data.GetCellData(), "color", np.tile(_bytes(color), (len(faces), 1)))
        append.AddInputData(data)
    normals = vtkPolyDataNormals()  # smooth over a sheave, sharp at its edges
    normals.SetInputConnection(append.GetOutputPort())
    normals.SetFeatureAngle(30)
    normals.ConsistencyOff()
    mapper = vtkPolyDataMapper()
    mapper.SetInputConnection(normals.GetOutputPort())
    mapper.SetColorModeToDirectScalars()
    mapper.SetScalarModeToUseCellFieldData()
    mapper.SelectColorArray("color")
    return _actor(mapper)


def _ground(frame, view):
    points, radii = frame.extent()
    up = _unit(view.up)
    half = 0.75 * (np.linalg.norm(np.ptp(points, axis=0)) + 2 * radii.max())
    middle = points.mean(axis=0)
    middle = middle + (view.ground - middle @ up) * up
    side = view.right
    ahead = np.cross(up, side)
    corners = middle + half * np.array([-side - ahead, side - ahead, side + ahead, ahead - side])
    actor = _faces([(corners, np.array([[0, 1, 2, 3]]), _color("ground", COLORS["ground"]))])
    actor.GetProperty().SetAmbient(0.7)
    actor.GetProperty().SetDiffuse(0.3)
    return actor


def _actor(mapper, ambient=0.3):
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetAmbient(ambient)
    actor.GetProperty().SetDiffuse(1 - ambient)
    return actor


def _bytes(colors):
    return np.round(255 * np.asarray(colors)).astype(np.uint8)


def _addText(renderer, text, x, y, across="Left", upright=False, size=18):
    """Text at a place in a renderer, from 0 to 1."""
    actor = vtkTextActor()
    actor.SetInput(text)
    style = actor.GetTextProperty()
    style.SetFontFamilyToArial()
    style.SetFontSize(size)
    style.SetColor(*matplotlib.colors.to_rgb(INK))
    getattr(style, f"SetJustificationTo{across}")()
    style.SetVerticalJustificationToCentered()
    if upright:
        actor.SetOrientation(90)
    actor.GetPositionCoordinate().SetCoordinateSystemToNormalizedViewport()
    actor.SetPosition(x, y)
    renderer.AddViewProp(actor)


def _addScale(renderer, perPixel, size):
    """A bar of a round length, about a sixth of the picture, in its lower left corner."""
    wanted = size[0] / 6 * perPixel
    ten = 10.0 ** math.floor(math.log10(wanted))
    length = max(k * ten for k in (1, 2, 5) if k * ten <= wanted)
    left, low, long_ = 0.04 * size[0], 0.04 * size[1], length / perPixel
    data = vtkPolyData()
    ends = [[0, 5], [0, -5], [0, 0], [long_, 0], [long_, 5], [long_, -5]]
    data.SetPoints(vtkPointsOf([[left + x, low + y, 0] for x, y in ends]))
    data.SetLines(_lines([6]))
    mapper = vtkPolyDataMapper2D()
    mapper.SetInputData(data)
    actor = vtkActor2D()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(*matplotlib.colors.to_rgb(INK))
    actor.GetProperty().SetLineWidth(2)
    renderer.AddViewProp(actor)
    _addText(renderer, _length(length), (left + long_ + 10) / size[0], low / size[1], size=16)


def _length(meters):
    for unit, name in ((1, "m"), (1e-2, "cm"), (1e-3, "mm")):
        if meters >= unit:
            return f"{meters / unit:g} {name}"
    return f"{meters:g} m"


def _tensionColors(frames, view):
    """Lookup table of the bar; None where cables have one colour."""
    if view.cables != "tension":
        return None
    all_ = [t for f in frames for _, t, _ in f.cables]
    if not all_:
        return None
    low, high = view.tension or (0.0, _roundUp(np.percentile(np.concatenate(all_), 95)))
    table = vtkLookupTable()
    shades = matplotlib.colors.LinearSegmentedColormap.from_list("tension", TENSION)
    table.SetNumberOfTableValues(256)
    for i in range(256):
        table.SetTableValue(i, *shades(i / 255))
    table.SetTableRange(low, high)
    table.Build()
    return table


def _roundUp(tension):
    """The next of 1, 2, 4 or 8 times a power of ten [N]; 1 where nothing pulls."""
    if tension <= 0:
        return 1.0
    ten = 10.0 ** math.floor(math.log10(tension))
    return next(k * ten for k in (1, 2, 4, 8, 10) if tension <= k * ten)


def _addBar(renderer, colors):
    bar = vtkScalarBarActor()
    bar.SetLookupTable(colors)
    bar.SetNumberOfLabels(5)
    bar.UnconstrainedFontSizeOn()
    bar.SetLabelFormat("%.3g")
    bar.SetBarRatio(0.3)
    bar.SetTextPad(6)
    bar.GetPositionCoordinate().SetValue(0.06, 0.08)
    bar.SetWidth(0.8)
    bar.SetHeight(0.75)
    style = bar.GetLabelTextProperty()
    style.SetFontFamilyToArial()
    style.SetFontSize(16)
    style.SetColor(*matplotlib.colors.to_rgb(INK))
    style.ItalicOff()
    style.BoldOff()
    style.ShadowOff()
    renderer.AddViewProp(bar)
    _addText(renderer, "tension\n[N]", 0.06, 0.91, size=16)


# ---- pictures ------------------------------------------------------------------------------------


def sheet(path, rows, view=View(), titles=(), sideTitles=(), cell=(560, 560)):
    """Writes a PNG of frames in rows and columns, those of a column equally large.

    rows         [[Frame, ...], ...]
    titles       over the columns; sideTitles: beside the rows
    cell         size of each picture [pixels]

    Cables are tubes of their true diameter, but never thinner than THINNEST pixels, so that one of 1 mm
    can be seen in a scene of 5 m. Raises OSError for a path that cannot be written to, RuntimeError
    where Xvfb is not installed.
    """
    frames = [frame for row in rows for frame in row]
    colors = _tensionColors(frames, view)
    columns = max(len(row) for row in rows)
    with _sheet(len(rows), columns, cell, len(sideTitles) > 0, colors is not None) as made:
        for column in range(columns):
            there = [(i, row[column]) for i, row in enumerate(rows) if column < len(row)]
            points, radii = (np.concatenate(q) for q in zip(*(f.extent() for _, f in there)))
            eye, middle = view.place(points, radii, cell[0] / cell[1])
            for i, frame in there:
                renderer = made.cells[i * columns + column]
                _draw(renderer, frame, view, eye, middle, cell, colors)
                if i == 0 and column < len(titles):
                    _addText(renderer, titles[column], 0.5, 0.96, "Centered")
        for i, title in enumerate(sideTitles):
            _addText(made.side, title, 0.6, 1 - (i + 0.5) / len(rows), "Centered", upright=True)
        if colors is not None:
            _addBar(made.bar, colors)
        made.save(path)


def picture(path, structures, bodies=None, view=View(), size=(1200, 900), perElement=8):
    """Writes a PNG of the scene as it is now; structures, bodies and perElement as in Frame, errors as of
    sheet().
    """
    sheet(path, [[Frame(structures, bodies, perElement)]], view, cell=size)


class Film:
    """Keeps pictures of structures and bodies while the scene runs: take() each time, then strip()
    and animate(). Takes what Frame does.
    """

    def __init__(self, structures, bodies=None, perElement=8):
        self.structures, self.bodies = list(structures), bodies
        self.perElement = perElement
        self.frames = []

    def take(self):
        """Keeps the present state."""
        self.frames.append(Frame(self.structures, self.bodies, self.perElement))

    def nearest(self, time):
        """The frame taken nearest to a time [s]."""
        return min(self.frames, key=lambda f: abs(f.time - time))

    def strip(self, path, times, view=View(), cell=(560, 560)):
        """Writes a PNG of pictures at some times [s] side by side, each as large as its content; all
        from the same side.
        """
        frames = [self.nearest(t) for t in times]
        sheet(path, [frames], view, [f"{f.time:.2f} s" for f in frames], cell=cell)

    def animate(self, path, fps=25, view=View(), slower=1.0, size=(960, 540), follow=False):
        """Writes all pictures as a film, .mp4 or .gif, by ffmpeg. Returns the file's name.

        slower: only told in the picture, how much slower than real time the film runs. size: even
        numbers of pixels. follow: the eye goes along with the middle of all that is shown, for what
        flies far. ValueError if that is to be at view.focus; RuntimeError where ffmpeg or Xvfb is not
        installed, or cannot write the file.
        """
        path = str(path)
        if follow and view.focus is not None:
            values.refuse("Film.animate: view.focus", view.focus, "must be None with follow=True")
        colors = _tensionColors(self.frames, view)
        note = f", {slower:g} times slower" if slower != 1 else ""
        extents = [f.extent() for f in self.frames]
        ways = [0.5 * (p.min(axis=0) + p.max(axis=0)) if follow else 0.0 for p, _ in extents]
        points = np.concatenate([p - way for (p, _), way in zip(extents, ways)])
        radii = np.concatenate([r for _, r in extents])
        cell = (size[0] - BAR, size[1]) if colors is not None else tuple(size)
        eye, middle = view.place(points, radii, cell[0] / cell[1])
        with contextlib.ExitStack() as opened:
            made = opened.enter_context(_sheet(1, 1, cell, False, colors is not None))
            write = opened.enter_context(_encoder(path, size, fps))
            if colors is not None:
                _addBar(made.bar, colors)
            for frame, way in zip(self.frames, ways):
                _draw(made.cells[0], frame, view, eye + way, middle + way, cell, colors)
                _addText(made.cells[0], f"{frame.time:.2f} s{note}", 0.02, 0.95)
                write(made.pixels().tobytes())
        return path


@contextlib.contextmanager
def _encoder(path, size, fps):
    """Function that takes the bytes of a film's next picture."""
    if shutil.which("ffmpeg") is None:
        raise RuntimeError("films need ffmpeg, which is not installed: apt install ffmpeg")
    gif = "split[a][b];[a]palettegen[p];[b][p]paletteuse"
    form = ["-vf", gif] if path.endswith(".gif") else ["-pix_fmt", "yuv420p", "-crf", "20"]
    command = ["ffmpeg", "-v", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24"]
    command += ["-s", f"{size[0]}x{size[1]}", "-r", str(fps), "-i", "-", *form, path]
    writer = subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE)
    try:
        yield writer.stdin.write
    except BrokenPipeError:
        pass  # it tells why
    finally:
        with contextlib.suppress(BrokenPipeError):
            writer.stdin.close()
        told = writer.stderr.read().decode(errors="replace").strip()
        writer.stderr.close()
        failed = writer.wait()
    if failed:
        raise RuntimeError(f"{path}: ffmpeg could not write the film: {told}")
