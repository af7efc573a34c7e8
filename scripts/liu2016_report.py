"""The page of Liu, van Wachem, Mudde, Chen & van Ommen (2016): every figure that was run, beside what the paper says of it."""

from __future__ import annotations

from pathlib import Path

import liu2016_beyond
import liu2016_breakage
import liu2016_cases
import liu2016_companion
import liu2016_curves
import liu2016_drag
import liu2016_flow
import run_times
from report import Section

TITLE = "Liu, van Wachem, Mudde, Chen & van Ommen (2016) with Talcum"
INTRODUCTION = (
    "Agglomerates of nanoparticles of 40 um in air: the cases of table 2 in a box of 2 x 0.4 x 10 mm with 12,500 particles, a quarter of the paper's "
    "cross-section and half of its height. The paper does not tell its number of particles. Intervals are those of 95 % confidence over windows of time and seeds."
)


def times_of_runs(results: Path) -> Section | None:
    """How long the runs took."""
    return run_times.section(results, liu2016_curves.KEPT, liu2016_curves.ALL_STUDIES)


def sections(results: Path) -> list[Section]:
    """All figures of which there are tables."""
    modules = (liu2016_cases, liu2016_flow, liu2016_breakage, liu2016_beyond, liu2016_companion, liu2016_drag)
    figures = [*(make for module in modules for make in module.SECTIONS), times_of_runs]
    found = (make(results) for make in figures)
    return [section for section in found if section is not None]
