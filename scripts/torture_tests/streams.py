"""Standard streams that are closed, full or have no reader, and limits of the system: an end with a message, and no panic."""

from __future__ import annotations

import os
import resource
import shutil
import subprocess
from pathlib import Path

from .damage import half_a_run
from .program import END, Broken, Context, Ended, case_arguments, case_file, environment, require_decent_end, wait
from .studies import study_file

# What a stream is: a file, a full device, a pipe without a reader, nothing at all, a folder.
STREAMS = ["null", "full", "pipe", "closed", "folder"]
# Below some 80 MB of address space HDF5, which does not check what it allocates, ends the program by a signal.
LIMITS = {
    "RLIMIT_FSIZE": [0, 1, 1000, 20_000, 200_000],
    "RLIMIT_NOFILE": [3, 4, 6, 10, 16, 24, 40],
    "RLIMIT_AS": [30_000_000, 120_000_000, 250_000_000, 300_000_000, 500_000_000],
    "RLIMIT_STACK": [500_000, 1_000_000],
    "RLIMIT_CORE": [0],
}


def commands(context: Context, folder: Path) -> list[list[str]]:
    """Every command that prints or writes, on the results of half a run."""
    case, half = str(case_file(context, "walls")), str(half_a_run(context))
    results = str(folder / "half")
    shutil.copytree(half, results)
    checkpoint = str(sorted(Path(results).glob("checkpoint-*.h5"))[-1])
    study = ["study", str(study_file(context, "grid")), "--output", str(folder / "study")]
    run = case_arguments(context, "walls", folder / "run", 0.02)
    return [["--help"], ["--version"], ["keys"], ["keys", "--json-schema"], ["new"], ["completions", "bash"], ["info"],
            ["analyse", "--list"], ["check", case], ["contact", case], ["info", checkpoint], ["analyse", results],
            ["summary", results], ["watch", results, "--once"], run, [*run, "--threads", "2"],
            ["run", case, "--until", "0.11", "--resume", "--output", results],
            ["restart", checkpoint, "--until", "0.12", "--output", str(folder / "restarted")],
            study, *([*study, f"--{how}"] for how in ("only-list", "status", "table", "write-slurm", "write-row"))]  # fmt: skip


def opened(kind: str, flags: int) -> int:
    """A descriptor of a kind; -1 if the stream is closed."""
    if kind == "closed":
        return -1
    if kind == "pipe":
        reader, writer = os.pipe()
        os.close(reader if flags == os.O_WRONLY else writer)
        return writer if flags == os.O_WRONLY else reader
    return os.open({"null": "/dev/null", "full": "/dev/full", "folder": "/"}[kind], os.O_RDONLY if kind == "folder" else flags)


def call(context: Context, words: list[str], kinds: list[str], limit: tuple[str, int] | None) -> Ended:
    """Calls the program with such streams and limits; errors that would go to /dev/null are read."""
    flags = [os.O_RDONLY, os.O_WRONLY, os.O_WRONLY]
    descriptors = [opened(kind, flag) for kind, flag in zip(kinds, flags)]

    def prepare() -> None:
        if limit:
            resource.setrlimit(getattr(resource, limit[0]), (limit[1], limit[1]))
        for stream, kind in enumerate(kinds):
            if kind == "closed":
                os.close(stream)
    given: list[int | None] = [number if number >= 0 else None for number in descriptors]
    if kinds[2] == "null":
        given[2] = subprocess.PIPE
    process = subprocess.Popen([str(context.program), *words], env=environment({}), preexec_fn=prepare, start_new_session=True,
                               stdin=given[0], stdout=given[1], stderr=given[2])  # fmt: skip
    for descriptor in descriptors:
        if descriptor >= 0:
            os.close(descriptor)
    return wait(process, END)


def streams(context: Context) -> dict[str, int]:
    """Odd streams."""
    folder = context.new_folder()
    words = context.random.choice(commands(context, folder))
    kinds = [context.random.choice(STREAMS) for _ in range(3)]
    ended = call(context, words, kinds, None)
    require_decent_end(ended, f"streams {kinds}: {' '.join(words)}")
    if ended.code not in (0, 1, 2):
        raise Broken(f"streams {kinds}: code {ended.code}: {' '.join(words)}: {ended.errors}")
    shutil.rmtree(folder)
    return {f"standard output: {kinds[1]}": 1}


def limits(context: Context) -> dict[str, int]:
    """Limits of the system."""
    folder = context.new_folder()
    words = context.random.choice(commands(context, folder))
    name = context.random.choice(sorted(LIMITS))
    value = context.random.choice(LIMITS[name])
    ended = call(context, words, ["null", "null", "null"], (name, value))
    what = f"{name} = {value}: {' '.join(words)}"
    require_decent_end(ended, what)
    if ended.code != 0 and not ended.errors.strip():
        raise Broken(f"{what}: code {ended.code}: {ended.errors}")
    shutil.rmtree(folder)
    return {f"{name}: {'done' if ended.code == 0 else 'an error'}": 1}
