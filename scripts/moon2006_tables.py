"""Tables of the studies of Moon, Kevrekidis & Sundaresan (2006), and drawings of them that several figures share."""

from __future__ import annotations

from pathlib import Path

from paper_tables import made_by, study_table
from study_tables import StudyTable
from talcum_results import Array, new_figure, read_profiles

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure

KEPT = Path(__file__).resolve().parent.parent / "cases/moon2006/results"


def table(results: Path, study: str, kind: str) -> StudyTable | None:
    """A table of a study, of the runs made here or the one that is kept."""
    return study_table(results, KEPT, study, kind)


def source(study: str, points: StudyTable) -> str:
    """Where the numbers of a section come from, and how to make them again."""
    return made_by("moon2006", study, points)


def sources(*studies: tuple[str, StudyTable | None]) -> list[str]:
    """The same for the studies of which there are tables."""
    return [source(study, points) for study, points in studies if points]


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


def states(points: StudyTable, axis: str) -> str:
    """What the beds of each point do, in words."""
    parts = [f"{float(row[axis]):g}: {row['waves'].replace('_', ' ')}" for row in points.rows]
    return "; ".join(parts)
