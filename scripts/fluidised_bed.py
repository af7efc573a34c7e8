"""Draws a bed in a volume-averaged gas: its particles, and the velocity (arrows) and voidage (grey) of the gas.

Particles are coloured by speed, or by the size of their agglomerates (--colour members) if the case has
output.agglomerates; particles in no agglomerate are grey.

Both are cut in the middle along y: the figure shows particles whose centres are in the middle third of the box, and the
middle layer of cells. It shows the last time in particles.vtkhdf and gas.vtkhdf, or the time --to. The script prints the mean
of the pressure drop and its standard deviation, over the rows of series.csv between --from and --to.
"""

from __future__ import annotations

# First, because it says what to do if numpy is missing.
from talcum_results import (
    RED,
    ResultsError,
    argument_parser,
    axis_label,
    draw_spheres,
    new_figure,
    picture_of,
    read_series,
    result_file,
    run_script,
    save_figure,
    snapshot_rows,
    snapshot_times,
)

from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

Array = np.ndarray


@dataclass
class Bed:
    """Particles and gas at one time, cut in the middle along y."""

    time: float
    lengths: Array
    centres: Array
    colours: Array
    label: str
    are_members: bool
    diameters: Array
    voidage: Array
    velocity: Array
    units: dict[str, str]


def step_at(times: Array, time: float | None) -> int:
    """The last step, or the last one not after a time."""
    steps = np.flatnonzero(times <= time) if time is not None else np.arange(len(times))
    if len(steps) == 0:
        raise ResultsError("there is no snapshot at or before that time" if len(times) else "there is no snapshot")
    return int(steps[-1])


def members_of(labels: Array) -> Array:
    """For each particle, the number of members of its agglomerate; NaN if it is in none and has a label below 0."""
    _, places, counts = np.unique(labels, return_inverse=True, return_counts=True)
    return np.where(labels < 0, np.nan, counts[places.ravel()])


def colours_of(data: h5py.Group, rows: slice, colour: str) -> tuple[Array, str]:
    """The values that colour the particles of a snapshot, and their label."""
    if colour == "speed":
        return np.linalg.norm(data["velocity"][rows], axis=1), axis_label("speed", data["velocity"].attrs["unit"])
    if "agglomerate" not in data:
        raise ResultsError("particles.vtkhdf has no agglomerates: see output.agglomerates")
    return members_of(data["agglomerate"][rows]), "members of the agglomerate; grey: in none"


def read_bed(folder: Path, time: float | None, colour: str = "speed") -> Bed:
    """The last snapshot in both files that is not after a time."""
    with (
        h5py.File(result_file(folder, "particles.vtkhdf")) as particles,
        h5py.File(result_file(folder, "gas.vtkhdf")) as gas,
    ):
        particles, gas = particles["VTKHDF"], gas["VTKHDF"]
        gas_step = step_at(snapshot_times(gas), time)
        step = step_at(snapshot_times(particles), gas["Steps/Values"][gas_step])
        rows = snapshot_rows(particles, step)
        data, cells = particles["PointData"], gas["CellData"]
        shape = cells["voidage"].shape
        middle = shape[2] // 2
        return Bed(
            particles["Steps/Values"][step],
            np.array(shape[:0:-1]) * gas.attrs["Spacing"],
            particles["Points"][rows],
            *colours_of(data, rows, colour),
            colour == "members",
            2.0 * data["radius"][rows],
            cells["voidage"][gas_step, :, middle],
            cells["velocity"][gas_step, :, middle],
            {
                "length": particles["Points"].attrs["unit"],
                "speed": data["velocity"].attrs["unit"],
                "time": particles["Steps/Values"].attrs["unit"],
            },
        )


