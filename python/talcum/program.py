"""Calls of the program talcum: check a case, run it, and continue from a checkpoint."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Mapping, Union

from talcum_results import program

from .tables import ResultsError

if TYPE_CHECKING:
    from .bed import Bed

PathText = Union[str, "PathLike[str]"]
Changes = Mapping[str, Any]


class TalcumError(ResultsError):
    """The program ended with an error. The text is the program's message, with file, line and key if a case is wrong."""


def check(case: PathText, *, ranks: int = 1, threads: int | None = None, set: Changes | None = None) -> str:
    """Checks a case, and returns the program's report of what would run."""
    command = [*launch(ranks, threads), "check", *thread_words(threads), *set_words(set), *file_words(case)]
    return call(command, quiet=True)


def run(
    case: PathText,
    ranks: int = 1,
    threads: int | None = None,
    set: Changes | None = None,
    *,
    output: PathText | None = None,
    resume: bool = False,
    until: float | None = None,
    force: bool = False,
    quiet: bool = True,
) -> Bed:
    """Runs a case to its end, or to a stop by signal or wall clock, and opens its results.

    `ranks` are processes of MPI, started by mpirun; `threads` are ranks as threads of one process. `set` changes keys
    of the case: `{"time.end": 5.0}`. `output` is the folder of results, results/NAME of the case by default. `resume`,
    `until` and `force` are the program's options of these names. Without `quiet` its messages are printed as they come.
    """
    folder = named(output) if output is not None else Path("results") / Path(case).stem
    options = [f"--output={folder}"]
    options += ["--resume"] if resume else []
    options += ["--force"] if force else []
    options += until_words(until)
    options += [*thread_words(threads), *set_words(set)]
    call([*launch(ranks, threads), "run", *options, *file_words(case)], quiet)
    return opened(folder)


def restart(
    checkpoint: PathText,
    ranks: int = 1,
    threads: int | None = None,
    set: Changes | None = None,
    *,
    output: PathText | None = None,
    until: float | None = None,
    force: bool = False,
    quiet: bool = True,
) -> Bed:
    """Continues from a checkpoint, in its folder or in `output`, and opens the results; the other arguments are as for `run`."""
    folder = named(output) if output is not None else Path(checkpoint).parent
    options = [f"--output={folder}"] if output is not None else []
    options += ["--force"] if force else []
    options += until_words(until)
    options += [*thread_words(threads), *set_words(set)]
    call([*launch(ranks, threads), "restart", *options, *file_words(checkpoint)], quiet)
    return opened(folder)


def opened(folder: Path) -> Bed:
    """The results of a folder."""
    from .bed import open_bed  # which itself measures by the program

    return open_bed(folder)


def launch(ranks: int, threads: int | None) -> list[str]:
    """The words that start the program."""
    if ranks < 1:
        raise TalcumError(f"ranks = {ranks}: must be 1 or more")
    if ranks == 1:
        return [program()]
    if threads is not None:
        raise TalcumError(f"ranks = {ranks}, threads = {threads}: give one of them; threads are ranks of one process")
    if shutil.which("mpirun") is None:
        raise TalcumError(f"ranks = {ranks}: there is no mpirun on PATH; threads = {ranks} starts ranks without MPI")
    return ["mpirun", "-n", str(ranks), program()]


def named(output: PathText) -> Path:
    """A folder for results; an empty text is an error."""
    if not str(output):
        raise TalcumError("output = '': must be the name of a folder")
    return Path(output)


def file_words(file: PathText) -> list[str]:
    """A file as the last word of a command: after two dashes it is not taken for an option, whatever its name."""
    return ["--", str(file)]


def thread_words(threads: int | None) -> list[str]:
    """The option for ranks as threads."""
    return [] if threads is None else ["--threads", str(threads)]


def until_words(until: float | None) -> list[str]:
    """The option for an earlier end."""
    return [] if until is None else [f"--until={float(until)!r}"]


def set_words(changes: Changes | None) -> list[str]:
    """The options that change keys of the case."""
    words = []
    for key, value in (changes or {}).items():
        if "=" in key:
            raise TalcumError(f"set: {key!r}: a key must not contain an equals sign")
        words += ["--set", f"{key}={toml_value(value, key)}"]
    return words


def toml_value(value: Any, key: str) -> str:
    """A value in TOML; `key` is named in the error if TOML has no such value."""
    if hasattr(value, "tolist"):  # an array or a number of numpy
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, (str, Path)):
        return toml_text(str(value))
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(toml_value(member, key) for member in value) + "]"
    if isinstance(value, Mapping):
        pairs = [f"{toml_key(str(name))} = {toml_value(member, key)}" for name, member in value.items()]
        return "{ " + ", ".join(pairs) + " }"
    raise TalcumError(f"set: {key} = {value!r}: must be a bool, a number, a text, a list or a dict")


def toml_text(text: str) -> str:
    """A text between quotation marks. JSON escapes as TOML does, except for DEL, which TOML requires to be escaped as well."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def toml_key(name: str) -> str:
    """A key of an inline table, between quotation marks if it needs them."""
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else toml_text(name)


def call(command: list[str], quiet: bool) -> str:
    """Runs a command, and returns what it prints on standard output; raises its error message if it fails."""
    where = subprocess.PIPE if quiet else subprocess.STDOUT
    form: dict[str, Any] = {"stdin": subprocess.DEVNULL, "encoding": "utf-8", "errors": "replace"}
    try:
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=where, **form) as process:
            if quiet:
                printed, messages = process.communicate()
            else:
                printed = messages = echoed(process)
    except OSError as reason:
        raise TalcumError(f"{command[0]}: cannot be started: {reason}") from reason
    if process.returncode != 0:
        raise TalcumError(error_in(messages, process.returncode))
    return str(printed)


def echoed(process: subprocess.Popen[str]) -> str:
    """Prints the lines of a process as they come, and returns all of them."""
    lines = []
    for line in process.stdout or ():
        print(line, end="", flush=True)
        lines.append(line)
    return "".join(lines)


def error_in(messages: str, code: int) -> str:
    """The program's error among all messages: from `error:` to the end, or to mpirun's message below a line of dashes."""
    found = re.search(r"^error: (.*?)(?=^-{5,}|\Z)", messages, re.MULTILINE | re.DOTALL)
    if found:
        return found.group(1).strip()
    last = "\n".join(messages.strip().splitlines()[-10:])
    return f"the program ended with exit code {code}: {last or 'it printed nothing'}"
