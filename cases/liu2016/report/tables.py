"""Tables of the studies of Liu et al. (2016), case by case: means with intervals, trends over density, gas velocity and Bond number."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from paper_report.page import Statement
from paper_report.tables import interval_of, made_by, study_table
from study_tables import Estimate, StudyTable, shortly
from talcum_results import BLUE, GREEN, GREY, ORANGE, RED, Array, new_figure

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from . import curves as curve_tables
from .curves import KEPT, STUDIES, WHOLE_BOX, WHOLE_PREFIX, case_name

CASES = (
    "rho137vdw20ug2", "rho137vdw20ug3", "rho137vdw20ug4", "rho250vdw20ug2",
    "rho250vdw20ug3", "rho250vdw20ug4", "rho250vdw10ug4", "rho250vdw5ug4",
)  # fmt: skip
"""Table 2 of the paper."""
SHOWN = {"rho137vdw20ug2": BLUE, "rho250vdw20ug2": ORANGE, "rho250vdw20ug4": RED, "rho250vdw5ug4": GREEN}
"""The cases of which the paper shows most, and their colours."""
FACTORS = {
    "density": (("rho137vdw20ug2", "rho250vdw20ug2"), ("rho137vdw20ug3", "rho250vdw20ug3"), ("rho137vdw20ug4", "rho250vdw20ug4")),
    "gas velocity": (("rho137vdw20ug2", "rho137vdw20ug3", "rho137vdw20ug4"), ("rho250vdw20ug2", "rho250vdw20ug3", "rho250vdw20ug4")),
    "Bond number": (("rho250vdw5ug4", "rho250vdw10ug4", "rho250vdw20ug4"),),
}
"""Series of cases in which one variable grows."""

Values = dict[str, Estimate]
"""A quantity by the name of the case."""


@dataclass(frozen=True)
class Beds:
    """Beds in one box: their studies, how the names of their tables of curves begin, their particles, and the cells of the gas."""

    studies: tuple[str, ...]
    prefix: str
    particles: int
    cells: str


SMALL = Beds(STUDIES, "", 12500, "[16, 3, 80]")
WHOLE = Beds(WHOLE_BOX, WHOLE_PREFIX, 100000, "[32, 6, 160]")


def table(results: Path, name: str, kind: str = "points") -> StudyTable | None:
    """A table of a study, of the runs made here or the one that is kept."""
    return study_table(results, KEPT, name, kind)


def study(results: Path, quantity: str, beds: Beds = SMALL) -> Values:
    """A quantity of the studies of the paper's cases."""
    found = {}
    for name in beds.studies:
        points = table(results, name)
        if points is None:
            continue
        for row in points.rows:
            case = case_name(*(float(row[key]) for key in ("density", "adhesion", "inlet_velocity")))
            found[case] = points.estimate(row, quantity)
    return {case: found[case] for case in CASES if case in found}


def by_case(curves: StudyTable, of: Callable[[StudyTable], Iterable[float]]) -> Values:
    """A quantity of the rows of each case; `of` gives its independent values."""
    cases = set(curves.texts("case"))
    return {case: interval_of(of(curves.where(case=case))) for case in CASES if case in cases}


def column(name: str) -> Callable[[StudyTable], list[float]]:
    """The values of a column."""
    return lambda rows: rows.numbers(name)


def told(values: Values, factor: float = 1.0) -> str:
    """All cases, one after the other, times a factor for the unit."""
    return "; ".join(f"{case}: {brief(found, factor)}" for case, found in values.items()) or "none"


def reaches(found: Estimate, low: float, high: float) -> bool:
    """Whether an interval, or a single value, reaches into a range."""
    return low <= found.mean <= high if math.isnan(found.lower) else found.overlaps(low, high)


def brief(found: Estimate, factor: float = 1.0) -> str:
    """A mean with its interval, where there is one."""
    if found.runs == 0:
        return "none"
    mean, lower, upper = (shortly(factor * value) for value in (found.mean, found.lower, found.upper))
    return mean if math.isnan(found.lower) else f"{mean} ({lower} to {upper})"


def cell(found: Estimate | None, factor: float = 1.0) -> str:
    """A mean with half of its interval, where there is one."""
    if found is None or found.runs == 0 or math.isnan(found.mean):
        return ""
    half = factor * (found.upper - found.mean)
    mean = shortly(factor * found.mean)
    return mean if math.isnan(half) else f"{mean} ± {half:.2g}"


def trends(quantity: str, values: Values, rises: dict[str, bool], scale: float = 1.0) -> list[Statement]:
    """For each variable that grows: the paper's statement on the quantity, the result (times a factor for the unit), and whether
    all its series agree."""
    statements = []
    for factor, grows in rises.items():
        known = [[scale * values[case].mean for case in cases if case in values] for cases in FACTORS[factor]]
        known = [series for series in known if len(series) > 1]
        steps = [after - before for series in known for before, after in zip(series, series[1:])]
        agrees = all((step > 0.0) == grows for step in steps) if steps else None
        found = "; ".join(" to ".join(f"{value:.3g}" for value in series) for series in known)
        paper = "rises" if grows else "falls"
        statements.append(Statement(f"{quantity} over the {factor}", paper, found or "none", agrees))
    return statements


def curves(panel: Axes, found: StudyTable, along: str, name: str, label: str, scale: float = 1.0, **chosen: float) -> None:
    """A column over another one, of the first seed of each case that is shown."""
    for case, colour in SHOWN.items():
        rows = found.where(case=case, seed="1", **chosen)
        if rows.rows:
            panel.plot(rows.numbers(along), scale * np.array(rows.numbers(name)), color=colour, label=case, linewidth=1.0)
    if panel.lines:
        panel.legend(fontsize=8)
    panel.set_xlabel(f"{along.replace('_', ' ')} [s]")
    panel.set_ylabel(label)


def bars(panel: Axes, values: Values, label: str, scale: float = 1.0) -> None:
    """A quantity of each case with its interval."""
    names = list(values)
    means: Array = scale * np.array([values[name].mean for name in names])
    halves = np.nan_to_num(scale * np.array([values[name].upper - values[name].mean for name in names]))
    panel.barh(range(len(names)), means, xerr=halves, color=[SHOWN.get(name, GREY) for name in names], capsize=3)
    panel.set_yticks(range(len(names)), names)
    panel.invert_yaxis()
    panel.set_xlabel(label)


def sources(results: Path, studies: tuple[str, ...] = STUDIES) -> list[str]:
    """The origin of the numbers of the paper's cases."""
    known = [(name, table(results, name)) for name in studies]
    return [made_by("liu2016", name, points) for name, points in known if points]


def panels(count: int, height: float = 4.2) -> tuple[Figure, list[Axes]]:
    """A figure of panels side by side."""
    figure, found = new_figure(1, count, size=(5.6 * count, height))
    return figure, list(found[0])


def read(results: Path, name: str, beds: Beds = SMALL) -> StudyTable | None:
    """A table of curves."""
    return curve_tables.table(results, beds.prefix + name)
