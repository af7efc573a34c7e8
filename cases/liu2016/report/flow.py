"""The beds of Liu et al. (2016) as a whole: the contact, and Figs 2 to 6: flow patterns, pressure drop, dispersion, coordination numbers."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from paper_report.page import Section, Statement, picture
from paper_report.tables import within
from study_tables import Estimate, StudyTable

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from . import pictures
from .curves import FOLLOWED
from .tables import SHOWN, SMALL, Beds, Values, bars, by_case, column, curves, panels, reaches, read, sources, study, table, told, trends

STORED = Path(__file__).resolve().parents[3] / "docs"
STEADY = 0.3
"""Time from which beds count [s]: in the paper coordination numbers are steady by then."""
TIMES = (0.1, 0.2, 0.3, 0.6, 1.2)
"""Times at which the coordination number is told [s]."""


def contact(_: Path) -> Section:
    """The loops of force over overlap."""
    text = (
        "The contact at Bo 20 and Bo 5, pressed to half of an overlap, almost parted, pressed to all of it, and parted: above, the slope of first "
        "loading; unloading is steeper, and at zero force an overlap remains."
    )
    figures = [(picture(STORED / "liu2016-contact-loop.png"), "Normal force over overlap.")]
    made = "Made by: talcum contact CASE > CASE.csv, then scripts/contact_loop.py (cases/liu2016/README.md)."
    return Section("Table 1: the contact", text, [], figures, [made])


def patterns(results: Path) -> Section | None:
    """Figs 2 and 3: particles and gas."""
    figures = [(figure, f"{case}: particles coloured by speed, gas velocity and voidage.")
               for case in SHOWN if (figure := pictures.pictured(results, f"flow-{case}"))]  # fmt: skip
    if not figures:
        return None
    text = "The small beds at 1.2 s, cut in the middle."
    return Section("Figs 2 and 3: flow patterns", text, [], figures, sources(results))


def pressure(results: Path) -> Section | None:
    """Fig. 4: pressure drop over time, its mean and deviation."""
    series = read(results, "series")
    drops, deviations, forces = (study(results, name) for name in ("pressure_drop", "pressure_deviation", "gas_force"))
    if series is None or not drops:
        return None
    statements = [
        Statement("mean gas force over the weight", "1: the gas carries the bed", told(forces),
                  all(within(found.mean, 1.0, 0.01) for found in forces.values())),
        Statement("mean pressure drop over the weight", "fluctuates around 1", told(drops), None),
    ]  # fmt: skip
    net = net_drops(results)
    if net:
        statements.append(Statement("the same less that of the empty channel", "fluctuates around 1", told(net),
                                    all(within(found.mean, 1.0, 0.03) for found in net.values())))  # fmt: skip
    rises = {"density": True, "gas velocity": True, "Bond number": True}
    statements += trends("its standard deviation", deviations, rises)
    figure, (over_time, by_name) = panels(2)
    curves(over_time, series, "time", "pressure_drop", "pressure drop over weight")
    bars(by_name, deviations, "standard deviation of the pressure drop over weight")
    text = (
        "The gas rubs on the walls, which are 0.4 mm apart here and 0.8 in the paper: the empty channel has a pressure drop too. It is computed on the "
        "cells of the beds, three across, on which it is 18.5 % below Poiseuille's. Means from 0.3 s on."
    )
    caption = "Left: means over 10 ms, first seed. Right: of the rows of 1 ms."
    return Section("Fig. 4: pressure drop", text, statements, [(figure, caption)], sources(results))


def net_drops(results: Path, beds: Beds = SMALL) -> Values:
    """Pressure drops over the weight of the particles that are left, less those of the empty channel."""
    drops, weights, friction = study(results, "pressure_drop", beds), study(results, "weight", beds), channel(results, beds)
    found = {}
    for case, drop in drops.items():
        velocity = case.split("ug")[1]
        if velocity in friction:
            off = friction[velocity] / weights[case].mean
            found[case] = Estimate(drop.mean - off, drop.lower - off, drop.upper - off, drop.runs)
    return found


def channel(results: Path, beds: Beds) -> dict[str, float]:
    """Force of the gas on the walls of the empty channel [N], by the gas velocity in cm/s."""
    points = table(results, "empty-channel")
    if points is None:
        return {}
    found = points.where(cells=beds.cells)
    drops, weights = found.estimates("pressure_drop"), found.estimates("weight")
    velocities = (f"{100.0 * velocity:.0f}" for velocity in found.numbers("inlet_velocity"))
    return {velocity: drop.mean * weight.mean for velocity, drop, weight in zip(velocities, drops, weights)}


def dispersion(results: Path) -> Section | None:
    """Fig. 5: squared displacements and dispersion coefficients."""
    coefficients, moved = read(results, "dispersion"), read(results, "displacements")
    if coefficients is None or moved is None:
        return None
    along, across = (by_case(coefficients, column(name)) for name in ("secant_z", "secant_x"))
    ratios = {case: along[case].mean / across[case].mean for case in along}
    statements = [
        Statement("D_sz [mm^2/s], largest slope of a secant", "curves; the text has no numbers", told(along, 1.0e6), None),
        Statement("D_sx [mm^2/s]", "curves; the text has no numbers", told(across, 1.0e6), None),
        Statement("D_sz over D_sx", "much larger than 1; asked here: more than 3",
                  "; ".join(f"{case}: {ratio:.2g}" for case, ratio in ratios.items()), all(ratio > 3.0 for ratio in ratios.values())),
    ]  # fmt: skip
    rises = {"density": False, "gas velocity": True, "Bond number": False}
    statements += trends("D_sz [mm^2/s]", along, rises, 1.0e6)
    figure, (left, right) = panels(2)
    curves(left, moved, "lag", "half_square_z", "half of the mean square displacement along z [mm^2]", 1.0e6, start=STEADY)
    bars(right, along, "D_sz [mm^2/s]", 1.0e6)
    text = "Displacements over 0.3 s from 0.3 s on (Fig. 3's cases: three windows, two seeds); intervals are those over windows and seeds."
    return Section("Fig. 5: dispersion of the solids", text, statements, [(figure, "Left: first window, first seed.")], sources(results))


def coordination(results: Path) -> Section | None:
    """Fig. 6: coordination numbers of the whole bed."""
    series, parts = read(results, "series"), read(results, "contacts")
    means = study(results, "coordination_number")
    if series is None or parts is None or not means:
        return None
    statements = [Statement("C_N of the whole bed, from 0.3 s on", "2 to 3 in all cases, steady from 0.3 s on", told(means),
                            all(reaches(found, 2.0, 3.0) for found in means.values()))]  # fmt: skip
    followed = parts.where(case=FOLLOWED, seed="1")
    figure, (left, right) = panels(2)
    curves(left, series, "time", "coordination_number", "C_N of the whole bed")
    draw_parts(right, followed)
    if followed.rows:
        last = followed.rows[-1]
        shares = [float(last[name]) for name in part_names()]
        most = sum(shares[1:5])
        statements.append(Statement("distribution of C_N, rho250vdw20ug4", "0 to 7, mostly 1 to 4",
                                    f"{most:.2f} of the particles have 1 to 4, {shares[0]:.2f} none", most > 0.5))  # fmt: skip
    text = (
        "Mean number of touching neighbours of all particles. The paper's mean holds single particles, too. The table: means over the 10 ms that end at a "
        "time, and the parts of the particles with so many neighbours, means from 0.3 s on; both over the seeds."
    )
    return Section("Fig. 6: coordination numbers", text, statements, [(figure, "Right: rho250vdw20ug4, means over 50 ms.")], sources(results),
                   coordination_table(series, parts))  # fmt: skip


def coordination_table(series: StudyTable, parts: StudyTable) -> list[list[str]]:
    """Coordination number of each case at some times, and its distribution from 0.3 s on; the first row is the head."""
    at = {time: by_case(series, partial(at_time, time=time)) for time in TIMES}
    names = part_names()
    few = [by_case(developed(parts), column(name)) for name in names[:5]]
    more = by_case(developed(parts), lambda rows: [sum(float(row[name]) for name in names[5:]) for row in rows.rows])
    head = ["", *(f"C_N at {time:g} s" for time in TIMES), *(f"with {number}" for number in range(5)), "with 5 or more"]
    rows = [[case, *(known(at[time].get(case)) for time in TIMES), *(known(shares.get(case)) for shares in (*few, more))] for case in at[TIMES[0]]]
    return [head, *rows]


def at_time(rows: StudyTable, time: float) -> list[float]:
    """Coordination numbers of the interval that ends at a time, of each seed."""
    return [float(row["coordination_number"]) for row in rows.rows if abs(float(row["time"]) - time) < 1.0e-6]


def developed(parts: StudyTable) -> StudyTable:
    """The rows from which on beds count: each is of the 50 ms up to its time."""
    rows = [row for row in parts.rows if float(row["time"]) > STEADY + 0.04]
    return StudyTable(parts.file, parts.provenance, rows, parts.units)


def known(found: Estimate | None) -> str:
    """A mean to two places; nothing without values."""
    return "" if found is None or found.runs == 0 else f"{found.mean:.2f}"


def part_names() -> list[str]:
    """Columns of the distribution of coordination numbers."""
    return [f"with_{number}" for number in range(7)] + ["with_7_or_more"]


def draw_parts(panel: Axes, followed: StudyTable) -> None:
    """The distribution at some times."""
    times = followed.numbers("time")
    asked = [time for time in (0.1, 0.3, 0.6, 0.9, 1.2) if times and time <= times[-1] + 0.005]  # the last look is 1 ms before the end
    for time, colour in zip(asked, colormaps["viridis"](np.linspace(0.0, 0.9, max(len(asked), 1)))):
        row = followed.rows[int(np.argmin(np.abs(np.array(times) - time)))]
        panel.plot(range(8), [float(row[name]) for name in part_names()], "o-", color=colour, label=f"{float(row['time']):.1f} s")
    panel.set_xlabel("C_N (7: or more)")
    panel.set_ylabel("part of the particles")
    if asked:
        panel.legend(fontsize=8)


SECTIONS = (contact, patterns, pressure, dispersion, coordination)
