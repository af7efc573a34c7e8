"""The tests of the companion paper of Liu et al. (2016), AIChE J. 62, 2259: angle of repose and fluidisation over the Bond number."""

from __future__ import annotations

import math
from pathlib import Path

from paper_report.page import Section, Statement
from paper_report.tables import made_by
from study_tables import StudyTable, shortly
from talcum_results import BLUE, ORANGE

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure

from .curves import HEAVY, IN_TIME, case_name, nominal_bond_number
from .tables import brief, panels, read, table


def heap(results: Path) -> Section | None:
    """Angle of repose over the Bond number."""
    points = table(results, "heap")
    if points is None:
        return None
    found = points.estimates("repose.angle")
    told = "; ".join(f"Bo {float(row['adhesion_over_weight']):g}: {brief(angle)}" for row, angle in zip(points.rows, found))
    rising = [angle.mean for angle in found if math.isfinite(angle.mean)]
    statements = [Statement("angle of repose [degrees]", "grows with cohesion", told, all(np.diff(rising) > 0.0))]
    left = "; ".join(f"Bo {float(row['adhesion_over_weight']):g}: {shortly(points.estimate(row, 'departed').mean)}" for row in points.rows)
    statements.append(Statement("particles that leave the plate, of 5,400", "", left, None))
    figure, (panel,) = panels(1)
    panel.errorbar(points.numbers("adhesion_over_weight"), [angle.mean for angle in found],
                   yerr=[angle.upper - angle.mean for angle in found], fmt="o-", color=BLUE, capsize=3)  # fmt: skip
    panel.set_xlabel("Bond number")
    panel.set_ylabel("angle of repose [degrees]")
    text = (
        "A block of 5,400 particles slumps on a plate with open ends. The companion paper's numbers were not available; it finds that the angle grows. "
        "For comparison: rounded grains in rotating drums have about 25 degrees (Kleinhans et al., J. Geophys. Res. 116 (2011) E11004); their shape "
        "hinders rolling, while these spheres roll without resistance."
    )
    return Section("Companion paper: angle of repose", text, statements, [(figure, "Means and intervals over seeds.")],
                   [made_by("liu2016", "heap", points)])  # fmt: skip


def fluidisation(results: Path) -> Section | None:
    """Beds over the Bond number: which of them fluidise."""
    points, curves = table(results, "fluidisation"), read(results, IN_TIME)
    if points is None:
        return None
    statements = []
    figure, (left, right) = panels(2)
    for velocity, colour in ((0.02, BLUE), (0.04, ORANGE)):
        rows = points.where(inlet_velocity=velocity)
        bond = [nominal_bond_number(HEAVY, adhesion) for adhesion in rows.numbers("adhesion")]
        for panel, name, label, scale in ((left, "agitation", "energy of fluctuations [pJ]", 1.0e12), (right, "coordination_number", "C_N", 1.0)):
            panel.plot(bond, [scale * found.mean for found in rows.estimates(name)], "o-", color=colour, label=f"{100.0 * velocity:.0f} cm/s")
            panel.set_xlabel("Bond number")
            panel.set_ylabel(label)
        for number, row in zip(bond, rows.rows):
            paper = "fluidised" if number < 30 else "a fixed bed in the end"
            told = bed_in_words(rows, row) + last_energy(curves, case_name(HEAVY, float(row["adhesion"]), velocity))
            statements.append(Statement(f"Bo {number}, {100.0 * velocity:.0f} cm/s", paper, told, None))
    left.legend(fontsize=8)
    figures = [(figure, "One bed each.")]
    made = [made_by("liu2016", "fluidisation", points)]
    if curves is not None:
        figures.append((energies(curves), "Energy of fluctuations over time, means over 50 ms; left at 2 cm/s, right at 4 cm/s."))
        made.append(f"Over time: {curves.file.name}, which holds the digests of its runs; made by scripts/report liu2016 --keep.")
    text = (
        "Means from 0.4 to 0.6 s. We do not know the gas velocity and drag factor of the companion paper's runs, so there are two velocities and one factor. "
        "A bed that comes to rest loses its energy of fluctuations, and its pressure drop is steady; a bed that rises as one plug has little of this energy, too."
    )
    return Section("Companion paper: fluidisation over the Bond number", text, statements, figures, made)


def bed_in_words(rows: StudyTable, row: dict[str, str]) -> str:
    """Means of a bed."""
    shown = (
        ("agitation", "energy of fluctuations", 1.0e12, "pJ"), ("pressure_deviation", "deviation of the pressure drop", 100.0, "% of the weight"),
        ("gas_force", "gas force over weight", 1.0, ""), ("centre_height", "centre", 1.0e3, "mm"), ("coordination_number", "C_N", 1.0, ""),
        ("departed", "departed", 1.0, ""),
    )  # fmt: skip
    return "; ".join(f"{words} {shortly(scale * rows.estimate(row, name).mean)} {unit}".strip() for name, words, scale, unit in shown)


def last_energy(curves: StudyTable | None, case: str) -> str:
    """The energy of fluctuations in the last interval of a bed."""
    rows = curves.where(case=case).rows if curves is not None else []
    if not rows:
        return ""
    return f"; energy in the last 50 ms {shortly(1.0e12 * float(rows[-1]['fluctuating_kinetic_energy']))} pJ"


def energies(curves: StudyTable) -> Figure:
    """Energy of fluctuations of each bed over time, on a logarithmic axis."""
    figure, shown = panels(2)
    velocities = ("2", "4")
    for panel, velocity in zip(shown, velocities):
        cases = [case for case in dict.fromkeys(curves.texts("case")) if case.endswith(f"ug{velocity}")]
        cases.sort(key=bond_of)
        for case, colour in zip(cases, colormaps["viridis"](np.linspace(0.0, 0.9, max(len(cases), 1)))):
            rows = curves.where(case=case)
            panel.plot(rows.numbers("time"), 1.0e12 * np.array(rows.numbers("fluctuating_kinetic_energy")), "o-", color=colour,
                       markersize=3, label=f"Bo {bond_of(case)}")  # fmt: skip
        panel.set(yscale="log", xlabel="time [s], end of the interval", title=f"{velocity} cm/s")
        if cases:
            panel.legend(fontsize=8)
    shown[0].set_ylabel("energy of fluctuations [pJ]")
    return figure


def bond_of(case: str) -> int:
    """The Bond number in the name of a case."""
    return int(case.split("vdw")[1].split("ug")[0])


SECTIONS = (heap, fluidisation)
