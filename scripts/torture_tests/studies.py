"""Studies that are killed, whose calls fail, or whose results are damaged: the tables of one left alone, or an error."""

from __future__ import annotations

import os
import shutil
import signal
import time
from pathlib import Path

from .damage import damaged
from .interruptions import CALLS, END, ERRORS, have_ended
from .program import (NOT_COUNTED, SMOKE, Broken, Context, Ended, Reference, children, different, require_decent_end, run,
                      start, tables, wait)  # fmt: skip

HEAD = """title = "torture"
case = "bed.toml"
[set]
output.series = 0.005
output.profiles = 0.01
checkpoint.every_steps = 40
[measure.energy]
column = "kinetic_energy_of_mean_motion"
statistic = "mean"
[measure.top]
column = "centre_height"
statistic = "last"
"""
AXIS = '[[axis]]\nkey = "{}"\nvalues = {}\n'
STUDIES = {
    "grid": "seeds = 2\n" + HEAD + AXIS.format("particles.start.bottom", [2.0, 4.0]),
    "chain": "seeds = 1\n" + HEAD + AXIS.format("contact.friction", [0.2, 0.6]) + '[continuation]\naxis = "contact.friction"\n',
    # The middle of the bed is some two diameters above its bottom.
    "search": "seeds = 1\n" + HEAD + '[bisection]\nkey = "particles.start.bottom"\nbracket = [2.0, 4.0]\ntolerance = 1.0\n'
    'measure = "top"\nthreshold = 5.2\ndirection = "rises"\n',
}
MOST_INTERRUPTIONS = 15
# One of these is in what a study prints that is not done.
MESSAGES = ["error:", "[ERROR]", "failed", "stopped"]
# Up to so many seconds after a start: before, within and between runs, which take less than a tenth of a second each.
DELAYS = [0.02, 0.1, 0.4]
FILES = ["case.toml", "complete", "checkpoint-", "series.csv", "profiles.h5", "runs.csv", "points.csv", "searches.csv",
         "study.h5", "failed", "error.log", "output.log", "lock", "bed.toml", "study.toml"]  # fmt: skip
DAMAGED = ["series.csv", "profiles.h5", "case.toml", "complete", "failed", "runs.csv", "points.csv", "study.h5"]


def study_file(context: Context, kind: str) -> Path:
    """The file of a study, with its case beside it."""
    folder = context.folder / "studies"
    path = folder / f"{kind}.toml"
    if not path.exists():
        folder.mkdir(exist_ok=True)
        bed = (SMOKE / "walls.toml").read_text(encoding="utf-8")
        (folder / "bed.toml").write_text(bed.replace("end = 4.0", "end = 0.04"), encoding="utf-8")
        path.write_text(STUDIES[kind], encoding="utf-8")
    return path


def arguments(context: Context, kind: str, folder: Path) -> list[str]:
    """The command that makes a study; runs that failed are tried again."""
    together = str(context.random.choice([1, 2]))
    return ["study", str(study_file(context, kind)), "--output", str(folder), "--retry", "--at-a-time", together]


def own_tables(folder: Path) -> dict[str, object]:
    """The tables of a study."""
    return {path.name: path.read_text(encoding="utf-8", errors="replace") for path in sorted(folder.glob("*.csv"))}


def study_tables(folder: Path) -> dict[str, object]:
    """The tables of a study, and the rows of all its runs."""
    found = own_tables(folder)
    for run_folder in sorted((folder / "runs").iterdir()):
        found |= {f"{run_folder.name}/{name}": table for name, table in tables(run_folder).items()}
    return found


def reference(context: Context, kind: str) -> dict[str, object]:
    """The tables of a study that was left alone, made once."""
    if kind not in context.references:
        folder = context.folder / f"whole-{kind}"
        ended = run(context, 0, arguments(context, kind, folder))
        if ended.code != 0:
            raise Broken(f"the study {kind} does not run: {ended.output}{ended.errors}")
        context.references[kind] = Reference("", study_tables(folder))
    return context.references[kind].tables


def require_the_same(context: Context, kind: str, folder: Path, ended: Ended) -> None:
    """A study must end well, with the tables of one that was left alone."""
    if ended.code != 0:
        raise Broken(f"{folder}: code {ended.code}: {(ended.output + ended.errors)[-2000:]}")
    wrong = different(study_tables(folder), reference(context, kind))
    if wrong:
        raise Broken(f"{folder}: other {', '.join(wrong)}")


def campaign(context: Context, interrupt) -> dict[str, int]:
    """Interrupts a study until it is complete; then compares its tables and the rows of its runs."""
    kind = context.random.choice(sorted(STUDIES))
    reference(context, kind)
    folder = context.new_folder()
    context.history.clear()
    counts = {"campaigns, each compared with a study that was left alone" + NOT_COUNTED: 1}
    for _ in range(context.random.randint(1, MOST_INTERRUPTIONS)):
        how, is_through = interrupt(context, folder, arguments(context, kind, folder))
        counts[how] = counts.get(how, 0) + 1
        if is_through:
            break
    ended = run(context, 0, arguments(context, kind, folder))
    try:
        require_the_same(context, kind, folder, ended)
    except Broken as error:
        raise Broken(f"{error}; {kind} after: {'; '.join(context.history)}") from error
    shutil.rmtree(folder)
    return counts


