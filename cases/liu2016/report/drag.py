"""Drag from the local agglomerates in place of one factor, as Liu et al. (2016) propose: two cases, compared with runs with one factor."""

from __future__ import annotations

from pathlib import Path

from paper_report.page import Section, Statement
from paper_report.tables import within
from study_tables import StudyTable, read_study_table, shortly
from talcum_results import BLUE, GREY, ORANGE

import numpy as np
from matplotlib.figure import Figure

from . import curves
from .tables import panels

FILE = "agglomerate-drag.csv"
CLOSURE = "from agglomerates"
ONE_FACTOR = "one factor, 0.2"
DRAGS = {ONE_FACTOR: GREY, CLOSURE: BLUE, "one factor, 1": ORANGE}
"""The drags that are compared, and their colours."""
NEAR = 0.25
"""A mean xi within this part of the paper's agrees: its 0.2 is one digit, 0.15 to 0.25."""
SHOWN = {
    "drag_factor_mean": ("xi", 1.0), "centre_height_m": ("centre [mm]", 1.0e3), "pressure_drop_over_weight": ("pressure drop over weight", 1.0),
    "coordination_number": ("C_N of the bed", 1.0), "large_diameter_m": ("d_agg [mm]", 1.0e3), "large_members": ("members", 1.0),
    "large_packing_fraction": ("packing", 1.0),
}  # fmt: skip
"""Columns that are shown: label, factor."""


def drag(_: Path) -> Section | None:
    """The part of the page about drag from the agglomerates."""
    file = curves.KEPT / FILE
    if not file.exists():
        return None
    found = read_study_table(file)
    statements = [Statement(f"mean xi by the agglomerates, {row['case']}", "0.2 for all particles", f"{float(row['drag_factor_mean']):.3f}",
                            within(float(row["drag_factor_mean"]), 0.2, NEAR)) for row in found.where(drag=CLOSURE).rows]  # fmt: skip
    statements += [Statement(f"{SHOWN[name][0]}, from agglomerates over one factor of 0.2", "", told_ratios(found, name), None)
                   for name in ("centre_height_m", "pressure_drop_over_weight", "large_diameter_m")]  # fmt: skip
    text = (
        "Each particle's xi follows from size and packing of the agglomerate that it is in. Two cases with half of the small bed's width (6,250 particles): 0.05 or "
        "0.1 s with xi = 0.2, then three ways from the same state. Means from 0.11 to 0.13 s (rho250vdw20ug4) and from 0.18 to 0.22 s (rho137vdw20ug2), "
        "while the bed still remembers its start: they show the direction in which the drag moves the bed, not a steady state. The pressure drop includes the "
        "friction of the gas at the walls. Agglomerates are sets of 15 or more whose contacts last for 1 ms; means are weighted by mass."
    )
    commit = found.provenance.get("commit", "unknown")[:10]
    made = f"Made by: talcum run, then talcum restart with --set, as in cases/liu2016/README.md (commit {commit}). Numbers: {FILE}; digests were not kept."
    return Section("Drag from the agglomerates", text, statements, [(bars_of(found), "Two cases, one run for each drag.")], [made], rows_of(found))


def told_ratios(found: StudyTable, name: str) -> str:
    """A quantity with drag from agglomerates over that with one factor of 0.2, case by case."""
    pairs = ((row, found.where(case=row["case"], drag=ONE_FACTOR).rows) for row in found.where(drag=CLOSURE).rows)
    return "; ".join(f"{row['case']}: {float(row[name]) / float(others[0][name]):.3f}" for row, others in pairs if others)


def rows_of(found: StudyTable) -> list[list[str]]:
    """A row for each run; the first row is the head."""
    head = ["case", "drag", *(label for label, _ in SHOWN.values())]
    return [head, *([row["case"], row["drag"], *(shortly(factor * float(row[name])) for name, (_, factor) in SHOWN.items())] for row in found.rows)]


def bars_of(found: StudyTable) -> Figure:
    """Bed height, pressure drop and agglomerates by case and drag."""
    names = ("centre_height_m", "pressure_drop_over_weight", "large_diameter_m")
    figure, shown = panels(len(names), 3.8)
    cases = list(dict.fromkeys(found.texts("case")))
    for panel, name in zip(shown, names):
        label, factor = SHOWN[name]
        for number, (way, colour) in enumerate(DRAGS.items()):
            values = [factor * float(row[name]) for case in cases for row in found.where(case=case, drag=way).rows]
            panel.bar(np.arange(len(values)) + 0.27 * (number - 1), values, 0.25, color=colour, label=way)
        panel.set_xticks(range(len(cases)), cases)
        panel.set_ylabel(label)
    shown[0].legend(fontsize=8, loc="lower right")
    return figure


SECTIONS = (drag,)
