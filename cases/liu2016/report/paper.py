"""The page of Liu, van Wachem, Mudde, Chen & van Ommen (2016): every figure that was run, compared with the text of the paper."""

from __future__ import annotations

from pathlib import Path

from paper_report import run_times
from paper_report.page import Paper, Section

from . import beyond, breakage, cases, companion, curves, drag, flow
from .kept import keep

TITLE = "Liu, van Wachem, Mudde, Chen & van Ommen (2016) with Talcum"
INTRODUCTION = (
    "Agglomerates of nanoparticles of 40 um in air: the cases of table 2 in a box of 2 x 0.4 x 10 mm with 12,500 particles, a quarter of the paper's "
    "cross-section and half of its height. The paper does not give its number of particles. Intervals are those of 95 % confidence over windows of time and seeds."
)


def times_of_runs(results: Path) -> Section | None:
    """The run times."""
    return run_times.section(results, curves.KEPT, curves.ALL_STUDIES)


def sections(results: Path) -> list[Section]:
    """All figures of which there are tables."""
    modules = (cases, flow, breakage, beyond, companion, drag)
    figures = [*(make for module in modules for make in module.SECTIONS), times_of_runs]
    found = (make(results) for make in figures)
    return [section for section in found if section is not None]


PAPER = Paper("liu2016", TITLE, INTRODUCTION, sections, keep)
