"""Studies: many runs of one case, and their tables `runs.csv` and `points.csv`."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Union

from talcum_results import program

from .program import call, file_words, named
from .study_tables import Estimate, StudyTable, read_study_table
from .tables import ResultsError

__all__ = ["Estimate", "Study", "StudyTable", "read_study", "run_study"]

PathText = Union[str, "PathLike[str]"]


@dataclass
class Study:
    """A row for each run, and a row for each point with means over the seeds and their intervals."""

    folder: Path
    runs: StudyTable
    points: StudyTable


def run_study(
    study: PathText,
    *,
    output: PathText | None = None,
    at_a_time: int | None = None,
    ranks_per_run: int | None = None,
    launcher: str | None = None,
    retry: bool = False,
    quiet: bool = True,
) -> Study:
    """Runs the missing runs of a study, and reads its tables.

    `output` is the folder of the study, results/NAME of the study file by default; `at_a_time`, `ranks_per_run`,
    `launcher` and `retry` are the program's options of these names. Without `quiet` its messages are printed.
    """
    folder = named(output) if output is not None else Path("results") / Path(study).stem
    options = [f"--output={folder}"]
    numbers = {"--at-a-time": at_a_time, "--ranks-per-run": ranks_per_run, "--launcher": launcher}
    options += [word for name, value in numbers.items() if value is not None for word in (name, str(value))]
    options += ["--retry"] if retry else []
    call([program(), "study", *options, *file_words(study)], quiet)
    return read_study(folder)


def read_study(folder: PathText) -> Study:
    """Reads the tables in a study's folder; the study need not be complete."""
    place = Path(folder)
    for name in ("runs.csv", "points.csv"):
        if not (place / name).is_file():
            raise ResultsError(f"{place / name}: there is no such file (yet); talcum study writes it")
    return Study(place, read_study_table(place / "runs.csv"), read_study_table(place / "points.csv"))
