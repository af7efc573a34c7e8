"""Reads the results of a run of talcum, and holds the functions that its drawing scripts share.

A run in progress can be read: a last row that is only half written is left out.
"""

from __future__ import annotations

import argparse
import csv
import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from dataclasses import dataclass, field, replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, NoReturn

try:
    import h5py
    import numpy as np
except ImportError as missing:
    sys.exit(f"error: {missing}. Call scripts/install once, then start this script with .venv/bin/python")

if TYPE_CHECKING:
    from matplotlib.collections import EllipseCollection
    from matplotlib.figure import Figure

Array = np.ndarray
NUMBERS = "fiu"  # the kinds of numbers that files hold: floating, integer and unsigned

# Colours that stay apart for colour-blind eyes and in grey print (after Okabe and Ito).
BLUE, ORANGE, GREEN, RED, BLACK, GREY = "#0072b2", "#e69f00", "#009e73", "#d55e00", "#000000", "#8c8c8c"


class ResultsError(Exception):
    """An error in the results or in the arguments, with a message for the user."""


@dataclass
class Series:
    """The table `series.csv`: columns over time, their units, and the comment lines above them."""

    columns: dict[str, Array]
    units: dict[str, str]
    provenance: list[str] = field(default_factory=list)

    def __getitem__(self, name: str) -> Array:
        if name not in self.columns:
            raise ResultsError(f"series.csv has no column '{name}'; it has {', '.join(self.columns)}")
        return self.columns[name]

    @property
    def time(self) -> Array:
        """The times of the rows."""
        return self["time"]

    def label(self, name: str, words: str | None = None) -> str:
        """An axis label: words (by default the column's name) and the column's unit."""
        return axis_label(words or name.replace("_", " "), self.units.get(name, ""))

    def between(self, start: float | None, end: float | None) -> Series:
        """The rows with start <= time <= end."""
        rows = rows_between(self.time, start, end)
        columns = {name: values[rows] for name, values in self.columns.items()}
        return Series(columns, self.units, self.provenance)


@dataclass
class Profiles:
    """Horizontal averages over height and time, from `profiles.h5`; arrays are [time][height]."""

    time: Array
    height: Array
    solids_fraction: Array
    solids_velocity: Array
    superficial_velocity: Array
    units: dict[str, str]
    attributes: dict[str, Any] = field(default_factory=dict)

    def between(self, start: float | None, end: float | None) -> Profiles:
        """The rows with start <= time <= end."""
        rows = rows_between(self.time, start, end)
        return replace(
            self,
            time=self.time[rows],
            solids_fraction=self.solids_fraction[rows],
            solids_velocity=self.solids_velocity[rows],
            superficial_velocity=self.superficial_velocity[rows],
        )

    def to_xarray(self) -> Any:
        """An xarray.Dataset over time and height, with units as attributes."""
        both, units = ("time", "height"), self.units
        variables = {
            "solids_fraction": (both, self.solids_fraction, {"units": units["solids_fraction"]}),
            "solids_velocity": (both, self.solids_velocity, {"units": units["solids_velocity"]}),
            "superficial_velocity": ("time", self.superficial_velocity, {"units": units["superficial_velocity"]}),
        }
        coordinates = {name: (name, getattr(self, name), {"units": units[name]}) for name in both}
        return optional("xarray", "to_xarray").Dataset(variables, coordinates, self.attributes)


def optional(library: str, purpose: str) -> Any:
    """A library that only some functions need, or an error that names the purpose."""
    try:
        return import_module(library)
    except ImportError as missing:
        words = f"{purpose} needs the Python package {library}: pip install {library} ({missing})"
        raise ResultsError(words) from missing


def rows_between(time: Array, start: float | None, end: float | None) -> Array:
    """Marks the rows with start <= time <= end; raises an error if there are none."""
    rows = np.ones(len(time), dtype=bool)
    if start is not None:
        rows &= time >= start
    if end is not None:
        rows &= time <= end
    if not rows.any():
        last = f"{time[0]:g} to {time[-1]:g}" if len(time) else "none"
        raise ResultsError(f"no results between times {start} and {end}; there are results at times {last}")
    return rows


def axis_label(words: str, unit: str) -> str:
    """Words with a unit in square brackets; a pure number has no unit."""
    return words if unit in ("", "1") else f"{words} [{unit}]"


