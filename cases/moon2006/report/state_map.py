"""The behaviour of beds over Bond number and Gamma, and the dependence of the critical Bond number, beyond Moon et al. (2006)."""

from __future__ import annotations

from pathlib import Path

from paper_report.page import Section, Statement
from study_tables import Estimate, StudyTable
from talcum_results import BLACK, BLUE, GREEN, GREY, ORANGE, RED, new_figure

import numpy as np
from matplotlib.figure import Figure

from .pictures import beds, save
from .tables import sources, table
from .thresholds import critical

MARKS = {
    "waves": ("o", BLUE, "waves"),
    "waves_in_part": ("D", GREEN, "waves in part"),
    "intermittent": ("^", ORANGE, "waves now and then"),
    "frozen": ("s", GREY, "frozen"),
    "rising_plug": ("v", RED, "one plug that rises"),
    "disordered": ("x", BLACK, "disordered"),
}
"""How a state of `waves.state` is drawn, and what it is called."""


SOFT = 2.0e5
"""k_n of Fig. 4."""
CUT_OFF, RANGE = 8.0e-6, 0.01
"""Cut-off and range of the attraction in the cases: it is constant up to the first, then falls as the inverse square up to the second."""


def drawn(runs: StudyTable, lines: list[tuple[float, StudyTable]]) -> Figure:
    """A panel for each gas velocity; beds that differ by their seed alone stand side by side."""
    velocities = sorted(set(runs.numbers("superficial_velocity")))
    figure, panels = new_figure(1, len(velocities), size=(5.2 * len(velocities), 4.4))
    for panel, velocity in zip(panels[0], velocities):
        for row in runs.where(superficial_velocity=velocity).rows:
            mark, colour, name = MARKS[row["waves"]]
            aside = 0.08 * (float(row["seed"]) - 1.5)
            panel.plot(float(row["gamma"]) + aside, float(row["bond_number"]), mark, color=colour, label=name, markersize=6)
        for where, points in lines:
            if where == velocity:
                found = [critical(points, row).mean for row in points.rows]
                panel.plot(points.numbers("gamma"), found, "-", color=GREY, label="Bo_c by bisection")
        panel.set_yscale("log", base=2)
        panel.set_yticks([4, 8, 16, 32, 64], ["4", "8", "16", "32", "64"])
        panel.set_ylim(1.6, 96)  # room for the legend
        panel.set_xlabel("Gamma")
        panel.set_ylabel("Bond number")
        panel.set_title(f"U_s {velocity:g}")
        named = dict(zip(*reversed(panel.get_legend_handles_labels())))
        panel.legend(named.values(), named.keys(), fontsize=7, loc="lower center", ncols=2)
    return figure


def over_all(results: Path) -> Section | None:
    """The map of Bond number and Gamma at two gas velocities."""
    runs = table(results, "map", "runs")
    if runs is None:
        return None
    usual, more = table(results, "fig4", "points"), table(results, "fig4-gas", "points")
    lines = critical_lines(usual, more)
    statements = []
    for velocity, points in lines:
        text = "; ".join(f"Gamma {float(row['gamma']):g}: {critical(points, row)}" for row in points.rows)
        statements.append(Statement(f"Bo_c at U_s {velocity:g}", "slightly higher with more gas", text, None))
    if usual is not None and more is not None:
        statements.append(more_gas(usual, more))
    text = "Vibration (f 0.16) and cohesion are switched on in the developed bed; two beds at each point, measured 25 to 100 time units later."
    caption = "What each bed does: Gamma 0 is a plate at rest. Lines: critical Bond numbers of Fig. 4."
    made_by = sources(("map", runs), ("fig4", usual), ("fig4-gas", more))
    figures = [(drawn(runs, lines), caption), *beds(results, "map")]
    return Section("The map of Bond number and Gamma", text, statements, figures, made_by)


