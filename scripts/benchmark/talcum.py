"""Talcum itself on the beds."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from statistics import mean

import h5py

from .beds import RESULTS, ROOT, TIME_STEP, Bed
from .runs import Measured, measured, on_cores, read_talcum

# Another build of it, if the variable names one.
PROGRAM = Path(os.environ.get("TALCUM", ROOT / "target" / "release" / "talcum"))
# The stage of cases/benchmark that follows the settling, by number.
STAGE = 2


def changes(bed: Bed) -> list[str]:
    """The options that differ from the settled bed without gas and cohesion."""
    settings = [f"stage.{STAGE}.{setting}" for setting in bed.settings]
    if bed.vibration:
        # Named in the stage, so that the phase is 0 at its start.
        settings += [
            f"stage.{STAGE}.vibration.gamma={bed.vibration.gamma}",
            f"stage.{STAGE}.vibration.frequency={bed.vibration.frequency}",
            f"stage.{STAGE}.duration={bed.steps * TIME_STEP}",
        ]
    return [argument for setting in settings for argument in ("--set", setting)]


def restart(bed: Bed, state: Path, output: Path, program: Path = PROGRAM) -> list[str]:
    """The command that does the bed's steps from a checkpoint."""
    with h5py.File(state, "r", locking=False) as file:
        clock = file["clock"].attrs
        steps = int(clock["step"]) - int(clock["origin_step"])
        time_step = float(clock["time_step"])
        now = float(clock["origin_time"]) + steps * time_step
    until = repr(now + bed.steps * time_step)
    return [str(program), "restart", str(state), "--until", until, "--output", str(output), *changes(bed)]


def run_talcum(bed: Bed, state: Path, first: bool, program: Path = PROGRAM, core: int = 0) -> Measured:
    """One measured run from a checkpoint; on one rank on the core of this number."""
    output = RESULTS / f"again-{os.getpid()}-{core}"
    command = restart(bed, state, output, program)
    return measured(read_talcum, on_cores(command, bed.ranks, first, core), bed.ranks, output)


def rate_of_copies(bed: Bed, state: Path, first: bool, copies: int) -> float:
    """Mean rate of runs on one rank that go on at once, each on a core of its own, and have nothing to do with each other."""
    with ThreadPoolExecutor(copies) as pool:
        return mean(pool.map(lambda core: run_talcum(bed, state, first, core=core).rate, range(copies)))
