"""Single wrong numbers in results: a resumed run mends them, sets the file aside with a warning, or changes no other."""

from __future__ import annotations

import shutil
from pathlib import Path
from random import Random

import h5py
import numpy as np

from .damage import ODD_NUMBERS, WHOLE, half_a_run
from .program import Broken, Context, case_arguments, few_ranks, reference, require_decent_end, run, tables

FILES = ["series.csv", "energy.csv", "walls.csv", "profiles.h5", "particles.vtkhdf", "measure-coordination.h5",
         "measure-contacts.vtkhdf"]  # fmt: skip
# Where the numbers stand that say what rows there are.
OFTEN = ["time", "Steps/", "NumberOf", "Offsets"]


def wrong_number(random: Random, values: np.ndarray, at: int) -> object:
    """A number in the place of another: an odd one, one of its neighbours, or one near it."""
    if values.dtype.kind == "f":
        return random.choice([*ODD_NUMBERS, values.flat[at - 1], -values.flat[at], np.nextafter(values.flat[at], 1e9)])
    limits = np.iinfo(values.dtype)
    return random.choice([0, 1, limits.min, limits.max, int(values.flat[at - 1]), min(int(values.flat[at]) + 1, limits.max)])


def change_hdf5(random: Random, path: Path) -> tuple[str, int]:
    """Changes a number of a file; returns its dataset and its place there."""
    with h5py.File(path, "r+", locking=False) as file:
        names: list[str] = []
        file.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
        names = [name for name in names if file[name].size and file[name].dtype.kind in "fiu"]
        often = [name for name in names if any(part in name for part in OFTEN)]
        name = random.choice(often if often and random.random() < 0.5 else names)
        values = file[name][()]
        at = random.randrange(values.size)
        with np.errstate(all="ignore"):
            values.flat[at] = wrong_number(random, values, at)
        file[name][...] = values
    return f"{path.name}/{name}", at


def change_text(random: Random, path: Path) -> tuple[str, int]:
    """The same for a table of text; the place is the number of its row."""
    lines = path.read_text(encoding="utf-8").splitlines()
    rows = [number for number, line in enumerate(lines) if not line.startswith("#")]
    row = random.randrange(1, len(rows))
    cells = lines[rows[row]].split(",")
    column = 0 if random.random() < 0.5 else random.randrange(len(cells))
    before = lines[rows[row - 1]].split(",")
    cells[column] = random.choice([*map(str, ODD_NUMBERS), before[column], "", "x", "-" + cells[column], cells[column] + "0"])
    lines[rows[row]] = ",".join(cells)
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path.name, row


def other_numbers(found: dict[str, object], expected: dict[str, object], name: str, at: int) -> list[str]:
    """Tables that differ from those expected in more than the number at a place of one of them."""
    wrong = []
    for table in sorted(found.keys() | expected.keys()):
        one, other = found.get(table), expected.get(table)
        if isinstance(one, list) and isinstance(other, list):
            allowed = at if table == name else -1
            without = other[:allowed] + other[allowed + 1:] if allowed >= 0 else other
            is_right = one == other or one == without or [*one[:allowed], *one[allowed + 1:]] == without
        elif isinstance(one, np.ndarray) and isinstance(other, np.ndarray) and one.shape == other.shape:
            places = np.flatnonzero(one.reshape(-1).view("V%d" % one.itemsize) != other.reshape(-1).view("V%d" % one.itemsize))
            is_right = places.size == 0 or (table == name and places.tolist() == [at])
        else:
            is_right = one == other if not isinstance(one, np.ndarray) else False
        if not is_right:
            wrong.append(table)
    return wrong


def numbers(context: Context) -> dict[str, int]:
    """Changes a number of the results of half a run, resumes it, and compares all rows with an uninterrupted run."""
    expected = reference(context, "walls", WHOLE)
    folder = context.new_folder()
    shutil.copytree(half_a_run(context), folder, dirs_exist_ok=True)
    path = folder / context.random.choice(FILES)
    change = change_text if path.suffix == ".csv" else change_hdf5
    name, at = change(context.random, path)
    if context.random.random() < 0.3:
        path.with_name(path.name + ".metadata").unlink(missing_ok=True)
    ended = run(context, few_ranks(context, alone=0.97), [*case_arguments(context, "walls", folder, WHOLE), "--resume"])
    what = f"{folder}: number {at} of {name} changed"
    require_decent_end(ended, what)
    if ended.code != 0 or ended.digest != expected.digest:
        raise Broken(f"{what}: code {ended.code}: {ended.errors[-2000:]}")
    aside = any("unreadable" in entry.name for entry in folder.iterdir())
    found = tables(folder)
    lost = path.suffix == ".csv" and len(found[path.name]) < len(expected.tables[path.name])
    without_copy = f"{path.name}.metadata is not there" in ended.errors
    if (aside or lost) and "WARN" not in ended.errors:
        raise Broken(f"{what}: rows are lost without a warning")
    wrong = other_numbers(found, expected.tables, name, at)
    if wrong and not ((aside or without_copy) and all(table.startswith(path.name) for table in wrong)):
        raise Broken(f"{what}: other numbers in {', '.join(wrong)}: {ended.errors[-1000:]}")
    same = not other_numbers(found, expected.tables, "", -1)
    shutil.rmtree(folder)
    return {f"{path.name}: {'set aside' if aside else 'as without' if same else 'this number or its row alone'}": 1}
