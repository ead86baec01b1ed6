"""Files for ParaView: cables as curves with what is read along them, bodies as surfaces."""

import os

import numpy as np
from yade import O

from .needs import needed

with needed("python3-vtk9"):
    from vtkmodules.vtkCommonCore import vtkIdList
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
    from vtkmodules.vtkFiltersCore import vtkAppendPolyData
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

from .surfaces import addField, polyData, solids, surfaces, vtkPointsOf


def cableData(structures, perElement=8):
    """vtkPolyData of the true curves, a line a cable or edge of a net, with point data

    tension        [N]
    strain         [-], Green's for ANCF, engineering strain for springs
    curvature      |r' x r''| / |r'|^3 [1/m]
    contactForce   of bodies on the cable in the last step, normal and friction together (3) [N]: that of
                   a place of contact stands at the nearest point, so that they add up to the whole.
                   Contacts of cables with each other are not in it
    velocity       (3) [m/s]; speed, its length
    radius         [m]
    """
    lines, start = vtkCellArray(), 0
    fields = {name: [] for name in ("tension", "strain", "curvature", "contactForce", "velocity")}
    points, radius = [], []
    for structure in structures:
        forces = structure.contactForces()
        for span in structure.spans:
            curve, stations = span.curve(perElement), span.stations(perElement)
            line = vtkIdList()
            for i in range(start, start + len(curve)):
                line.InsertNextId(i)
            lines.InsertNextCell(line)
            start += len(curve)
            points.append(curve)
            fields["tension"].append(span.tensions(perElement))
            fields["strain"].append([span.strain(s) for s in stations])
            fields["curvature"].append(span.curvatures(perElement))
            fields["contactForce"].append(_atPoints(span, forces, stations))
            fields["velocity"].append([list(span.velocity(s)) for s in stations])
            radius.append(np.full(len(curve), structure.radius))
    data = vtkPolyData()
    if not points:
        return data
    data.SetPoints(vtkPointsOf(np.concatenate(points)))
    data.SetLines(lines)
    for name, parts in fields.items():
        addField(data.GetPointData(), name, np.concatenate(parts))
    addField(
        data.GetPointData(), "speed", np.linalg.norm(np.concatenate(fields["velocity"]), axis=1)
    )
    addField(data.GetPointData(), "radius", np.concatenate(radius))
    return data


def _atPoints(span, forces, stations):
    """The forces on a span, each at the nearest of its stations, (n, 3)."""
    sums = np.zeros((len(stations), 3))
    for at, s, force in forces:
        if at is span:
            sums[np.abs(stations - s).argmin()] += force
    return sums


def bodyData(ids=None, shown=(), across=32):
    """vtkPolyData of the surfaces of spheres, boxes, facets, walls and sheaves; cell data `id`, `speed`
    [m/s].

    ids      None: all bodies that are no elements of cables; clumps stand for their members
    shown    points (n, 3) besides, that walls shall reach beyond [m]
    across   faces around a sphere
    """
    append = vtkAppendPolyData()
    points = np.asarray(shown, float).reshape(-1, 3)
    for i, places, faces in surfaces(solids(ids), points, across):
        data = polyData(places, faces)
        addField(data.GetCellData(), "id", np.full(len(faces), i))
        addField(data.GetCellData(), "speed", np.full(len(faces), O.bodies[i].state.vel.norm()))
        append.AddInputData(data)
    if append.GetNumberOfInputConnections(0) == 0:
        return vtkPolyData()
    append.SetOutputPointsPrecision(1)  # double
    append.Update()
    return append.GetOutput()


class VtkRecorder:
    """Writes <prefix>cables-0000.vtp, <prefix>bodies-0000.vtp at each save(), and
    <prefix>cables.pvd, <prefix>bodies.pvd with their times.

    structures: cables and nets; bodies: ids, None: all that are no elements of cables. OSError for
    a file that cannot be written.
    """

    def __init__(self, prefix, structures, bodies=None, perElement=8):
        self.prefix, self.structures = str(prefix), list(structures)
        self.bodies, self.perElement = bodies, perElement
        self._written = {"cables": [], "bodies": []}
        os.makedirs(os.path.dirname(self.prefix) or ".", exist_ok=True)

    def save(self):
        """Writes the present state."""
        self._write("cables", cableData(self.structures, self.perElement))
        knots = [s.knots for s in self.structures]
        self._write("bodies", bodyData(self.bodies, np.concatenate(knots) if knots else ()))

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
