"""The Python package reads damaged results, and files of other shapes: results, or an error of its own, and nothing else."""

from __future__ import annotations

import shutil
import sys
from typing import Callable

import h5py

from .damage import RESULTS, change_contents, damaged, good_checkpoint, half_a_run
from .program import ROOT, Broken, Context

sys.path[:0] = [str(ROOT / "python"), str(ROOT / "scripts")]
import talcum  # noqa: E402
import talcum.files  # noqa: E402

# A damaged file stays so: there is nothing to wait for.
talcum.files.PAUSE = 0.0
READINGS: dict[str, Callable[[talcum.Bed], object]] = {
    "case": lambda bed: bed.case,
    "digest": lambda bed: (bed.is_complete, bed.digest),
    "series": lambda bed: bed.series["bed_top"],
    "walls": lambda bed: bed.walls.keys(),
    "energy": lambda bed: bed.energy.keys(),
    "profiles": lambda bed: bed.profiles.solids_fraction,
    "times": lambda bed: bed.times,
    "particles": lambda bed: (bed.particles().position, bed.particles(0.05).velocity),
    "instruments": lambda bed: bed.instruments,
    "instrument": lambda bed: bed.instrument("coordination").scalars,
    "contacts": lambda bed: bed.contacts().keys(),
    "contacts of checkpoint": lambda bed: bed.contacts(checkpoint=True).keys(),
    "checkpoint": lambda bed: bed.checkpoint(),
    "representation": repr,
}


def readings(context: Context) -> dict[str, int]:
    """Damages one file, and reads everything."""
    folder = context.new_folder()
    shutil.copytree(half_a_run(context), folder, dirs_exist_ok=True)
    path = folder / context.random.choice([*RESULTS, good_checkpoint(context).name])
    what = "bytes"
    if path.suffix in (".h5", ".vtkhdf") and context.random.random() < 0.8:
        with h5py.File(path, "r+", locking=False) as file:
            what = change_contents(context.random, file)
    else:
        path.write_bytes(damaged(context.random, path.read_bytes()))
    counts = {"read": 0, "refused": 0}
    for name, reading in READINGS.items():
        try:
            reading(talcum.open(folder))
            counts["read"] += 1
        except talcum.ResultsError:
            counts["refused"] += 1
        except Exception as error:
            raise Broken(f"{name} of {path} ({what}): {type(error).__name__}: {error}") from error
    shutil.rmtree(folder)
    return {f"readings of damaged results, {how}": count for how, count in counts.items() if count}
