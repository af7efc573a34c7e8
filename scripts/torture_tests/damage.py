"""Damaged checkpoints and results: refused with a message, mended or set aside, and never another answer."""

from __future__ import annotations

import shutil
from pathlib import Path
from random import Random

import h5py
import numpy as np

from .case_reader import CaseReader
from .program import (
    Broken,
    Context,
    Ended,
    case_arguments,
    few_ranks,
    reference,
    require_decent_end,
    require_the_same,
    run,
    tables,
)

HALF, WHOLE = 0.1, 0.15
RESULTS = ["series.csv", "energy.csv", "walls.csv", "profiles.h5", "particles.vtkhdf", "measure-coordination.h5",
           "measure-contacts.vtkhdf", "profiles.h5.metadata", "particles.vtkhdf.metadata", "case.toml"]  # fmt: skip


def damaged(random: Random, data: bytes) -> bytes:
    """Changes some bits, bytes, a block, or the length."""
    changed = bytearray(data)
    kind = random.choice(["bit", "bytes", "block", "shorter", "longer", "swap"])
    at = random.randrange(len(changed))
    if kind == "bit":
        changed[at] ^= 1 << random.randrange(8)
    elif kind == "bytes":
        for _ in range(random.randint(1, 20)):
            changed[random.randrange(len(changed))] = random.randrange(256)
    elif kind == "block":
        end = min(len(changed), at + 512)
        changed[at:end] = random.choice([bytes(end - at), random.randbytes(end - at)])
    elif kind == "shorter":
        del changed[at:]
    elif kind == "longer":
        changed += random.randbytes(random.randint(1, 4096))
    else:
        other = random.randrange(len(changed))
        first, second = sorted((at, other))
        length = min(256, second - first, len(changed) - second)
        changed[first:first + length], changed[second:second + length] = (
            changed[second:second + length], changed[first:first + length])  # fmt: skip
    return bytes(changed)


def half_a_run(context: Context) -> Path:
    """The folder of a run that has reached its half, made once."""
    folder = context.folder / "half"
    if not folder.exists():
        ended = run(context, 0, case_arguments(context, "walls", folder, HALF))
        if ended.code != 0:
            raise Broken(ended.errors)
    return folder


def good_checkpoint(context: Context) -> Path:
    """Its last state."""
    return sorted(half_a_run(context).glob("checkpoint-*.h5"))[-1]


def ask(context: Context, path: Path, ranks: int) -> Ended:
    """The program's output about a checkpoint."""
    command = ["info", str(path)]
    if context.random.random() < 0.3:
        command = ["restart", str(path), "--output", str(path.parent / "on"), "--until", repr(HALF)]
    ended = run(context, ranks, command)
    require_decent_end(ended, f"{command[0]} {path}")
    if ended.code != 0 and str(path) not in ended.errors:
        raise Broken(f"the error does not name {path}: {ended.errors}")
    return ended


def checkpoints(context: Context) -> dict[str, int]:
    """A damaged checkpoint is refused."""
    good = good_checkpoint(context).read_bytes()
    bad = damaged(context.random, good)
    path = context.new_folder() / "bad.h5"
    path.write_bytes(bad)
    ended = ask(context, path, few_ranks(context, alone=0.97))
    if bad != good and ended.code == 0:
        raise Broken(f"{path} was taken")
    shutil.rmtree(path.parent)
    return {"damaged checkpoints refused" if ended.code else "damage that changed nothing": 1}


ODD_NUMBERS = [0, 1, -1, 2, 1e300, -1e300, 1e-300, float("nan"), float("inf"), 2**63, 2**64 - 1, 10**9]


