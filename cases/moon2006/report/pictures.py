"""The solids fraction over height and time in some beds of Moon, Kevrekidis & Sundaresan (2006): a picture for each study."""

from __future__ import annotations

from pathlib import Path

from paper_report.page import picture
from talcum_results import Profiles, new_figure, read_profiles

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure

from . import tables

Choice = dict[str, float | str]
"""Values of a study's columns, of which the first run is shown."""

BEDS: dict[str, list[Choice]] = {
    "developed-bed": [{"seed": 1}],
    "fig1": [{"superficial_velocity": velocity} for velocity in (0.052, 0.082)],
    "fig1-sections": [{"count": count} for count in (6000, 12000)],
    "fig2": [{"bond_number": bond, "friction_cap": "net"} for bond in (2.0, 4.0, 6.0, 8.0)],
    "fig2-long": [{"bond_number": bond} for bond in (4.0, 5.0, 6.0, 7.0)],
    "fig3": [{"gamma": gamma} for gamma in (1.0, 1.5, 2.0, 3.0, 4.0, 6.0)],
    "fine-powder": [{"asperity_radius": radius} for radius in (4.25e-8, 8.9e-8, 2.23e-7)],
    "map": [{"superficial_velocity": 0.12, "gamma": gamma, "bond_number": 32.0} for gamma in (2.0, 3.0, 4.0, 6.0)],
    "wide": [{"bond_number": bond, "gamma": gamma} for bond in (0.0, 8.0) for gamma in (0.0, 3.0)],
}
"""The beds that are shown of each study."""
SYMBOLS = {"bond_number": "Bo", "gamma": "Gamma", "superficial_velocity": "U_s", "count": "particles", "asperity_radius": "asperities [m]"}
INSIDE = 0.02
"""Solids fraction above which there is a bed."""


def beds(results: Path, study: str) -> list[tuple[Figure, str]]:
    """The picture of a study with its caption: of the runs made here, else the one that is kept; nothing if there is neither."""
    caption = "Solids fraction (dark: dilute) over height and time, one bed of each kind."
    drawn, kept = figure(results, study), tables.KEPT / f"{study}.png"
    if drawn is None and kept.exists():
        drawn = picture(kept)
    return [(drawn, caption)] if drawn else []


def figure(results: Path, study: str) -> Figure | None:
    """The beds of a study over height and time; None if not all of them are here."""
    runs = tables.table(results, study, "runs")
    rows = [(chosen, runs.where(**chosen).rows[:1]) for chosen in BEDS[study]] if runs else []
    folders = [(chosen, results / study / "runs" / row["run"]) for chosen, found in rows for row in found]
    if not folders or not all((folder / "profiles.h5").exists() for _, folder in folders):
        return None
    columns = 2 if len(folders) > 3 else len(folders)
    lines = -(-len(folders) // columns)
    drawn, panels = new_figure(lines, columns, size=(5.6 * columns, 2.7 * lines))
    for panel, (chosen, folder) in zip(panels.flat, folders):
        profiles = read_profiles(folder)
        bed = np.ma.masked_less(profiles.solids_fraction, INSIDE)
        low, high = np.percentile(bed.compressed(), [2.0, 99.5])
        panel.grid(False)
        panel.pcolormesh(profiles.time, profiles.height, bed.T, cmap=colormaps["cividis"].with_extremes(bad="white"),
                         vmin=low, vmax=high, shading="nearest", rasterized=True)  # fmt: skip
        panel.set_ylim(0.0, top(profiles))
        panel.set_title(", ".join(named(*pair) for pair in chosen.items()), fontsize=9)
    for panel in panels[-1]:
        panel.set_xlabel(f"time [{profiles.units['time']}]")
    for panel in panels[:, 0]:
        panel.set_ylabel(f"height [{profiles.units['height']}]")
    return drawn


def top(profiles: Profiles) -> float:
    """A height with a little room above the bed."""
    highest = np.flatnonzero((profiles.solids_fraction > INSIDE).any(axis=0))
    return float(1.03 * profiles.height[highest[-1]]) if len(highest) else float(profiles.height[-1])


def named(key: str, value: float | str) -> str:
    """A value with its symbol."""
    shown = value if isinstance(value, str) else f"{value:g}"
    return f"{SYMBOLS.get(key, key.replace('_', ' '))} {shown}"


def keep(results: Path, folder: Path) -> None:
    """Stores the pictures of all studies whose runs are here."""
    for study in BEDS:
        drawn = figure(results, study)
        if drawn is not None:
            save(drawn, folder / f"{study}.png")


def save(drawn: Figure, file: Path) -> None:
    """Stores a picture."""
    drawn.savefig(file, dpi=75)
    print(f"figure: {file}")
