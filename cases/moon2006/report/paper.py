"""The page of Moon, Kevrekidis & Sundaresan (2006): every figure that was run, compared with the text of the paper."""

from __future__ import annotations

import math
from pathlib import Path

from paper_report import run_times
from paper_report.page import Paper, Section, Statement
from paper_report.tables import interval_of, over, within
from study_tables import Estimate, StudyTable

from . import beyond, boxes, cycle, fluidisation, powder, state_map, tables, thresholds, wide
from .kept import keep
from .pictures import beds
from .tables import parts, source, sources, states, table

TITLE = "Moon, Kevrekidis & Sundaresan (2006) with Talcum"
INTRODUCTION = (
    "Beds of 3,000 particles, 5 d x 5 d wide and about 100 d deep, in a column gas; all numbers are dimensionless "
    "(rho_s = d = g = 1; St 55, k_n 2e5, e 0.9, mu 0.1). Intervals are those of 95 % confidence over the seeds of the bed."
)


def figure_1(results: Path) -> Section | None:
    """Travelling waves without cohesion."""
    points = table(results, "developed-bed", "points")
    if points is None:
        return None
    row = points.rows[0]
    speed, length, period = (points.estimate(row, name) for name in ("speed", "wavelength", "period"))
    gas, front = points.estimate(row, "gas_force"), points.estimate(row, "front_speed")
    statements = [
        Statement("bed at U_s 0.12", "alternating plugs and voids that rise periodically", row["waves"].replace("_", " "), None),
        Statement("speed of the waves", "not given in the text", str(speed), None),
        Statement("wavelength; period", "not given in the text", f"{length}; {period}", None),
        Statement("gas force over the weight", "1 above minimum fluidisation", str(gas), within(gas.mean, 1.0, 0.02)),
        Statement("front by which waves climb through the poured bed", "not shown", str(front), None),
    ]
    text = "Poured without gas for 25 time units, then fluidised at U_s 0.12 for 300: measured from 225 on."
    return Section("Fig. 1: waves without cohesion", text, statements, beds(results, "developed-bed"), [source("developed-bed", points)])


def figure_2(results: Path) -> Section | None:
    """Cohesion switched on in the developed bed."""
    points = table(results, "fig2", "points")
    if points is None:
        return None
    groups = [(f"friction cap: {cap}", points.where(friction_cap=cap)) for cap in ("net", "contact")]
    groups = [(name, group) for name, group in groups if group.rows]
    statements = []
    for name, group in groups:
        statements.append(Statement(f"parts of heights and times by the Bond number ({name})",
                                    "waves up to 4, intermittent at 6, one plug above 7",
                                    parts(group, "bond_number"), None))  # fmt: skip
        speeds = [e.mean for e in group.estimates("speed")][:2]
        falls = len(speeds) == 2 and speeds[1] < speeds[0]
        statements.append(Statement(f"speed from Bo 2 to Bo 4 ({name})", "falls",
                                    " to ".join(f"{speed:.3g}" for speed in speeds), falls))  # fmt: skip
        still = group.where(bond_number=8.0)
        share = still.estimates("share")[0] if still.rows else None
        if share:
            statements.append(Statement(f"part of the bed with waves at Bo 8 ({name})", "none: agrees below 0.1", str(share),
                                        share.mean < 0.1))  # fmt: skip
    quantities = {"speed": "wave speed [sqrt(g d)]", "share": "part with waves", "frozen_share": "part that stands still"}
    figures = [(over(points, "bond_number", quantities, groups), "Over the Bond number; means and intervals over seeds.")]
    figures += beds(results, "fig2")
    text = (
        "Cohesion is switched on in the developed bed (the final states of Fig. 1); measured 75 to 150 time units later. The paper's "
        "text allows two readings of Coulomb's limit: from the net normal force, or from the contact force alone."
    )
    return Section("Fig. 2: waves slow down and freeze as cohesion grows", text, statements, figures, [source("fig2", points)])