def velocity_unit(length: str, time: str) -> str:
    """The unit of a velocity, from those of length and time."""
    if (length, time) == ("d", "sqrt(d/g)"):
        return "sqrt(g d)"
    return f"{length}/{time}"


def result_file(path: Path, name: str) -> Path:
    """The file `name` of a results folder, or `path` itself if it is a file."""
    if path.is_dir():
        path = path / name
    if not path.is_file():
        raise ResultsError(f"{path}: there is no such file; name the output folder of a run, or the file itself")
    return path


def results_folder(path: Path) -> Path:
    """The folder in which figures are put by default."""
    return path if path.is_dir() else path.parent


def split_heading(heading: str) -> tuple[str, str]:
    """Splits `name [unit]` into name and unit."""
    name, _, unit = heading.strip().partition("[")
    return name.strip(), unit.strip().removesuffix("]")


def complete_lines(file: Path) -> list[str]:
    """The lines of a text file, without an unfinished last line."""
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as reason:
        raise ResultsError(f"{file}: cannot be read: {reason}") from reason
    return text[: text.rfind("\n") + 1].splitlines()


def read_series(path: Path) -> Series:
    """Reads `series.csv` of a folder."""
    file = result_file(path, "series.csv")
    lines = complete_lines(file)
    provenance = [line[1:].strip() for line in lines if line.startswith("#")]
    rows = list(csv.reader(line for line in lines if line and not line.startswith("#")))
    if len(rows) < 2:
        raise ResultsError(f"{file}: holds no results yet")
    headings = [split_heading(heading) for heading in rows[0]]
    table = series_table(file, rows[1:], len(headings))
    columns = {name: table[:, index] for index, (name, _) in enumerate(headings)}
    return Series(columns, dict(headings), provenance)


def series_table(file: Path, rows: list[list[str]], width: int) -> Array:
    """Turns the rows of a series into numbers; an error names a row that cannot be read."""
    table = np.empty((len(rows), width))
    for index, row in enumerate(rows):
        try:
            table[index] = [float(value) if value.strip() else np.nan for value in row]
        except ValueError as reason:
            words = f"row {index + 1} below the header does not hold {width} numbers"
            raise ResultsError(f"{file}: {words}: {','.join(row)}") from reason
    return table


def read_profiles(path: Path) -> Profiles:
    """Reads `profiles.h5` of a folder, also while a run is writing it."""
    file = result_file(path, "profiles.h5")
    try:
        with h5py.File(file, "r", locking=False) as contents:
            profiles = profiles_of(file, contents)
    except OSError as reason:
        words = "is damaged, is not an HDF5 file, or is being written at this moment (then try again)"
        raise ResultsError(f"{file}: {words}: {reason}") from reason
    if len(profiles.time) == 0:
        raise ResultsError(f"{file}: holds no results yet")
    return profiles


def profiles_of(file: Path, contents: h5py.File) -> Profiles:
    """Takes the profiles from an open file; rows that are not complete yet are left out."""
    names = ["time", "height", "solids_fraction", "solids_velocity", "superficial_velocity"]
    absent = [name for name in names if name not in contents]
    if absent:
        raise ResultsError(f"{file}: has no dataset {', '.join(absent)}; is it a profiles.h5 of talcum?")
    data = {name: numbers_of(file, contents[name], 2 if name.startswith("solids") else 1) for name in names}
    if {data[name].shape[1:] for name in ("solids_fraction", "solids_velocity")} != {data["height"].shape}:
        raise ResultsError(f"{file}: its profiles do not have a number for each height; is it a profiles.h5 of talcum?")
    units = {name: text_of(contents[name].attrs.get("unit", "")) for name in names}
    rows = min(len(data[name]) for name in names if name != "height")
    while rows > 1 and data["time"][rows - 1] <= data["time"][rows - 2]:
        rows -= 1  # room that was made in the file but is not filled yet
    columns = {name: data[name] if name == "height" else data[name][:rows] for name in names}
    attributes = {name: text_of(value) for name, value in contents.attrs.items()}
    return Profiles(**columns, units=units, attributes=attributes)


def numbers_of(file: Path, dataset: Any, dimensions: int) -> Array:
    """A dataset of numbers with a given number of dimensions."""
    if not isinstance(dataset, h5py.Dataset) or dataset.ndim != dimensions or dataset.dtype.kind not in NUMBERS:
        words = f"is not an array of numbers with {dimensions} dimension{'s' if dimensions > 1 else ''}"
        raise ResultsError(f"{file}: {dataset.name} {words}; is it a profiles.h5 of talcum?")
    return np.asarray(dataset[...], dtype=float)


