"""Starts a program on chosen cores, and reads rate, stages and memory from its output."""

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

# A run that got less than this part of the time in which it could run has shared its cores.
LEAST_SHARE = 0.97
ATTEMPTS = 3
# Seconds between samples of the memory of a process.
POLL = 0.1


class BenchmarkError(Exception):
    """An error, with a message for the user."""


@dataclass
class Measured:
    """One run of one program on one bed."""

    rate: float  # million particle-steps per second, of all ranks
    median_rate: float | None = None  # the same at the median step, if the program prints it
    share_of_cores: float = 1.0
    largest_memory: float = 0.0  # bytes, of the largest process
    usual_memory: float = 0.0  # bytes, in the steps, of the process started
    stages: dict[str, float] = field(default_factory=dict)  # name: share of time
    imbalance: dict[str, float] = field(default_factory=dict)  # name: largest over mean
    digest: str = ""

    def as_dict(self) -> dict[str, object]:
        """The run as a dict for a JSON file."""
        return asdict(self)


@dataclass
class Finished:
    """The output of a process, and the resources that it used."""

    words: str
    share_of_cores: float
    largest_memory: float
    usual_memory: float


def environment(ranks: int) -> dict[str, str]:
    """Open MPI refuses root, and more ranks than cores, unless a variable says that this is meant; one thread each."""
    more = {"OMP_NUM_THREADS": "1", "RUST_LOG": "info"}
    if os.getuid() == 0:
        more |= {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
        more |= {"PRTE_ALLOW_RUN_AS_ROOT": "1", "PRTE_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    if ranks > (os.cpu_count() or 1):
        more |= {"OMPI_MCA_rmaps_base_oversubscribe": "1", "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe"}
    return os.environ | more


# Highest priority for a rank, in its session too, if this user may: some launchers give each rank a session.
GO_FIRST = ["nice", "-n", "-20", "sh", "-c", 'echo -20 2>/dev/null >/proc/self/autogroup; exec "$0" "$@"']


def on_cores(command: list[str], ranks: int, first: bool = False, core: int = 0) -> list[str]:
    """The command on `ranks` cores: one rank without a launcher, on the core of this number; `first` before other users."""
    if first:
        command = [*GO_FIRST, *command]
    cores = sorted(os.sched_getaffinity(0))
    if ranks == 1:
        return ["taskset", "-c", str(cores[core]), *command]
    place = ["--bind-to", "core"] if ranks <= len(cores) else []
    return ["mpirun", "-n", str(ranks), *place, *command]


def execute(command: list[str], ranks: int = 1) -> Finished:
    """Runs a command to its end, and keeps its output."""
    with tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as said:
        streams = {"stdin": subprocess.DEVNULL, "stdout": said, "stderr": said}
        process = subprocess.Popen(command, **streams, cwd=ROOT, env=environment(ranks), start_new_session=True)
        seen, status, used = watch(process.pid)
        process.returncode = os.waitstatus_to_exitcode(status)
        said.seek(0)
        words = said.read()
    if process.returncode != 0:
        raise BenchmarkError(f"{' '.join(command)}: ended with {process.returncode}\n{words[-2000:]}")
    return Finished(words, seen.share_of_cores, used.ru_maxrss * 1024.0, seen.usual_memory)


@dataclass
class Watched:
    """Observations of a process and its descendants while they run."""

    # Nanoseconds that each has run, and waited for a core.
    ran: dict[int, tuple[int, int]] = field(default_factory=dict)
    memory: list[float] = field(default_factory=list)

    def look(self, pid: int) -> None:
        """Takes one more sample."""
        largest = 0.0
        for each in (pid, *descendants(pid)):
            try:
                ran, waited, _ = Path(f"/proc/{each}/schedstat").read_text(encoding="ascii").split()
                resident = Path(f"/proc/{each}/statm").read_text(encoding="ascii").split()[1]
            except (OSError, ValueError, IndexError):
                continue  # it has ended
            self.ran[each] = (int(ran), int(waited))
            largest = max(largest, float(resident) * resource.getpagesize())
        self.memory.append(largest)

    @property
    def share_of_cores(self) -> float:
        """The time that the processes ran, divided by the time in which they could run."""
        ran, waited = (sum(times) for times in zip(*self.ran.values())) if self.ran else (0, 0)
        return ran / (ran + waited) if ran else 1.0

    @property
    def usual_memory(self) -> float:
        """Bytes between the middle and the last tenth, where a program that is measured does its steps."""
        count = len(self.memory)
        steps = self.memory[count // 2 : max(count * 9 // 10, count // 2 + 1)]
        return median(steps) if steps else 0.0


def descendants(pid: int) -> list[int]:
    """Children, their children and so on: launchers start ranks that way."""
    try:
        words = Path(f"/proc/{pid}/task/{pid}/children").read_text(encoding="ascii")
    except OSError:
        return []
    children = [int(word) for word in words.split()]
    return children + [each for child in children for each in descendants(child)]


def watch(pid: int) -> tuple[Watched, int, resource.struct_rusage]:
    """Waits for a process, and returns the observations, its status and its resources."""
    seen = Watched()
    while True:
        done, status, used = os.wait4(pid, os.WNOHANG)
        if done:
            return seen, status, used
        seen.look(pid)
        time.sleep(POLL)


STAGE_LINE = re.compile(r"^(?P<name>\S.*?)\s+[\d.]+\s+(?P<share>[\d.]+) %\s+(?P<imbalance>[\d.]+)$", re.MULTILINE)
STAGE_END = re.compile(
    r'stage "[^"]*" ends: \d+ steps, ([\d.]+) million particle-steps/s(?:, ([\d.]+) at the median step)?'
)


def read_talcum(words: str) -> Measured:
    """Rate, stages and digest of the end of a run; the rate is that of the last stage, without its set-up."""
    rates = STAGE_END.findall(words)
    digest = re.search(r"^digest (\w+)$", words, re.MULTILINE)
    if not rates or not digest:
        raise BenchmarkError(f"talcum did not print its rate:\n{words[-2000:]}")
    rows = STAGE_LINE.findall(words)
    return Measured(
        rate=float(rates[-1][0]),
        median_rate=float(rates[-1][1]) if rates[-1][1] else None,
        stages={name: float(share) / 100.0 for name, share, _ in rows},
        imbalance={name: float(imbalance) for name, _, imbalance in rows},
        digest=digest[1],
    )


LOOP = re.compile(r"Loop time of ([\d.eE+-]+) on \d+ procs for (\d+) steps with (\d+) atoms")


def read_peer(words: str) -> Measured:
    """Rate of the last `run` of LAMMPS or LIGGGHTS."""
    loops = LOOP.findall(words)
    if not loops:
        raise BenchmarkError(f"no loop time in the program's output:\n{words[-2000:]}")
    seconds, steps, atoms = loops[-1]
    return Measured(rate=int(steps) * int(atoms) / float(seconds) * 1.0e-6)


def measured(
    read: Callable[[str], Measured], command: list[str], ranks: int, fresh: Path | None = None
) -> Measured:
    """Runs a program and reads its output. If others share the core, the rate is per second of the core's time, since one rank never waits.

    Several ranks do wait for each other, so a run of theirs that lacked cores is tried again; the best attempt counts.
    The folder `fresh` is removed after each.
    """
    best: Measured | None = None
    for _ in range(ATTEMPTS if ranks > 1 else 1):
        finished = execute(command, ranks)
        if fresh:
            shutil.rmtree(fresh, ignore_errors=True)
        result = read(finished.words)
        result.share_of_cores = finished.share_of_cores
        result.largest_memory, result.usual_memory = finished.largest_memory, finished.usual_memory
        if ranks == 1 and result.share_of_cores < LEAST_SHARE:
            result.rate /= result.share_of_cores
        if best is None or result.share_of_cores > best.share_of_cores:
            best = result
        if result.share_of_cores >= LEAST_SHARE:
            break
    assert best is not None
    return best
