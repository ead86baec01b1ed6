"""Pictures and films of cables, nets and bodies, and curves over time, by matplotlib without a
screen.
"""

import shutil

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib import animation  # noqa: E402
from matplotlib.collections import PolyCollection  # noqa: E402
from yade import O, wrapper  # noqa: E402

SKY = "#f4f6f8"
CABLE = "#1f3b57"
COLORS = {"target": "#c9a227", "bullet": "#c0392b", "box": "#8c9aa6"}


class Camera:
    """A perspective view. azimuth, elevation [deg] of the eye as seen from the target; distance [m]
    from it.
    """

    def __init__(self, target=(0, 0, 0), azimuth=-60.0, elevation=18.0, distance=4.0):
        a, e = np.radians([azimuth, elevation])
        self.target = np.array(target, float)
        self.back = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
        self.right = np.array([-np.sin(a), np.cos(a), 0.0])
        self.up = np.cross(self.back, self.right)
        self.distance = distance
        self.light = (self.back + 0.8 * self.up - 0.5 * self.right) / np.sqrt(1.89)

    def project(self, p):
        """Points (..., 3) to the picture (..., 2) [m at the target] and depth towards the eye
        (...).
        """
        rel = np.asarray(p) - self.target
        depth = rel @ self.back
        scale = self.distance / np.maximum(self.distance - depth, 1e-3 * self.distance)
        return np.stack([rel @ self.right * scale, rel @ self.up * scale], -1), depth

    def towards(self, p):
        """Unit vectors from points (n, 3) to the eye."""
        v = self.target + self.distance * self.back - p
        return v / np.linalg.norm(v, axis=-1, keepdims=True)


