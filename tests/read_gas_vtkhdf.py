"""Reads gas.vtkhdf as ParaView does and compares it with expected.csv beside it, bit by bit.

Usage: read_gas_vtkhdf.py gas.vtkhdf expected.csv
expected.csv has a row for each cell at each time: time, cell, pressure, u, v, w, voidage, solids u, v, w.
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
for row in numpy.loadtxt(expected_path, delimiter=",", ndmin=2):
    expected.setdefault(row[0], []).append(row[2:])

reader = vtkHDFReader()
reader.SetFileName(path)
reader.UpdateInformation()
information = reader.GetOutputInformation(0)
key = vtkStreamingDemandDrivenPipeline.TIME_STEPS()
times = [information.Get(key, step) for step in range(information.Length(key))]
assert times == list(expected), (times, list(expected))
for step, time in enumerate(times):
    reader.SetStep(step)
    reader.Update()
    output = reader.GetOutput()
    assert output.GetClassName() == "vtkImageData", output.GetClassName()
    rows = numpy.array(expected[time])
    assert output.GetNumberOfCells() == len(rows), (time, output.GetNumberOfCells(), len(rows))
    data = output.GetCellData()
    names = ["pressure", "velocity", "voidage", "solids_velocity"]
    columns = [vtk_to_numpy(data.GetArray(name)).reshape(len(rows), -1) for name in names]
    found = numpy.hstack(columns)
    assert found.dtype == numpy.float64, found.dtype
    assert found.tobytes() == rows.tobytes(), (time, found, rows)
print(f"{len(times)} times, cells {output.GetDimensions()}, spacing {output.GetSpacing()}")
