"""Starts Talcum, with or without faults, and compares its results."""

from __future__ import annotations

import os
import random
import resource
import shutil
import signal
import subprocess
import time
from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
SMOKE = ROOT / "cases" / "smoke"
# Nothing may take longer: a run of a smoke case takes a second.
PATIENCE = 60.0
# An error or a death on one rank must end all ranks within this time.
END = 30.0
# The factor on these times on a machine that does other work.
TIMES = [1.0]
# Every kind of file that a bed without gas writes, often.
OFTEN = ["output.series=0.005", "output.walls=0.01", "output.energy=0.01", "output.profiles=0.01", "output.particles=0.02",
         "checkpoint.every_steps=60", "checkpoint.keep=2"]  # fmt: skip
MEASURES = """
[measure.coordination]
kind = "coordination"
every = 0.005
average = 0.02
[measure.contacts]
kind = "contacts"
every = 0.02
write = 0.02
"""
# Ends the name of an outcome that is printed but does not count as an attempt.
NOT_COUNTED = " (not counted)"
# The transports that one machine needs: a start takes a tenth of a second instead of half of one.
QUICK_START = {"OMPI_MCA_pml": "ob1", "OMPI_MCA_btl": "self,vader", "OMPI_MCA_ess_singleton_isolated": "1",
               "OMPI_MCA_plm": "isolated", "PMIX_MCA_gds": "hash"}  # fmt: skip
# No attempt's bed needs more: a process beyond this limit uses memory without bound.
MOST_MEMORY = 4 << 30


class Broken(Exception):
    """An error of the program, with what is needed to repeat it."""


@dataclass
class Context:
    """State that all attempts share."""

    program: Path
    library: Path
    folder: Path
    random: random.Random
    # Starts ranks, followed by their number; and the share of runs that are started without it.
    launcher: tuple[str, ...] = ("mpirun", "--bind-to", "none", "-n")
    alone: float = 0.9
    references: dict[str, "Reference"] = field(default_factory=dict)
    case_reader: object = None
    server: object = None
    # The actions on the present run, so that they can be repeated.
    history: list[str] = field(default_factory=list)

    def new_folder(self) -> Path:
        """An empty folder of its own for an attempt."""
        path = self.folder / f"{self.random.getrandbits(48):012x}"
        path.mkdir(parents=True)
        return path


@dataclass
class Reference:
    """The results of an uninterrupted run."""

    digest: str
    tables: dict[str, object]


@dataclass
class Ended:
    """How a call of the program ended; the code is None if it did not end in time."""

    code: int | None
    output: str
    errors: str
    seconds: float

    @property
    def digest(self) -> str:
        """The digest in the last line, or nothing."""
        last = self.output.strip().rsplit("\n", 1)[-1]
        return last.removeprefix("digest ") if last.startswith("digest ") else ""


def environment(more: dict[str, str]) -> dict[str, str]:
    """Ranks that wait leave their core to others: there may be more ranks than cores."""
    settings = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
                "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_mpi_yield_when_idle": "1"}  # fmt: skip
    return {**os.environ, "RUST_LOG": "info", **settings, **QUICK_START, **more}


def few_ranks(context: "Context", alone: float | None = None) -> int:
    """Returns 0 (without mpirun) with a given probability, by default that of all attempts, otherwise 1, 2 or 3."""
    share = context.alone if alone is None else alone
    return 0 if context.random.random() < share else context.random.choice([1, 2, 2, 3])


def command(context: Context, ranks: int, arguments: list[str]) -> list[str]:
    """Runs alone if the number of ranks is 0, otherwise under mpirun."""
    launcher = [*context.launcher, str(ranks)] if ranks else []
    return [*launcher, str(context.program), *arguments]


def start(context: Context, ranks: int, arguments: list[str], more: dict[str, str]) -> subprocess.Popen[bytes]:
    """Starts a process in a group of its own, so that all of it can be ended."""
    pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    line = command(context, ranks, arguments)
    if more:
        # Set for the ranks alone: mpirun itself must stay whole.
        at = len(line) - len(arguments) - 1
        line = [*line[:at], "env", *(f"{name}={value}" for name, value in more.items()), *line[at:]]
    before = None if ranks else limit_memory
    return subprocess.Popen(line, env=environment({}), start_new_session=True, preexec_fn=before, **pipes)