def kill(context: Context, folder: Path, words: list[str]) -> tuple[str, bool]:
    """SIGKILL of a study, of one of its runs, or of both at once."""
    random = context.random
    process = start(context, 0, words, {})
    time.sleep(random.uniform(0.0, random.choice(DELAYS)))
    runs = children(process.pid)
    whom = random.choice(["a study alone", "a run of a study", "a study and its runs"]) if runs else "a study between its runs"
    victims = {"a run of a study": runs[:1], "a study and its runs": [process.pid, *runs]}.get(whom, [process.pid])
    if process.poll() is None:
        for victim in victims:
            try:
                os.kill(victim, signal.SIGKILL)
            except ProcessLookupError:
                pass
    ended = wait(process, END)
    context.history.append(f"{whom} killed: code {ended.code}")
    if ended.code is None or not have_ended([process.pid] if whom == "a study alone" else [process.pid, *victims]):
        raise Broken(f"{folder}: no end within {END} s after a kill of {whom}")
    if ended.code == 0:
        return "studies that ended before they were killed" + NOT_COUNTED, True
    return f"kills of {whom}", False


def kills(context: Context) -> dict[str, int]:
    """Kills at random instants."""
    return campaign(context, kill)


def at_call(context: Context, folder: Path, words: list[str], error: int, calls: list[str]) -> tuple[str, Ended]:
    """Makes a call of a study and of its runs fail, or kills them in it."""
    random = context.random
    call = random.choice(calls)
    fault = {
        "LD_PRELOAD": str(context.library),
        "FAULT_CALL": call,
        "FAULT_PATH": random.choice(FILES) if random.random() < 0.7 else folder.name,
        "FAULT_FROM": str(1 + int(random.expovariate(1.0 / random.choice([1.0, 5.0, 20.0])))),
        "FAULT_ERROR": str(error),
    }
    if random.random() < 0.5:
        fault["FAULT_COUNT"] = "1"
    ended = wait(start(context, 0, words, fault), END)
    settings = " ".join(f"{name}={value}" for name, value in fault.items() if name != "LD_PRELOAD")
    context.history.append(f"{settings}: code {ended.code}")
    if ended.code is None:
        raise Broken(f"{settings}: no end within {END} s: {' '.join(words)}")
    if error:
        require_decent_end(ended, f"{settings}: {' '.join(words)}")
        if ended.code != 0 and not any(word in ended.output + ended.errors for word in MESSAGES):
            raise Broken(f"{settings}: code {ended.code} without a message: {ended.output}{ended.errors}")
    return call, ended


def kills_at_calls(context: Context) -> dict[str, int]:
    """Kills in the middle of calls that write, rename, cut or sync."""
    def interrupt(context: Context, folder: Path, words: list[str]) -> tuple[str, bool]:
        call, ended = at_call(context, folder, words, 0, ["write", "sync", "rename", "cut", "open"])
        if ended.code == 0:
            return "studies that did not reach the call" + NOT_COUNTED, True
        return f"kills at {call}", False
    return campaign(context, interrupt)


def faults(context: Context) -> dict[str, int]:
    """Calls that fail."""
    def interrupt(context: Context, folder: Path, words: list[str]) -> tuple[str, bool]:
        name, error = context.random.choice(list(ERRORS.items()))
        call, ended = at_call(context, folder, words, error, CALLS)
        if ended.code == 0:
            return "studies that did not reach the call, or continued after it" + NOT_COUNTED, True
        return f"{call}: {name}, an error", False
    return campaign(context, interrupt)


def damage(context: Context) -> dict[str, int]:
    """Results of a complete study that are gone or cut short: the same tables again, or an error."""
    kind = context.random.choice(sorted(STUDIES))
    expected = reference(context, kind)
    folder = context.new_folder()
    shutil.copytree(context.folder / f"whole-{kind}", folder, dirs_exist_ok=True)
    name = context.random.choice(DAMAGED)
    runs = sorted((folder / "runs").iterdir())
    path = folder / name if (folder / name).exists() else context.random.choice(runs) / name
    before = path.read_bytes() if path.exists() else b"of no run"
    how = context.random.choice(["gone", "cut short", "damaged"])
    path.unlink(missing_ok=True)
    if how == "cut short":
        path.write_bytes(before[: context.random.randrange(len(before))])
    elif how == "damaged":
        path.write_bytes(damaged(context.random, before))
    words = arguments(context, kind, folder)
    if context.random.random() < 0.5:
        words.remove("--retry")
    ended = run(context, 0, words)
    require_decent_end(ended, f"{path} {how}")
    # A digit that was changed in a row cannot be seen; nor can rows of a whole table that are gone from its middle.
    if ended.code == 0 and how != "damaged" and "WARN" not in ended.errors:
        wrong = different(own_tables(folder), {table: text for table, text in expected.items() if "/" not in table})
        if wrong:
            raise Broken(f"{path} {how}: other {', '.join(wrong)} without a message: {ended.errors}")
    shutil.rmtree(folder)
    return {f"{name} {how}, {'an error' if ended.code else 'the same tables'}": 1}
