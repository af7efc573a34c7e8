"""The results of a run."""

from __future__ import annotations

import contextlib
import io
import re
from importlib import import_module
from os import PathLike
from pathlib import Path
from typing import Any, Sequence, Union

import numpy as np

import talcum_results

from .checkpoint import Checkpoint, read_checkpoint
from .fields import Fields, read_fields
from .files import attributes, read_hdf5, require
from .instrument import Instrument, read_instrument, read_kind
from .snapshots import (
    Contacts,
    Particles,
    nearest,
    read_checkpoint_contacts,
    read_lines,
    read_particles,
    read_times,
    time_of_checkpoint,
)
from .tables import Analysis, Array, Profiles, ResultsError, Table, optional, read_table

FileName = Union[str, "PathLike[str]", None]


class Bed:
    """A folder of results, also of a run in progress.

    Each property reads its file again each time, so keep results that you use twice in a variable.
    """

    def __init__(self, folder: Union[str, PathLike[str]]) -> None:
        self.folder = Path(folder)
        if not (self.folder / "case.toml").is_file():
            raise ResultsError(f"{self.folder}: is not a folder of results: there is no case.toml in it")

    def __repr__(self) -> str:
        return f"<Bed of {self.folder}>"

    @property
    def case(self) -> dict[str, Any]:
        """The case in effect, as a dict of its sections."""
        toml = toml_reader()
        file = self.folder / "case.toml"
        try:
            case: dict[str, Any] = toml.loads(file.read_text(encoding="utf-8"))
        except (OSError, ValueError) as reason:
            raise ResultsError(f"{file}: cannot be read: {reason}") from reason
        return case

    @property
    def is_complete(self) -> bool:
        """Whether the run has reached its end, or `until`, and has not been continued from there."""
        return (self.folder / "complete").is_file()

    @property
    def digest(self) -> str:
        """The digest of the newest checkpoint, as `talcum info` prints it; in a complete run this is the digest of the end."""
        return read_hdf5(self.newest_checkpoint, lambda contents: str(attributes(contents)["digest"]))

    @property
    def checkpoints(self) -> list[Path]:
        """The checkpoints, the newest last."""
        found = self.folder.glob("checkpoint-*.h5")
        return sorted(file for file in found if re.fullmatch(r"checkpoint-\d{12}\.h5", file.name))

    @property
    def newest_checkpoint(self) -> Path:
        """The newest checkpoint."""
        if not self.checkpoints:
            words = "a run writes one at its end, and as [checkpoint] of its case says"
            raise ResultsError(f"{self.folder}: there is no checkpoint yet; {words}")
        return self.checkpoints[-1]

    @property
    def series(self) -> Table:
        """Numbers over time: `bed.series["bed_top"]`."""
        return read_table(require(self.folder / "series.csv", "output.series"))

    @property
    def walls(self) -> Table:
        """The force on every wall over time; `wall` holds names, an empty `diameter` (all particles) is NaN."""
        return read_table(require(self.folder / "walls.csv", "output.walls"), texts=("wall",))

    @property
    def energy(self) -> Table:
        """Energies stored, and work by mechanism, over time."""
        return read_table(require(self.folder / "energy.csv", "output.energy"))

    @property
    def profiles(self) -> Profiles:
        """Solids fraction and velocity over time and height."""
        file = require(self.folder / "profiles.h5", "output.profiles")
        profiles = read_hdf5(file, lambda contents: talcum_results.profiles_of(file, contents))
        if len(profiles.time) == 0:
            raise ResultsError(f"{file}: holds no results yet")
        return profiles

    @property
    def times(self) -> Array:
        """The times of the snapshots of particles."""
        return read_times(self._snapshots)

    @property
    def _snapshots(self) -> Path:
        return require(self.folder / "particles.vtkhdf", "output.particles")

    def particles(self, time: float | None = None, exact: bool = False) -> Particles:
        """The particles of the snapshot nearest to a time, the last by default; `.time` is the time of the snapshot.

        With `exact`, any other time than the wanted one is an error.
        """
        return read_particles(self._snapshots, time, exact)

    def gas(self, time: float | None = None, exact: bool = False) -> Fields:
        """A volume-averaged gas at the snapshot nearest to a time, the last by default."""
        return read_fields(require(self.folder / "gas.vtkhdf", "output.gas"), time, exact)

    @property
    def gas_times(self) -> Array:
        """The times of the snapshots of a volume-averaged gas."""
        return read_times(require(self.folder / "gas.vtkhdf", "output.gas"))

    @property
    def instruments(self) -> dict[str, str]:
        """The kinds of the instruments by their names."""
        files = sorted(self.folder.glob("measure-*.h5"))
        return {file.stem[len("measure-") :]: read_kind(file) for file in files}

    def instrument(self, name: str) -> Instrument:
        """The tables of the instrument `[measure.NAME]`."""
        return read_instrument(require(self.folder / f"measure-{name}.h5", f"[measure.{name}]"))

    def fields(self, name: str, time: float | None = None, exact: bool = False) -> Fields:
        """The fields of an instrument on cells at the time nearest to a given one, the last by default."""
        return read_fields(require(self.folder / f"measure-{name}.vtkhdf", f"[measure.{name}] on cells"), time, exact)

    def agglomerates(self, instrument: str | None = None) -> Instrument:
        """The tables of the instrument of kind agglomerates; `instrument` names it if there are several."""
        return self.instrument(self._of_kind("agglomerates", instrument))

    def contacts(
        self, time: float | None = None, exact: bool = False, instrument: str | None = None, checkpoint: bool = False
    ) -> Contacts:
        """The touching pairs at the time nearest to the given one, the last by default.

        They come from the instrument of kind contacts (with forces), or from the nearest checkpoint (with histories) if
        there is no such instrument or `checkpoint` is true. `instrument` names it if there are several.
        """
        if checkpoint or (instrument is None and "contacts" not in self.instruments.values()):
            return self._checkpoint_contacts(time, exact)
        name = self._of_kind("contacts", instrument)
        lines = require(self.folder / f"measure-{name}.vtkhdf", f'[measure.{name}] with kind = "contacts"')
        return read_lines(lines, time, exact)

    def checkpoint(self, time: float | None = None, exact: bool = False) -> Checkpoint:
        """The state of the run in the checkpoint nearest to a time, the newest by default."""
        return read_checkpoint(self._checkpoint_near(time, exact)[0])

    def _checkpoint_contacts(self, time: float | None, exact: bool) -> Contacts:
        return read_checkpoint_contacts(*self._checkpoint_near(time, exact))

    def _checkpoint_near(self, time: float | None, exact: bool) -> tuple[Path, float]:
        newest, files = self.newest_checkpoint, self.checkpoints
        times = np.array([time_of_checkpoint(file) for file in files])
        index = nearest(times, time, exact, newest)
        return files[index], float(times[index])

    def _of_kind(self, kind: str, name: str | None) -> str:
        """The name of the instrument of a kind."""
        names = [known for known, its_kind in self.instruments.items() if its_kind == kind]
        if name is not None:
            if name not in names:
                known = ", ".join(names) or "none"
                raise ResultsError(f"{self.folder}: no instrument '{name}' of kind {kind}; there are: {known}")
            return name
        if not names:
            maker = f'[measure.NAME] with kind = "{kind}" makes one'
            raise ResultsError(f"{self.folder}: there is no instrument of kind {kind}; {maker}")
        if len(names) > 1:
            raise ResultsError(f"{self.folder}: several instruments are of kind {kind}: name one of {', '.join(names)}")
        return names[0]

    def analyse(self, analyses: Sequence[str], start: float | None = None, end: float | None = None) -> Analysis:
        """Analyses between two times with `talcum analyse`: `bed.analyse(["waves"]).number("waves.speed")`."""
        return talcum_results.analyse(self.folder, list(analyses), start, end)

    def plot_series(self, file: FileName = None, start: float | None = None, end: float | None = None) -> Path:
        """Draws numbers over time. All `plot_` methods return the path of the figure, by default in the folder of results."""
        return self._draw("series", "series.png", file, start, end)

    def plot_spacetime(
        self, file: FileName = None, start: float | None = None, end: float | None = None, colours: str = "YlGnBu"
    ) -> Path:
        """Draws the solids fraction over height and time, with the rays of the waves that `talcum analyse` finds."""
        return self._draw("spacetime", "spacetime.png", file, start, end, "--colours", colours)

    def plot_minimum_fluidisation(
        self, file: FileName = None, start: float | None = None, end: float | None = None
    ) -> Path:
        """Draws the pressure drop over the gas velocity, with U_mf."""
        return self._draw("minimum_fluidisation", "minimum_fluidisation.png", file, start, end)

    def plot_cycle(self, file: FileName = None, start: float | None = None, end: float | None = None) -> Path:
        """Draws a vibrated bed over one cycle of its plate."""
        return self._draw("cycle", "cycle.png", file, start, end)

    def plot_particles(
        self,
        file: FileName = None,
        start: float | None = None,
        end: float | None = None,
        colour: str = "speed",
        panels: int = 1,
    ) -> Path:
        """Draws the particles from the side, at `panels` times side by side; by default only at the last time.

        `colour` is speed, rise (vertical velocity), size, or the name of a column such as agglomerate or class.
        """
        options = ["--colour", colour, "--panels", str(panels)]
        return self._draw("particles", "particles.png", file, start, end, *options)

    def plot_section(self, file: FileName = None, start: float | None = None, end: float | None = None) -> Path:
        """Draws a section through particles and a volume-averaged gas, at the last snapshot until `end`."""
        return self._draw("fluidised_bed", "bed.png", file, start, end)

    def _draw(
        self, module: str, name: str, file: FileName, start: float | None, end: float | None, *options: str
    ) -> Path:
        """Calls a module that draws, without its printed output; matplotlib's settings stay as they were."""
        matplotlib = optional("matplotlib", "a drawing")
        place = self.folder / name if file is None else Path(file)
        words = [str(self.folder), f"--output={place}", *options]
        words += [f"--{word}={time!r}" for word, time in (("from", start), ("to", end)) if time is not None]
        with matplotlib.rc_context(), contextlib.redirect_stdout(io.StringIO()):
            import_module(f".{module}", __package__).main(words)
        return place


def toml_reader() -> Any:
    """Python's reader of TOML, or before Python 3.11 the package tomli."""
    try:
        return import_module("tomllib")
    except ImportError:
        return optional("tomli", "bed.case before Python 3.11")


def open_bed(folder: Union[str, PathLike[str]]) -> Bed:
    """Opens the folder of a run, also while it is in progress."""
    return Bed(folder)
