"""Kills at random instants and at calls, calls that fail, two runs in one folder."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import time
from pathlib import Path
from random import Random

from .program import (END, NOT_COUNTED, Broken, Context, Ended, case_arguments, few_ranks, ranks_of, reference,
                      require_decent_end, require_the_same, run, start, wait)  # fmt: skip

# Some hundred to two thousand steps, one checkpoint in sixty.
CASES = {"walls": 0.4, "rank-equality": 0.2, "polydisperse": 0.1}
MOST_INTERRUPTIONS = 25
# Errors of the system: no space, quota, input/output; 0 kills the process at the call.
ERRORS = {"no space": 28, "quota": 122, "input/output": 5}
CALLS = ["write", "sync", "rename", "cut", "open", "read"]
FILES = ["checkpoint-", "series.csv", "energy.csv", "profiles.h5", "particles.vtkhdf", "measure-", ".metadata", "case.toml",
         "complete"]  # fmt: skip
# Calls that go well before one fails, in the mean; of those that write or read there are more.
MEAN_CALLS = {True: [3.0, 20.0, 60.0], False: [1.0, 3.0, 10.0]}
# Up to so many seconds after a run has begun in its folder: a few writes, a checkpoint, or several.
DELAYS = [0.01, 0.05, 0.2]


def campaign(context: Context, interrupt) -> dict[str, int]:
    """Interrupts a run until it is complete, on other ranks each time; then compares its results."""
    case, until = context.random.choice(list(CASES.items()))
    reference(context, case, until)
    folder = context.new_folder()
    arguments = [*case_arguments(context, case, folder, until), "--resume"]
    context.history.clear()
    counts = {"campaigns, each compared with an uninterrupted run" + NOT_COUNTED: 1}
    for _ in range(context.random.randint(1, MOST_INTERRUPTIONS)):
        how, is_through = interrupt(context, folder, arguments)
        counts[how] = counts.get(how, 0) + 1
        if is_through:
            break
    ended = run(context, few_ranks(context), arguments)
    try:
        require_the_same(context, case, until, folder, ended)
    except Broken as error:
        raise Broken(f"{error}; {' '.join(arguments)} after: {'; '.join(context.history)}") from error
    shutil.rmtree(folder)
    return counts


def wait_for_beginning(process: subprocess.Popen[bytes], folder: Path) -> bool:
    """Waits until the run has locked its folder; returns False if it ends before."""
    def owner() -> str:
        try:
            return (folder / "running").read_text(encoding="utf-8")
        except OSError:
            return ""
    before, deadline = owner(), time.monotonic() + END
    while owner() in ("", before):
        if process.poll() is not None or time.monotonic() > deadline:
            return False
        time.sleep(0.001)
    return True


def kill(context: Context, folder: Path, arguments: list[str]) -> tuple[str, bool]:
    """SIGKILL of one rank, of all, or of everything, at a random instant."""
    random = context.random
    ranks = few_ranks(context)
    process = start(context, ranks, arguments, {})
    at_work = random.random() < 0.9 and wait_for_beginning(process, folder)
    time.sleep(random.uniform(0.0, random.choice(DELAYS)))
    if process.poll() is not None:
        return "runs that ended before they were killed" + NOT_COUNTED, True
    whom = random.choice(["one rank", "all ranks", "everything"]) if ranks else "a run alone"
    all_ranks = ranks_of(process)
    strike(process, whom, all_ranks, random)
    context.history.append(f"{whom} killed on {ranks} ranks")
    ended = wait(process, END)
    if ended.code is None or not have_ended(all_ranks):
        raise Broken(f"no end within {END} s after a kill of {whom}: {' '.join(arguments)}")
    if ended.code == 0:
        return "runs that ended before they were killed" + NOT_COUNTED, True
    return f"kills of {whom}{'' if at_work else ', while it started'}", False


def strike(process: subprocess.Popen[bytes], whom: str, all_ranks: list[int], random: Random) -> None:
    """Kills one rank, all, or mpirun and whatever belongs to its group."""
    if whom == "everything" or not all_ranks:
        os.killpg(process.pid, signal.SIGKILL)
        return
    for victim in [random.choice(all_ranks)] if whom == "one rank" else all_ranks:
        try:
            os.kill(victim, signal.SIGKILL)
        except ProcessLookupError:
            pass


def have_ended(processes: list[int]) -> bool:
    """Whether all have ended within a short time."""
    deadline = time.monotonic() + END
    while any(Path(f"/proc/{process}").exists() for process in processes):
        if time.monotonic() > deadline:
            return False
        time.sleep(0.005)
    return True


def kills(context: Context) -> dict[str, int]:
    """Kills at random instants."""
    return campaign(context, kill)


def at_call(context: Context, folder: Path, arguments: list[str], error: int, calls: list[str]) -> tuple[str, Ended]:
    """Makes a call of one rank or of all fail, or kills the process in it."""
    ranks = few_ranks(context)
    call = context.random.choice(calls)
    of_one_kind = context.random.random() < 0.3
    before = context.random.expovariate(1.0 / context.random.choice(MEAN_CALLS[call in ("write", "read")]))
    fault = {
        "LD_PRELOAD": str(context.library),
        "FAULT_CALL": call,
        "FAULT_PATH": context.random.choice(FILES) if of_one_kind else folder.name,
        "FAULT_FROM": str(int(before) + 1),
        "FAULT_ERROR": str(error),
    }
    if context.random.random() < 0.5:
        fault["FAULT_COUNT"] = "1"
    if context.random.random() < 0.6:
        fault["FAULT_RANK"] = str(context.random.randrange(max(ranks, 1)))
    ended = wait(start(context, ranks, arguments, fault), END)
    settings = " ".join(f"{name}={value}" for name, value in fault.items() if name != "LD_PRELOAD")
    context.history.append(f"{settings} on {ranks} ranks: code {ended.code}")
    what = f"{settings} on {ranks} ranks: {' '.join(arguments)}"
    if error:
        require_decent_end(ended, what)
        if ended.code != 0 and "error:" not in ended.errors:
            raise Broken(f"{what}: code {ended.code} without an error message: {ended.errors[-1000:]}")
    elif ended.code is None:
        raise Broken(f"{what}: no end within {END} s")
    return call, ended


def kills_at_calls(context: Context) -> dict[str, int]:
    """Kills in the middle of calls that write, rename, cut or sync."""
    def interrupt(context: Context, folder: Path, arguments: list[str]) -> tuple[str, bool]:
        call, ended = at_call(context, folder, arguments, 0, ["write", "sync", "rename", "cut"])
        if ended.code == 0:
            return "runs that did not reach the call" + NOT_COUNTED, True
        return f"kills at {call}", False
    return campaign(context, interrupt)


def faults(context: Context) -> dict[str, int]:
    """Calls that fail."""
    def interrupt(context: Context, folder: Path, arguments: list[str]) -> tuple[str, bool]:
        name, error = context.random.choice(list(ERRORS.items()))
        call, ended = at_call(context, folder, arguments, error, CALLS)
        if ended.code == 0:
            return "runs that did not reach the call, or continued after it" + NOT_COUNTED, True
        return f"{call}: {name}, an error on all ranks", False
    return campaign(context, interrupt)


def two_at_once(context: Context) -> dict[str, int]:
    """A second run in the folder of a first one is refused, and does not harm the first."""
    case, until = "walls", CASES["walls"]
    folder = context.new_folder()
    arguments = case_arguments(context, case, folder, until)
    first = start(context, context.random.choice([0, 0, 2]), arguments, {})
    wait_for_beginning(first, folder)
    second = run(context, 0, [*arguments, context.random.choice(["--resume", "--force"])])
    was_running = first.poll() is None
    ended = wait(first)
    if was_running and (second.code != 1 or "another run is writing here: process" not in second.errors):
        raise Broken(f"{folder}: a second run was not refused: {second.errors}")
    if was_running:
        require_the_same(context, case, until, folder, ended)
    shutil.rmtree(folder)
    return {"second runs refused" if was_running else "first run over too early" + NOT_COUNTED: 1}
