"""Beds in a volume-averaged gas, as their cases stand: rates, and how the step divides."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from .beds import ROOT, Bed
from .runs import Measured, execute, on_cores
from .states import STATES, is_kept, run_to
from .tables import efficiency, median_rates, ratio, rounded, table
from .talcum import PROGRAM, rate_of_copies, run_talcum

MOST_RANKS = 2
"""Ranks that states are made on, and rows are measured on."""


@dataclass(frozen=True)
class CoupledBed:
    """A case, and the time at which it is measured."""

    name: str
    case: str
    time: float
    particles: int
    steps: int

    @property
    def state(self) -> Path:
        """The checkpoint at that time."""
        return STATES / f"coupled-{Path(self.case).stem}-{self.particles}.h5"

    def on(self, ranks: int) -> Bed:
        """This case as a row of the benchmark."""
        return Bed(self.name, self.state.stem, self.particles, self.steps, 0, ranks=ranks)


COUPLED = (
    CoupledBed("agglomerates, small box (Liu et al.)", "cases/liu2016/small/rho250vdw20ug4.toml", 0.05, 12_500, 8_000),
    CoupledBed("agglomerates, full box (Liu et al.)", "cases/liu2016/full/rho250vdw20ug4.toml", 0.02, 100_000, 1_000),
    CoupledBed("bubbling beads (Mueller et al.)", "cases/experiments/mueller2009.toml", 0.3, 9_240, 4_000),
    CoupledBed("flat bed of beads (van Wachem et al.)", "cases/experiments/van-wachem2001.toml", 0.5, 17_562, 4_000),
)


def prepare(bed: CoupledBed) -> Path:
    """The state, made if it is not there; kept for later calls."""
    if is_kept(bed.state, execute, PROGRAM):
        return bed.state
    ranks = min(MOST_RANKS, os.cpu_count() or 1)
    return run_to(bed.state, ROOT / bed.case, bed.time, lambda command: execute(on_cores(command, ranks), ranks), PROGRAM)


def line(
    bed: CoupledBed, ranks: int, runs: list[Measured], alone: list[Measured], copies: list[float]
) -> list[str]:
    """A row of the table; `alone` are the runs on one rank, round by round, `copies` the rates of as many such runs at once as
    there are ranks."""
    rates, rates_alone = ([run.rate for run in of] for of in (runs, alone))
    rate = median(rates)
    shares = [
        100.0 * median(run.stages.get(name, 0.0) for run in runs)
        for name in ("contact forces", "coarse-grain, gas", "gas force", "migrate, rebuild lists", "integrate")
    ]
    gained = efficiency(rates, rates_alone, ranks)
    at_median = efficiency(median_rates(runs), median_rates(alone), ranks)
    numbers = (rate, rate / ranks, gained, at_median, ratio(copies, rates_alone))
    return [bed.name, str(ranks), *map(rounded, numbers), *(rounded(share, 1) for share in shares)]


def coupled(rounds: int, first: bool) -> str:
    """A table of rates on one rank and two, measured in turns."""
    numbers = [ranks for ranks in range(1, MOST_RANKS + 1) if ranks <= (os.cpu_count() or 1)]
    states = {bed: prepare(bed) for bed in COUPLED}
    runs: dict[tuple[CoupledBed, int], list[Measured]] = {}
    copies: dict[tuple[CoupledBed, int], list[float]] = {}
    for _ in range(rounds):
        for bed, start in states.items():
            for ranks in numbers:
                runs.setdefault((bed, ranks), []).append(run_talcum(bed.on(ranks), start, first))
                if ranks > 1:
                    copied = rate_of_copies(bed.on(1), start, first, ranks)
                    copies.setdefault((bed, ranks), []).append(copied)
    rows = [
        line(bed, ranks, found, runs[bed, 1], copies.get((bed, ranks), [])) for (bed, ranks), found in runs.items()
    ]
    head = ["bed", "ranks", "million particle-steps/s", "per rank", "efficiency",
            "at the median step", "of copies", "contacts, %", "gas, %", "gas force, %", "lists, %", "integration, %"]  # fmt: skip
    return table(head, rows)
