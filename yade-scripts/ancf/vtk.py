"""Files for ParaView: cables as curves with tension and speed, bodies as surfaces."""

import os

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData, vtkPolyLine
from vtkmodules.vtkCommonTransforms import vtkTransform
from vtkmodules.vtkFiltersCore import vtkAppendPolyData
from vtkmodules.vtkFiltersGeneral import vtkTransformPolyDataFilter
from vtkmodules.vtkFiltersSources import vtkCubeSource, vtkSphereSource
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter
from yade import O, wrapper


def cableData(structures, perElement=8):
    """vtkPolyData of the true curves; point data `tension` [N], `speed` [m/s], `velocity` [m/s],
    `radius` [m].
    """
    points, lines = vtkPoints(), vtkCellArray()
    tension, velocity, radius = [], [], []
    for structure in structures:
        for span in structure.spans:
            curve = span.curve(perElement)
            line = vtkPolyLine()
            line.GetPointIds().SetNumberOfIds(len(curve))
            for i, p in enumerate(curve):
                line.GetPointIds().SetId(i, points.InsertNextPoint(p))
            lines.InsertNextCell(line)
            tension += list(span.tensions(perElement))
            velocity += [list(span.velocity(s)) for s in span.stations(perElement)]
            radius += [structure.radius] * len(curve)
    data = vtkPolyData()
    data.SetPoints(points)
    data.SetLines(lines)
    speed = np.linalg.norm(np.array(velocity), axis=1)
    fields = {"tension": tension, "speed": speed, "velocity": velocity, "radius": radius}
    for name, values in fields.items():
        _addField(data.GetPointData(), name, values)
    return data


def bodyData(ids, across=32):
    """vtkPolyData of the surfaces of spheres and boxes; cell data `id` and `speed` [m/s]."""
    append = vtkAppendPolyData()
    for i in ids:
        surface = _surface(O.bodies[i], across)
        if surface is not None:
            cells = surface.GetNumberOfCells()
            _addField(surface.GetCellData(), "id", np.full(cells, i))
            _addField(surface.GetCellData(), "speed", np.full(cells, O.bodies[i].state.vel.norm()))
            append.AddInputData(surface)
    if append.GetNumberOfInputConnections(0) == 0:
        return vtkPolyData()
    append.Update()
    return append.GetOutput()


def _addField(target, name, values):
    array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    target.AddArray(array)


def _surface(body, across):
    shape, state = body.shape, body.state
    if isinstance(shape, wrapper.Sphere):
        source = vtkSphereSource()
        source.SetRadius(shape.radius)
        source.SetThetaResolution(across)
        source.SetPhiResolution(across // 2)
    elif isinstance(shape, wrapper.Box):
        source = vtkCubeSource()
        source.SetXLength(2 * shape.extents[0])
        source.SetYLength(2 * shape.extents[1])
        source.SetZLength(2 * shape.extents[2])
    else:
        return None
    axis, angle = state.ori.toAxisAngle()
    transform = vtkTransform()
    transform.Translate(*state.pos)
    transform.RotateWXYZ(np.degrees(angle), *axis)
    moved = vtkTransformPolyDataFilter()
    moved.SetTransform(transform)
    moved.SetInputConnection(source.GetOutputPort())
    moved.Update()
    return moved.GetOutput()


class VtkRecorder:
    """Writes <prefix>cables-0000.vtp, <prefix>bodies-0000.vtp at each save(), and
    <prefix>cables.pvd with their times.

    structures: cables and nets; bodies: ids of spheres and boxes, None: all that are no elements
    of cables.
    """

    def __init__(self, prefix, structures, bodies=None, perElement=8):
        self.prefix, self.structures = str(prefix), list(structures)
        self.bodies, self.perElement = bodies, perElement
        self._written = {"cables": [], "bodies": []}
        os.makedirs(os.path.dirname(self.prefix) or ".", exist_ok=True)

    def save(self):
        """Writes the present state."""
        ids = self.bodies
        if ids is None:
            ids = [
                b.id for b in O.bodies if b.shape and not isinstance(b.shape, wrapper.CableElement)
            ]
        self._write("cables", cableData(self.structures, self.perElement))
        self._write("bodies", bodyData(ids))

    def _write(self, what, data):
        files = self._written[what]
        path = f"{self.prefix}{what}-{len(files):04d}.vtp"
        writer = vtkXMLPolyDataWriter()
        writer.SetFileName(path)
        writer.SetInputData(data)
        if not writer.Write():
            raise OSError(f"{path} could not be written")
        files.append((O.time, os.path.basename(path)))
        self._writeSeries(what, files)

    def _writeSeries(self, what, files):
        rows = [f'    <DataSet timestep="{t:.9g}" file="{name}"/>' for t, name in files]
        text = ['<VTKFile type="Collection" version="0.1">', "  <Collection>", *rows]
        text += ["  </Collection>", "</VTKFile>", ""]
        with open(f"{self.prefix}{what}.pvd", "w", encoding="utf-8") as file:
            file.write("\n".join(text))
