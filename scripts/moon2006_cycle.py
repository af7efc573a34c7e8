"""The shaken bed of Moon, Kevrekidis & Sundaresan (2006) over the cycle of its plate: Figs 6 to 9."""

from __future__ import annotations

from pathlib import Path

from cycle import average_over_phase, find_vibration
from moon2006_tables import sources, table
from paper_tables import over, within
from report import Section, Statement
from talcum_results import GREY, new_figure, read_series

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure

STEADY = 62.5
"""Time from which cycles are averaged: the fourth."""
CURVES = {"bed_bottom": "bottom of the bed [d]", "plate_stress": "stress on the plate / weight", "grid_pressure_drop": "pressure drop / weight"}


def over_the_cycle(results: Path) -> Figure | None:
    """Curves over the cycle for each gas velocity, of the first run of each; None if no run is here."""
    runs = table(results, "fig7", "runs")
    rows = runs.where(wall_bond_number=0.0, seed=1).rows if runs else []
    folders = [(float(row["superficial_velocity"]), results / "fig7/runs" / row["run"]) for row in rows]
    folders = [(velocity, folder) for velocity, folder in folders if (folder / "series.csv").exists()]
    if not folders:
        return None
    figure, panels = new_figure(1, len(CURVES), size=(4.6 * len(CURVES), 3.8))
    for place, (velocity, folder) in enumerate(folders):
        series = read_series(folder).between(STEADY, None)
        cycle = average_over_phase(series, find_vibration(series, None), 50)
        colour = colormaps["viridis"](place / len(folders))
        for panel, name in zip(panels[0], CURVES):
            panel.plot(cycle.phase, cycle.mean[name], color=colour, label=f"U_s {velocity:g}")
    phase = np.linspace(0.0, 1.0, 201)
    panels[0, 1].plot(phase, 1.0 + 3.0 * np.sin(2.0 * np.pi * phase), "--", color=GREY, label="1 + 3 sin(2 pi f t)")
    for panel, label in zip(panels[0], CURVES.values()):
        panel.set_xlabel("phase of the plate, f t")
        panel.set_ylabel(label)
    panels[0, 1].legend(fontsize=7)
    return figure


def figures_6_to_9(results: Path) -> Section | None:
    """The cycle of a shaken bed."""
    points, stiff = table(results, "fig7", "points"), table(results, "fig8", "points")
    if points is None:
        return None
    statements = []
    groups = [(f"Bo_p {bond:g}", points.where(wall_bond_number=bond)) for bond in (0.0, 40.0)]
    groups += [("k_n 2e6", stiff)] if stiff else []
    groups = [(name, group) for name, group in groups if group.rows]
    for name, group in groups:
        velocities = group.numbers("superficial_velocity")
        peaks = [e.mean for e in group.estimates("peak")]
        shrinks = all(later < earlier for earlier, later in zip(peaks, peaks[1:5]))
        text = "; ".join(f"{u:g}: {peak:.3g}" for u, peak in zip(velocities, peaks))
        statements.append(Statement(f"peak of the plate's stress over U_s ({name})", "shrinks as U_s grows", text, shrinks))
        sums = [a.mean + b.mean for a, b in zip(group.estimates("plate_stress"), group.estimates("gas_force"))]
        text = f"{min(sums):.4f} to {max(sums):.4f}"
        statements.append(Statement(f"mean plate stress + gas force ({name})", "1, by eq. (17)", text,
                                    all(within(total, 1.0, 0.01) for total in sums)))  # fmt: skip
        plateau = group.estimates("pressure_drop")[-1]
        statements.append(Statement(f"mean pressure drop at U_s {velocities[-1]:g} ({name})", "1", str(plateau),
                                    within(plateau.mean, 1.0, 0.02)))  # fmt: skip
    measures = {"peak": "peak of plate stress / weight", "gas_force": "mean gas force / weight", "lift": "lift [d]"}
    figures = [(over(points, "superficial_velocity", measures, groups), "Over U_s; means and intervals over seeds.")]
    curves = over_the_cycle(results)
    if curves is not None:
        figures.insert(0, (curves, "One bed of each gas velocity over the cycle (k_n 2e5, Bo_p 0), cycles 4 to 8."))
    text = "Poured with its cohesion (Bo 20), then shaken at Gamma 3 and f 0.16 in gas; cycles 4 to 8."
    return Section("Figs 6 to 9: the cycle", text, statements, figures, sources(("fig7", points), ("fig8", stiff)))
