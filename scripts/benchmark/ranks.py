"""Strong and weak scaling on the cores of this machine; with more ranks than cores only whether the bits agree."""

from __future__ import annotations

import os
from dataclasses import dataclass, replace
from statistics import median

from . import peers
from .beds import BEDS, Bed
from .runs import BenchmarkError, Measured, execute
from .states import state
from .tables import LAMMPS, TALCUM, efficiency, median_rates, ratio, rounded, table
from .talcum import PROGRAM, rate_of_copies, run_talcum

STRONG = next(bed for bed in BEDS if bed.name == "24,000 settled")
LARGE = next(bed for bed in BEDS if bed.name == "216,000 settled")
# As many steps as of the bed beside it: the start of a run then weighs as much.
WEAK = Bed("24,000 per rank, settled", "settled-48000", 48_000, STRONG.steps, STRONG.warm_up)
# Copies of the settled bed of 24,000: out of every cache.
LARGEST = Bed("1,944,000 settled", "settled-1944000", 1_944_000, 20, 0)
RANKS = (1, 2, 4, 8)
# Ranks that wait for each other on shared cores are slow: fewer steps say as much about the bits.
STEPS_OF_DIGESTS = 100


@dataclass(frozen=True)
class Row:
    """A bed on some ranks; its rate per rank is compared with that of another bed on one rank."""

    bed: Bed
    beside: Bed

    @property
    def with_peers(self) -> bool:
        """Whether peers run it too: their files of the largest bed would take longer than all runs."""
        return self.bed.particles <= LARGE.particles


def rows(cores: int) -> list[Row]:
    """The rows that are measured on a number of cores."""
    numbers = [n for n in RANKS if n <= cores]
    agitated, small = (next(bed for bed in BEDS if bed.name == name) for name in ("24,000 agitated", "3,000 settled"))
    compared = [(bed, bed) for bed in (STRONG, agitated, small, LARGE)] + [(LARGEST, LARGE)]
    found = [Row(replace(bed, ranks=n), beside) for bed, beside in compared for n in numbers]
    return found + [Row(replace(WEAK, ranks=2), STRONG)] * (2 in numbers)


def digests() -> str:
    """The digest that all numbers of ranks end with; an error if there are several."""
    start = state(STRONG.state, execute, PROGRAM)
    found = {n: run_talcum(replace(STRONG, ranks=n, steps=STEPS_OF_DIGESTS), start, False).digest for n in RANKS}
    if len(set(found.values())) != 1:
        raise BenchmarkError(f"the number of ranks changes the result: {found}")
    return found[1]


Rates = dict[tuple[str, Bed], list[Measured]]
# Of runs on one rank at once, as many as the bed has ranks, of the bed that it is compared with.
COPIES = "copies"


def measure(wanted: list[Row], rounds: int, first: bool, with_peers: bool) -> Rates:
    """All runs, interleaved, of Talcum and, if asked, of LAMMPS."""
    lammps = next((peer for peer in peers.peers_here() if with_peers and peer.name == LAMMPS), None)
    states = {row.bed: state(row.bed.state, execute, PROGRAM) for row in wanted}
    skins = {
        row.bed: peers.best_skin(lammps, replace(row.bed, ranks=1), states[row.bed], first)
        for row in wanted if lammps and row.with_peers
    }  # fmt: skip
    beside = {row.bed: row.beside for row in wanted if row.bed.ranks > 1}
    runs: Rates = {}
    for _ in range(rounds):
        for bed, start in states.items():
            runs.setdefault((TALCUM, bed), []).append(run_talcum(bed, start, first))
            if bed in beside:
                rate = rate_of_copies(beside[bed], states[beside[bed]], first, bed.ranks)
                runs.setdefault((COPIES, bed), []).append(Measured(rate))
            if lammps and bed in skins:
                runs.setdefault((LAMMPS, bed), []).append(peers.run_peer(lammps, bed, start, skins[bed], first))
    return runs


def scaling_table(wanted: list[Row], runs: Rates) -> str:
    """Rates and efficiencies, and the same of LAMMPS where it was measured; ratios are of runs of the same round."""
    rates = {key: [run.rate for run in found] for key, found in runs.items()}
    lines = []
    for row in wanted:
        bed = row.bed
        ours, theirs = (rates.get((name, bed), []) for name in (TALCUM, LAMMPS))
        alone = [rates.get((name, replace(row.beside, ranks=1)), []) for name in (TALCUM, LAMMPS)]
        efficiencies = [efficiency(of_bed, of_beside, bed.ranks) for of_bed, of_beside in zip((ours, theirs), alone)]
        beside = runs.get((TALCUM, replace(row.beside, ranks=1)), [])
        at_median = efficiency(median_rates(runs[TALCUM, bed]), median_rates(beside), bed.ranks)
        of_copies = ratio(rates.get((COPIES, bed), []), alone[0])
        waiting = median(run.stages.get("decide (wait)", 0.0) for run in runs[TALCUM, bed])
        lines.append([bed.name, str(bed.ranks), f"{median(ours):.2f}", f"{median(ours) / bed.ranks:.2f}", row.beside.name,
                      rounded(efficiencies[0]), rounded(at_median), rounded(of_copies), f"{100.0 * waiting:.1f} %",
                      rounded(efficiencies[1]), rounded(ratio(ours, theirs))])  # fmt: skip
    head = ["bed", "ranks", "million particle-steps/s", "per rank", "beside, on one rank", "efficiency",
            "at the median step", "of copies", "waiting to decide", f"efficiency of {LAMMPS}", f"to {LAMMPS}"]  # fmt: skip
    return table(head, lines)


def scaling(rounds: int, first: bool, with_peers: bool) -> str:
    """A table of rates and efficiencies, and a sentence on the digests."""
    wanted = rows(os.cpu_count() or 1)
    measured = scaling_table(wanted, measure(wanted, rounds, first, with_peers))
    same = f"On {', '.join(map(str, RANKS))} ranks, {STEPS_OF_DIGESTS} steps of the bed of 24,000 end with one digest,"
    return f"{measured}\n\n{same} `{digests()}`."
