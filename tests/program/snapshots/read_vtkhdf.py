"""Reads particles.vtkhdf, gas.vtkhdf or a file of an instrument as ParaView does and compares it with a table, bit by bit.

Usage: read_vtkhdf.py FILE expected.csv
expected.csv has a row for each particle, cell or line at each time: time, then the numbers in the order of `NAMES`.
"""

import sys

try:
    import numpy
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonDataModel import vtkPolyData
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
    from vtkmodules.vtkIOHDF import vtkHDFReader
except ImportError as error:
    print(f"missing: {error}")
    sys.exit(77)

NAMES = {
    "vtkPolyData": ["id", "position", "velocity", "angular_velocity", "radius"],
    "lines": ["lower", "higher", "ends", "normal_force", "cohesive_force", "tangential_force", "overlap", "age"],
    "vtkImageData": ["pressure", "velocity", "voidage", "solids_velocity"],
}

path, expected_path = sys.argv[1:]
expected = {}
for line in open(expected_path):
    time, *numbers = map(float, line.split(","))
    expected.setdefault(time, []).append(numbers)


def rows_of(output):
    """The numbers of the particles, lines or cells, a row for each."""
    kind = output.GetClassName()
    data, count = output.GetCellData(), output.GetNumberOfCells()
    if isinstance(output, vtkPolyData) and output.GetNumberOfLines() > 0:
        kind = "lines"
        assert count == output.GetNumberOfLines(), count
    elif isinstance(output, vtkPolyData):
        data, count = output.GetPointData(), output.GetNumberOfPoints()
        if data.HasArray("radius"):
            # One vertex of all particles, by which they are drawn. A time without contacts has no cells.
            assert output.GetNumberOfVerts() == output.GetNumberOfCells() == 1, output.GetNumberOfVerts()
            drawn = vtk_to_numpy(output.GetVerts().GetConnectivityArray())
            assert drawn.tolist() == list(range(count)), drawn
    if count == 0:
        return []
    columns = []
    for name in NAMES[kind]:
        if name == "position":
            column = vtk_to_numpy(output.GetPoints().GetData())
        elif name == "ends":
            points = vtk_to_numpy(output.GetPoints().GetData())
            ends = vtk_to_numpy(output.GetLines().GetConnectivityArray())
            column = points[ends.reshape(count, 2)]
        else:
            column = vtk_to_numpy(data.GetArray(name))
        assert column.dtype == numpy.float64 or name in ("id", "lower", "higher"), (name, column.dtype)
        columns.append(column.reshape(count, -1).astype(float))
    return numpy.hstack(columns)


reader = vtkHDFReader()
reader.SetFileName(path)
reader.UpdateInformation()
information = reader.GetOutputInformation(0)
key = vtkStreamingDemandDrivenPipeline.TIME_STEPS()
times = [information.Get(key, step) for step in range(information.Length(key))]
assert [time for time in times if time in expected] == list(expected), (times, list(expected))
for step, time in enumerate(times):
    reader.SetStep(step)
    reader.Update()
    found, rows = rows_of(reader.GetOutput()), expected.get(time, [])
    assert len(found) == len(rows), (time, len(found), len(rows))
    if rows:
        assert found.tobytes() == numpy.array(rows).tobytes(), (time, found, rows)
output = reader.GetOutput()
if isinstance(output, vtkPolyData):
    print(f"{len(times)} times, {len(times) - len(expected)} of them without particles")
else:
    print(f"{len(times)} times, cells {output.GetDimensions()}, spacing {output.GetSpacing()}")
