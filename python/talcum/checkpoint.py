"""A checkpoint: everything that the future of a run depends on."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, Union

from .files import attributes, read_hdf5
from .snapshots import Contacts, Particles, clock_time, table_of
from .tables import ResultsError, Table


@dataclass
class Checkpoint:
    """The state of a run at one time. `attributes` are those of the file: title, case, version and so on."""

    file: Path
    time: float
    step: int
    digest: str
    particles: Particles
    contacts: Contacts
    wall_contacts: Table
    gas: Table
    attributes: dict[str, Any]


def read_checkpoint(file: Union[str, "PathLike[str]"]) -> Checkpoint:
    """Reads a checkpoint, `checkpoint-*.h5` or `stage-*.h5`."""
    path = Path(file)
    if not path.is_file():
        raise ResultsError(f"{path}: there is no such file")

    def take(contents: Any) -> Checkpoint:
        found = attributes(contents)
        time, step = clock_time(contents), int(contents["clock"].attrs["step"])
        names = ("particles", "contacts", "wall_contacts", "gas")
        particles, contacts, walls, gas = (table_of(path, contents[name], None) for name in names)
        pairs = Contacts(time, contacts)
        return Checkpoint(path, time, step, str(found["digest"]), Particles(time, particles), pairs, walls, gas, found)

    return read_hdf5(path, take)
