"""Tables of the studies of Moon, Kevrekidis & Sundaresan (2006), and drawings of them that several figures share."""

from __future__ import annotations

import math
from pathlib import Path

from study_tables import StudyTable, read_study_table
from talcum_results import BLUE, GREY, ORANGE, RED, Array, new_figure, read_profiles

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure

KEPT = Path(__file__).resolve().parent.parent / "cases/moon2006/results"


def table(results: Path, study: str, kind: str) -> StudyTable | None:
    """A table of a study: of the runs made here, else the one that is kept; None if there is neither. Of points without a
    complete run nothing is known, and a study that was only begun here does not count."""
    for file in (results / study / f"{kind}.csv", KEPT / f"{study}-{kind}.csv"):
        if file.exists():
            found = read_study_table(file)
            rows = [row for row in found.rows if is_known(row)]
            if rows:
                return StudyTable(found.file, found.provenance, rows, found.units)
    return None


def is_known(row: dict[str, str]) -> bool:
    """Whether a run of a row, or one run of a point, is complete, and a search has found its crossing."""
    return row.get("runs") != "0" and row.get("found") != "0" and row.get("state", "complete") == "complete"


def source(study: str, points: StudyTable) -> str:
    """Where the numbers of a section come from, and how to make them again."""
    commit = points.provenance.get("commit", "unknown")[:12]
    return f"Made by: talcum study cases/moon2006/studies/{study}.toml (Talcum commit {commit}, {points.file.name})."


def sources(*studies: tuple[str, StudyTable | None]) -> list[str]:
    """The same for the studies of which there are tables."""
    return [source(study, points) for study, points in studies if points]


def within(value: float, paper: float, part: float) -> bool:
    """Whether a value is within a part of the paper's."""
    return math.isfinite(value) and abs(value - paper) <= part * abs(paper)


def space_time(results: Path, run: str, study: str, start: float) -> Figure | None:
    """The solids fraction of a run over time and height; None if the run is not here."""
    folder = results / study / "runs" / run
    if not (folder / "profiles.h5").exists():
        return None
    profiles = read_profiles(folder).between(start, None)
    figure, panels = new_figure(size=(9.0, 3.6))
    panel = panels[0, 0]
    panel.grid(False)
    bed: Array = np.ma.masked_less(profiles.solids_fraction, 0.02)
    colours = colormaps["cividis"].with_extremes(bad="white")
    mesh = panel.pcolormesh(profiles.time, profiles.height, bed.T, cmap=colours, vmin=0.3, vmax=0.63,
                            shading="nearest", rasterized=True)  # fmt: skip
    panel.set_ylim(0.0, 135.0)
    panel.set_xlabel("time [sqrt(d/g)]")
    panel.set_ylabel("height [d]")
    figure.colorbar(mesh, label="solids fraction")
    return figure


def pictures(results: Path, study: str, runs: StudyTable | None, start: float, **chosen: float | str):
    """The picture over height and time of the first run with these values, if it is here."""
    for row in runs.where(**chosen).rows[:1] if runs else []:
        figure = space_time(results, row["run"], study, start)
        if figure is not None:
            named = ", ".join(f"{name} {value}" for name, value in chosen.items())
            yield figure, f"Solids fraction over height and time: {named}."


def over(points: StudyTable, axis: str, measures: dict[str, str], groups: list[tuple[str, StudyTable]]) -> Figure:
    """Measures over a key, a panel each, a line for each group."""
    figure, panels = new_figure(1, len(measures), size=(4.6 * len(measures), 3.8))
    for panel, (measure, label) in zip(panels[0], measures.items()):
        for (name, group), colour in zip(groups, (BLUE, ORANGE, RED, GREY)):
            found = group.estimates(measure)
            x = np.array(group.numbers(axis))
            y = np.array([e.mean for e in found])
            error = np.array([[e.mean - e.lower, e.upper - e.mean] for e in found]).T
            panel.errorbar(x, y, yerr=np.nan_to_num(error), fmt="o-", color=colour, label=name, capsize=3)
        panel.set_xlabel(axis.replace("_", " "))
        panel.set_ylabel(label)
        panel.set_ylim(bottom=0.0)
    panels[0, 0].legend()
    return figure


def states(points: StudyTable, axis: str) -> str:
    """What the beds of each point do, in words."""
    parts = [f"{float(row[axis]):g}: {row['waves'].replace('_', ' ')}" for row in points.rows]
    return "; ".join(parts)
