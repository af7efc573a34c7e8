"""Names of folders that mean something to a shell, to TOML, to MPI or to HDF5: as any other, or refused at the start."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path
from random import Random

from .program import Broken, Context, Ended, case_arguments, few_ranks, reference, require_decent_end, run
from .studies import STUDIES, study_file

PARTS = [":", "ufs:", "nfs:", " ", "\n", "\t", "'", '"', "`id`", "$(id)", "${HOME}", "\\", "%d", "%s", "{ranks}", "}", "#", ";",
         "&", "|", "*", "?", "[1]", "e\u0301", "\u00a0", "\u200b", "\u202e", "\x7f", "\x1b[31m", "\U0001f30a", "-", "--help", "=",
         ",", "~", "checkpoint-", ".h5", ".partial", "x" * 60]  # fmt: skip


def odd_name(random: Random) -> str:
    """A name of some odd parts, no longer than file systems allow."""
    name = "".join(random.choices([*PARTS, "a", "b"], k=random.randint(1, 5)))
    if random.random() < 0.1:
        name += "\udcff"  # a byte that is not UTF-8
    while len(name.encode(errors="surrogateescape")) > 200:
        name = name[:-10]
    return name


def shown(name: Path) -> str:
    """A name as a literal of Python."""
    return ascii(str(name))


def require(context: Context, ended: Ended, folder: Path, until: float) -> bool:
    """A run must have ended well, or must have been refused before it wrote results; returns whether it ended well."""
    require_decent_end(ended, shown(folder))
    if ended.code == 0:
        if ended.digest != reference(context, "walls", until).digest:
            raise Broken(f"{shown(folder)}: another digest")
        return True
    if "error:" not in ended.errors or (folder / "series.csv").exists():
        raise Broken(f"{shown(folder)}: code {ended.code}: {ended.errors[-1500:]}")
    return False


def run_there(context: Context, folder: Path) -> bool:
    """A run in a folder of an odd name, its continuation on other ranks, and what reads it."""
    half, whole = 0.02, 0.04
    begun = run(context, few_ranks(context, alone=0.7), case_arguments(context, "walls", folder, half))
    if not require(context, begun, folder, half):
        return False
    resumed = run(context, few_ranks(context, alone=0.7), [*case_arguments(context, "walls", folder, whole), "--resume"])
    if not require(context, resumed, folder, whole):
        raise Broken(f"{shown(folder)}: run, but not resumed: {resumed.errors}")
    checkpoint = sorted(folder.glob("checkpoint-*.h5"))[-1]
    for words in (["info", "--", str(checkpoint)], ["analyse", "--", str(folder)], ["summary", "--", str(folder)]):
        ended = run(context, 0, words)
        if ended.code != 0:
            raise Broken(f"{words[0]} {shown(folder)}: code {ended.code}: {ended.errors}")
    return True


def study_there(context: Context, folder: Path) -> bool:
    """A study whose file and results lie below an odd name, and its files for schedulers."""
    folder.mkdir()
    beds = study_file(context, "grid").parent
    shutil.copy(beds / "bed.toml", folder)
    begun = folder / "begun.toml"
    begun.write_text(STUDIES["chain"], encoding="utf-8")
    words = ["study", f"--output={folder / 'out'}", "--at-a-time", "2"]
    for more in ([], ["--write-slurm"], ["--write-row"]):
        ended = run(context, 0, [*words, *more, "--", str(begun)])
        require_decent_end(ended, shown(folder))
        if ended.code != 0:
            if more or "error:" not in ended.errors:
                raise Broken(f"{shown(folder)}: a study: code {ended.code}: {ended.output}{ended.errors[-1500:]}")
            return False
    syntax = subprocess.run(["bash", "-n", folder / "out" / "study.slurm"], capture_output=True, text=True, check=False)
    if syntax.returncode or syntax.stderr:
        raise Broken(f"{shown(folder)}: the job script is wrong: {syntax.stderr}")
    return True


def names(context: Context) -> dict[str, int]:
    """A run or a study below an odd name."""
    # Made first: a reference is a run of its own.
    for until in (0.02, 0.04):
        reference(context, "walls", until)
    above = context.new_folder()
    folder = above / odd_name(context.random)
    of_study = context.random.random() < 0.3
    is_done = (study_there if of_study else run_there)(context, folder)
    shutil.rmtree(above)
    return {f"{'studies' if of_study else 'runs'}, {'as any other' if is_done else 'refused'}": 1}