def sphereFaces(center, radius, across=40):
    """Quads (n, 4, 3) of a sphere."""
    theta = np.linspace(0, np.pi, across // 2 + 1)
    phi = np.linspace(0, 2 * np.pi, across + 1)
    t, f = np.meshgrid(theta, phi, indexing="ij")
    p = np.stack([np.sin(t) * np.cos(f), np.sin(t) * np.sin(f), np.cos(t)], -1)
    return _quads(np.asarray(center) + radius * p).reshape(-1, 4, 3)


def boxFaces(center, rotation, extents, across=8):
    """Quads (n, 4, 3) of a box with half sizes `extents`; rotation (3, 3)."""
    g = np.linspace(-1, 1, across + 1)
    a, b = np.meshgrid(g, g, indexing="ij")
    one = np.ones_like(a)
    faces = []
    for axis in range(3):
        for side in (-1, 1):
            p = np.empty((*a.shape, 3))
            p[..., axis], p[..., (axis + 1) % 3], p[..., (axis + 2) % 3] = side * one, a, side * b
            faces.append(_quads(p))
    quads = np.concatenate(faces).reshape(-1, 4, 3) * np.asarray(extents)
    return quads @ np.asarray(rotation).T + np.asarray(center)


def _quads(p):
    return np.stack([p[:-1, :-1], p[1:, :-1], p[1:, 1:], p[:-1, 1:]], -2).reshape(-1, 4, 3)


def _rotation(ori):
    m = ori.toRotationMatrix()
    return np.array([[m[i, j] for j in range(3)] for i in range(3)])


class Body:
    """Shape, pose and colour of a body, kept for drawing."""

    def __init__(self, body, color=None):
        shape, self.center = body.shape, np.array(list(body.state.pos))
        self.color = color
        self.rotation = _rotation(body.state.ori)
        self.kind = type(shape).__name__
        if isinstance(shape, wrapper.Sphere):
            self.radius = shape.radius
        elif isinstance(shape, wrapper.Box):
            self.extents = np.array(list(shape.extents))
        elif isinstance(shape, wrapper.Facet):
            self.vertices = np.array([list(v) for v in shape.vertices])

    def faces(self):
        """Faces (n, 3 or 4, 3) of its surface; empty for shapes that have none here."""
        if hasattr(self, "radius"):
            return sphereFaces(self.center, self.radius)
        if hasattr(self, "extents"):
            return boxFaces(self.center, self.rotation, self.extents)
        if hasattr(self, "vertices"):
            return (self.vertices @ self.rotation.T + self.center)[None]
        return np.empty((0, 4, 3))

    def shownColor(self):
        default = COLORS["box"] if hasattr(self, "extents") else COLORS["target"]
        return np.array(matplotlib.colors.to_rgb(self.color or default))


class Frame:
    """Cables and bodies at one time."""

    def __init__(self, structures, bodies, perElement):
        self.time = O.time
        self.curves = [span.curve(perElement) for s in structures for span in s.spans]
        self.bodies = [Body(O.bodies[i], color) for i, color in bodies.items() if O.bodies[i]]

    def points(self):
        """All points that must be in the picture, (n, 3)."""
        surfaces = [b.faces().reshape(-1, 3) for b in self.bodies]
        return np.vstack(self.curves + surfaces)


def draw(ax, frame, camera, width=0.9):
    """Draws a frame on 2D axes, what is nearer over what is farther; width of the cables
    [points].
    """
    polygons, depths, fill, edge, widths = [], [], [], [], []
    for body in frame.bodies:
        faces = body.faces()
        if len(faces) == 0:
            continue
        normal = np.cross(faces[:, 2] - faces[:, 0], faces[:, -1] - faces[:, 1])
        size = np.linalg.norm(normal, axis=1)
        middle = faces.mean(axis=1)
        with np.errstate(invalid="ignore", divide="ignore"):
            normal = normal / size[:, None]
        outwards = np.sign(((middle - body.center) * normal).sum(1))
        normal *= np.where(outwards == 0, 1, outwards)[:, None]
        seen = (size > 1e-14) & ((normal * camera.towards(middle)).sum(1) > 0)
        shade = 0.42 + 0.58 * np.clip(normal[seen] @ camera.light, 0, 1)
        colors = np.clip(shade[:, None] * body.shownColor(), 0, 1)
        flat, _ = camera.project(faces[seen])
        polygons += list(flat)
        depths += list(camera.project(middle[seen])[1])
        fill += list(np.column_stack([colors, np.ones(len(colors))]))
        edge += list(np.column_stack([colors, np.ones(len(colors))]))
        widths += [0.4] * len(colors)
    line = np.array(matplotlib.colors.to_rgba(CABLE))
    for curve in frame.curves:
        flat, depth = camera.project(curve)
        polygons += list(np.stack([flat[:-1], flat[1:]], 1))
        depths += list(0.5 * (depth[:-1] + depth[1:]) + 2e-3 * camera.distance)
        fill += [line] * (len(curve) - 1)
        edge += [line] * (len(curve) - 1)
        widths += [width] * (len(curve) - 1)
    order = np.argsort(depths)
    ax.add_collection(
        PolyCollection(
            [polygons[i] for i in order],
            facecolors=[fill[i] for i in order],
            edgecolors=[edge[i] for i in order],
            linewidths=[widths[i] for i in order],
            capstyle="round",
        )
    )
    ax.set_aspect("equal")
    ax.set_facecolor(SKY)
    ax.set_xticks([])
    ax.set_yticks([])
    for spine in ax.spines.values():
        spine.set_visible(False)


class Film:
    """Keeps pictures of structures and bodies while the scene runs: take() each time, then strip()
    and animate().

    structures   cables and nets
    bodies       {id: colour}, or ids, of spheres, boxes and facets to show; bullets of nets are
                 shown by themselves
    perElement   pieces that a cable element is drawn with
    """

    def __init__(self, structures, bodies=(), perElement=8):
        self.structures = list(structures)
        self.bodies = dict(bodies) if isinstance(bodies, dict) else {i: None for i in bodies}
        for s in self.structures:
            for i in getattr(s, "bullets", []):
                self.bodies.setdefault(i, COLORS["bullet"])
        self.perElement = perElement
        self.frames = []

    def take(self):
        """Keeps the present state."""
        self.frames.append(Frame(self.structures, self.bodies, self.perElement))

    def _camera(self, azimuth, elevation):
        points = np.vstack([f.points() for f in self.frames])
        low, high = points.min(axis=0), points.max(axis=0)
        size = np.linalg.norm(high - low)
        return Camera(0.5 * (low + high), azimuth, elevation, 2.5 * size)

    def _limits(self, ax, camera, frames, aspect, margin=0.06):
        """Shows all of the frames in a picture `aspect` times as wide as high."""
        flat = np.vstack([camera.project(f.points())[0] for f in frames])
        middle = 0.5 * (flat.min(axis=0) + flat.max(axis=0))
        size = np.ptp(flat, axis=0)
        half = (0.5 + margin) * max(size[1], size[0] / aspect)
        ax.set_xlim(middle[0] - aspect * half, middle[0] + aspect * half)
        ax.set_ylim(middle[1] - half, middle[1] + half)

    def nearest(self, time):
        """The frame taken nearest to a time [s]."""
        return min(self.frames, key=lambda f: abs(f.time - time))

    def strip(self, path, times, azimuth=-62.0, elevation=20.0):
        """Pictures at some times [s] side by side, each as large as its content; all from the same
        side.
        """
        figure, axes = plt.subplots(1, len(times), figsize=(4.2 * len(times), 4.6))
        camera = self._camera(azimuth, elevation)
        for ax, time in zip(np.atleast_1d(axes), times):
            frame = self.nearest(time)
            draw(ax, frame, camera, width=1.1)
            self._limits(ax, camera, [frame], 1.0)
            ax.set_title(f"{frame.time:.2f} s", fontsize=13)
        figure.tight_layout()
        figure.savefig(path, dpi=130)
        plt.close(figure)

    def animate(self, path, fps=25, azimuth=-62.0, elevation=20.0, slower=1.0):
        """Writes all pictures as a film: .mp4 by ffmpeg where it is installed, else .gif. Returns
        the file's name.

        slower: only told in the picture, how much slower than real time the film runs.
        """
        path = str(path)
        ffmpeg = shutil.which("ffmpeg") is not None and path.endswith(".mp4")
        if not ffmpeg:
            path = path.rsplit(".", 1)[0] + ".gif"
        figure, ax = plt.subplots(figsize=(9, 5))
        camera = self._camera(azimuth, elevation)
        note = f", {slower:g} times slower" if slower != 1 else ""

        def show(frame):
            ax.clear()
            draw(ax, frame, camera)
            self._limits(ax, camera, self.frames, 9 / 5)
            ax.text(0.02, 0.95, f"{frame.time:.2f} s{note}", transform=ax.transAxes)

        figure.subplots_adjust(0, 0, 1, 1)
        writer = (
            animation.FFMpegWriter(fps, bitrate=2400) if ffmpeg else animation.PillowWriter(fps)
        )
        with writer.saving(figure, path, dpi=100):
            for frame in self.frames:
                show(frame)
                writer.grab_frame()
        plt.close(figure)
        return path


class History:
    """Displacement and velocity of bodies and the mouth area of a net over time: sample() each
    time, then save() and plot().
    """

    def __init__(self, net, bodies=None):
        self.net = net
        self.bodies = list(net.bullets if bodies is None else bodies)
        self.start = [np.array(list(O.bodies[i].state.pos)) for i in self.bodies]
        self.time, self.position, self.velocity, self.area = [], [], [], []

    def sample(self):
        """Keeps the present state."""
        states = [O.bodies[i].state for i in self.bodies]
        self.time.append(O.time)
        self.position.append([list(s.pos) for s in states])
        self.velocity.append([list(s.vel) for s in states])
        self.area.append(self.net.mouthArea())

    @property
    def displacement(self):
        """Distance from the start, (times, bodies) [m]."""
        return np.linalg.norm(np.array(self.position) - np.array(self.start), axis=2)

    @property
    def speed(self):
        """(times, bodies) [m/s]."""
        return np.linalg.norm(np.array(self.velocity), axis=2)

    def save(self, path):
        """Writes a CSV: time [s], mouth area [m2], then position, velocity, displacement and speed
        of every body.
        """
        head = ["time_s", "mouth_area_m2"]
        for k in range(len(self.bodies)):
            head += [f"{q}{k + 1}_{u}" for q, u in zip(("x", "y", "z"), "mmm")]
            head += [f"v{q}{k + 1}_m_s" for q in "xyz"]
            head += [f"displacement{k + 1}_m", f"speed{k + 1}_m_s"]
        position, velocity = np.array(self.position), np.array(self.velocity)
        displacement, speed = self.displacement, self.speed
        columns = [self.time, self.area]
        for k in range(len(self.bodies)):
            columns += [*position[:, k].T, *velocity[:, k].T, displacement[:, k], speed[:, k]]
        rows = np.column_stack(columns)
        np.savetxt(path, rows, fmt="%.9g", delimiter=",", header=",".join(head), comments="")

    def plot(self, path, events=None):
        """Displacement, velocity and mouth area over time, like Figs. 16-17 of Shan, Guo, Gill
        2019.

        events: {label: time [s]} to be marked.
        """
        figure, axes = plt.subplots(1, 3, figsize=(15, 4.4))
        curves = (
            (self.displacement, "displacement of bullets [m]"),
            (self.speed, "speed of bullets [m/s]"),
            (np.array(self.area)[:, None], "mouth area [m²]"),
        )
        for ax, (data, title) in zip(axes, curves):
            for k in range(data.shape[1]):
                label = f"bullet {k + 1}" if data.shape[1] > 1 else None
                ax.plot(
                    self.time, data[:, k], lw=1.4, ls=("-", "--", "-.", ":")[k % 4], label=label
                )
            for i, (label, time) in enumerate((events or {}).items()):
                ax.axvline(time, color="0.5", lw=0.8, ls=":")
                at = (time, 0.02 + 0.06 * i)
                ax.annotate(
                    f" {label}", at, xycoords=("data", "axes fraction"), fontsize=8, color="0.35"
                )
            ax.set_xlabel("time [s]")
            ax.set_ylabel(title)
            ax.set_ylim(bottom=0)
            ax.grid(alpha=0.3)
            if data.shape[1] > 1:
                ax.legend(fontsize=9)
        figure.tight_layout()
        figure.savefig(path, dpi=130)
        plt.close(figure)
