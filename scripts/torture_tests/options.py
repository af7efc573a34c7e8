"""Options of every command with odd values: done, or refused with a message, in little time and memory."""

from __future__ import annotations

import re
import shutil
import subprocess
from functools import cache
from pathlib import Path

from .damage import good_checkpoint, half_a_run
from .inputs import WORDS
from .program import END, Broken, Context, Ended, case_file, environment, limit_memory, require_decent_end, wait
from .studies import study_file

VALUES = [*WORDS, "4294967297", "18446744073709551617", "7,7905747460161236407,1", "-0", "1e-320", "+1", "١", "1,2", "time",
          "waves", "bed_top", "..", "no/such/file", "mean", "--", "-n", "inf", "-inf", "1s", "\n", "a" * 5000]  # fmt: skip
# A page is served, or a terminal is drawn in, until somebody ends it; and a run has its end.
ENDLESS = {"--serve", "--until", "--help"}


@cache
def options_of(program: Path, name: str) -> list[str]:
    """The options of a command, from its help."""
    text = subprocess.run([program, name, "--help"], capture_output=True, text=True, check=True).stdout
    return sorted(set(re.findall(r"--[a-z][a-z-]+", text)) - ENDLESS)


def subjects(context: Context) -> dict[str, list[str]]:
    """What each command is given."""
    case, half = str(case_file(context, "walls")), str(half_a_run(context))
    study = str(study_file(context, "grid"))
    return {"check": [case], "contact": [case], "info": [str(good_checkpoint(context))], "analyse": [half], "summary": [half],
            "watch": [half], "study": [study, context.random.choice(["--only-list", "--status"])], "keys": ["contact"],
            "run": [case, "--until=0.001"], "restart": [str(good_checkpoint(context)), "--until=0.101"]}  # fmt: skip


def options(context: Context) -> dict[str, int]:
    """One command with one to three options."""
    random = context.random
    name, words = random.choice(sorted(subjects(context).items()))
    command = [str(context.program), name, *words]
    for _ in range(random.randint(1, 3)):
        known = options_of(context.program, name)
        option = random.choice(known) if known else "--no-such-option"
        value = random.choice(VALUES).replace("\\u0000", "")
        command += random.choice([[option, value], [f"{option}={value}"], [option], [value]])
    folder = context.new_folder()
    pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    process = subprocess.Popen(command, env=environment({}), cwd=folder, preexec_fn=limit_memory, start_new_session=True, **pipes)
    ended: Ended = wait(process, END)
    require_decent_end(ended, ascii(command))
    if ended.code not in (0, 1, 2) or (ended.code != 0 and "error" not in ended.errors):
        raise Broken(f"{ascii(command)}: code {ended.code}: {ended.errors[-1000:]}")
    shutil.rmtree(folder)
    return {f"options of {name}, {'taken' if ended.code == 0 else 'refused'}": 1}