def change_contents(random: Random, file: h5py.File) -> str:
    """Removes an item, gives it another type or shape, or puts odd numbers into it."""
    names: list[str] = []
    file.visit(names.append)
    name = random.choice([*names, "/"])
    item = file[name]
    if item.attrs and (not isinstance(item, h5py.Dataset) or random.random() < 0.2):
        attribute = random.choice(sorted(item.attrs))
        if random.random() < 0.2:
            del item.attrs[attribute]
        else:
            item.attrs[attribute] = random.choice([*ODD_NUMBERS[:6], "x", "", np.zeros(3)])
        return f"{name}@{attribute}"
    if name == "/" or random.random() < 0.1 or not isinstance(item, h5py.Dataset):
        name = random.choice(names)
        del file[name]
        return f"no {name}"
    values = item[()]
    how = random.choice(["number", "number", "type", "longer", "shorter", "wider"])
    if how == "number" and values.dtype.kind in "fiu" and values.size:
        odd = random.choice(ODD_NUMBERS)
        kept = values.copy()
        with np.errstate(all="ignore"):
            kept.flat[random.randrange(values.size)] = odd if values.dtype.kind == "f" else int(
                np.nan_to_num(odd, posinf=0)) % 2**63  # fmt: skip
    elif how == "type":
        kept = np.zeros(values.shape, random.choice(["f4", "i1", "u8", "S4"]))
    elif how == "longer" and values.ndim:
        kept = np.concatenate([values, values[:1]])
    elif how == "shorter" and values.ndim:
        kept = values[:-1]
    else:
        kept = np.zeros((*values.shape, 2))
    attributes = dict(item.attrs)
    del file[name]
    file[name] = kept
    file[name].attrs.update(attributes)
    return f"{how} in {name}"


def contents(context: Context) -> dict[str, int]:
    """A checkpoint with a good checksum and odd contents: refused, or the digest is that of its state."""
    folder = context.new_folder()
    path = folder / "odd.h5"
    shutil.copy(good_checkpoint(context), path)
    with h5py.File(path, "r+", locking=False) as file:
        what = change_contents(context.random, file)
    CaseReader.of(context).seal(path)
    ended = ask(context, path, few_ranks(context, alone=0.97))
    expected = reference(context, "walls", HALF).digest
    if ended.code == 0 and ended.digest != expected:
        raise Broken(f"{path} ({what}) was taken with another state")
    shutil.rmtree(folder)
    return {"checkpoints with odd contents refused" if ended.code else "checkpoints with odd contents, the same state": 1}


def results(context: Context) -> dict[str, int]:
    """Damaged results are mended, or set aside with a warning; the digest stays right. A file that was cut short has all its
    rows again, unless it was set aside, and no invented rows."""
    expected = reference(context, "walls", WHOLE).digest
    folder = context.new_folder()
    shutil.copytree(half_a_run(context), folder, dirs_exist_ok=True)
    path = folder / context.random.choice(RESULTS)
    before = path.read_bytes()
    after = damaged(context.random, before)
    path.write_bytes(after)
    was_cut = len(after) < len(before) and before.startswith(after)
    require_decent_end(run(context, 0, ["analyse", str(folder)]), f"analyse with {path} damaged")
    arguments = [*case_arguments(context, "walls", folder, WHOLE), "--resume"]
    ended = run(context, few_ranks(context, alone=0.97), arguments)
    require_decent_end(ended, f"{path} damaged")
    if ended.code != 0 or ended.digest != expected:
        raise Broken(f"{path}: code {ended.code}: {ended.errors}")
    aside = any("unreadable" in entry.name for entry in folder.iterdir())
    if aside and "WARN" not in ended.errors:
        raise Broken(f"{path} was set aside without a warning")
    if was_cut and not aside and path.suffix == ".csv":
        # Rows that were cut off before the checkpoint are lost, and the program warns of it.
        whole, mended = reference(context, "walls", WHOLE).tables[path.name], tables(folder)[path.name]
        lines = after.decode(errors="replace").splitlines()[:-1]
        times = {line.split(",")[0] for line in lines if line[:1].isdigit()}
        # At least two times show the interval between rows.
        if mended != whole and len(times) > 1 and "WARN" not in ended.errors:
            raise Broken(f"{path} has lost rows without a warning")
    elif was_cut and not aside:
        (folder / "analysis.h5").unlink(missing_ok=True)  # of the damaged files
        require_the_same(context, "walls", WHOLE, folder, ended)
    shutil.rmtree(folder)
    return {f"{path.name} damaged, {'set aside' if aside else 'mended'}": 1}
