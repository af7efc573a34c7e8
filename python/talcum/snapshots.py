"""Particles and contacts at one time, from particles.vtkhdf, an instrument's lines, or a checkpoint."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from talcum_results import snapshot_rows, snapshot_times

from .files import column, read_hdf5
from .tables import Array, ResultsError, Table, optional

SAME_TIME = 1e-9  # of the largest time: times of snapshots are rounded multiples of decimal numbers


class Particles(Table):
    """All particles at one time: `position`, `velocity`, `angular_velocity`, `radius`, `id`, sorted by id."""

    def __init__(self, time: float, table: Table) -> None:
        super().__init__(table.source, table.columns, table.units)
        self.time = time

    @property
    def position(self) -> Array:
        """Centres, a row of x, y, z for each particle."""
        return self["position"]

    @property
    def velocity(self) -> Array:
        """Velocities of the centres."""
        return self["velocity"]

    @property
    def radius(self) -> Array:
        """Radii."""
        return self["radius"]

    def to_pyvista(self) -> Any:
        """A pyvista.PolyData of the centres, with the columns as data of the points."""
        mesh = optional("pyvista", "to_pyvista").PolyData(self.position)
        for name in self.columns:
            if name != "position":
                mesh.point_data[name] = self[name]
        return mesh


class Contacts(Table):
    """Touching pairs at one time: ids `lower` and `higher`, and the other columns of the file."""

    def __init__(self, time: float, table: Table) -> None:
        super().__init__(table.source, table.columns, table.units)
        self.time = time

    def to_pyvista(self) -> Any:
        """A pyvista.PolyData with a line for each pair, and the columns as data of the lines."""
        if "ends" not in self:
            raise ResultsError(f"{self.source}: has no lines; an instrument of kind contacts writes them")
        pairs = np.arange(2 * self.rows).reshape(-1, 2)
        lines = np.hstack([np.full((self.rows, 1), 2), pairs]).ravel()
        mesh = optional("pyvista", "to_pyvista").PolyData(self["ends"].reshape(-1, 3), lines=lines)
        for name in self.columns:
            if name != "ends":
                mesh.cell_data[name] = self[name]
        return mesh


def nearest(times: Array, time: float | None, exact: bool, source: Path) -> int:
    """The number of the time nearest to a wanted one; the last if none is wanted."""
    if len(times) == 0:
        raise ResultsError(f"{source}: holds no results yet")
    if time is None:
        return len(times) - 1
    index = int(np.argmin(np.abs(times - time)))
    tolerance = SAME_TIME * max(abs(float(times[-1])), abs(time))
    if exact and abs(float(times[index]) - time) > tolerance:
        raise ResultsError(f"{source}: has nothing at time {time:g}; the nearest is {times[index]:g}")
    return index


def read_times(file: Path) -> Array:
    """The times in a VTKHDF file."""
    return read_hdf5(file, lambda contents: snapshot_times(contents["VTKHDF"]))


def read_particles(file: Path, time: float | None, exact: bool) -> Particles:
    """The particles at the time nearest to a wanted one."""

    def take(contents: Any) -> Particles:
        root = contents["VTKHDF"]
        times = snapshot_times(root)
        step = nearest(times, time, exact, file)
        rows = snapshot_rows(root, step)
        datasets = {"position": root["Points"], **root["PointData"]}
        return Particles(float(times[step]), table_of(file, datasets, rows))

    return read_hdf5(file, take)


def read_lines(file: Path, time: float | None, exact: bool) -> Contacts:
    """The contacts that an instrument wrote, at the time nearest to a wanted one."""

    def take(contents: Any) -> Contacts:
        root = contents["VTKHDF"]
        times = snapshot_times(root)
        step = nearest(times, time, exact, file)
        first = int(root["Steps/CellDataOffsets/lower"][step])
        rows = slice(first, first + int(root["Lines/NumberOfCells"][step]))
        table = table_of(file, root["CellData"], rows)
        ends, unit = column(root["Points"], slice(2 * rows.start, 2 * rows.stop))
        table.columns["ends"], table.units["ends"] = ends.reshape(-1, 2, 3), unit
        return Contacts(float(times[step]), table)

    return read_hdf5(file, take)


def time_of_checkpoint(file: Path) -> float:
    """The time of a checkpoint."""

    return read_hdf5(file, clock_time)


def clock_time(contents: Any) -> float:
    """The time in an open checkpoint."""
    clock = contents["clock"].attrs
    steps = int(clock["step"]) - int(clock["origin_step"])
    return float(clock["origin_time"] + steps * clock["time_step"])


def read_checkpoint_contacts(file: Path, time: float) -> Contacts:
    """The contacts that a checkpoint of a time keeps, with their histories."""
    return read_hdf5(file, lambda contents: Contacts(time, table_of(file, contents["contacts"], None)))


def table_of(file: Path, datasets: Any, rows: slice | None) -> Table:
    """Rows of datasets as a table."""
    read = {name: column(dataset, rows) for name, dataset in datasets.items()}
    columns = {name: values for name, (values, _) in read.items()}
    return Table(file, columns, {name: unit for name, (_, unit) in read.items()})
