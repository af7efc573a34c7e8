"""The tables of a study: `runs.csv` and `points.csv`."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Union

from .study_tables import Estimate, StudyTable, read_study_table
from .tables import ResultsError

__all__ = ["Estimate", "Study", "StudyTable", "read_study"]


@dataclass
class Study:
    """A row for each run, and a row for each point with means over the seeds and their intervals."""

    folder: Path
    runs: StudyTable
    points: StudyTable


def read_study(folder: Union[str, "PathLike[str]"]) -> Study:
    """Reads the tables of a study's folder, also of one that is not complete."""
    place = Path(folder)
    for name in ("runs.csv", "points.csv"):
        if not (place / name).is_file():
            raise ResultsError(f"{place / name}: there is no such file (yet); talcum study writes it")
    return Study(place, read_study_table(place / "runs.csv"), read_study_table(place / "points.csv"))
