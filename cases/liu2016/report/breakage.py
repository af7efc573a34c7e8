"""Agglomerates of Liu et al. (2016): Figs 7 to 10, how they break up, and what they are like."""

from __future__ import annotations

import math
from functools import partial
from pathlib import Path

from paper_report.page import Section, Statement
from paper_report.tables import interval_of
from study_tables import StudyTable

import numpy as np
from matplotlib.figure import Figure

from . import pictures
from .curves import BREAKAGE, FOLLOWED
from .pictures import REFERENCE
from .tables import CASES, SHOWN, Values, bars, by_case, column, curves, panels, reaches, read, sources, told, trends

PROPERTIES = {
    "diameter": ("d_agg [mm]", 1.0e3),
    "coordination_number": ("C_N", 1.0),
    "packing_fraction": ("packing fraction", 1.0),
    "fractal_dimension": ("D_f", 1.0),
}
"""The quantities of Figs 9 and 10: label, factor."""
TOLD_LAGS = (0.01, 0.03, 0.05)
"""Lags at which what is left of agglomerates is described [s]."""


def identification(results: Path) -> Section | None:
    """Figs 1 and 7: agglomerates of one t_0, in the bed, singly, and tagged."""
    captions = {
        "lags": f"Fig. 1: {FOLLOWED}, what is left of the agglomerates of t_0 = 0.3 s after some lags; grey: in none.",
        "cases": "The same of four cases at the lag 0.01 s. Particles behind are darker.",
        "singly": "Agglomerates at the lag 0.01 s, taken out: the largest of each case, and those nearest to 200, 60 and 20 members; the bars are 0.2 mm long.",
        "tagged": "Fig. 7: particles that were in the largest agglomerate at 0.31 s, later on, and a fifth of the others.",
    }  # fmt: skip
    figures = [(figure, caption) for name, caption in captions.items() if (figure := pictures.pictured(results, name))]
    if not figures:
        return None
    text = "Colours tell agglomerates apart and mean nothing else."
    return Section("Figs 1 and 7: agglomerates in the bed", text, [], figures, sources(results))


def breakage(results: Path) -> Section | None:
    """Fig. 8: number and diameter of agglomerates over the lag, and critical times."""
    found, times = read(results, "agglomerates"), read(results, "critical")
    if found is None:
        return None
    kept = {lag: by_case(found, partial(share_kept, lag=lag)) for lag in (0.05, 0.1)}
    slowest = max(SHOWN, key=lambda case: kept[0.05][case].mean if case in kept[0.05] else -math.inf)
    # Lifetimes depend on t_0, and some cases have the first alone; after 0.05 s none of it are left in three cases.
    first = by_case(found.where(reference_time=REFERENCE), partial(share_kept, lag=0.03))
    statements = [
        Statement("agglomerates left after 0.05 s, of those after 0.01 s", "most: ug2 is intact after 1.5 s", told(kept[0.05]),
                  min(value.mean for value in kept[0.05].values()) > 0.5),
        Statement("the same after 0.1 s", "", told(kept[0.1]), None),
        Statement("left after 0.05 s by t_0", "one t_0, of 1 s", told_by_window(found, 0.05), None),
        Statement("slowest breakage of the cases of Fig. 3", "rho250vdw20ug2", slowest, slowest == "rho250vdw20ug2"),
    ]  # fmt: skip
    if times is not None:
        papers = {"most": "a little above 0 for heavy particles", "few": "slowest for rho250vdw20ug2", "steady": "slowest for rho250vdw20ug2"}
        names = {"most": "tau_Nmax", "few": "tau_N15", "steady": "tau_ds"}
        statements += [Statement(f"{names[name]} [ms]", paper, told(by_case(times, column(name)), 1.0e3), None) for name, paper in papers.items()]
    rises = {"density": True, "gas velocity": False, "Bond number": True}
    statements += trends(f"left after 0.03 s of t_0 = {REFERENCE:g} s", first, rises)
    figure, (left, right) = panels(2)
    curves(left, found, "lag", "agglomerates", "N_agg", reference_time=REFERENCE)
    curves(right, found, "lag", "diameter", "d_agg [mm], weighted by mass", 1.0e3, reference_time=REFERENCE)
    left.set_yscale("log")
    text = (
        "Agglomerates are connected sets, of 15 particles or more, of the contacts of t_0 that touch at t_0 + lag (sampled every 10 ms, from t_0 = 0.3 s on; the paper's t_0 is 1 s). "
        "Critical times come from runs sampled every 2 ms, from 0.3 and 0.4 s on. Agglomerates of t_0 = 0.3 s last for a shorter time than those of "
        "0.6 and 0.9 s."
    )
    made = [*sources(results), *sources(results, BREAKAGE)]
    return Section("Fig. 8: breakage", text, statements, [(figure, "First window of the first seed.")], made)


def share_kept(rows: StudyTable, lag: float) -> list[float]:
    """The agglomerates at a lag over those at the first lag, for each run and window."""
    at: dict[tuple[str, str], dict[float, float]] = {}
    for row in rows.rows:
        key = (row["seed"], row["reference_time"])
        at.setdefault(key, {})[round(float(row["lag"]), 6)] = float(row["agglomerates"])
    return [numbers[lag] / numbers[min(numbers)] for numbers in at.values() if lag in numbers and numbers[min(numbers)] > 0.0]


def told_by_window(found: StudyTable, lag: float) -> str:
    """The parts left at a lag, as means over the seeds, by t_0, for each case that has several windows."""
    told_cases = []
    for case in CASES:
        rows = found.where(case=case)
        starts = sorted(set(rows.numbers("reference_time")))
        parts = [interval_of(share_kept(rows.where(reference_time=start), lag)) for start in starts]
        if len(starts) > 1 and any(part.mean > 0.0 for part in parts):
            told_cases.append(f"{case}: {', '.join(f'{part.mean:.2g} ({start:g} s)' for start, part in zip(starts, parts) if part.runs)}")
    return "; ".join(told_cases) or "none"