def figure_3(results: Path) -> Section | None:
    """Vibration brings the waves back."""
    points, contact = (table(results, study, "points") for study in ("fig3", "fig3-contact"))
    if points is None:
        return None
    speeds = [e.mean for e in points.estimates("speed")]
    gammas = points.numbers("gamma")
    strong = [speed for gamma, speed in zip(gammas, speeds) if gamma >= 3.0 and math.isfinite(speed)]
    spread = (max(strong) - min(strong)) / (sum(strong) / len(strong)) if strong else float("nan")
    statements = [
        Statement("Gamma and state", "a plug up to 2, waves above", states(points, "gamma"), None),
        Statement("speed for Gamma of 3 and more", "nearly the same",
                  ", ".join(f"{speed:.3g}" for speed in strong), spread < 0.3 if strong else None),
    ]  # fmt: skip
    if contact is not None:
        statements.append(Statement("Gamma and state, Coulomb's limit from the contact force alone", "a plug up to 2, waves above", states(contact, "gamma"), None))
    for study, limit in (("fig3", "net"), ("fig3-contact", "contact")):
        statements += all_returns(table(results, study, "runs"), limit)
    quantities = {"speed": "wave speed [sqrt(g d)]", "share": "part that waves sweep", "in_windows": "part of the record with waves"}
    figures = [(over(points, "gamma", quantities, [("Bo 20", points)]), "Over Gamma; means and intervals over seeds.")]
    figures += beds(results, "fig3")
    text = (
        "Cohesion (Bo 20) and vibration (f 0.16) are switched on in the developed bed; measured from 25 to 100 time units "
        "later, with the swing of the bed's centre taken out. Speeds within 30 % of each other are called nearly the same. Waves are measured in two ways: "
        "by the material that they sweep, which counts a single gap that crosses it, and by windows of heights and times in which a pattern repeats."
    )
    return Section("Fig. 3: vibration brings the waves back", text, statements, figures, sources(("fig3", points), ("fig3-contact", contact)))


QUANTITIES_OF_WAVES = {"share": "waves sweep half of the material", "in_windows": "windows show waves in half of heights and times"}
"""Two quantities that say how much of a bed has waves."""


def all_returns(runs: StudyTable | None, limit: str) -> list[Statement]:
    """Gamma at which waves come back, by each quantity."""
    if runs is None:
        return []
    statements = []
    for quantity, words in QUANTITIES_OF_WAVES.items():
        back = returns(runs, quantity)
        told = f"{back}, by lines between the points of each seed" if back.runs else "not reached"
        statements.append(Statement(f"Gamma from which {words} (Coulomb's limit: {limit})", "between 2 and 3: agrees if the interval overlaps that", told,
                                    back.overlaps(2.0, 3.0) if back.runs > 1 else None))  # fmt: skip
    return statements


def returns(runs: StudyTable, quantity: str) -> Estimate:
    """Gamma at which a quantity of the waves grows beyond one half: mean over the seeds with Student's interval."""
    found = []
    for seed in sorted(set(runs.numbers("seed"))):
        of_seed = runs.where(seed=seed)
        pairs = sorted(zip(of_seed.numbers("gamma"), of_seed.numbers(quantity)))
        steps = [(a, b) for a, b in zip(pairs, pairs[1:]) if a[1] < 0.5 <= b[1]]
        found += [a[0] + (0.5 - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) for a, b in steps[:1]]
    return interval_of(found)


def times_of_runs(results: Path) -> Section | None:
    """The run times."""
    return run_times.section(results, tables.KEPT, tables.STUDIES)


def sections(results: Path) -> list[Section]:
    """All figures of which there are tables."""
    figures = (fluidisation.minimum_fluidisation, figure_1, fluidisation.lower_velocities,
               fluidisation.other_sections, fluidisation.choices, figure_2, thresholds.without_vibration,
               thresholds.long_times, figure_3, thresholds.over_gamma,
               thresholds.over_frequency, state_map.over_all, state_map.stiffness, cycle.figures_6_to_9,
               boxes.figure_10, boxes.figure_11,
               beyond.distributor, beyond.compressible, wide.wide_bed,
               powder.fine_powder, times_of_runs)  # fmt: skip
    found = (make(results) for make in figures)
    return [section for section in found if section is not None]


PAPER = Paper("moon2006", TITLE, INTRODUCTION, sections, keep)
