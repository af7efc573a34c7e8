"""Reads particles.vtkhdf as ParaView does and compares it with expected.csv beside it, bit by bit.

Usage: read_particles_vtkhdf.py particles.vtkhdf expected.csv
expected.csv has a row for each particle at each time: time, id, x, y, z, vx, vy, vz, wx, wy, wz, radius.
"""

import sys

try:
    import numpy
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
    from vtkmodules.vtkIOHDF import vtkHDFReader
except ImportError as error:
    print(f"missing: {error}")
    sys.exit(77)

path, expected_path = sys.argv[1:]
expected = {}
for line in open(expected_path):
    numbers = line.strip().split(",")
    expected.setdefault(float(numbers[0]), []).append([float(number) for number in numbers[1:]])

reader = vtkHDFReader()
reader.SetFileName(path)
reader.UpdateInformation()
information = reader.GetOutputInformation(0)
key = vtkStreamingDemandDrivenPipeline.TIME_STEPS()
times = [information.Get(key, step) for step in range(information.Length(key))]
empty_times = [time for time in times if time not in expected]
assert [time for time in times if time in expected] == list(expected), (times, list(expected))
for step, time in enumerate(times):
    reader.SetStep(step)
    reader.Update()
    output = reader.GetOutput()
    assert output.GetClassName() == "vtkPolyData", output.GetClassName()
    rows = numpy.array(expected.get(time, [])).reshape(-1, 11)
    assert output.GetNumberOfPoints() == len(rows), (time, output.GetNumberOfPoints(), len(rows))
    if not len(rows):
        continue
    data = output.GetPointData()
    columns = [vtk_to_numpy(data.GetArray("id")).reshape(-1, 1)]
    columns.append(vtk_to_numpy(output.GetPoints().GetData()))
    columns.append(vtk_to_numpy(data.GetArray("velocity")))
    columns.append(vtk_to_numpy(data.GetArray("angular_velocity")))
    columns.append(vtk_to_numpy(data.GetArray("radius")).reshape(-1, 1))
    found = numpy.hstack([column.astype(float) for column in columns])
    assert columns[1].dtype == numpy.float64, columns[1].dtype
    assert found.tobytes() == rows.tobytes(), (time, found, rows)
print(f"{len(times)} times, {len(empty_times)} of them without particles")