def snapshot_times(vtkhdf: Any) -> Array:
    """The times in a VTKHDF file; their number is written last, when everything else is complete."""
    steps = vtkhdf["Steps"]
    times = np.asarray(steps["Values"][: int(steps.attrs["NSteps"])], dtype=float)
    if times.ndim != 1:
        raise ValueError(f"{steps.name}/Values is not a list of times")
    return times


def snapshot_rows(vtkhdf: Any, step: int) -> slice:
    """The rows of the particles of a snapshot."""
    first = int(vtkhdf["Steps/PointOffsets"][step])
    return slice(first, first + int(vtkhdf["NumberOfPoints"][step]))


def text_of(value: Any) -> Any:
    """An attribute's value, with bytes turned into text."""
    if isinstance(value, np.ndarray) and value.size == 1:
        value = value.reshape(-1)[0]
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    return value


def read_case(profiles: Profiles | None, path: Path) -> dict[str, Any]:
    """The case that was run, from the profiles or from `case.toml`; empty if neither has it."""
    try:
        import tomllib
    except ImportError:  # Python before 3.11
        return {}
    text = profiles.attributes.get("case") if profiles is not None else None
    beside = results_folder(path) / "case.toml"
    if not isinstance(text, str) and beside.is_file():
        text = beside.read_text(encoding="utf-8")
    try:
        return tomllib.loads(text) if isinstance(text, str) else {}
    except tomllib.TOMLDecodeError:
        return {}


@dataclass
class Analysis:
    """The results of `talcum analyse`: numbers and texts by their names, reasons for missing ones, and tables of columns."""

    values: dict[str, float | str]
    errors: dict[str, float]
    units: dict[str, str]
    reasons: dict[str, str]
    tables: dict[str, dict[str, Array]]

    def text(self, name: str) -> str:
        """A number with its error and unit, as text; if there is none, the reason in brackets."""
        if name not in self.values:
            return f"none ({self.reasons.get(name, 'not analysed')})"
        value, error, unit = self.values[name], self.errors.get(name), self.units.get(name, "1")
        if isinstance(value, str):
            return value
        shown = f"{value:.4g}" if error is None else f"{value:.4g} +- {error:.2g}"
        return shown if unit == "1" else f"{shown} {unit}"

    def number(self, name: str) -> float:
        """A number, or NaN if there is none."""
        value = self.values.get(name, np.nan)
        return float(value) if isinstance(value, float) else np.nan


def program() -> str:
    """The path of talcum: the environment variable TALCUM, or the program built in this repository, or the installed one."""
    beside = shutil.which("talcum", path=sysconfig.get_path("scripts"))  # where pip puts it
    target = Path(__file__).resolve().parent.parent / "target"
    built = [path for path in (target / "release/talcum", target / "debug/talcum") if path.is_file()]
    newest = max(built, key=lambda path: path.stat().st_mtime, default=None)
    found = os.environ.get("TALCUM") or (str(newest) if newest else beside or shutil.which("talcum"))
    if not found:
        places = "the environment variable TALCUM, target/ of this clone, next to Python, PATH"
        words = f"there is no program talcum (looked for in: {places})"
        raise ResultsError(f"{words}: pip install the package, or cargo build --release, or set TALCUM to its path")
    return found


def analyse(results: Path, analyses: list[str], start: float | None = None, end: float | None = None) -> Analysis:
    """Analyses a folder of results, between two times, with `talcum analyse`."""
    if not results.is_dir():
        raise ResultsError(f"{results}: there is no such folder; name the output folder of a run")
    command = [program(), "analyse"]
    command += [word for name in analyses for word in ("--analysis", name)]
    command += [f"--from={float(start)!r}"] if start is not None else []
    command += [f"--to={float(end)!r}"] if end is not None else []
    with tempfile.TemporaryDirectory() as folder:
        # After two dashes a folder is not taken for an option, whatever its name.
        ended = subprocess.run([*command, "--output", folder, "--", str(results)], capture_output=True, text=True)
        if ended.returncode != 0:
            raise ResultsError(ended.stderr.strip().removeprefix("error: ") or "talcum analyse failed")
        return read_analysis(Path(folder) / "analysis.h5")


