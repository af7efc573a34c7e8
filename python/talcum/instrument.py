"""The results of an instrument, a `[measure.NAME]` of a case: tables of numbers over time."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py

from .files import attributes, read_hdf5
from .snapshots import table_of
from .tables import ResultsError, Table


@dataclass
class Instrument:
    """The tables of one instrument by their names, including `results`, and its `constants`."""

    name: str
    kind: str
    tables: dict[str, Table]
    constants: Table
    attributes: dict[str, Any]

    def __getitem__(self, table: str) -> Table:
        if table not in self.tables:
            known = ", ".join(self.tables)
            raise ResultsError(f"{self.constants.source}: has no table '{table}'; it has {known}")
        return self.tables[table]

    @property
    def scalars(self) -> list[str]:
        """The columns of `results` that have one number in each row."""
        return [name for name in str(self.attributes.get("scalars", "")).split(",") if name]


def read_instrument(file: Path) -> Instrument:
    """Reads a measure-NAME.h5; rows that are not complete yet are left out."""

    def take(contents: Any) -> Instrument:
        found = attributes(contents)
        tables = {name: complete_rows(file, item) for name, item in contents.items() if isinstance(item, h5py.Group)}
        fixed = {name: item for name, item in contents.items() if isinstance(item, h5py.Dataset)}
        name = str(found.get("measure", file.stem.removeprefix("measure-")))
        return Instrument(name, str(found["kind"]), tables, table_of(file, fixed, None), found)

    return read_hdf5(file, take)


def complete_rows(file: Path, group: Any) -> Table:
    """The number of rows that all columns of a group have."""
    rows = min((len(dataset) for dataset in group.values()), default=0)
    return table_of(file, group, slice(0, rows))


def read_kind(file: Path) -> str:
    """The kind of an instrument."""
    return read_hdf5(file, lambda contents: str(attributes(contents)["kind"]))
