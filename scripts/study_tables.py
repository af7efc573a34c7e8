"""Reads and writes the tables of a study: runs.csv and points.csv, as `talcum study` writes them."""

from __future__ import annotations

import csv
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from talcum_results import ResultsError, optional, split_heading


@dataclass
class Estimate:
    """A mean over the seeds with its confidence interval, and the number of seeds that gave a value."""

    mean: float
    lower: float
    upper: float
    runs: int

    def overlaps(self, lower: float, upper: float) -> bool:
        """Whether its interval and another have a part in common."""
        return self.lower <= upper and lower <= self.upper

    def __str__(self) -> str:
        if self.runs == 0:
            return "none"
        if self.runs == 1:
            return f"{shortly(self.mean)} (one seed)"
        return f"{shortly(self.mean)} ({shortly(self.lower)} to {shortly(self.upper)}; {self.runs} seeds)"


@dataclass
class StudyTable:
    """Rows of a table by their headings, without units, and the comment lines above them."""

    file: Path
    provenance: dict[str, str]
    rows: list[dict[str, str]]
    units: dict[str, str] = field(default_factory=dict)

    def where(self, **values: float | str) -> StudyTable:
        """The rows in which these columns have these values."""
        rows = [row for row in self.rows if all(same(self.cell(row, name), value) for name, value in values.items())]
        return StudyTable(self.file, self.provenance, rows, self.units)

    def cell(self, row: dict[str, str], name: str) -> str:
        """A cell as text."""
        if name not in row:
            raise ResultsError(f"{self.file}: has no column {name}")
        return row[name]

    def numbers(self, name: str) -> list[float]:
        """A column as numbers; empty cells are NaN."""
        return [number_of(self.cell(row, name)) for row in self.rows]

    def texts(self, name: str) -> list[str]:
        """A column as texts."""
        return [self.cell(row, name) for row in self.rows]

    def to_pandas(self) -> Any:
        """A pandas.DataFrame; a column holds numbers if all its cells do, except empty ones, which become NaN."""
        frame = optional("pandas", "to_pandas").DataFrame({name: self.column(name) for name in self.units})
        frame.attrs["units"] = dict(self.units)
        return frame

    def column(self, name: str) -> list[float] | list[str]:
        """A column as numbers, or as texts if some of its cells are not numbers."""
        try:
            return self.numbers(name)
        except ValueError:
            return self.texts(name)

    def estimates(self, quantity: str) -> list[Estimate]:
        """A quantity of every point with its interval."""
        return [self.estimate(row, quantity) for row in self.rows]

    def estimate(self, row: dict[str, str], quantity: str) -> Estimate:
        """A quantity of one point with its interval."""
        mean, lower, upper = (number_of(self.cell(row, quantity + end)) for end in ("", "_lower", "_upper"))
        given = row.get(f"{quantity}_runs", row.get("runs", "0"))
        runs = int(given) if mean == mean else 0
        return Estimate(mean, lower, upper, runs)


def shortly(number: float) -> str:
    """A number to three digits; from a thousand on, a whole number."""
    return f"{number:,.0f}" if abs(number) >= 1000.0 else f"{number:.3g}"


def number_of(text: str) -> float:
    """A number, or NaN for an empty cell."""
    return float(text) if text else float("nan")


def same(cell: str, value: float | str) -> bool:
    """Whether a cell holds a value."""
    return cell == value if isinstance(value, str) else bool(cell) and float(cell) == value


def read_study_table(file: Path) -> StudyTable:
    """Reads a table of a study."""
    try:
        lines = file.read_text().splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise ResultsError(f"{file}: cannot be read: {error}") from error
    notes = [line[2:].split(": ", 1) for line in lines if line.startswith("# ")]
    # If several lines have one name, such as those of the quantities, the first counts.
    provenance = {note[0]: note[-1] for note in reversed(notes)}
    table = list(csv.reader(line for line in lines if not line.startswith("#")))
    if not table:
        raise ResultsError(f"{file}: has no heading: is it a table of talcum study?")
    units = dict(split_heading(heading) for heading in table[0])
    names = list(units)
    for row in table[1:]:
        if len(row) != len(names):
            raise ResultsError(f"{file}: a row has {len(row)} cells in place of {len(names)}")
    return StudyTable(file, provenance, [dict(zip(names, row)) for row in table[1:]], units)


def table_of_rows(file: Path, provenance: dict[str, str], rows: list[dict[str, str]]) -> StudyTable:
    """A table of rows whose keys are headings, with their units: "time [s]"."""
    units = dict(split_heading(heading) for heading in rows[0])
    return StudyTable(file, provenance, [dict(zip(units, row.values())) for row in rows], units)


def write_study_table(table: StudyTable, file: Path) -> None:
    """Writes a table, with its provenance above it."""
    heads = [f"{name} [{unit}]" if unit else name for name, unit in table.units.items()]
    lines = [f"# {name}: {value}" for name, value in table.provenance.items()]
    lines += [",".join(heads), *(",".join(row[name] for name in table.units) for row in table.rows)]
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(f"table: {file}")