def read_analysis(file: Path) -> Analysis:
    """Reads an analysis.h5."""
    found = Analysis({}, {}, {}, {}, {})
    with h5py.File(file, "r") as contents:
        contents.visititems(lambda name, item: found.tables.update(table_of(name, item)))
    scalars = found.tables.pop("scalars")
    for name, value, error, text, unit, reason in zip(
        *(scalars[key] for key in ("name", "value", "error", "text", "unit", "no_value_because"))
    ):
        found.units[name] = unit
        if reason:
            found.reasons[name] = reason
            continue
        found.values[name] = text or float(value)
        if np.isfinite(error) and error > 0.0:
            found.errors[name] = float(error)
    return found


def table_of(name: str, item: Any) -> dict[str, dict[str, Array]]:
    """A group that holds columns, by its name; nothing for other items."""
    if not isinstance(item, h5py.Group):
        return {}
    columns = {key: column for key, column in item.items() if isinstance(column, h5py.Dataset)}
    read = {key: c.asstr()[()] if h5py.check_string_dtype(c.dtype) else c[()] for key, c in columns.items()}
    return {name: read} if read else {}


def new_figure(rows: int = 1, columns: int = 1, size: tuple[float, float] = (9.0, 5.5)) -> tuple[Figure, Array]:
    """A figure with panels in rows and columns, in the common style of all scripts.

    It is made without pyplot, so that no window is opened and a notebook's figures stay as they are.
    """
    optional("matplotlib", "a drawing").rcParams.update(
        {
            "font.size": 12,
            "axes.titlesize": 12,
            "legend.fontsize": 10,
            "axes.grid": True,
            "grid.alpha": 0.3,
            "axes.spines.top": False,
            "axes.spines.right": False,
            "lines.linewidth": 1.3,
        }
    )
    figure = import_module("matplotlib.figure").Figure(figsize=size, layout="constrained")
    return figure, figure.subplots(rows, columns, squeeze=False)


def draw_spheres(panel: Any, centres: Array, diameters: Array, values: Array) -> EllipseCollection:
    """Spheres of their true size in a panel, coloured by values; a sphere without a value is grey."""
    from matplotlib import colormaps
    from matplotlib.collections import EllipseCollection

    colours = colormaps["viridis"].with_extremes(bad="lightgrey")
    spheres = EllipseCollection(diameters, diameters, np.zeros(len(diameters)), units="xy", offsets=centres,
                                offset_transform=panel.transData, cmap=colours)  # fmt: skip
    spheres.set_array(np.ma.masked_invalid(values))
    panel.add_collection(spheres)
    return spheres


def save_figure(figure: Figure, picture: Path) -> None:
    """Writes a figure under another name first, so that nobody sees half of it."""
    beside = picture.with_name(f".{os.getpid()}-{picture.name}")
    try:
        figure.savefig(beside, dpi=150, bbox_inches="tight")
        os.replace(beside, picture)
    except (OSError, ValueError) as reason:
        beside.unlink(missing_ok=True)
        raise ResultsError(f"{picture}: cannot be written: {reason}") from reason
    print(f"figure: {picture}")


def argument_parser(description: str, picture: str) -> argparse.ArgumentParser:
    """The options that all drawing scripts have."""
    parser = argparse.ArgumentParser(
        description=description, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("results", type=Path, help="output folder of a run")
    parser.add_argument("--from", dest="start", type=float, metavar="TIME", help="leave out earlier times")
    parser.add_argument("--to", dest="end", type=float, metavar="TIME", help="leave out later times")
    parser.add_argument("--output", type=Path, metavar="FILE", help=f"the figure (default: RESULTS/{picture})")
    return parser


def picture_of(arguments: argparse.Namespace, name: str) -> Path:
    """The path of the figure: --output, or `name` in the results folder."""
    return arguments.output or results_folder(arguments.results) / name


def run_script(main: Callable[[list[str] | None], None]) -> NoReturn:
    """Runs a script's main function; an error is printed as a message, with exit code 1."""
    try:
        main(None)
        sys.stdout.flush()
    except ResultsError as error:
        sys.exit(f"error: {error}")
    except BrokenPipeError:
        # The reader, for example `head`, has closed the pipe; Python would otherwise report this once more at its end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    sys.exit(0)