def draw_particles(figure: Figure, panel, bed: Bed) -> None:
    inside = np.abs(bed.centres[:, 1] - 0.5 * bed.lengths[1]) < bed.lengths[1] / 6.0
    spheres = draw_spheres(panel, bed.centres[inside][:, [0, 2]], bed.diameters[inside], bed.colours[inside])
    shown = bed.colours[np.isfinite(bed.colours)]
    if len(shown) and not bed.are_members:
        spheres.set_clim(0.0, np.percentile(shown, 99.0))
    panel.set_title(f"particles, {axis_label(f'time {bed.time:.4g}', bed.units['time'])}")
    key = figure.colorbar(spheres, ax=panel, location="bottom", label=bed.label)
    if len(shown) and bed.are_members:
        low, high = shown.min(), max(shown.max(), 2.0 * shown.min())
        spheres.set_norm(LogNorm(low, high))
        marks = round_marks(low, high)
        key.set_ticks(marks, labels=[str(mark) for mark in marks])
        key.set_ticks([], minor=True)


def round_marks(low: float, high: float) -> list[int]:
    """The numbers 1, 2, 5, 10, 20 ... between two limits, as marks of a logarithmic scale."""
    marks = (digit * 10**power for power in range(9) for digit in (1, 2, 5))
    return [mark for mark in marks if low <= mark <= high]


def draw_gas(figure: Figure, panel, bed: Bed, top: float) -> None:
    """Voidage as shades of grey, and the velocity of the gas as thin arrows on it, with a key."""
    nz, nx = bed.voidage.shape
    extent = (0.0, bed.lengths[0], 0.0, bed.lengths[2])
    field = panel.imshow(bed.voidage, origin="lower", extent=extent, cmap="gray", vmin=0.3, vmax=1.0)
    x = (np.arange(nx) + 0.5) * bed.lengths[0] / nx
    z = (np.arange(nz) + 0.5) * bed.lengths[2] / nz
    shown = z < top
    arrows = bed.velocity[shown]
    # The fastest gas has arrows two cells long.
    fastest = np.percentile(np.linalg.norm(arrows, axis=-1), 99.0)
    scale = fastest / (2.0 * bed.lengths[2] / nz) or 1.0
    panel.quiver(
        x,
        z[shown],
        arrows[..., 0],
        arrows[..., 2],
        color=RED,
        pivot="mid",
        angles="xy",
        scale_units="xy",
        scale=scale,
        width=0.006,
    )
    # The key is in the title, because the layout would not count a key next to it and would cut it off above high panels.
    panel.set_title(f"gas, {axis_label(f'arrows to {fastest:.2g}', bed.units['speed'])}; voidage", loc="left")
    figure.colorbar(field, ax=panel, location="bottom", label="voidage")


def draw(bed: Bed) -> Figure:
    """Draws both panels side by side, up to a height above the bed."""
    # A few particles that fly far above are left out.
    highest = np.percentile(bed.centres[:, 2], 99.9) if len(bed.centres) else 0.0
    top = min(bed.lengths[2], max(1.2 * highest, bed.lengths[0]))
    figure, panels = new_figure(1, 2, (8.0, 2.2 + 3.4 * top / bed.lengths[0]))
    draw_particles(figure, panels[0, 0], bed)
    draw_gas(figure, panels[0, 1], bed, top)
    for panel in panels[0]:
        panel.set(xlim=(0.0, bed.lengths[0]), ylim=(0.0, top), aspect="equal")
        panel.locator_params(axis="x", nbins=4)
        panel.set_xlabel(axis_label("x", bed.units["length"]))
        panel.grid(False)
    panels[0, 0].set_ylabel(axis_label("z", bed.units["length"]))
    return figure


def main(words: list[str] | None = None) -> None:
    parser = argument_parser(__doc__, "bed.png")
    meaning = "what colours the particles (default: speed)"
    parser.add_argument("--colour", choices=["speed", "members"], default="speed", help=meaning)
    arguments = parser.parse_args(words)
    bed = read_bed(arguments.results, arguments.end, arguments.colour)
    rows = read_series(arguments.results).between(arguments.start, arguments.end)
    drop = rows["grid_pressure_drop"]
    print(f"pressure drop over weight: mean {drop.mean():.4f}, standard deviation {drop.std():.4f}")
    save_figure(draw(bed), picture_of(arguments, "bed.png"))


if __name__ == "__main__":
    run_script(main)
