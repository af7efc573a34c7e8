"""The check of the model of many ranks: how long the processor computes in a step on more ranks than there are cores.

Ranks that share cores wait for each other, so wall-clock times say little. This module counts samples of what the processor
executes (`perf record`, from Debian's linux-perf): a sample in the program itself is a time of computation.
"""

from __future__ import annotations

import math
import re
import shutil
from dataclasses import replace
from pathlib import Path

from . import scaling
from .beds import BEDS, RESULTS, Bed
from .runs import BenchmarkError, execute, on_cores
from .states import state
from .tables import table
from .talcum import PROGRAM, restart

BED = next(bed for bed in BEDS if bed.name == "24,000 settled")
# Columns, as in the model.
WIDTH = 20.0  # diameters, of the box along x and y
GRIDS = {1: (1, 1, 1), 2: (2, 1, 1), 4: (2, 2, 1), 8: (4, 2, 1)}
# Steps of two runs; start and end cancel in the difference of their times.
SHORTER, LONGER = 200, 1800
# Samples per second: a prime, so that no loop of a round time is in step with it.
FREQUENCY = 1999
# A line of perf's report: share, number of samples, program or library, symbol.
LINE = re.compile(r"^\s*[\d.]+%\s*;\s*(\d+)\s*;\s*(\S+)\s*;", re.MULTILINE)


def samples(report: str, program: str) -> int:
    """How many samples of a report lie in a program."""
    found = LINE.findall(report)
    if not found:
        raise BenchmarkError(f"perf took no samples:\n{report[:2000]}")
    return sum(int(count) for count, owner in found if owner == program)


def computing(bed: Bed, start: Path, first: bool) -> float:
    """Processor time of a run in the program's own code, of all ranks together; seconds."""
    record, output = RESULTS / "perf.data", RESULTS / "processor"
    grid = ",".join(map(str, GRIDS[bed.ranks]))
    command = [*restart(bed, start, output), "--set", f"parallel.ranks=[{grid}]"]
    sampled = ["perf", "record", "-q", "-e", "cpu-clock", "-F", str(FREQUENCY), "-o", str(record)]
    execute([*sampled, *on_cores(command, bed.ranks, first)], bed.ranks)
    shutil.rmtree(output, ignore_errors=True)
    name = PROGRAM.name
    report = ["perf", "report", "-i", str(record), "--stdio", "-n", "-t", ";", "--sort", "dso,sym", "--comm", name]
    found = samples(execute(report).words, name)
    record.unlink()
    return found / FREQUENCY


def of_a_step(bed: Bed, start: Path, first: bool) -> float:
    """Processor time per step and rank, in seconds."""
    longer, shorter = (computing(replace(bed, steps=steps), start, first) for steps in (LONGER, SHORTER))
    return (longer - shorter) / (LONGER - SHORTER) / bed.ranks


def copies(ranks: int) -> float:
    """Copies that a rank has of other ranks' particles in a pair, by the model's count: half of those around its column."""
    along = GRIDS[ranks][:2]
    sides, is_cut = [WIDTH / count for count in along], [count > 1 for count in along]
    return scaling.PART_IN_PAIRS * scaling.copies_around(sides, is_cut, BED.particles / WIDTH**2)


def processor(rounds: int, first: bool) -> str:
    """A table of the time that a rank computes in a step, compared with its share of the time of a single rank."""
    if not shutil.which("perf"):
        raise BenchmarkError("perf is not installed: apt-get install linux-perf")
    start = state(BED.state, execute, PROGRAM)
    beds = [replace(BED, ranks=ranks) for ranks in GRIDS]
    # Other processes on the machine can only add to it.
    least = dict.fromkeys(GRIDS, math.inf)
    for _ in range(rounds):
        for bed in beds:
            least[bed.ranks] = min(least[bed.ranks], of_a_step(bed, start, first))
    return table_of(least)


def table_of(least: dict[int, float]) -> str:
    """The mean cost of a copy over that of a particle, from the seconds that each rank computes in a step."""
    rows = []
    for ranks, found in least.items():
        share, held = least[1] / ranks, copies(ranks)
        cost = f"{(found - share) / held * BED.particles / least[1]:.2f}" if held else "-"
        numbers = [f"{1e6 * found:.1f}", f"{1e6 * share:.1f}", f"{held:.0f}"]
        rows.append([f"{ranks}", f"{BED.particles / ranks:,.0f}", *numbers, cost])
    head = ["ranks", "particles per rank", "computes, us", "its share of one rank's", "copies", "a copy over a particle"]
    return table(head, rows)