def critical_lines(usual: StudyTable | None, more: StudyTable | None) -> list[tuple[float, StudyTable]]:
    """The critical Bond numbers of Fig. 4 that are known, by the gas velocity."""
    return [(velocity, points) for velocity, points in ((0.12, usual), (0.15, more)) if points is not None]


def keep(results: Path, folder: Path) -> None:
    """Stores the picture of the map, from the tables of the runs made here or those that are kept."""
    runs = table(results, "map", "runs")
    if runs is not None:
        lines = critical_lines(table(results, "fig4", "points"), table(results, "fig4-gas", "points"))
        save(drawn(runs, lines), folder / "map-states.png")


def more_gas(usual: StudyTable, more: StudyTable) -> Statement:
    """How much larger Bo_c is with more gas, where both are known. Where the intervals overlap nothing is decided."""
    pairs = []
    for row in more.rows:
        same = usual.where(gamma=float(row["gamma"])).rows
        if same:
            pairs.append((critical(more, row), critical(usual, same[0])))
    pairs = [(a, b) for a, b in pairs if np.isfinite(a.mean / b.mean)]
    told = ", ".join(f"{a.mean / b.mean:.2f}" for a, b in pairs) or "none"
    apart = [a.mean > b.mean for a, b in pairs if not a.overlaps(b.lower, b.upper)]
    return Statement("Bo_c with more gas, divided by that at U_s 0.12", "a little more than 1: judged where the intervals do not overlap", told,
                     all(apart) if apart else None)  # fmt: skip


def work_of_parting(bond_number: float, stiffness: float) -> float:
    """The work that separates two particles: that of the attraction, and that stored in the spring."""
    force = bond_number * np.pi / 6
    return force * CUT_OFF * (2 - CUT_OFF / RANGE) + force**2 / (2 * stiffness)


def stiffness(results: Path) -> Section | None:
    """Bo_c of stiff particles, and of soft ones with the force or the work of the stiff ones."""
    points, soft = table(results, "stiffness", "points"), table(results, "fig4", "points")
    if points is None or not points.rows:
        return None
    named = {
        "keeps_force": "stiff particles, k_n 2e6",
        "keeps_work": "k_n 2e5, with the work of parting of the stiff ones",
    }
    # Soft particles with the work of stiff ones have the Bond number of those, which are so many times as stiff.
    meant = [float(row["normal_stiffness"]) * float(row["stiffness_reduction"]) for row in points.rows]
    beds = [(named[row["softening"]], k_n, critical(points, row)) for row, k_n in zip(points.rows, meant)]
    usual = [critical(soft, row) for row in soft.where(gamma=3.0).rows] if soft else []
    beds += [("k_n 2e5, with the force of the stiff ones (Fig. 4)", SOFT, found) for found in usual]
    statements = []
    for name, k_n, found in beds:
        agrees = found.overlaps(usual[0].lower, usual[0].upper) if usual and name == named["keeps_force"] else None
        statements.append(Statement(f"Bo_c: {name}", "does not depend on k_n: agrees if stiff and soft overlap at equal force", str(found), agrees))
        works = (work_of_parting(bond, k_n) for bond in (found.mean, found.lower, found.upper))
        work = Estimate(*works, found.runs)
        statements.append(Statement(f"work of parting at that Bo_c: {name}", "not in the paper", f"{work} rho_s g d^4", None))
    text = (
        "Gamma 3, f 0.16. A spring under the attraction F0 stores F0^2 / (2 k_n), which parting two particles takes on top of the work of "
        "the attraction, 2 F0 cut_off: at Bo 20 1.6 times as much at k_n 2e5, 0.16 times at 2e6. If the force decides, stiff and soft "
        "particles have the same Bo_c at equal force; if the work does, at equal work."
    )
    title = "Beyond the paper: stiffness, force and work of parting"
    return Section(title, text, statements, [], sources(("stiffness", points), ("fig4", soft)))
