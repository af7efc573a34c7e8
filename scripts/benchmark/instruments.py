"""The cost of `[measure.NAME]`, each kind alone and all at once, on the settled bed of 24,000 particles, on one rank."""

from __future__ import annotations

from statistics import median

from .beds import RESULTS, TIME_STEP
from .runs import Measured, execute, measured, on_cores, read_talcum
from .states import CASES, box_lengths, case_text, state
from .tables import table
from .talcum import PROGRAM

STATE = "settled-24000"
INTERVALS = (100, 1000)
# Looks of a run. Rows, windows and written lines follow one another after ten.
LOOKS = 20
PER_ROW = 10
# Keys of each kind besides `kind` and `every`; {row} is the time of ten samples.
KINDS = {
    "coordination": "average = {row}",
    "probe": 'at = "plane"\naxis = "z"\nposition = 10.0\naverage = {row}',
    "phase_average": "frequency = {frequency}",
    "time_average": "average = {row}",
    "mixing": "window = {row}",
    "contacts": "write = {row}",
    "stress, layers": "average = {row}",
    "stress, cells": "average = {row}\ncells = [10, 10, 55]",
    "agglomerates": "window = {row}",
}


def section(name: str, interval: int) -> str:
    """One instrument that samples every so many steps."""
    every = interval * TIME_STEP
    # Each of the 25 bins of a phase has a sample.
    keys = KINDS[name].format(row=PER_ROW * every, frequency=1.0 / (40.0 * every))
    return f'[measure.{name.replace(", ", "-")}]\nkind = "{name.split(",")[0]}"\nevery = {every}\n{keys}\n'


def case_with(names: list[str], interval: int) -> str:
    """The settled bed with these instruments."""
    box = box_lengths((CASES / "bed-24000.toml").read_text("utf-8"))
    start = f'kind = "run"\npath = "states/{STATE}.h5"'
    bed = case_text("What instruments cost", box, start, end=LOOKS * interval * TIME_STEP)
    return bed + "".join(section(name, interval) for name in names)


def run_with(names: list[str], interval: int, first: bool) -> Measured:
    """One run with these instruments."""
    case, output = RESULTS / "instruments.toml", RESULTS / "instruments"
    case.write_text(case_with(names, interval), encoding="utf-8")
    command = [str(PROGRAM), "run", str(case), "--output", str(output), "--force"]
    return measured(read_talcum, on_cores(command, 1, first), 1, output)


def share(run: Measured) -> float:
    """Time of the instruments over that of the steps, as the run itself clocks it; what it writes at its end left out."""
    sampling, writing = (run.stages.get(name, 0.0) for name in ("instruments", "output"))
    return sampling / (1.0 - sampling - writing)


def instruments(rounds: int, first: bool) -> str:
    """A table of shares, and how much slower runs with all instruments are than runs without, in pairs."""
    state(STATE, execute, PROGRAM)
    everything = list(KINDS)
    shares: dict[tuple[str, int], list[float]] = {}
    slower: dict[int, list[float]] = {interval: [] for interval in INTERVALS}
    for _ in range(rounds):
        for interval in INTERVALS:
            for name in everything:
                shares.setdefault((name, interval), []).append(share(run_with([name], interval, first)))
            without = run_with([], interval, first)
            run = run_with(everything, interval, first)
            shares.setdefault(("all at once", interval), []).append(share(run))
            slower[interval].append(without.rate / run.rate - 1.0)
    percent = lambda values: f"{100.0 * median(values):.1f}"  # noqa: E731
    rows = [[name, *(percent(shares[name, interval]) for interval in INTERVALS)] for name in (*everything, "all at once")]
    head = ["kind", *(f"every {interval} steps, per cent" for interval in INTERVALS)]
    pairs = ", ".join(f"{percent(slower[interval])} % every {interval} steps" for interval in INTERVALS)
    words = f"Medians of {rounds} rounds. Runs with all of them took longer than runs without, in alternating pairs, by"
    return f"{table(head, rows)}\n\n{words} {pairs}."
