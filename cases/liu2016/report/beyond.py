"""Beyond the figures of Liu et al. (2016): choices that the paper leaves open, and readings of it in which agglomerates last longer."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from paper_report.page import Section, Statement
from paper_report.tables import made_by
from study_tables import StudyTable

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from .breakage import of_lag
from .curves import case_name
from .pictures import REFERENCE
from .tables import SHOWN, panels, read, sources, table

LAGS = {"10ms": 0.01, "30ms": 0.03, "50ms": 0.05}
"""Lags at which the studies count agglomerates [s], by the end of their columns."""
LONG_LAGS = LAGS | {"100ms": 0.1, "300ms": 0.3}
"""Lags of the study of lasting agglomerates."""
READINGS = (
    "as it stands", "drag exponent 1.65", "drag factor 0.15", "primary particles of 5 nm", "primary particles of 1 nm", "friction 0.7", "tangential spring 1.6 N/m",
    "restitution 0.3", "plasticity index 0.5", "friction limited by the net force", "reloading along the limit of adhesion", "smooth walls",
    "a fifth of the gas step", "cells of six diameters along x and z", "no friction of the gas at walls", "contacts that touch at each millisecond",
    "primary particles of 2 nm", "plasticity index 0.35",
)  # fmt: skip
"""The rows of readings.toml."""
LASTING: dict[str, dict[str, float | str]] = {
    "d_NP = 1 nm": {"primary_diameter": 1.0e-9}, "plasticity index 0.5": {"loading_stiffness": 1.0},
    "cells of six diameters": {"cells": "[8, 3, 40]"},
}  # fmt: skip
"""The changes of `lasting-agglomerates`, by the value that differs from the case."""
PAPER = "C_N of the bed 2 to 3, in agglomerates 3; packing 0.2 to 0.3, D_f 1.9 to 2.3; agglomerates outlive 0.1 s"


def lifetimes(points: StudyTable, row: dict[str, str], lags: dict[str, float] = LAGS) -> list[float]:
    """Number of agglomerates at each lag."""
    return [points.estimate(row, f"agglomerates_{end}").mean for end in lags]


def in_words(points: StudyTable, row: dict[str, str], lags: dict[str, float] = LAGS) -> str:
    """Lifetimes and properties of a bed."""
    names = {"coordination_number": "C_N of the bed", "coordination_in_agglomerates": "in agglomerates", "packing_fraction": "packing",
             "fractal_dimension": "D_f"}  # fmt: skip
    rest = "; ".join(f"{words} {points.estimate(row, name).mean:.3g}" for name, words in names.items())
    return f"{told_lifetimes(lifetimes(points, row, lags), lags)}; {rest}"


def told_lifetimes(left: list[float], lags: dict[str, float]) -> str:
    """Numbers of agglomerates at lags."""
    return f"N_agg {', '.join(f'{value:.3g}' for value in left)} after {', '.join(f'{1e3 * lag:.0f}' for lag in lags.values())} ms"


def depth(results: Path) -> Section | None:
    """How deep the bed is."""
    points = table(results, "depth")
    if points is None:
        return None
    paper = "2 to 3 for the whole bed; agglomerates outlive 0.1 s"
    statements = [Statement(f"{row['count']} particles", paper, in_words(points, row), None) for row in points.rows]
    text = ("The paper does not give its number of particles. Beds 1.05 and 4.2 mm deep at a packing of 0.5, in a box of the paper's height; t_0 = 0.3 s; "
            "C_N of the bed is the mean from 0.2 s on.")  # fmt: skip
    return Section("The number of particles", text, statements, [drawn(points, [f"{row['count']}" for row in points.rows])],
                   [made_by("liu2016", "depth", points)])  # fmt: skip


def readings(results: Path) -> Section | None:
    """Choices that the paper leaves open."""
    points = table(results, "readings")
    if points is None:
        return None
    names = [READINGS[int(row["point"]) - 1] for row in points.rows]
    statements = [Statement(name, "", in_words(points, row), None) for name, row in zip(names, points.rows)]
    text = (
        "rho250vdw20ug4 in the small box, one change at a time, from the same developed bed; t_0 is 0.1 s after the change. Lifetimes in the paper are "
        "ten times as long."
    )
    return Section("Choices that the paper leaves open", text, statements, [drawn(points, names)], [made_by("liu2016", "readings", points)])


def lasting(results: Path) -> Section | None:
    """Cases of Fig. 3 by readings in which agglomerates last longer."""
    points = table(results, "lasting-agglomerates")
    if points is None:
        return None
    statements = []
    groups = {words: found.rows for words, differs in LASTING.items() if (found := points.where(**differs)).rows}
    figure, shown = panels(len(groups))
    for panel, (words, rows) in zip(shown, groups.items()):
        for row in rows:
            case = case_name(*(float(row[key]) for key in ("density", "adhesion", "inlet_velocity")))
            statements.append(Statement(f"{case}, {words}", PAPER, in_words(points, row, LONG_LAGS), None))
            draw_lifetimes(panel, lifetimes(points, row, LONG_LAGS), LONG_LAGS, marker="o", color=SHOWN[case], label=case)
        panel.set_title(words)
    cases = [case for case in SHOWN if any(statement.quantity.startswith(case) for statement in statements)]
    for case, left in as_it_stands(results, cases).items():
        statements.append(Statement(f"{case}, as it stands", PAPER, told_lifetimes(left, LONG_LAGS), None))
        for panel in shown:
            draw_lifetimes(panel, left, LONG_LAGS, linestyle="--", linewidth=1.0, color=SHOWN[case], label=f"{case}, as it stands")
    shown[0].legend(fontsize=6)
    text = (
        "The adhesion of a contact is limited by (delta / d_NP + 1) F0. With d_NP = 1 nm and the plastic overlap as delta (the same as 5 nm and the largest "
        "overlap) the limit is hardly reached; with a plasticity index of 0.5, the largest that the paper names, impacts lose more; "
        "cells of six diameters along x and z do not show the gas between single agglomerates. t_0 = 0.3 s; the cases as they stand: the same t_0, "
        "means over two seeds."
    )
    caption = "Agglomerates of t_0 that are left; broken: the cases as they stand."
    return Section("Readings by which agglomerates last longer", text, statements, [(figure, caption)],
                   [made_by("liu2016", "lasting-agglomerates", points), *sources(results, ("fig3-cases",))])  # fmt: skip


def as_it_stands(results: Path, cases: list[str]) -> dict[str, list[float]]:
    """Number of agglomerates of the first t_0 at each lag, without another reading: means over the seeds."""
    found = read(results, "agglomerates")
    if found is None:
        return {}
    rows = {case: found.where(case=case, reference_time=REFERENCE) for case in cases}
    return {case: [float(np.mean(of_lag(known, lag))) for lag in LONG_LAGS.values()] for case, known in rows.items()
            if all(of_lag(known, lag) for lag in LONG_LAGS.values())}  # fmt: skip


def draw_lifetimes(panel: Axes, left: list[float], lags: dict[str, float], **style: Any) -> None:
    """Numbers of agglomerates over the lag, on a logarithmic axis on which none stand at 0.5."""
    panel.plot([1e3 * lag for lag in lags.values()], np.maximum(left, 0.5), **style)
    panel.set_yscale("log")
    panel.set_xlabel("lag since t_0 [ms]")
    panel.set_ylabel("N_agg (0.5: none)")


def drawn(points: StudyTable, names: list[str]) -> tuple[Figure, str]:
    """Numbers of agglomerates over the lag."""
    figure, (panel,) = panels(1, 5.0)
    colours = colormaps["viridis"](np.linspace(0.0, 0.9, len(names)))
    for number, (row, name) in enumerate(zip(points.rows, names)):
        style = {"marker": "os^v"[number % 4], "color": colours[number], "label": name, "linewidth": 1.0}
        draw_lifetimes(panel, lifetimes(points, row), LAGS, **style)
    panel.legend(fontsize=6)
    return figure, "Agglomerates of t_0 that are left."


SECTIONS = (depth, readings, lasting)
