"""The eight cases of Liu et al. (2016) side by side: what the paper says of each quantity, and what the small beds give."""

from __future__ import annotations

import math
from functools import partial
from pathlib import Path

from liu2016_breakage import of_first_lag, share_kept
from liu2016_flow import channel, less_friction
from liu2016_tables import CASES, Values, by_case, column, read, sources, study
from report import Section
from study_tables import Estimate

Column = tuple[str, str, float, Values]
"""A quantity: its name, what the paper says, a factor for its unit, its values by case."""


def columns(results: Path) -> list[Column]:
    """All quantities of the table; none without runs."""
    coefficients, looks = read(results, "dispersion"), read(results, "agglomerates")
    drops = study(results, "pressure_drop")
    if coefficients is None or looks is None or not drops:
        return []
    first = {name: by_case(looks, partial(of_first_lag, name=name)) for name in
             ("agglomerates", "diameter", "coordination_number", "packing_fraction", "fractal_dimension")}  # fmt: skip
    return [
        ("gas force over weight", "1", 1.0, study(results, "gas_force")),
        ("pressure drop less the walls' over weight", "1", 1.0, less_friction(drops, channel(results))),
        ("its deviation [%]", "rises with density, u_g, Bo", 100.0, study(results, "pressure_deviation")),
        ("C_N of the bed", "2 to 3", 1.0, study(results, "coordination_number")),
        ("centre [mm]", "", 1.0e3, study(results, "centre_height")),
        ("departed", "", 1.0, study(results, "departed")),
        ("D_sz [mm^2/s]", "falls with density and Bo, rises with u_g", 1.0e6, by_case(coefficients, column("secant_z"))),
        ("D_sx [mm^2/s]", "much smaller", 1.0e6, by_case(coefficients, column("secant_x"))),
        ("N_agg", "", 1.0, first["agglomerates"]),
        ("d_agg [mm]", "falls to 0.2", 1.0e3, first["diameter"]),
        ("C_N in agglomerates", "3", 1.0, first["coordination_number"]),
        ("packing", "0.2 to 0.3", 1.0, first["packing_fraction"]),
        ("D_f", "1.9 to 2.3", 1.0, first["fractal_dimension"]),
        ("left after 50 ms", "most", 1.0, by_case(looks, partial(share_kept, lag=0.05))),
    ]  # fmt: skip


def cell(found: Estimate | None, factor: float) -> str:
    """A mean with half of its interval, where there is one."""
    if found is None or found.runs == 0 or math.isnan(found.mean):
        return ""
    half = factor * (found.upper - found.mean)
    mean = f"{factor * found.mean:.3g}"
    return mean if math.isnan(half) else f"{mean} ± {half:.2g}"


def table(results: Path) -> list[list[str]]:
    """A row for each quantity: its name, the paper, the cases; the first row is the head."""
    known = columns(results)
    shown = [case for case in CASES if any(case in values for *_, values in known)]
    rows = [[name, paper, *(cell(values.get(case), factor) for case in shown)] for name, paper, factor, values in known]
    return [["", "paper", *(case.replace("vdw", " vdw").replace("ug", " ug") for case in shown)], *rows] if rows else []


def cases(results: Path) -> Section | None:
    """The table."""
    found = table(results)
    if not found:
        return None
    text = (
        "Small beds, from 0.3 s on. The four cases of Fig. 3 have three windows of 0.3 s in each of their runs, the others one. What is said of "
        "agglomerates is at the lag 0.01 s. ± is half of the interval of 95 % confidence over seeds, or over windows and seeds."
    )
    return Section("Table 2, case by case", text, sources=sources(results), table=found)


SECTIONS = (cases,)
