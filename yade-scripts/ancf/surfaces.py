"""Surfaces of bodies, as points and faces, for pictures and for ParaView."""

import numpy as np
from yade import O, wrapper

from .needs import needed
from .structure import matrix

with needed("python3-vtk9"):
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
    from vtkmodules.vtkFiltersSources import vtkSphereSource

AROUND = 64  # faces around a sheave

_CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
_SIDES = np.array(
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
)


def solids(ids=None):
    """Numbers of the bodies with a shape to be shown: all but elements of cables; of ids, clumps by
    their members. ValueError for a body that is not there.
    """
    if ids is None:
        ids = [b.id for b in O.bodies if b.shape and not isinstance(b.shape, wrapper.CableElement)]
    shown = []
    for i in ids:
        if not 0 <= i < len(O.bodies) or O.bodies[i] is None:
            raise ValueError(f"bodies: there is no body {i} in O.bodies")
        shape = O.bodies[i].shape
        shown += list(shape.members.keys()) if isinstance(shape, wrapper.Clump) else [i]
    return list(dict.fromkeys(shown))


def surfaces(ids, points, across=32):
    """[(id, points (n, 3) [m] in the scene, faces (m, 3 or 4), numbers of its points)] of bodies that
    have a surface here.

    points   (n, 3) that are shown as well [m]: walls, which are endless, reach a little beyond all
    across   faces around a sphere
    """
    found, walls = [], []
    for i in ids:
        body = O.bodies[i]
        if isinstance(body.shape, wrapper.Wall):
            walls.append(i)
            continue
        made = _surface(body.shape, across)
        if made is not None:
            local, faces = made
            place = local @ matrix(body.state.ori).T + np.array(list(body.state.pos))
            found.append((i, place, faces))
    if walls:
        shown = np.vstack([np.asarray(points).reshape(-1, 3), *(p for _, p, _ in found)])
        if not len(shown):
            shown = np.array([[-1.0, -1, -1], [1, 1, 1]])
        low, high = shown.min(axis=0), shown.max(axis=0)
        room = 0.1 * np.linalg.norm(high - low)
        found += [(i, *_wall(O.bodies[i], low - room, high + room)) for i in walls]
    return found


def _surface(shape, across):
    """Points in the body's frame and faces, or None."""
    if isinstance(shape, wrapper.Sphere):
        points, faces = sphere(across)
        return shape.radius * points, faces
    if isinstance(shape, wrapper.Box):
        return _CORNERS * np.array(list(shape.extents)), _SIDES
    if isinstance(shape, wrapper.Facet):
        return np.array([list(v) for v in shape.vertices]), np.array([[0, 1, 2]])
    if isinstance(shape, wrapper.Sheave):
        return turned(np.array(shape.outline()))
    return None


def sphere(across):
    """The unit sphere, with so many faces around it."""
    source = vtkSphereSource()
    source.SetRadius(1)
    source.SetThetaResolution(across)
    source.SetPhiResolution(across // 2)
    source.Update()
    made = source.GetOutput()
    points = vtk_to_numpy(made.GetPoints().GetData()).astype(float)
    return points, vtk_to_numpy(made.GetPolys().GetConnectivityArray()).reshape(-1, 3)


def turned(outline):
    """The surface that an outline (n, 2) of (z, radius) [m] sweeps about the z axis."""
    angle = np.linspace(0, 2 * np.pi, AROUND, endpoint=False)
    z, r = (np.repeat(q[:, None], AROUND, axis=1) for q in outline.T)
    points = np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=-1).reshape(-1, 3)
    k = np.arange(len(points)).reshape(len(outline), AROUND)
    on = np.roll(k, -1, axis=1)
    return points, np.stack([k[:-1], on[:-1], on[1:], k[1:]], axis=-1).reshape(-1, 4)


def _wall(body, low, high):
    """The part of a wall that lies across the box from low (3) to high (3)."""
    axis = body.shape.axis
    u, v = (axis + 1) % 3, (axis + 2) % 3
    points = np.array([low, low, high, high], float)
    points[1, u], points[3, u] = high[u], low[u]
    points[:, axis] = body.state.pos[axis]
    return points, np.array([[0, 1, 2, 3]])


def polyData(points, faces):
    """A vtkPolyData of points (n, 3) and faces (m, k)."""
    data = vtkPolyData()
    data.SetPoints(vtkPointsOf(points))
    cells = vtkCellArray()
    connectivity = np.ascontiguousarray(faces, dtype=np.int64)
    cells.SetData(connectivity.shape[1], numpy_to_vtkIdTypeArray(connectivity.ravel(), deep=True))
    data.SetPolys(cells)
    return data


def vtkPointsOf(points):
    """vtkPoints in double precision of an array (n, 3)."""
    made = vtkPoints()
    made.SetData(numpy_to_vtk(np.ascontiguousarray(points, dtype=float), deep=True))
    return made


def addField(target, name, values):
    """Puts an array with a name into point or cell data."""
    array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    target.AddArray(array)
    return array
