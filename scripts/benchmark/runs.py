"""Starts a program on chosen cores and reads rate, stages and memory off what it says."""

from __future__ import annotations

import os
import re
import resource
import shutil
import subprocess
import tempfile
import time
from dataclasses import asdict, dataclass, field
from pathlib import Path
from statistics import median
from typing import Callable

from .beds import ROOT

# A run that got less of its cores than this shared them with others: it is measured again.
LEAST_SHARE = 0.93
ATTEMPTS = 3
# Seconds between looks at the memory of a process.
POLL = 0.1


class BenchmarkError(Exception):
    """What went wrong, in words for the user."""


@dataclass
class Measured:
    """One run of one program on one bed."""

    rate: float  # million particle-steps per second, of all ranks
    share_of_cores: float = 1.0
    largest_memory: float = 0.0  # bytes, of the largest process
    usual_memory: float = 0.0  # bytes, in the steps, of the process started
    stages: dict[str, float] = field(default_factory=dict)  # name: share of time
    imbalance: dict[str, float] = field(default_factory=dict)  # name: largest over mean
    digest: str = ""

    def as_dict(self) -> dict[str, object]:
        """For a JSON file."""
        return asdict(self)


@dataclass
class Finished:
    """What a process said, and what it used."""

    words: str
    share_of_cores: float
    largest_memory: float
    usual_memory: float


def environment(ranks: int) -> dict[str, str]:
    """Open MPI refuses root, and more ranks than cores, unless it is told that this is meant; one thread each."""
    more = {"OMP_NUM_THREADS": "1", "RUST_LOG": "info"}
    if os.getuid() == 0:
        more |= {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
        more |= {"PRTE_ALLOW_RUN_AS_ROOT": "1", "PRTE_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    if ranks > (os.cpu_count() or 1):
        more |= {"OMPI_MCA_rmaps_base_oversubscribe": "1", "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe"}
    return os.environ | more


# Highest priority for a rank, in its session too, if this user may: some launchers give each rank a session.
GO_FIRST = ["nice", "-n", "-20", "sh", "-c", 'echo -20 2>/dev/null >/proc/self/autogroup; exec "$0" "$@"']


def on_cores(
    command: list[str], ranks: int, first: bool = False, launcher: str = "mpirun", place: str = "--bind-to core"
) -> list[str]:
    """The command on `ranks` cores: one rank without a launcher, on the first core; `first` before other users."""
    if first:
        command = [*GO_FIRST, *command]
    cores = sorted(os.sched_getaffinity(0))
    if ranks == 1:
        return ["taskset", "-c", str(cores[0]), *command]
    if ranks > len(cores):
        place = ""
    return [launcher, "-n", str(ranks), *place.split(), *command]


def execute(command: list[str], ranks: int = 1) -> Finished:
    """Runs a command to its end, and keeps what it says."""
    with tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as said:
        begin = time.monotonic()
        streams = {"stdin": subprocess.DEVNULL, "stdout": said, "stderr": said}
        process = subprocess.Popen(command, **streams, cwd=ROOT, env=environment(ranks), start_new_session=True)
        memory, status, used = watch(process.pid)
        process.returncode = os.waitstatus_to_exitcode(status)
        elapsed = time.monotonic() - begin
        said.seek(0)
        words = said.read()
    if process.returncode != 0:
        raise BenchmarkError(f"{' '.join(command)}: ended with {process.returncode}\n{words[-2000:]}")
    share = (used.ru_utime + used.ru_stime) / (elapsed * ranks)
    return Finished(words, share, used.ru_maxrss * 1024.0, memory)


def watch(pid: int) -> tuple[float, int, resource.struct_rusage]:
    """Waits for a process; its memory after the start and before the end, its status, and what it used."""
    seen = []
    while True:
        done, status, used = os.wait4(pid, os.WNOHANG)
        if done:
            # Between its middle and its last tenth a program that is measured does its steps.
            steps = seen[len(seen) // 2 : max(len(seen) * 9 // 10, len(seen) // 2 + 1)]
            return (median(steps) if steps else 0.0), status, used
        try:
            resident = Path(f"/proc/{pid}/statm").read_text(encoding="ascii").split()[1]
            seen.append(float(resident) * resource.getpagesize())
        except (OSError, IndexError):
            pass
        time.sleep(POLL)


STAGE_LINE = re.compile(r"^(?P<name>\S.*?)\s+[\d.]+\s+(?P<share>[\d.]+) %\s+(?P<imbalance>[\d.]+)$", re.MULTILINE)
STAGE_END = re.compile(r'stage "[^"]*" ends: (\d+) steps, ([\d.]+) million particle-steps/s')


def read_talcum(words: str) -> Measured:
    """Rate, stages and digest of the end of a run; the rate is that of the last stage, without its set-up."""
    rates = STAGE_END.findall(words)
    digest = re.search(r"^digest (\w+)$", words, re.MULTILINE)
    if not rates or not digest:
        raise BenchmarkError(f"talcum did not say its rate:\n{words[-2000:]}")
    rows = STAGE_LINE.findall(words)
    return Measured(
        rate=float(rates[-1][1]),
        stages={name: float(share) / 100.0 for name, share, _ in rows},
        imbalance={name: float(imbalance) for name, _, imbalance in rows},
        digest=digest[1],
    )


LOOP = re.compile(r"Loop time of ([\d.eE+-]+) on \d+ procs for (\d+) steps with (\d+) atoms")


def read_peer(words: str) -> Measured:
    """Rate of the last `run` of LAMMPS or LIGGGHTS."""
    loops = LOOP.findall(words)
    if not loops:
        raise BenchmarkError(f"no loop time in what the program said:\n{words[-2000:]}")
    seconds, steps, atoms = loops[-1]
    return Measured(rate=int(steps) * int(atoms) / float(seconds) * 1.0e-6)


def measured(
    read: Callable[[str], Measured], command: list[str], ranks: int, fresh: Path | None = None
) -> Measured:
    """Runs and reads; again if others took the cores, at most three times; the attempt with most of them counts.

    The folder `fresh` is removed before each attempt.
    """
    best: Measured | None = None
    for _ in range(ATTEMPTS):
        if fresh:
            shutil.rmtree(fresh, ignore_errors=True)
        finished = execute(command, ranks)
        result = read(finished.words)
        result.share_of_cores = finished.share_of_cores
        result.largest_memory, result.usual_memory = finished.largest_memory, finished.usual_memory
        if best is None or result.share_of_cores > best.share_of_cores:
            best = result
        if result.share_of_cores >= LEAST_SHARE:
            break
    assert best is not None
    return best
