"""Fields on the cells of a volume-averaged gas, or of an instrument on cells, at one time."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from talcum_results import snapshot_times

from .files import column, read_hdf5
from .snapshots import nearest
from .tables import Array, ResultsError, Table, optional


@dataclass
class Fields:
    """Fields by name, `fields["voidage"]`. Arrays are [z][y][x]; for vectors and tensors the components come last.

    `x`, `y` and `z` are the centres of the cells.
    """

    source: Path
    time: float
    x: Array
    y: Array
    z: Array
    columns: dict[str, Array]
    units: dict[str, str]

    def __getitem__(self, name: str) -> Array:
        if name not in self.columns:
            raise ResultsError(f"{self.source}: has no field '{name}'; it has {', '.join(self.columns)}")
        return self.columns[name]

    def keys(self) -> list[str]:
        """The names of the fields."""
        return list(self.columns)

    def to_pandas(self) -> Any:
        """A pandas.DataFrame with a row for each cell: x, y, z of its centre, then the fields, vectors by components."""
        z, y, x = (axis.ravel() for axis in np.meshgrid(self.z, self.y, self.x, indexing="ij"))
        flat = {name: values.reshape(len(x), *values.shape[3:]) for name, values in self.columns.items()}
        return Table(self.source, {"x": x, "y": y, "z": z, **flat}, self.units).to_pandas()

    def to_xarray(self) -> Any:
        """An xarray.Dataset over z, y and x, with units as attributes; `component` is x, y or z, and tensors also have `row`."""
        variables: dict[str, Any] = {}
        for name, values in self.columns.items():
            behind = {0: (), 1: ("component",), 2: ("row", "component")}[values.ndim - 3]
            variables[name] = (("z", "y", "x", *behind), values, {"units": self.units[name]})
        places = {"z": self.z, "y": self.y, "x": self.x}
        coordinates: dict[str, Any] = {name: (name, at, {"units": self.units[name]}) for name, at in places.items()}
        used = {name for dimensions, _, _ in variables.values() for name in dimensions}
        coordinates.update({name: ["x", "y", "z"] for name in ("row", "component") if name in used})
        return optional("xarray", "to_xarray").Dataset(variables, coordinates, {"time": self.time})


def read_fields(file: Path, time: float | None, exact: bool) -> Fields:
    """The fields at the time nearest to a wanted one, of a file of ImageData."""

    def take(contents: Any) -> Fields:
        root = contents["VTKHDF"]
        times = snapshot_times(root)
        step = nearest(times, time, exact, file)
        read = {name: column(dataset, slice(step, step + 1)) for name, dataset in root["CellData"].items()}
        units = {name: unit for name, (_, unit) in read.items()}
        x, y, z = (middles(root.attrs, axis) for axis in range(3))
        length = length_unit(contents)
        units.update(x=length, y=length, z=length)
        return Fields(file, float(times[step]), x, y, z, {n: matrices(v[0]) for n, (v, _) in read.items()}, units)

    return read_hdf5(file, take)


def middles(attributes: Any, axis: int) -> Array:
    """The centres of the cells along an axis."""
    cells = int(attributes["WholeExtent"][2 * axis + 1] - attributes["WholeExtent"][2 * axis])
    return np.asarray(attributes["Origin"][axis] + (np.arange(cells) + 0.5) * attributes["Spacing"][axis])


def matrices(values: Array) -> Array:
    """Values of cells; nine components in a row, as VTK requires them, become a matrix of three rows."""
    return values.reshape(*values.shape[:3], 3, 3) if values.shape[3:] == (9,) else values


def length_unit(contents: Any) -> str:
    """The unit of lengths in a file, from the units of its case."""
    units = contents["talcum"].attrs["units"]
    return "m" if (units.decode() if isinstance(units, bytes) else str(units)) == "si" else "d"
