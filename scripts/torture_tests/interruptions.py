"""Kills at random instants and at calls, calls that fail, two runs in one folder."""

from __future__ import annotations

import os
import shutil
import signal
import time

from .program import (END, Broken, Context, case_arguments, ranks_of, reference, require_decent_end,
                      require_the_same, run, start, wait)  # fmt: skip

CASES = {"walls": 0.15, "rank-equality": 0.1, "polydisperse": 0.05}
MOST_INTERRUPTIONS = 6
# Errors of the system: no space, quota, input/output; 0 kills the process at the call.
ERRORS = {"no space": 28, "quota": 122, "input/output": 5}
CALLS = ["write", "sync", "rename", "cut", "open", "read"]
FILES = ["checkpoint-", "series.csv", "profiles.h5", "particles.vtkhdf", ".metadata", "case.toml", "complete"]


def campaign(context: Context, interrupt) -> dict[str, int]:
    """A run that is interrupted again and again, on other ranks each time, and at last let through."""
    case, until = context.random.choice(list(CASES.items()))
    reference(context, case, until)
    folder = context.new_folder()
    counts: dict[str, int] = {}
    for _ in range(context.random.randint(1, MOST_INTERRUPTIONS)):
        how = interrupt(context, [*case_arguments(case, folder, until), "--resume"])
        counts[how] = counts.get(how, 0) + 1
    ranks = context.random.choice([0, 1, 2, 3])
    ended = run(context, ranks, [*case_arguments(case, folder, until), "--resume"])
    require_the_same(context, case, until, folder, ended)
    shutil.rmtree(folder)
    return counts


def kill(context: Context, arguments: list[str]) -> str:
    """SIGKILL of one rank, of all, or of everything, at a random instant."""
    ranks = context.random.choice([0, 1, 2, 3])
    process = start(context, ranks, arguments, {})
    time.sleep(context.random.uniform(0.0, 1.5))
    victims = ranks_of(process)
    whom = context.random.choice(["one rank", "all ranks", "everything"])
    if whom == "everything":
        os.killpg(process.pid, signal.SIGKILL)
    elif victims:
        for victim in victims if whom == "all ranks" else [context.random.choice(victims)]:
            try:
                os.kill(victim, signal.SIGKILL)
            except ProcessLookupError:
                pass
    if wait(process, END).code is None:
        raise Broken(f"no end within {END} s after a kill of {whom}: {' '.join(arguments)}")
    return f"kills of {whom}"


def kills(context: Context) -> dict[str, int]:
    """Kills at random instants."""
    return campaign(context, kill)


def at_call(context: Context, arguments: list[str], error: int, calls: list[str]) -> tuple[str, int | None]:
    """Lets a call of one rank or of all fail, or die in it."""
    ranks = context.random.choice([0, 1, 2, 3])
    call = context.random.choice(calls)
    fault = {
        "LD_PRELOAD": str(context.library),
        "FAULT_CALL": call,
        "FAULT_PATH": context.random.choice(FILES),
        "FAULT_FROM": str(int(context.random.expovariate(1 / 20)) + 1),
        "FAULT_ERROR": str(error),
    }
    if context.random.random() < 0.5:
        fault["FAULT_COUNT"] = "1"
    if context.random.random() < 0.6:
        fault["FAULT_RANK"] = str(context.random.randrange(max(ranks, 1)))
    ended = wait(start(context, ranks, arguments, fault), END)
    what = f"{' '.join(f'{name}={value}' for name, value in fault.items())} on {ranks} ranks: {' '.join(arguments)}"
    if error:
        require_decent_end(ended, what)
        if ended.code != 0 and "error:" not in ended.errors:
            raise Broken(f"{what}: code {ended.code} without an error message: {ended.errors[-1000:]}")
    elif ended.code is None:
        raise Broken(f"{what}: no end within {END} s")
    return call, ended.code


def kills_at_calls(context: Context) -> dict[str, int]:
    """Kills in the middle of calls that write, rename, cut or sync."""
    def interrupt(context: Context, arguments: list[str]) -> str:
        call, _ = at_call(context, arguments, 0, ["write", "sync", "rename", "cut"])
        return f"kills at {call}"
    return campaign(context, interrupt)


def faults(context: Context) -> dict[str, int]:
    """Calls that fail."""
    def interrupt(context: Context, arguments: list[str]) -> str:
        name, error = context.random.choice(list(ERRORS.items()))
        call, code = at_call(context, arguments, error, CALLS)
        return f"{call}: {name}, {'no effect' if code == 0 else 'error'}"
    return campaign(context, interrupt)


def two_at_once(context: Context) -> dict[str, int]:
    """A second run in the folder of a first one is refused, and does it no harm."""
    case, until = "walls", CASES["walls"]
    folder = context.new_folder()
    arguments = case_arguments(case, folder, until)
    first = start(context, context.random.choice([0, 2]), arguments, {})
    deadline = time.monotonic() + 20.0
    while not (folder / "series.csv").exists() and first.poll() is None and time.monotonic() < deadline:
        time.sleep(0.001)
    second = run(context, 0, [*arguments, context.random.choice(["--resume", "--force"])])
    was_running = first.poll() is None
    ended = wait(first)
    if was_running and (second.code != 1 or "another run is writing here: process" not in second.errors):
        raise Broken(f"{folder}: a second run was not refused: {second.errors}")
    if was_running:
        require_the_same(context, case, until, folder, ended)
    shutil.rmtree(folder)
    return {"second runs refused" if was_running else "first run over too early": 1}
