"""Beyond the figures of Liu et al. (2016): what the paper leaves open, the companion paper's tests, drag from the agglomerates themselves."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from liu2016_curves import GRAVITY, PARTICLE, case_name
from liu2016_tables import SHOWN, brief, panels, table
from paper_tables import made_by
from report import Section, Statement
from study_tables import StudyTable
from talcum_results import BLUE, ORANGE

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

LAGS = {"10ms": 0.01, "30ms": 0.03, "50ms": 0.05}
"""Lags at which the studies count agglomerates [s], by the end of their columns."""
LONG_LAGS = LAGS | {"100ms": 0.1, "300ms": 0.3}
"""Those of the study of agglomerates that last."""
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
"""What `lasting-agglomerates` varies, by the value that differs from the case."""
PAPER = "C_N of the bed 2 to 3, in agglomerates 3; packing 0.2 to 0.3, D_f 1.9 to 2.3; agglomerates outlive 0.1 s"


def lifetimes(points: StudyTable, row: dict[str, str], lags: dict[str, float] = LAGS) -> list[float]:
    """Number of agglomerates at each lag."""
    return [points.estimate(row, f"agglomerates_{end}").mean for end in lags]


def in_words(points: StudyTable, row: dict[str, str], lags: dict[str, float] = LAGS) -> str:
    """Lifetimes and properties of a bed."""
    left = ", ".join(f"{value:.0f}" for value in lifetimes(points, row, lags))
    names = {"coordination_number": "C_N of the bed", "coordination_in_agglomerates": "in agglomerates", "packing_fraction": "packing",
             "fractal_dimension": "D_f"}  # fmt: skip
    rest = "; ".join(f"{words} {points.estimate(row, name).mean:.3g}" for name, words in names.items())
    return f"N_agg {left} after {', '.join(f'{1e3 * lag:.0f}' for lag in lags.values())} ms; {rest}"


def depth(results: Path) -> Section | None:
    """How deep the bed is."""
    points = table(results, "depth")
    if points is None:
        return None
    paper = "2 to 3 for the whole bed; agglomerates outlive 0.1 s"
    statements = [Statement(f"{row['count']} particles", paper, in_words(points, row), None) for row in points.rows]
    text = "The paper does not tell its number of particles. Beds 1.1 and 4.4 mm deep at rest, in a box of the paper's height; t_0 = 0.3 s."
    return Section("The number of particles", text, statements, [drawn(points, [f"{row['count']}" for row in points.rows])],
                   [made_by("liu2016", "depth", points)])  # fmt: skip


def readings(results: Path) -> Section | None:
    """Readings of what the paper leaves open."""
    points = table(results, "readings")
    if points is None:
        return None
    names = [READINGS[int(row["point"]) - 1] for row in points.rows]
    statements = [Statement(name, "", in_words(points, row), None) for name, row in zip(names, points.rows)]
    text = (
        "rho250vdw20ug4 in the small box, one change at a time, from the same developed bed; t_0 is 0.1 s after the change. Lifetimes in the paper are "
        "ten times as long."
    )
    return Section("Readings of what the paper leaves open", text, statements, [drawn(points, names)], [made_by("liu2016", "readings", points)])


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
    shown[0].legend(fontsize=7)
    text = (
        "The adhesion of a contact is limited by (delta / d_NP + 1) F0. With d_NP = 1 nm and the plastic overlap as delta (the same as 5 nm and the largest "
        "overlap) the limit is hardly reached; with a plasticity index of 0.5, the largest that the paper names, impacts lose more; "
        "cells of six diameters along x and z do not show the gas between single agglomerates. t_0 = 0.3 s."
    )
    return Section("Readings by which agglomerates last longer", text, statements, [(figure, "Agglomerates of t_0 that are left.")],
                   [made_by("liu2016", "lasting-agglomerates", points)])  # fmt: skip


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


def heap(results: Path) -> Section | None:
    """Angle of repose over the Bond number."""
    points = table(results, "heap")
    if points is None:
        return None
    found = points.estimates("repose.angle")
    told = "; ".join(f"Bo {float(row['bond_number']):g}: {brief(angle)}" for row, angle in zip(points.rows, found))
    rising = [angle.mean for angle in found if math.isfinite(angle.mean)]
    statements = [Statement("angle of repose [degrees]", "grows with cohesion", told, all(np.diff(rising) > 0.0))]
    figure, (panel,) = panels(1)
    panel.errorbar(points.numbers("bond_number"), [angle.mean for angle in found],
                   yerr=[angle.upper - angle.mean for angle in found], fmt="o-", color=BLUE, capsize=3)  # fmt: skip
    panel.set_xlabel("Bond number")
    panel.set_ylabel("angle of repose [degrees]")
    text = "A block of 5,400 particles slumps on a plate with open ends. The companion paper's numbers could not be had; that the angle grows is its finding."
    return Section("Companion paper: angle of repose", text, statements, [(figure, "Means and intervals over seeds.")],
                   [made_by("liu2016", "heap", points)])  # fmt: skip


def fluidisation(results: Path) -> Section | None:
    """Beds over the Bond number: which of them fluidise."""
    points = table(results, "fluidisation")
    if points is None:
        return None
    weight = 250.0 * math.pi / 6.0 * PARTICLE**3 * GRAVITY
    statements = []
    figure, (left, right) = panels(2)
    for velocity, colour in ((0.02, BLUE), (0.04, ORANGE)):
        rows = points.where(inlet_velocity=velocity)
        bond = [adhesion / weight for adhesion in rows.numbers("adhesion")]
        for panel, name, label in ((left, "agitation", "energy of fluctuations [J]"), (right, "coordination_number", "C_N")):
            panel.plot(bond, [found.mean for found in rows.estimates(name)], "o-", color=colour, label=f"{100.0 * velocity:.0f} cm/s")
            panel.set_xlabel("Bond number")
            panel.set_ylabel(label)
        for number, row in zip(bond, rows.rows):
            told = "; ".join(f"{words} {rows.estimate(row, name).mean:.3g}" for name, words in (
                ("agitation", "energy of fluctuations [J]"), ("pressure_deviation", "deviation of the pressure drop"), ("centre_height", "centre [m]"),
                ("coordination_number", "C_N")))  # fmt: skip
            paper = "fluidised" if number < 30.0 else "a fixed bed in the end"
            statements.append(Statement(f"Bo {number:.0f}, {100.0 * velocity:.0f} cm/s", paper, told, None))
    left.legend(fontsize=8)
    text = "From 0.4 to 0.6 s. Gas velocity and drag factor of the companion paper's runs are not told in what was at hand: two velocities, one factor."
    return Section("Companion paper: fluidisation over the Bond number", text, statements, [(figure, "One bed each.")],
                   [made_by("liu2016", "fluidisation", points)])  # fmt: skip


SECTIONS = (depth, readings, lasting, heap, fluidisation)
