"""Measurements as tables in Markdown, and their places in docs/performance-tables.md."""

from __future__ import annotations

import os
import platform
import re
import subprocess
from pathlib import Path
from statistics import median
from typing import Any

from .beds import BEDS, ROOT, Bed
from .runs import Measured

# Runs of one bed by program: [{"rate": ..., ...}, ...], one of each program in each round.
Runs = dict[str, list[dict[str, Any]]]
# The peer that ratios are taken to: compiled for the processor.
TALCUM, LAMMPS = "Talcum", "LAMMPS native"
SMALL, LARGE = "24,000 settled", "216,000 settled"


def rates(runs: Runs, program: str) -> list[float]:
    """Rates of a program, round by round."""
    return [run["rate"] for run in runs.get(program, [])]


def ratio(above: list[float], below: list[float]) -> float | None:
    """Median of the ratios of runs of the same round."""
    ratios = [a / b for a, b in zip(above, below)]
    return median(ratios) if ratios else None


def efficiency(rates_on_ranks: list[float], alone: list[float], ranks: int) -> float | None:
    """Rate per rank over the rate on one rank."""
    gained = ratio(rates_on_ranks, alone)
    return None if gained is None else gained / ranks


def median_rates(runs: list[Measured]) -> list[float]:
    """Rates at the median step, round by round, which steps that other programs disturb do not change; none if no run tells it."""
    return [run.median_rate for run in runs if run.median_rate is not None]


def rounded(number: float | None, digits: int = 2) -> str:
    """A number for a table; a dash if there is none."""
    return "-" if number is None else f"{number:.{digits}f}"


def table(head: list[str], rows: list[list[str]]) -> str:
    """A table in Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def rate_table(beds: list[Bed], results: dict[str, Runs]) -> str:
    """Million particle-steps per second of each program, medians, and the ratios aimed at."""
    programs = [name for name in dict.fromkeys(name for runs in results.values() for name in runs) if name != TALCUM]
    rows = []
    for bed in beds:
        runs = results[bed.name]
        ours = rates(runs, TALCUM)
        cells = [median(ours), median(ours) / bed.ranks]
        cells += [median(rates(runs, name)) if name in runs else None for name in programs]
        to_lammps = ratio(ours, rates(runs, LAMMPS))
        beside = f"{rounded(ratio(ours, rates(results.get(bed.beside or '', {}), TALCUM)))}" if bed.beside else "-"
        aim = f"{bed.aim}" if bed.aim else "-"
        rows.append([bed.name, *map(rounded, cells), rounded(to_lammps), aim, beside])
    head = ["bed", TALCUM, "per core", *programs, f"to {LAMMPS}", "aim", "to its other bed"]
    return table(head, rows)


def stage_table(beds: list[Bed], results: dict[str, Runs]) -> str:
    """Shares of the stages of Talcum's step in per cent, medians over the runs, and the largest imbalance."""
    names = list(results[beds[0].name][TALCUM][0]["stages"])
    rows = []
    for bed in beds:
        runs = results[bed.name][TALCUM]
        shares = [100.0 * median(run["stages"].get(name, 0.0) for run in runs) for name in names]
        work = "contact forces"
        imbalance = median(run["imbalance"].get(work, 1.0) for run in runs)
        rows.append([bed.name, *(rounded(share, 1) for share in shares), rounded(imbalance)])
    return table(["bed", *names, "imbalance of contacts"], rows)


def memory_table(results: dict[str, Runs]) -> str:
    """Bytes per particle: how the memory of a process grows from 24,000 to 216,000 particles."""
    counts = {bed.name: bed.particles for bed in BEDS}
    small, large = results.get(SMALL, {}), results.get(LARGE, {})

    def growth(name: str, key: str) -> str:
        used = [median(run[key] for run in runs[name]) for runs in (small, large)]
        return f"{(used[1] - used[0]) / (counts[LARGE] - counts[SMALL]):.0f}"

    rows = [[name, growth(name, "usual_memory"), growth(name, "largest_memory")] for name in large if name in small]
    return table(["program", "bytes per particle in the steps", "at most"], rows) if rows else ""


def machine() -> dict[str, Any]:
    """Processor, cores, compiler and commit."""
    processor = platform.processor() or platform.machine()
    try:
        found = re.search(r"model name\s*:\s*(.*)", Path("/proc/cpuinfo").read_text(encoding="utf-8"))
        processor = found[1] if found else processor
    except OSError:
        pass
    return {
        "processor": processor,
        "cores": os.cpu_count(),
        "vectors": vector_width(),
        "rust": said_by("rustc", "--version"),
        "commit": said_by("git", "describe", "--always", "--dirty", "--abbrev=10"),
    }


def vector_width() -> str:
    """The widest vector instructions of this processor."""
    try:
        flags = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        return "unknown"
    return next((name for name in ("avx512f", "avx2", "asimd", "sse2") if re.search(rf"\b{name}\b", flags)), "none")


def said_by(*command: str) -> str:
    """A program's text about itself, or nothing."""
    try:
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
        return done.stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


def write_between_markers(path: Path, name: str, words: str) -> None:
    """Puts words between `<!-- NAME -->` and `<!-- end of NAME -->` of a file."""
    text = path.read_text(encoding="utf-8")
    begin, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->"
    before, found, rest = text.partition(begin)
    _, ended, after = rest.partition(end)
    if not found or not ended:
        raise ValueError(f"{path} has no place for the table '{name}'")
    path.write_text(f"{before}{begin}\n{words.strip()}\n\n{end}{after}", encoding="utf-8")
