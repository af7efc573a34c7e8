"""Strong and weak scaling on the cores of this machine; with more ranks than cores only whether the bits agree."""

from __future__ import annotations

import os
from dataclasses import replace
from statistics import median

from .beds import BEDS, Bed
from .runs import BenchmarkError, Measured, execute
from .states import state
from .tables import table
from .talcum import PROGRAM, run_talcum

STRONG = next(bed for bed in BEDS if bed.name == "24,000 settled")
WEAK = Bed("24,000 per rank, settled", "settled-48000", 48_000, 500, 0, ranks=2)
RANKS = (1, 2, 4, 8)
# Ranks that wait for each other on shared cores are slow: fewer steps tell as much about the bits.
STEPS_OF_DIGESTS = 100


def digests() -> str:
    """The digest that all numbers of ranks end with; an error if there are several."""
    start = state(STRONG.state, execute, PROGRAM)
    found = {n: run_talcum(replace(STRONG, ranks=n, steps=STEPS_OF_DIGESTS), start, False).digest for n in RANKS}
    if len(set(found.values())) != 1:
        raise BenchmarkError(f"the number of ranks changes the result: {found}")
    return found[1]


def scaling(rounds: int, first: bool) -> str:
    """A table of rates and efficiencies, and a sentence on the digests."""
    numbers = [n for n in RANKS if n <= (os.cpu_count() or 1)]
    runs: dict[tuple[str, int], list[Measured]] = {}
    for _ in range(rounds):
        for n in numbers:
            bed = replace(STRONG, ranks=n)
            runs.setdefault((bed.name, n), []).append(run_talcum(bed, state(bed.state, execute, PROGRAM), first))
        if 2 in numbers:
            runs.setdefault((WEAK.name, 2), []).append(run_talcum(WEAK, state(WEAK.state, execute, PROGRAM), first))
    alone = median(run.rate for run in runs[STRONG.name, 1])
    rows = []
    for (name, n), found in runs.items():
        rate = median(run.rate for run in found)
        waiting = median(run.stages.get("decide (wait)", 0.0) for run in found)
        rows.append([name, str(n), f"{rate:.2f}", f"{rate / n:.2f}", f"{rate / (n * alone):.2f}",
                     f"{100.0 * waiting:.1f} %"])  # fmt: skip
    head = ["bed", "ranks", "million particle-steps/s", "per rank", "efficiency", "waiting to decide"]
    same = f"On {', '.join(map(str, RANKS))} ranks, {STEPS_OF_DIGESTS} steps of the bed of 24,000 end with one digest,"
    return f"{table(head, rows)}\n\n{same} `{digests()}`."
