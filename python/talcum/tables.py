"""Tables of results: columns by name, with units."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any, Iterator

import numpy as np
import numpy.typing as npt

from talcum_results import (
    Analysis,
    Profiles,
    ResultsError,
    complete_lines,
    optional,
    rows_between,
    series_table,
    split_heading,
)

__all__ = ["Analysis", "Array", "Profiles", "ResultsError", "Table", "optional", "read_table"]

Array = npt.NDArray[Any]


class Table:
    """Columns of equal length, by name: `table["time"]` is an array, `table.units["time"]` its unit."""

    def __init__(self, source: Path, columns: dict[str, Array], units: dict[str, str]) -> None:
        self.source = source
        self.columns = columns
        self.units = units

    def __getitem__(self, name: str) -> Array:
        if name not in self.columns:
            raise ResultsError(f"{self.source}: has no column '{name}'; it has {', '.join(self.columns)}")
        return self.columns[name]

    def __contains__(self, name: object) -> bool:
        return name in self.columns

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def keys(self) -> list[str]:
        """The names of the columns."""
        return list(self.columns)

    @property
    def rows(self) -> int:
        """The number of rows."""
        return min((len(column) for column in self.columns.values()), default=0)

    def where(self, rows: Array) -> Table:
        """The rows that an array of bool marks."""
        return Table(self.source, {name: column[rows] for name, column in self.columns.items()}, self.units)

    def between(self, start: float | None = None, end: float | None = None) -> Table:
        """The rows with start <= time <= end; an error if there are none."""
        return self.where(rows_between(self["time"], start, end))

    def to_pandas(self) -> Any:
        """A pandas.DataFrame. A vector has a column for each component: velocity_x, velocity_y, velocity_z."""
        pandas = optional("pandas", "to_pandas")
        flat: dict[str, Array] = {}
        for name, column in self.columns.items():
            flat.update(components(name, column))
        frame = pandas.DataFrame(flat)
        frame.attrs["units"] = dict(self.units)
        return frame

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {self.source}: {self.rows} rows of {', '.join(self.columns)}>"


def components(name: str, column: Array) -> dict[str, Array]:
    """The components of a column: x, y, z for vectors, otherwise numbered; the column itself if it has only one."""
    if column.ndim == 1:
        return {name: column}
    flat = column.reshape(len(column), int(np.prod(column.shape[1:])))
    endings = ["x", "y", "z"] if column.shape[1:] == (3,) else [str(index) for index in range(flat.shape[1])]
    return {f"{name}_{ending}": flat[:, index] for index, ending in enumerate(endings)}


def read_table(file: Path, texts: tuple[str, ...] = ()) -> Table:
    """Reads a table of text such as series.csv; columns named in `texts` are not numbers."""
    lines = [line for line in complete_lines(file) if line and not line.startswith("#")]
    cells = list(csv.reader(lines))
    if not cells:
        raise ResultsError(f"{file}: holds no results yet")
    headings = [split_heading(heading) for heading in cells[0]]
    rows = cells[1:]
    for row in rows:
        if len(row) != len(headings):
            raise ResultsError(f"{file}: a row has {len(row)} cells in place of {len(headings)}: {','.join(row)}")
    numeric = [index for index, (name, _) in enumerate(headings) if name not in texts]
    numbers = series_table(file, [[row[index] for index in numeric] for row in rows], len(numeric))
    columns: dict[str, Array] = {}
    for index, (name, _) in enumerate(headings):
        text = np.array([row[index] for row in rows], dtype=str)
        columns[name] = numbers[:, numeric.index(index)] if index in numeric else text
    return Table(file, columns, dict(headings))
