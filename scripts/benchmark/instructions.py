"""Instructions per particle and step of the beds on one rank, counted by Valgrind's Cachegrind: they do not depend on a clock or on other programs.

`python -m benchmark.instructions` compares three small beds with the kept counts.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import sys
from dataclasses import replace
from pathlib import Path

from .beds import BEDS, RESULTS, ROOT, Bed
from .runs import BenchmarkError, execute, on_cores
from .states import state
from .talcum import PROGRAM, restart

# Valgrind takes some fifty times as long as the processor.
PARTICLE_STEPS = 600_000
COUNTED = re.compile(r"I\s+refs:\s+([\d,]+)")


def count(bed: Bed, steps: int, start: Path, program: Path) -> int:
    """All instructions of a run of so many steps."""
    output = RESULTS / f"counted-{os.getpid()}"
    if not shutil.which("valgrind"):
        raise BenchmarkError("instructions are counted by Valgrind, which is not installed: apt-get install valgrind")
    valgrind = ["valgrind", "--tool=cachegrind", "--cache-sim=no", f"--cachegrind-out-file={os.devnull}"]
    words = execute(valgrind + restart(replace(bed, steps=steps), start, output, program)).words
    shutil.rmtree(output, ignore_errors=True)
    found = COUNTED.search(words)
    if not found:
        raise BenchmarkError(f"Valgrind counted nothing:\n{words[-2000:]}")
    return int(found[1].replace(",", ""))


def per_particle_step(bed: Bed, start: Path, program: Path = PROGRAM) -> float:
    """Instructions of a step per particle: the difference of two runs, so that start and end do not count."""
    few = max(5, PARTICLE_STEPS // bed.particles // 4)
    many = 4 * few
    counts = [count(bed, steps, start, program) for steps in (few, many)]
    return (counts[1] - counts[0]) / ((many - few) * bed.particles)


def counted(bed: Bed) -> float:
    """Instructions of a step per particle of a bed, whose state is made if it is not there."""
    return per_particle_step(bed, state(bed.state, lambda command: execute(on_cores(command, 1)), PROGRAM))


def instructions(beds: list[Bed]) -> str:
    """The table."""
    rows = ["| bed | instructions per particle and step |", "| --- | --- |"]
    for bed in beds:
        if bed.ranks == 1:
            rows.append(f"| {bed.name} | {counted(bed):.1f} |")
            print(rows[-1], flush=True)
    return "\n".join(rows)


# Counts of the build that scripts/test makes, by name of the bed.
KEPT = ROOT / "tests" / "instructions.json"
# The checks of arithmetic and of arguments in that build triple the count: 1 % of it is 3 % of what users run. Counts repeat
# to 0.1 %.
ALLOWED = 0.01


def require_kept() -> str:
    """Counts the beds of `KEPT` again, and fails if one takes more instructions than are kept there."""
    kept: dict[str, float] = json.loads(KEPT.read_text(encoding="utf-8"))
    now = {bed.name: counted(bed) for bed in BEDS if bed.name in kept}
    rows = ["| bed | instructions per particle and step | kept |", "| --- | --- | --- |"]
    rows += [f"| {name} | {now[name]:.1f} | {before:.1f} |" for name, before in kept.items()]
    table = "\n".join(rows)
    grown = [name for name, before in kept.items() if now[name] > before * (1.0 + ALLOWED)]
    if grown:
        raise BenchmarkError(
            f"{', '.join(grown)}: more than {100 * ALLOWED:.0f} % above the kept count; if a change is worth it, "
            f"its commit says why and changes {KEPT.relative_to(ROOT)}\n{table}"
        )
    return table


if __name__ == "__main__":
    try:
        print(require_kept())
    except BenchmarkError as error:
        sys.exit(f"error: {error}")
