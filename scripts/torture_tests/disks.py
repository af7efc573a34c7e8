"""Disks that fill up while a run or a study writes: an error, and the same results once there is room."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

from . import studies
from .program import NOT_COUNTED, Broken, Context, case_arguments, reference, require_decent_end, require_the_same, run

UNTIL = 0.1
# A run needs some hundred kB, a study some MB.
SIZES_KB = [60, 120, 200, 350, 500, 700, 1000, 1500]


def disks(context: Context) -> dict[str, int]:
    """One run or study on a small disk, which is then made large."""
    kind = context.random.choice(["a run", *sorted(studies.STUDIES)])
    if kind == "a run":
        reference(context, "walls", UNTIL)
    else:
        studies.reference(context, kind)
    folder = context.new_folder()
    size = context.random.choice(SIZES_KB)
    mount = ["mount", "-t", "tmpfs", "-o", f"size={size}k", "talcum-torture", str(folder)]
    if subprocess.run(mount, capture_output=True, check=False).returncode:
        shutil.rmtree(folder)
        return {"without the right to mount a disk" + NOT_COUNTED: 1}
    try:
        return fill(context, kind, size, folder)
    finally:
        subprocess.run(["umount", "--lazy", folder], check=True)
        folder.rmdir()


def fill(context: Context, kind: str, size: int, folder: Path) -> dict[str, int]:
    """The run or the study on the mounted disk."""
    results = folder / "results"
    words = studies.arguments(context, kind, results) if kind != "a run" else [
        *case_arguments(context, "walls", results, UNTIL), "--resume"]  # fmt: skip
    first = run(context, 0, words)
    what = f"{kind} on a disk of {size} kB"
    require_decent_end(first, what)
    if first.code != 0 and "o space left" not in first.output + first.errors:
        raise Broken(f"{what}: code {first.code} without the reason: {first.output}{first.errors[-2000:]}")
    subprocess.run(["mount", "-o", "remount,size=200m", str(folder)], check=True)
    again = run(context, 0, words)
    if kind == "a run":
        require_the_same(context, "walls", UNTIL, results, again)
    else:
        studies.require_the_same(context, kind, results, again)
    return {f"{'a run' if kind == 'a run' else 'a study'}, {'room enough' + NOT_COUNTED if first.code == 0 else 'full'}": 1}
