"""Critical Bond numbers of Moon, Kevrekidis & Sundaresan (2006): Figs 2, 4 and 5."""

from __future__ import annotations

from pathlib import Path

from paper_report.page import Section, Statement
from paper_report.tables import over
from study_tables import Estimate, StudyTable
from talcum_results import BLUE, GREY, Array, new_figure

import numpy as np
from matplotlib.figure import Figure

from .pictures import beds
from .tables import parts, source, table

CRITERION = (
    "The paper calls Bo_c the largest Bond number at which the bed can be fluidised, with waves that travel. Here it is the Bond number at which waves "
)
RESTING = CRITERION + "fill half of the bed's heights and times from 75 to 150 time units after cohesion was switched on, located by bisection, seed by seed."
VIBRATED = CRITERION + "sweep half of the bed's material from 25 to 100 time units after cohesion and vibration were switched on, located by bisection, seed by seed."


def critical(points: StudyTable, row: dict[str, str]) -> Estimate:
    """The critical value of a point; its interval holds the width of the last brackets."""
    mean, lower, upper = (float(row[name] or "nan") for name in ("critical", "lower", "upper"))
    return Estimate(mean, lower, upper, int(points.cell(row, "found")))


def without_vibration(results: Path) -> Section | None:
    """Bo_c of the bed that is not vibrated, by both readings of the friction's cap."""
    points = table(results, "bond-critical", "points")
    if points is None:
        return None
    statements = []
    for row in points.rows:
        found = critical(points, row)
        agrees = found.overlaps(6.0, 7.0) if found.runs else None
        paper = "intermittent waves at 6, none above 7: agrees if the interval overlaps 6 to 7"
        statements.append(Statement(f"Bo_c (friction cap: {row['friction_cap']})", paper, str(found), agrees))
    return Section("Fig. 2: the critical Bond number", RESTING, statements, [], [source("bond-critical", points)])


def long_times(results: Path) -> Section | None:
    """The waves long after cohesion was switched on."""
    points = table(results, "fig2-long", "points")
    if points is None or not points.rows:
        return None
    statements = [Statement("parts of heights and times by the Bond number", "intermittent waves at 6, one plug above 7", parts(points, "bond_number"), None)]
    for row in points.rows:
        share, still, front = (points.estimate(row, name) for name in ("share", "frozen_share", "front_speed"))
        told = f"{share}; still {still.mean:.2g}; front {front}"
        statements.append(Statement(f"Bo {float(row['bond_number']):g}: part with waves, and the front's speed", "not shown", told, None))
    quantities = {"share": "part with waves", "frozen_share": "part that stands still", "front_speed": "speed of the front [sqrt(g d)]"}
    figures = [(over(points, "bond_number", quantities, [("400 to 500", points)]), "Over the Bond number; means and intervals over seeds.")]
    figures[0][0].axes[-1].autoscale(axis="y")  # its speeds are negative
    figures += beds(results, "fig2-long")
    text = (
        "The beds of Fig. 2 for 500 time units: the bed freezes from the top, by a front that goes down (its speed is negative). What "
        "the bed does is measured in the last 100 time units, the front in all of them."
    )
    return Section("Beyond the paper: the front that freezes the bed", text, statements, figures, [source("fig2-long", points)])


def line(x: Array, y: Array) -> tuple[float, float, float]:
    """Slope and intercept of the least-squares line, and R^2."""
    slope, intercept = np.polyfit(x, y, 1)
    rest, spread = np.sum((y - slope * x - intercept) ** 2), np.sum((y - y.mean()) ** 2)
    return float(slope), float(intercept), float(1.0 - rest / spread)


def drawn(axis: str, x: Array, found: list[Estimate], fit: tuple[float, float] | None) -> Figure:
    """Bo_c with its interval over a key, and a straight line."""
    figure, panels = new_figure(size=(6.4, 4.2))
    panel = panels[0, 0]
    mean = np.array([e.mean for e in found])
    error = np.array([[e.mean - e.lower, e.upper - e.mean] for e in found]).T
    panel.errorbar(x, mean, yerr=np.nan_to_num(error), fmt="o", color=BLUE, capsize=3)
    if fit is not None:
        panel.plot(x, fit[0] * x + fit[1], "-", color=GREY)
    panel.set_xlabel(axis)
    panel.set_ylabel("critical Bond number")
    panel.set_ylim(bottom=0.0)
    return figure


def over_gamma(results: Path) -> Section | None:
    """Bo_c over the intensity of the vibration."""
    points = table(results, "fig4", "points")
    if points is None:
        return None
    rows = [row for row in points.rows if row["critical"]]
    x, found = np.array([float(row["gamma"]) for row in rows]), [critical(points, row) for row in rows]
    text = "; ".join(f"Gamma {gamma:g}: {estimate}" for gamma, estimate in zip(x, found))
    statements = [Statement("Bo_c over Gamma at f 0.16", "grows almost linearly", text, None)]
    fit = None
    if len(rows) >= 3:
        slope, intercept, explained = line(x, np.array([e.mean for e in found]))
        fit = (slope, intercept)
        told = f"slope {slope:.3g}, intercept {intercept:.3g}, R^2 {explained:.3f}"
        statements.append(Statement("straight line", "almost linear: agrees if R^2 is above 0.95", told, explained > 0.95))
    figures = [(drawn("Gamma", x, found, fit), "Means and intervals over seeds; least-squares line.")]
    return Section("Fig. 4: the critical Bond number over Gamma", VIBRATED, statements, figures, [source("fig4", points)])


def over_frequency(results: Path) -> Section | None:
    """Bo_c over the frequency of the vibration."""
    points, usual = table(results, "fig5", "points"), table(results, "fig4", "points")
    if points is None:
        return None
    known = [(float(row["frequency"]), critical(points, row)) for row in points.rows if row["critical"]]
    at_three = usual.where(gamma=3.0).rows if usual else []
    known += [(0.16, critical(usual, row)) for row in at_three if usual and row["critical"]]
    known.sort(key=lambda pair: pair[0])
    x, found = np.array([frequency for frequency, _ in known]), [estimate for _, estimate in known]
    text = "; ".join(f"f {frequency:g}: {estimate}" for frequency, estimate in known)
    overlap = max(e.lower for e in found) <= min(e.upper for e in found) if len(found) > 1 else None
    statements = [Statement("Bo_c over f at Gamma 3", "virtually independent of f: agrees if all intervals overlap", text, overlap)]
    figures = [(drawn("frequency [sqrt(g/d)]", x, found, None), "Means and intervals over seeds; f 0.16 is that of Fig. 4.")]
    return Section("Fig. 5: the critical Bond number over the frequency", VIBRATED, statements, figures, [source("fig5", points)])
