"""Tables of the studies of Moon, Kevrekidis & Sundaresan (2006)."""

from __future__ import annotations

from pathlib import Path

from paper_report import tables as paper_tables
from paper_report.tables import made_by, study_table
from study_tables import StudyTable

KEPT = Path(__file__).resolve().parent.parent / "results"
STUDIES = paper_tables.studies_of(KEPT)
"""The names of all studies."""


def table(results: Path, study: str, kind: str) -> StudyTable | None:
    """A table of a study, of the runs made here or the one that is kept."""
    return study_table(results, KEPT, study, kind)


def made_or_kept(made: StudyTable | None, name: str) -> StudyTable | None:
    """A table of the runs made here, else the one of this name that is kept."""
    return paper_tables.made_or_kept(made, KEPT / name)


def source(study: str, points: StudyTable) -> str:
    """The origin of the numbers of a section, and how to repeat them."""
    return made_by("moon2006", study, points)


def sources(*studies: tuple[str, StudyTable | None]) -> list[str]:
    """The origin of the numbers of those studies that have tables."""
    return [source(study, points) for study, points in studies if points]


def states(points: StudyTable, axis: str) -> str:
    """The behaviour of the beds of each point, as text."""
    parts = [f"{float(row[axis]):g}: {row['waves'].replace('_', ' ')}" for row in points.rows]
    return "; ".join(parts)


def parts(points: StudyTable, axis: str) -> str:
    """The parts of heights and times that have waves, stand still and rise as a plug, at each point, as means over the seeds."""
    words = {"share": "waves", "frozen_share": "still", "plug_share": "plug"}
    told = []
    for row in points.rows:
        shares = ", ".join(f"{name} {points.estimate(row, quantity).mean:.2f}" for quantity, name in words.items())
        told.append(f"{float(row[axis]):g}: {shares}")
    return "; ".join(told)
