"""Draws a bed from the side: its particles, coloured by speed, vertical velocity, size, agglomerate or another dataset of snapshots.

--panels draws several times side by side; --animate makes a GIF of all times. If the box is deep, the script shows the middle
third along y, as a section through the bed.
"""

from __future__ import annotations

# First, because it says what to do if numpy is missing.
from talcum_results import (
    Array,
    ResultsError,
    argument_parser,
    axis_label,
    draw_spheres,
    new_figure,
    picture_of,
    result_file,
    run_script,
    save_figure,
    snapshot_rows,
    snapshot_times,
)

import argparse
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import h5py
import numpy as np
from matplotlib import colormaps
from matplotlib.animation import FuncAnimation, PillowWriter
from matplotlib.collections import EllipseCollection
from matplotlib.colors import Colormap, ListedColormap
from matplotlib.figure import Figure

MOST_CLASSES = 12
"""With more numbers than this, a colour scale is continuous."""
SECTION_FROM = 8.0
"""Least depth of a bed along y, in mean diameters, for which a section is shown."""


@dataclass
class Snapshot:
    """Particles at one time: a row of x and z, a diameter, and the value that colours each."""

    time: float
    place: Array
    diameter: Array
    value: Array


@dataclass
class Bed:
    """The snapshots of a run, and the meaning of their colours."""

    snapshots: list[Snapshot]
    label: str
    units: dict[str, str]
    are_diameters: bool = False

    @cached_property
    def values(self) -> Array:
        """The values that colour the particles of all snapshots, without NaN."""
        values = np.concatenate([snapshot.value for snapshot in self.snapshots])
        return values[np.isfinite(values)]

    @cached_property
    def sizes(self) -> Array:
        """The diameters, ascending, if colours stand for a few of them; otherwise none."""
        sizes = np.unique(self.values) if self.are_diameters else self.values[:0]
        return sizes if 2 <= len(sizes) <= MOST_CLASSES else sizes[:0]

    @cached_property
    def is_numbered(self) -> bool:
        """Whether colours stand for numbers of classes or contacts, or for a few sizes."""
        return len(self.sizes) > 0 or are_numbers_of_few(self.values)

    @cached_property
    def limits(self) -> tuple[float, float]:
        """The range of the colours, except for a few fast particles."""
        if len(self.values) == 0:
            return 0.0, 1.0
        if len(self.sizes) > 0:
            return -0.5, len(self.sizes) - 0.5
        if self.is_numbered:
            # Each number has a colour of its own.
            return float(self.values.min()) - 0.5, float(self.values.max()) + 0.5
        low, high = np.percentile(self.values, [1.0, 99.0])
        return float(low), float(high if high > low else low + 1.0)

    def coloured(self, value: Array) -> Array:
        """The values of a snapshot that colours show; for a few sizes, the number of the size."""
        return np.searchsorted(self.sizes, value).astype(float) if len(self.sizes) > 0 else value


def value_of(data: h5py.Group, rows: slice, colour: str, file: Path) -> Array:
    """The values that colour the particles of a snapshot."""
    if colour == "speed":
        return np.linalg.norm(data["velocity"][rows], axis=1)
    if colour == "rise":
        return data["velocity"][rows][:, 2]
    if colour == "size":
        return 2.0 * data["radius"][rows]
    if colour not in data:
        shown = ", ".join(["speed", "rise", "size", *sorted(data)])
        raise ResultsError(f"{file}: has no {colour}, only {shown}: see output.particle_fields and output.agglomerates")
    values = data[colour][rows]
    if colour == "agglomerate":
        # Neighbouring numbers get distant colours; particles in no agglomerate are left grey.
        return np.where(values < 0, np.nan, values * 7 % 20)
    return values.astype(float) if values.ndim == 1 else np.linalg.norm(values, axis=1)


def read_bed(folder: Path, colour: str, start: float | None, end: float | None) -> Bed:
    """The snapshots between two times."""
    file = result_file(folder, "particles.vtkhdf")
    with h5py.File(file) as contents:
        root = contents["VTKHDF"]
        data = root["PointData"]
        snapshots = []
        for step, time in enumerate(snapshot_times(root)):
            if (start is not None and time < start) or (end is not None and time > end):
                continue
            rows = snapshot_rows(root, step)
            points, diameter = root["Points"][rows], 2.0 * data["radius"][rows]
            shown = section(points[:, 1], diameter)
            value = value_of(data, rows, colour, file)
            snapshots.append(Snapshot(float(time), points[shown][:, [0, 2]], diameter[shown], value[shown]))
        units = {"length": root["Points"].attrs["unit"], "time": root["Steps/Values"].attrs["unit"]}
        label = label_of(data, colour, units["length"])
    if not snapshots:
        raise ResultsError(f"{file}: holds no snapshot at these times")
    return Bed(snapshots, label, units, colour == "size")


def label_of(data: h5py.Group, colour: str, length: str) -> str:
    """The label of the colours."""
    speed = data["velocity"].attrs["unit"]
    labels = {"speed": ("speed", speed), "rise": ("vertical velocity", speed), "size": ("diameter", length)}
    name, unit = labels.get(colour) or (colour.replace("_", " "), data[colour].attrs["unit"])
    return axis_label(name, unit) if unit != "1" else name


