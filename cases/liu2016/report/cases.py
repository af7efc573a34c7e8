"""The eight cases of Liu et al. (2016) side by side: the paper's statement on each quantity, the small beds, and the effect of the whole box."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from paper_report.page import Section

from . import pictures
from .breakage import of_first_lag, share_kept
from .curves import FOLLOWED
from .flow import net_drops
from .tables import CASES, SMALL, WHOLE, Beds, Values, by_case, cell, column, read, sources, study

Column = tuple[str, str, float, Values]
"""A quantity: its name, what the paper says, a factor for its unit, its values by case."""


def columns(results: Path, beds: Beds = SMALL) -> list[Column]:
    """All quantities of the table; none without runs."""
    coefficients, looks = read(results, "dispersion", beds), read(results, "agglomerates", beds)
    forces = study(results, "gas_force", beds)
    if coefficients is None or looks is None or not forces:
        return []
    first = {name: by_case(looks, partial(of_first_lag, name=name)) for name in
             ("agglomerates", "diameter", "coordination_number", "packing_fraction", "fractal_dimension")}  # fmt: skip
    return [
        ("gas force over weight", "1", 1.0, forces),
        ("pressure drop less the walls' over weight", "1", 1.0, net_drops(results, beds)),
        ("its deviation [%]", "rises with density, u_g, Bo", 100.0, study(results, "pressure_deviation", beds)),
        ("C_N of the bed", "2 to 3", 1.0, study(results, "coordination_number", beds)),
        ("centre [mm]", "", 1.0e3, study(results, "centre_height", beds)),
        ("departed", "", 1.0, study(results, "departed", beds)),
        ("D_sz [mm^2/s]", "falls with density and Bo, rises with u_g", 1.0e6, by_case(coefficients, column("secant_z"))),
        ("D_sx [mm^2/s]", "much smaller", 1.0e6, by_case(coefficients, column("secant_x"))),
        ("N_agg", "", 1.0, first["agglomerates"]),
        ("d_agg [mm]", "falls to 0.2", 1.0e3, first["diameter"]),
        ("C_N in agglomerates", "3", 1.0, first["coordination_number"]),
        ("packing", "0.2 to 0.3", 1.0, first["packing_fraction"]),
        ("D_f", "1.9 to 2.3", 1.0, first["fractal_dimension"]),
        *((f"left after {1e3 * lag:.0f} ms", "most", 1.0, by_case(looks, partial(share_kept, lag=lag))) for lag in (0.03, 0.05)),
    ]  # fmt: skip


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
        "Small beds, from 0.3 s on. The four cases of Fig. 3 have three windows of 0.3 s in each of their runs, the others one, from 0.3 s on, in "
        "which agglomerates of the cases of Fig. 3 are short-lived (Fig. 8). Values for agglomerates are at the lag 0.01 s. ± is half of the interval of 95 % confidence over "
        "seeds, or over windows and seeds."
    )
    return Section("Table 2, case by case", text, sources=sources(results), table=found)


def boxes(results: Path) -> list[list[str]]:
    """The followed case in the small and in the whole box: a row for each quantity; the first row is the head."""
    small, whole = columns(results), columns(results, WHOLE)
    rows = [[name, paper, *(cell(values.get(FOLLOWED), factor) for values in (here, there))]
            for (name, paper, factor, here), (*_, there) in zip(small, whole)]  # fmt: skip
    return [["", "paper", *(f"{beds.particles:,} particles" for beds in (SMALL, WHOLE))], *rows] if rows else []


def box(results: Path) -> Section | None:
    """The part of the page about the effect of the whole box."""
    found = boxes(results)
    if not found:
        return None
    text = (
        f"{FOLLOWED} in the paper's box of 4 x 0.8 x 20 mm for 0.6 s, compared with the small one. One seed and one window, of t_0 = 0.3 s, in which agglomerates "
        "of the small box are short-lived too (Fig. 8). "
        "With eight times as many particles it has eight times as many agglomerates if the box does not matter."
    )
    picture = pictures.pictured(results, "box")
    figures = [(picture, "The whole box: agglomerates of t_0 = 0.3 s that are left.")] if picture else []
    return Section("The size of the box", text, figures=figures, sources=sources(results, WHOLE.studies), table=found)


SECTIONS = (cases, box)