def of_lag(rows: StudyTable, lag: float) -> list[float]:
    """Numbers of agglomerates at a lag, of each run and window."""
    return [float(row["agglomerates"]) for row in rows.rows if abs(float(row["lag"]) - lag) < 1.0e-6]


def lag_table(found: StudyTable) -> list[list[str]]:
    """The agglomerates that are left at some lags, in the windows that have some; the first row is the head."""
    names = ("coordination_number", "packing_fraction", "fractal_dimension")
    rows = []
    for case in CASES:
        at = {lag: [row for row in found.where(case=case).rows if abs(float(row["lag"]) - lag) < 1.0e-6] for lag in TOLD_LAGS}
        cells = [mean_of(at[lag], name) for name in names for lag in TOLD_LAGS]
        if any(cells):
            rows.append([case, *cells])
    labels = [PROPERTIES[name][0].replace(" fraction", "") for name in names]
    return [["", *(f"{label}, {1e3 * lag:.0f} ms" for label in labels for lag in TOLD_LAGS)], *rows]


def mean_of(rows: list[dict[str, str]], name: str) -> str:
    """Mean of a column over rows, without those that have none."""
    found = interval_of(float(row[name]) for row in rows)
    return "" if found.runs == 0 else f"{found.mean:.2f}"


def properties(results: Path) -> Section | None:
    """Figs 9 and 10: what agglomerates are like."""
    found, single, rates = (read(results, name) for name in ("agglomerates", "singles", "rates"))
    if found is None:
        return None
    means = {name: by_case(found, partial(of_first_lag, name=name)) for name in PROPERTIES}
    expected = {"diameter": ("falls to about 0.2 mm", (1.5e-4, 3.0e-4)), "coordination_number": ("about 3", (2.5, 3.5)),
                "packing_fraction": ("0.2 to 0.3", (0.2, 0.3)), "fractal_dimension": ("1.9 to 2.3", (1.9, 2.3))}  # fmt: skip
    statements = []
    for name, (paper, (low, high)) in expected.items():
        inside = all(reaches(value, low, high) for value in means[name].values())
        label, factor = PROPERTIES[name]
        statements.append(Statement(f"{label} at a lag of 0.01 s", paper, told(means[name], factor), inside))
    crossing = crossings(rates)
    if crossing:
        statements.append(Statement("members at which loss and gain are equal", "not shown", told(crossing), None))
    figure, shown = panels(4, 3.6)
    for panel, (name, (label, factor)) in zip(shown, PROPERTIES.items()):
        bars(panel, means[name], label, factor)
    figures = [(figure, "Fig. 9: means weighted by mass, at the lag 0.01 s of each window; intervals over windows and seeds.")]
    if single is not None and single.rows:
        figures.append((distributions(single), f"Fig. 10: single agglomerates of {FOLLOWED} at the lag 0.01 s."))
    if rates is not None:
        figures.append((draw_rates(rates), "Members that an agglomerate loses and gains in a unit of time, by its size, over windows of 10 ms."))
    text = (
        "The paper shows its values at the critical times; where few agglomerates outlive 50 ms, as here, these times say little, and all values are those of the lag 0.01 s. "
        "A range is reached if the interval of every case has a part in it. The table: the same at later lags, means over the windows in which agglomerates "
        "are left."
    )
    return Section("Figs 9 and 10: properties of agglomerates", text, statements, figures, sources(results), lag_table(found))


def of_first_lag(rows: StudyTable, name: str) -> list[float]:
    """A column at the first lag of each run and window."""
    first = min(rows.numbers("lag"))
    return [float(row[name]) for row in rows.rows if float(row["lag"]) <= first * (1.0 + 1e-6)]


def crossings(rates: StudyTable | None) -> Values:
    """The size at which agglomerates lose as many members as they gain."""
    if rates is None:
        return {}
    return by_case(rates, lambda rows: {row["seed"]: float(row["crossing"] or math.nan) for row in rows.rows}.values())


def distributions(single: StudyTable) -> Figure:
    """Histograms of the properties of single agglomerates."""
    figure, shown = panels(4, 3.4)
    for panel, (name, (label, factor)) in zip(shown, PROPERTIES.items()):
        values = factor * np.array(single.numbers(name))
        panel.hist(values[np.isfinite(values)], bins=24, density=True, color=SHOWN[FOLLOWED])
        panel.set_xlabel(label)
    shown[0].set_ylabel("density")
    return figure


def draw_rates(rates: StudyTable) -> Figure:
    """Loss and gain of members over size."""
    figure, shown = panels(2)
    for panel, name in zip(shown, ("lost", "gained")):
        for case, colour in SHOWN.items():
            rows = rates.where(case=case, seed="1")
            if rows.rows:
                panel.errorbar(rows.numbers("from_members"), rows.numbers(name), yerr=rows.numbers(f"{name}_error"), fmt="o-",
                               color=colour, label=case, capsize=2)  # fmt: skip
        panel.set_xscale("log")
        panel.set_yscale("log")
        sizes = sorted(set(rates.numbers("from_members")))
        panel.set_xticks(sizes, [f"{size:.0f}" for size in sizes])
        panel.set_xticks([], minor=True)
        panel.set_xlabel("members, from")
        panel.set_ylabel(f"members {name} [1/s]")
    shown[0].legend(fontsize=8)
    return figure


SECTIONS = (identification, breakage, properties)
