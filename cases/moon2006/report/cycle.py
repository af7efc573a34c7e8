"""The shaken bed of Moon, Kevrekidis & Sundaresan (2006) over the cycle of its plate: Figs 6 to 9."""

from __future__ import annotations

from pathlib import Path

from cycle import average_over_phase, find_vibration
from paper_report.page import Section, Statement
from paper_report.tables import over, within
from study_tables import StudyTable, table_of_rows
from talcum_results import GREY, Array, new_figure, read_series

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure

from .tables import made_or_kept, sources, table

FREQUENCY = 0.16
"""Frequency of the plate."""
STEADY = 62.5
"""Time from which cycles are averaged: the fourth."""
PHASES = 100
"""Bins of a cycle, as many as rows of the series."""
STUDIES = {"fig7": "2e5", "fig8": "2e6"}
"""Their particles' k_n."""
WALLS = (0.0, 40.0)
"""Bond numbers of the plate."""
CURVES = {
    "centre_velocity": "velocity of the centre [sqrt(g d)]",
    "plate_stress": "stress on the plate / weight",
    "grid_pressure_drop": "pressure drop / weight",
}
KEPT = "cycle.csv"


def curves(results: Path) -> StudyTable | None:
    """Means at equal phases of the first run of each plate, stiffness and gas velocity; the kept table if no such run is here."""
    return made_or_kept(made(results), KEPT)


def made(results: Path) -> StudyTable | None:
    """The curves of the runs that are here."""
    rows: list[dict[str, str]] = []
    provenance = {"title": "Figs 6 to 9: means at equal phases of cycles 4 to 8, the first bed of each kind"}
    for study in STUDIES:
        runs = table(results, study, "runs")
        if runs:
            provenance[f"{study} commit"] = runs.provenance.get("commit", "unknown")
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
    named = {"study": study, "wall_bond_number": run["wall_bond_number"], "superficial_velocity [sqrt(g d)]": run["superficial_velocity"]}
    units = {"centre_velocity": " [sqrt(g d)]"}
    return [
        named | {"phase": f"{phase:.4g}"} | {name + units.get(name, ""): f"{cycle.mean[name][place]:.5g}" for name in CURVES}
        for place, phase in enumerate(cycle.phase)
    ]


def by_velocity(found: StudyTable, study: str, wall_bond_number: float) -> dict[float, StudyTable]:
    """The curves of a study and plate by the gas velocity."""
    beds = found.where(study=study, wall_bond_number=wall_bond_number)
    return {velocity: beds.where(superficial_velocity=velocity) for velocity in sorted(set(beds.numbers("superficial_velocity")))}


def drawn(found: StudyTable, study: str, wall_bond_number: float) -> Figure | None:
    """Curves over the cycle for each gas velocity; None if there are none of this study and plate."""
    beds = by_velocity(found, study, wall_bond_number)
    if not beds:
        return None
    labels = {"rise": "rise of the bed's centre [d]"} | CURVES
    figure, panels = new_figure(1, len(labels), size=(3.6 * len(labels), 3.6))
    for place, (velocity, bed) in enumerate(beds.items()):
        colour = colormaps["viridis"](place / len(beds))
        for panel, name in zip(panels[0], labels):
            values = rise(bed) if name == "rise" else bed.numbers(name)
            panel.plot(bed.numbers("phase"), values, color=colour, label=f"U_s {velocity:g}")
    phase = np.linspace(0.0, 1.0, 201)
    panels[0, 2].plot(phase, 1.0 + 3.0 * np.sin(2.0 * np.pi * phase), "--", color=GREY, label="1 + 3 sin(2 pi f t)")
    for panel, label in zip(panels[0], labels.values()):
        panel.set_xlabel("phase of the plate, f t")
        panel.set_ylabel(label)
    figure.legend(*panels[0, 2].get_legend_handles_labels(), loc="outside lower center", ncols=len(beds) + 1, frameon=False)
    return figure


def rise(bed: StudyTable) -> Array:
    """Height of the bed's centre above its lowest, by its velocity over one cycle, without the drift from cycle to cycle."""
    velocity = np.array(bed.numbers("centre_velocity"))
    height = np.cumsum(velocity - velocity.mean()) / (FREQUENCY * len(velocity))
    return height - height.min()


def rises(found: StudyTable, study: str, wall_bond_number: float) -> dict[float, float]:
    """How far the bed's centre rises above the plate within a cycle, by the gas velocity."""
    return {velocity: float(rise(bed).max()) for velocity, bed in by_velocity(found, study, wall_bond_number).items()}


def lifts_off(found: StudyTable, study: str, wall_bond_number: float, name: str) -> list[Statement]:
    """Fig. 6: the bed leaves the plate and comes back."""
    known = rises(found, study, wall_bond_number)
    if not known:
        return []
    still, most = known[min(known)], max(known.values())
    text = "; ".join(f"{velocity:g}: {height:.3g}" for velocity, height in known.items())
    return [Statement(f"rise of the bed's centre above the plate within a cycle, by U_s, in d ({name})",
                      "the bed lifts off by less than d without gas, and further with it", text, still < min(1.0, most))]  # fmt: skip


def over_the_cycle(found: StudyTable) -> list[tuple[Figure, str]]:
    """The curves of both plates and both stiffnesses, with captions."""
    pictures = [(drawn(found, study, bond), f"One bed of each gas velocity over the cycle, means of cycles 4 to 8: k_n {stiffness}, Bo_p {bond:g}.")
                for study, stiffness in STUDIES.items() for bond in WALLS]  # fmt: skip
    return [(figure, caption) for figure, caption in pictures if figure is not None]


def figures_6_to_9(results: Path) -> Section | None:
    """The cycle of a shaken bed."""
    points, stiff = table(results, "fig7", "points"), table(results, "fig8", "points")
    if points is None:
        return None
    statements = []
    beds = [(f"k_n {stiffness}", of_study) for stiffness, of_study in zip(STUDIES.values(), (points, stiff)) if of_study]
    groups = [(f"{name}, Bo_p {bond:g}", of_study.where(wall_bond_number=bond)) for name, of_study in beds for bond in WALLS]
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
    found = curves(results)
    for study, stiffness in STUDIES.items() if found else ():
        for bond in WALLS:
            statements += lifts_off(found, study, bond, f"k_n {stiffness}, Bo_p {bond:g}")
    quantities = {"peak": "peak of plate stress / weight", "gas_force": "mean gas force / weight", "pressure_drop": "mean pressure drop / weight"}
    figures = [(over(points, "superficial_velocity", quantities, groups), "Over U_s; means and intervals over seeds.")]
    figures = (over_the_cycle(found) if found else []) + figures
    text = (
        "Poured with its cohesion (Bo 20), then shaken at Gamma 3 and f 0.16 in gas; cycles 4 to 8. Coulomb's limit is that from the contact "
        "force alone. The bed lifts off by less than the spacing of the nodes of the gas, so that its flight is shown by the height of its centre."
    )
    return Section("Figs 6 to 9: the cycle", text, statements, figures, sources(("fig7", points), ("fig8", stiff)))