def section(y: Array, diameter: Array) -> Array:
    """The particles in the middle third along y if the bed is deep, else all."""
    if len(y) == 0 or np.ptp(y) < SECTION_FROM * diameter.mean():
        return np.ones(len(y), bool)
    middle = 0.5 * (y.min() + y.max())
    return np.abs(y - middle) < np.ptp(y) / 6.0


def are_numbers_of_few(values: Array) -> bool:
    """Whether values are numbers of classes or contacts: whole, and few."""
    return len(values) > 0 and np.ptp(values) <= MOST_CLASSES and bool(np.all(values == np.round(values)))


def frame(bed: Bed) -> tuple[float, float, float]:
    """The part that is shown: limits along x, and the height, except for a few particles that fly far above."""
    x = np.concatenate([snapshot.place[:, 0] for snapshot in bed.snapshots])
    z = np.concatenate([snapshot.place[:, 1] for snapshot in bed.snapshots])
    margin = 0.5 * bed.snapshots[0].diameter.max(initial=0.0)
    return float(x.min() - margin), float(x.max() + margin), float(np.percentile(z, 99.9) + 2.0 * margin)


def spheres(panel, snapshot: Snapshot, bed: Bed) -> EllipseCollection:
    """The particles of a snapshot in a panel."""
    drawn = draw_spheres(panel, snapshot.place, snapshot.diameter, bed.coloured(snapshot.value))
    drawn.set_clim(*bed.limits)
    if bed.is_numbered:
        low, high = bed.limits
        # Light enough for outlines, which keep neighbours of one colour apart.
        drawn.set(cmap=class_colours(int(high - low)))
        drawn.set(edgecolor="black", linewidth=0.3)
    panel.set_title(axis_label(f"time {snapshot.time:.4g}", bed.units["time"]))
    return drawn


def class_colours(count: int) -> Colormap:
    """A colour for each of `count` classes; if there are few, neighbours differ strongly."""
    few = colormaps["Set2"].colors
    return ListedColormap(few[:count]) if count <= len(few) else colormaps["viridis"].resampled(count)


def empty_panels(bed: Bed, count: int) -> tuple[Figure, Array]:
    """Panels for `count` snapshots side by side."""
    left, right, top = frame(bed)
    tall = top / (right - left)
    width = min(max(4.5 / tall, 1.8), 9.0 if count == 1 else 5.0)
    figure, panels = new_figure(1, count, (width * count + 1.2, min(width * tall, 9.0) + 1.6))
    for panel in panels[0]:
        panel.set(xlim=(left, right), ylim=(0.0, top), aspect="equal")
        panel.locator_params(axis="x", nbins=2)
        panel.set_xlabel(axis_label("x", bed.units["length"]))
        panel.grid(False)
    panels[0, 0].set_ylabel(axis_label("z", bed.units["length"]))
    return figure, panels


def draw(bed: Bed, count: int) -> Figure:
    """Draws `count` of the snapshots side by side, evenly spread and including the last."""
    places = np.unique(np.linspace(len(bed.snapshots) - 1, 0, count).round().astype(int)) if count > 1 else [-1]
    shown = [bed.snapshots[place] for place in places]
    figure, panels = empty_panels(bed, len(shown))
    for panel, snapshot in zip(panels[0], shown):
        drawn = spheres(panel, snapshot, bed)
    key = figure.colorbar(drawn, ax=list(panels[0]), location="right", label=bed.label, shrink=0.6)
    if bed.is_numbered:
        low, high = bed.limits
        key.set_ticks(np.arange(low + 0.5, high), labels=[f"{size:.4g}" for size in bed.sizes] or None)
    return figure


def animate(bed: Bed, file: Path) -> None:
    """Makes a GIF of all snapshots, with twelve frames a second."""
    figure, panels = empty_panels(bed, 1)
    panel = panels[0, 0]
    figure.colorbar(spheres(panel, bed.snapshots[0], bed), ax=panel, location="right", label=bed.label)

    def show(number: int) -> list[EllipseCollection]:
        for collection in list(panel.collections):
            collection.remove()
        return [spheres(panel, bed.snapshots[number], bed)]

    try:
        FuncAnimation(figure, show, frames=len(bed.snapshots)).save(file, writer=PillowWriter(fps=12), dpi=80)
    except OSError as error:
        raise ResultsError(f"{file}: cannot be written: {error}") from error
    print(f"animation: {file}")


def parser() -> argparse.ArgumentParser:
    """The options."""
    options = argument_parser(__doc__, "particles.png")
    meaning = "what colours the particles: speed, rise, size, agglomerate, or another dataset of the file (default: speed)"
    options.add_argument("--colour", default="speed", metavar="NAME", help=meaning)
    options.add_argument("--panels", type=int, default=1, metavar="N", help="times side by side (default: only the last)")
    options.add_argument("--animate", type=Path, metavar="FILE", help="make a GIF of all times as well")
    return options


def main(words: list[str] | None = None) -> None:
    """Reads and draws."""
    arguments = parser().parse_args(words)
    if arguments.panels < 1:
        raise ResultsError(f"--panels {arguments.panels}: at least 1 is needed")
    bed = read_bed(arguments.results, arguments.colour, arguments.start, arguments.end)
    save_figure(draw(bed, arguments.panels), picture_of(arguments, "particles.png"))
    if arguments.animate is not None:
        animate(bed, arguments.animate)


if __name__ == "__main__":
    run_script(main)