def wait(process: subprocess.Popen[bytes], patience: float = PATIENCE) -> Ended:
    """Waits for the end; ends it if it takes too long. Seconds in which this process was stopped do not count."""
    began = time.monotonic()
    output, errors, code = b"", b"", None
    patience *= TIMES[0]
    for second in range(1, int(patience) + 1):
        try:
            output, errors = process.communicate(timeout=1.0)
            code = process.returncode
            break
        except subprocess.TimeoutExpired:
            if second == int(patience):  # it has had all of its time
                os.killpg(process.pid, signal.SIGKILL)
                output, errors = process.communicate()
    # A stream that was not a pipe gives nothing.
    text = [(part or b"").decode(errors="replace") for part in (output, errors)]
    return Ended(code, *text, time.monotonic() - began)


def limit_memory() -> None:
    """Limits the memory of a new process, in which it is called."""
    resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))


def run(context: Context, ranks: int, arguments: list[str], more: dict[str, str] | None = None) -> Ended:
    """Starts and waits."""
    return wait(start(context, ranks, arguments, more or {}))


def children(process: int) -> list[int]:
    """The processes that a process has started and those that these have started."""
    found = []
    for task in Path(f"/proc/{process}/task").glob("*/children"):
        try:
            for child in task.read_text().split():
                found += [int(child), *children(int(child))]
        except OSError:
            pass
    return found


def ranks_of(process: subprocess.Popen[bytes]) -> list[int]:
    """The processes of the program itself."""
    def name(number: int) -> str:
        try:
            return Path(f"/proc/{number}/comm").read_text().strip()
        except OSError:
            return ""
    return [number for number in [process.pid, *children(process.pid)] if name(number) == "talcum"]


def case_file(context: Context, case: str) -> Path:
    """A smoke case with instruments."""
    path = context.folder / f"{case}.toml"
    if not path.exists():
        path.write_text((SMOKE / path.name).read_text(encoding="utf-8") + MEASURES, encoding="utf-8")
    return path


def case_arguments(context: Context, case: str, folder: Path, until: float) -> list[str]:
    """A run of a smoke case with all outputs."""
    often = [argument for key in OFTEN for argument in ("--set", key)]
    return ["run", str(case_file(context, case)), "--output", str(folder), "--until", repr(until), *often]


def tables(folder: Path) -> dict[str, object]:
    """The rows of all results: text of the tables, numbers of every dataset."""
    found: dict[str, object] = {}
    for path in sorted(folder.glob("*.csv")):
        lines = path.read_text(encoding="utf-8").splitlines()
        found[path.name] = [line for line in lines if not line.startswith("#")]
    for path in sorted(folder.glob("*.h5")) + sorted(folder.glob("*.vtkhdf")):
        if path.name.startswith("checkpoint-"):
            continue
        with h5py.File(path, "r", locking=False) as file:
            def visit(name: str, item: object, of: str = path.name) -> None:
                if isinstance(item, h5py.Dataset):
                    found[f"{of}/{name}"] = item[()]
            file.visititems(visit)
    return found


def different(one: dict[str, object], other: dict[str, object]) -> list[str]:
    """Names of tables that are not the same, bit by bit."""
    def same(a: object, b: object) -> bool:
        if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
            return a.shape == b.shape and a.tobytes() == b.tobytes()
        return type(a) is type(b) and a == b
    return [name for name in sorted(one.keys() | other.keys()) if not same(one.get(name), other.get(name))]


def reference(context: Context, case: str, until: float) -> Reference:
    """The results of a run without interruption, made once."""
    key = f"{case} {until}"
    if key not in context.references:
        folder = context.new_folder()
        ended = run(context, 0, case_arguments(context, case, folder, until))
        if ended.code != 0:
            raise Broken(f"{case} does not run: {ended.errors}")
        context.references[key] = Reference(ended.digest, tables(folder))
        shutil.rmtree(folder)
    return context.references[key]


def require_the_same(context: Context, case: str, until: float, folder: Path, ended: Ended) -> None:
    """Digest and all rows must be those of a run without interruption."""
    expected = reference(context, case, until)
    if ended.code != 0 or ended.digest != expected.digest:
        raise Broken(f"{folder}: code {ended.code}, digest {ended.digest or 'none'} instead of {expected.digest}:"
                     f" {ended.errors[-2000:]}")  # fmt: skip
    wrong = different(tables(folder), expected.tables)
    if wrong:
        raise Broken(f"{folder}: other rows in {', '.join(wrong)}")


def require_decent_end(ended: Ended, what: str) -> None:
    """Checks that a run ended in time, with an exit code and no panic."""
    if ended.code is None:
        raise Broken(f"{what}: no end within {PATIENCE} s: {ended.errors[-2000:]}")
    if "panicked" in ended.errors or ended.code in (101, 139, 134, -11, -6):
        raise Broken(f"{what}: code {ended.code}: {ended.errors[-2000:]}")
