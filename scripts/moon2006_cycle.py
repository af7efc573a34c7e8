"""The shaken bed of Moon, Kevrekidis & Sundaresan (2006) over the cycle of its plate: Figs 6 to 9."""

from __future__ import annotations

from pathlib import Path

from cycle import average_over_phase, find_vibration
from moon2006_tables import made_or_kept, sources, table
from paper_tables import over, within
from report import Section, Statement
from study_tables import StudyTable, table_of_rows, write_study_table
from talcum_results import GREY, new_figure, read_series

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure

STEADY = 62.5
"""Time from which cycles are averaged: the fourth."""
PHASES = 50
STUDIES = ("fig7", "fig8")
"""Soft and stiff particles."""
CURVES = {
    "bed_bottom": "bottom of the bed [d]",
    "centre_velocity": "velocity of the centre [sqrt(g d)]",
    "plate_stress": "stress on the plate / weight",
    "grid_pressure_drop": "pressure drop / weight",
}
KEPT = "cycle.csv"


def curves(results: Path) -> StudyTable | None:
    """Means at equal phases of the first run of each plate, stiffness and gas velocity; the kept table if no such run is here."""
    return made_or_kept(made(results), KEPT)


def made(results: Path) -> StudyTable | None:
    """The same of the runs that are here."""
    rows: list[dict[str, str]] = []
    provenance: dict[str, str] = {}
    for study in STUDIES:
        runs = table(results, study, "runs")
        for run in runs.where(seed=1).rows if runs else []:
            folder = results / study / "runs" / run["run"]
            if (folder / "series.csv").exists():
                rows += over_one_cycle(study, run, folder)
                provenance[f"{study} {run['run']}"] = f"digest {run['digest']}"
    return table_of_rows(results / KEPT, provenance, rows) if rows else None


def over_one_cycle(study: str, run: dict[str, str], folder: Path) -> list[dict[str, str]]:
    """The curves of one run."""
    series = read_series(folder).between(STEADY, None)
    cycle = average_over_phase(series, find_vibration(series, None), PHASES)
    named = {"study": study, "wall_bond_number": run.get("wall_bond_number", "0"), "superficial_velocity [sqrt(g d)]": run["superficial_velocity"]}
    units = {"bed_bottom": " [d]", "centre_velocity": " [sqrt(g d)]"}
    return [
        named | {"phase": f"{phase:.4g}"} | {name + units.get(name, ""): f"{cycle.mean[name][place]:.5g}" for name in CURVES}
        for place, phase in enumerate(cycle.phase)
    ]


def keep(results: Path, folder: Path) -> None:
    """Stores the curves of the runs that are here."""
    found = made(results)
    if found is not None:
        write_study_table(found, folder / KEPT)


def drawn(found: StudyTable, study: str, wall_bond_number: float) -> Figure | None:
    """Curves over the cycle for each gas velocity; None if there are none of this study and plate."""
    beds = found.where(study=study, wall_bond_number=wall_bond_number)
    velocities = sorted(set(beds.numbers("superficial_velocity")))
    if not velocities:
        return None
    figure, panels = new_figure(1, len(CURVES), size=(3.6 * len(CURVES), 3.6))
    for place, velocity in enumerate(velocities):
        bed = beds.where(superficial_velocity=velocity)
        colour = colormaps["viridis"](place / len(velocities))
        for panel, name in zip(panels[0], CURVES):
            panel.plot(bed.numbers("phase"), bed.numbers(name), color=colour, label=f"U_s {velocity:g}")
    phase = np.linspace(0.0, 1.0, 201)
    panels[0, 2].plot(phase, 1.0 + 3.0 * np.sin(2.0 * np.pi * phase), "--", color=GREY, label="1 + 3 sin(2 pi f t)")
    for panel, label in zip(panels[0], CURVES.values()):
        panel.set_xlabel("phase of the plate, f t")
        panel.set_ylabel(label)
    panels[0, 2].legend(fontsize=6)
    return figure


def over_the_cycle(results: Path) -> list[tuple[Figure, str]]:
    """The curves of both plates and both stiffnesses, with captions."""
    found = curves(results)
    if found is None:
        return []
    kinds = [("fig7", 0.0, "k_n 2e5, Bo_p 0"), ("fig7", 40.0, "k_n 2e5, Bo_p 40"), ("fig8", 0.0, "k_n 2e6, Bo_p 0")]
    pictures = [(drawn(found, study, bond), f"One bed of each gas velocity over the cycle, means of cycles 4 to 8: {words}.") for study, bond, words in kinds]
    return [(figure, caption) for figure, caption in pictures if figure is not None]


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
    measures = {"peak": "peak of plate stress / weight", "gas_force": "mean gas force / weight", "pressure_drop": "mean pressure drop / weight"}
    figures = [(over(points, "superficial_velocity", measures, groups), "Over U_s; means and intervals over seeds.")]
    figures = over_the_cycle(results) + figures
    text = "Poured with its cohesion (Bo 20), then shaken at Gamma 3 and f 0.16 in gas; cycles 4 to 8."
    return Section("Figs 6 to 9: the cycle", text, statements, figures, sources(("fig7", points), ("fig8", stiff)))
