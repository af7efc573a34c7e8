"""Run times of a paper's studies, from the table that each run prints at its end."""

from __future__ import annotations

import platform
import re
from collections.abc import Iterable
from pathlib import Path

from .page import Section, Statement
from study_tables import StudyTable, read_study_table, write_study_table

import numpy as np

KEPT = "run-times.csv"
STAGE = re.compile(r"^\S.* +(\d+\.\d\d) +\d+\.\d % +\d+\.\d\d$", re.MULTILINE)
"""A line of that table: a stage of the time step, seconds, share, imbalance."""
UNITS = {"study": "", "runs": "", "median": "s", "longest": "s", "all": "h", "processor": ""}
"""Columns of the kept table."""


def seconds_of(run: Path) -> float | None:
    """The run time [s]; None if the run is not complete, or was stopped and resumed, so that only its last part is known."""
    try:
        output = (run / "output.log").read_text()
    except OSError:
        return None
    if "resuming from" in output or "complete at" not in output:
        return None
    return sum(float(seconds) for seconds in STAGE.findall(output))


def made(results: Path, studies: Iterable[str]) -> dict[str, dict[str, str]]:
    """A row for each study that has complete runs here."""
    rows = {}
    for study in studies:
        known = [seconds for seconds in map(seconds_of, (results / study / "runs").glob("*")) if seconds is not None]
        if known:
            rows[study] = {
                "study": study,
                "runs": str(len(known)),
                "median": f"{np.median(known):.0f}",
                "longest": f"{max(known):.0f}",
                "all": f"{sum(known) / 3600.0:.2g}",
                "processor": processor(),
            }
    return rows


def processor() -> str:
    """The name of the processor."""
    try:
        named = re.search(r"^model name\s*: (.*)$", Path("/proc/cpuinfo").read_text(), re.MULTILINE)
    except OSError:
        named = None
    return (named.group(1) if named else platform.processor() or "unknown").replace(",", ";")


def times(results: Path, kept: Path, studies: Iterable[str]) -> StudyTable | None:
    """Run times of the studies that were run here, and kept times of the others; None if there are neither."""
    file = kept / KEPT
    found = {row["study"]: row for row in read_study_table(file).rows} if file.exists() else {}
    found |= made(results, studies)
    rows = [found[study] for study in sorted(found)]
    return StudyTable(file, {"title": "Times of runs, each on one core"}, rows, UNITS) if rows else None


def keep(results: Path, kept: Path, studies: Iterable[str]) -> None:
    """Adds the times of the studies that were run here to the kept ones."""
    found = times(results, kept, studies)
    if found is not None:
        write_study_table(found, kept / KEPT)


def section(results: Path, kept: Path, studies: Iterable[str]) -> Section | None:
    """The part of the page that reports them."""
    found = times(results, kept, studies)
    if found is None:
        return None
    statements = [
        Statement(row["study"], "not given", f"{row['median']} s; longest {row['longest']} s; runs that were not interrupted: {row['runs']}, {row['all']} h of one core ({row['processor']})", None)
        for row in found.rows
    ]
    text = (
        "Median time of a run on one core, by the table that each run prints at its end, with as many runs at a time as the machine has cores. "
        "Of runs that were stopped and resumed only the last part is known; they are not counted."
    )
    return Section("Run times", text, statements, [], [f"Numbers: {found.file.name}"])
