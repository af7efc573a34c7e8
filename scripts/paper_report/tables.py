"""Tables of a paper's studies, for the pages of several papers: the kept table if a study was not run, the origin of
numbers, and curves over a key."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path

from study_tables import Estimate, StudyTable, read_study_table
from talcum_results import BLUE, GREY, ORANGE, RED, new_figure

import numpy as np
from matplotlib.figure import Figure


STUDENT = (12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228)
"""Quantiles of Student's distribution for a confidence of 95 %, from one degree of freedom on."""


def student(freedom: int) -> float:
    """The quantile for a confidence of 95 %; beyond the table within 0.003 of it."""
    return STUDENT[freedom - 1] if freedom <= len(STUDENT) else 1.96 + 2.37 / freedom + 2.8 / freedom**2


def interval_of(values: Iterable[float]) -> Estimate:
    """Mean with Student's interval of independent values."""
    known = np.array([value for value in values if math.isfinite(value)])
    if not len(known):
        return Estimate(math.nan, math.nan, math.nan, 0)
    mean = float(np.mean(known))
    if len(known) == 1:
        return Estimate(mean, math.nan, math.nan, 1)
    half = student(len(known) - 1) * float(np.std(known, ddof=1)) / math.sqrt(len(known))
    return Estimate(mean, mean - half, mean + half, len(known))


def studies_of(kept: Path) -> list[str]:
    """The names of all studies of a paper, by the folder of its kept tables."""
    return sorted(file.stem for file in (kept.parent / "studies").glob("*.toml"))


def study_table(results: Path, kept: Path, study: str, kind: str) -> StudyTable | None:
    """A table of a study, from the runs made here, otherwise the kept one; None if there is neither. Points without a
    complete run are left out, and a study that was only begun here does not count."""
    for file in (results / study / f"{kind}.csv", kept / f"{study}-{kind}.csv"):
        if file.exists():
            found = read_study_table(file)
            rows = [row for row in found.rows if is_known(row)]
            if rows:
                return StudyTable(found.file, found.provenance, rows, found.units)
    return None


def made_or_kept(made: StudyTable | None, kept: Path) -> StudyTable | None:
    """A table of the runs made here, otherwise the kept one; None if there is neither."""
    return made or (read_study_table(kept) if kept.exists() else None)


def is_known(row: dict[str, str]) -> bool:
    """Whether a run of a row, or one run of a point, is complete, and a search has found its crossing."""
    return row.get("runs") != "0" and row.get("found") != "0" and row.get("state", "complete") == "complete"


def made_by(paper: str, study: str, points: StudyTable) -> str:
    """The origin of the numbers of a section, and how to repeat them."""
    commits = [commit.strip()[:10] for commit in points.provenance.get("commit", "unknown").split(",")]
    version = points.provenance.get("talcum_version", "of unknown version")
    return (
        f"Made by: talcum study cases/{paper}/studies/{study}.toml (Talcum {version}, commit {', '.join(commits)}). "
        f"Numbers: {points.file.name}; digests of all runs: {points.file.name.replace('points', 'runs')}."
    )


def within(value: float, paper: float, part: float) -> bool:
    """Whether a value is within a fraction of the paper's value."""
    return math.isfinite(value) and abs(value - paper) <= part * abs(paper)


LABELS = {"bond_number": "Bond number", "gamma": "Gamma", "superficial_velocity": "U_s [sqrt(g d)]"}
"""The labels of axes."""


def over(points: StudyTable, axis: str, quantities: dict[str, str], groups: list[tuple[str, StudyTable]]) -> Figure:
    """Quantities over a key, a panel each, a line for each group."""
    figure, panels = new_figure(1, len(quantities), size=(4.6 * len(quantities), 3.8))
    for panel, (quantity, label) in zip(panels[0], quantities.items()):
        for (name, group), colour in zip(groups, (BLUE, ORANGE, RED, GREY)):
            found = group.estimates(quantity)
            x = np.array(group.numbers(axis))
            y = np.array([e.mean for e in found])
            error = np.array([[e.mean - e.lower, e.upper - e.mean] for e in found]).T
            panel.errorbar(x, y, yerr=np.nan_to_num(error), fmt="o-", color=colour, label=name, capsize=3)
        panel.set_xlabel(LABELS.get(axis, axis.replace("_", " ")))
        panel.set_ylabel(label)
        panel.set_ylim(bottom=0.0)
    panels[0, 0].legend()
    return figure
