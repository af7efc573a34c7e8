"""Files of results. An error for a missing file names the key of the case that makes it; HDF5 files can be read while a run writes them."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any, Callable, TypeVar

import h5py
import numpy as np

from talcum_results import NUMBERS, text_of

from .tables import Array, ResultsError

T = TypeVar("T")
ATTEMPTS, PAUSE = 5, 0.2  # a run seldom writes, and for a few milliseconds
# What h5py and numpy raise where a file cannot be read, lacks something, or holds it in another shape or kind.
UNREADABLE = (OSError, RuntimeError, LookupError, TypeError, ValueError, AttributeError)


def require(file: Path, maker: str) -> Path:
    """The file, if it exists; otherwise an error that names the key of the case that makes it."""
    if not file.is_file():
        raise ResultsError(f"{file}: there is no such file (yet); a run writes it if its case has {maker}")
    return file


def read_hdf5(file: Path, take: Callable[[Any], T]) -> T:
    """The result of `take` for an open HDF5 file; a file that cannot be read, as in the middle of a write, is tried again."""
    left = ATTEMPTS
    while True:
        try:
            # Without locks, as the program itself opens its files.
            with h5py.File(file, "r", locking=False) as contents:
                return take(contents)
        except UNREADABLE as reason:
            left -= 1
            if left == 0:
                words = "is damaged, is not such a file of talcum, or is being written at this moment (then try again)"
                raise ResultsError(f"{file}: {words}: {reason}") from reason
            time.sleep(PAUSE)


def attributes(item: Any) -> dict[str, Any]:
    """The attributes of a group or a dataset."""
    return {name: text_of(value) for name, value in item.attrs.items()}


def column(dataset: Any, rows: slice | None = None) -> tuple[Array, str]:
    """Rows of a dataset of numbers, all by default, and their unit."""
    if not isinstance(dataset, h5py.Dataset) or dataset.ndim == 0 or dataset.dtype.kind not in NUMBERS:
        raise ValueError(f"{dataset.name} is not an array of numbers")
    return np.asarray(dataset[rows if rows is not None else ...]), str(text_of(dataset.attrs.get("unit", "")))
