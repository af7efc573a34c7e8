"""Compares the spouted bed of Yue et al. (2020) with its experiment: the mean speed of the beads over the width, at six heights.

    talcum run cases/experiments/yue2020.toml
    scripts/report yue2020 results/yue2020

Speeds are those of particles near the front and the back wall, where the camera sees them, from particles.vtkhdf. The measured
values are in cases/experiments/measured. With --keep the speeds are also written to a small table, which this script reads in place
of a run.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

# First, because it says what to do if numpy is missing.
from talcum_results import (
    BLACK,
    BLUE,
    GREY,
    Array,
    argument_parser,
    new_figure,
    picture_of,
    read_series,
    result_file,
    rows_between,
    run_script,
    save_figure,
    snapshot_rows,
    snapshot_times,
)

import h5py
import numpy as np
from matplotlib.figure import Figure

from .experiment import MEASURED, provenance

AT_REST = 0.2
"""Height of the bed at rest [m]."""
MIDDLE = 0.14
"""Place along x where the jet enters [m]."""
DEPTH = 0.04
"""Depth of the box along y [m]."""
SEEN = 3.75e-3
"""Particles count whose centres are so near to the front or the back wall: a diameter and a half [m]."""
HALF_WIDTH, HALF_HEIGHT = 3.5e-3, 4.0e-3
"""Half of a window along x and z: the windows of the experiment follow one another after 7 mm [m]."""
STEADY = 1.3
"""Time from which the run counts if nothing else is asked: 1 s after the jet was turned on."""


@dataclass
class Profile:
    """Mean speed over the width at one height."""

    place: Array
    """Distance from the middle along x [m]."""
    speed: Array
    """Mean speed [m/s]; undefined where no particle came by."""

    @property
    def peak(self) -> float:
        """The highest speed."""
        return float(np.nanmax(self.speed))

    @property
    def width(self) -> float:
        """Width over which the speed is above half of its peak, about the peak; the profile is taken as straight between places."""
        fine = np.linspace(self.place[0], self.place[-1], 2001)
        high = np.interp(fine, self.place, np.nan_to_num(self.speed)) > 0.5 * self.peak
        middle = int(np.argmin(np.abs(fine - self.place[np.nanargmax(self.speed)])))
        before, after = np.flatnonzero(~high[:middle]), np.flatnonzero(~high[middle:])
        first = before[-1] + 1 if len(before) else 0
        last = middle + after[0] - 1 if len(after) else len(fine) - 1
        return float(fine[last] - fine[first])


Profiles = dict[float, Profile]


def measured() -> Profiles:
    """The profiles of the experiment by height over that of the bed at rest."""
    return read_table(MEASURED / "yue2020.csv")


def read_table(file: Path) -> Profiles:
    """The profiles of a table."""
    table = read_series(file)
    heights = table["height_at_rest"]
    rows_of = {float(height): heights == height for height in np.unique(heights)}
    return {height: Profile(table["x"][rows] * 1e-3, table["speed"][rows]) for height, rows in rows_of.items()}


def of_run(results: Path, start: float | None, end: float | None) -> tuple[Profiles, list[str]]:
    """The profiles of a run, or of the table that was kept of one, at the places of the experiment; and where they come from."""
    if results.is_file():
        return read_table(results), provenance(results)
    of_experiment = measured()
    with h5py.File(result_file(results, "particles.vtkhdf")) as file:
        root = file["VTKHDF"]
        times = snapshot_times(root)
        steps = np.flatnonzero(rows_between(times, STEADY if start is None else start, end))
        sums = [speeds_of(root, int(step), of_experiment) for step in steps]
    looks = f"# mean of {len(steps)} snapshots from {times[steps[0]]:g} to {times[steps[-1]]:g} s"
    profiles = {}
    for height, profile in of_experiment.items():
        count, speed = np.sum([sums_of[height] for sums_of in sums], axis=0)
        profiles[height] = Profile(profile.place, np.divide(speed, count, out=np.full(len(count), np.nan), where=count > 0))
    return profiles, [*provenance(results), looks]


def speeds_of(root: h5py.Group, step: int, places: Profiles) -> dict[float, Array]:
    """Number of particles and sum of their speeds in the windows of each height, as seen from the front."""
    rows = snapshot_rows(root, step)
    position, velocity = root["Points"][rows], root["PointData/velocity"][rows]
    seen = np.minimum(position[:, 1], DEPTH - position[:, 1]) <= SEEN
    position, speed = position[seen], np.hypot(velocity[seen, 0], velocity[seen, 2])
    found = {}
    for height, profile in places.items():
        at_height = np.abs(position[:, 2] - height * AT_REST) <= HALF_HEIGHT
        across = np.abs(position[at_height, 0] - MIDDLE - profile.place[:, np.newaxis]) <= HALF_WIDTH
        found[height] = np.array([across.sum(axis=1), (across * speed[at_height]).sum(axis=1)])
    return found


def compared(of_experiment: Profiles, found: Profiles) -> list[str]:
    """The rows of the table."""
    lines = ["| height over that at rest | peak speed [m/s] | Talcum | width at half the peak [mm] | Talcum |", "| --- | --- | --- | --- | --- |"]
    for height, profile in of_experiment.items():
        of_talcum = found[height]
        peaks = f"{profile.peak:.2f} | {of_talcum.peak:.2f}"
        lines.append(f"| {height:g} | {peaks} | {1e3 * profile.width:.0f} | {1e3 * of_talcum.width:.0f} |")
    return lines


def keep(found: Profiles, comments: list[str], file: Path) -> None:
    """Writes the profiles as a table."""
    lines = [f"{height:g},{1e3 * x:.3f},{v:.4g}" for height, profile in found.items() for x, v in zip(profile.place, profile.speed)]
    file.write_text("\n".join([*comments, "height_at_rest [1],x [mm],speed [m/s]", *lines]) + "\n", encoding="utf-8")
    print(f"table: {file}")


def draw(of_experiment: Profiles, found: Profiles) -> Figure:
    """A panel for each height."""
    figure, panels = new_figure(2, 3, size=(14.0, 7.5))
    for panel, (height, profile) in zip(panels.flat, of_experiment.items()):
        panel.plot(1e3 * profile.place, profile.speed, "o", color=BLACK, markersize=3.5, label="experiment")
        panel.plot(1e3 * found[height].place, found[height].speed, color=BLUE, linewidth=1.5, label="Talcum")
        panel.axvline(0.0, color=GREY, linewidth=0.6)
        panel.set_title(f"{height:g} of the height at rest", loc="left", fontsize=10)
        panel.set_xlabel("distance from the middle [mm]")
        panel.set_ylabel("mean speed of the beads [m/s]")
    panels[0, 0].legend()
    return figure


def main(command_line: list[str] | None = None) -> None:
    """Prints the table, draws, keeps the profiles if asked."""
    parser = argument_parser(__doc__, "yue2020.png")
    parser.add_argument("--keep", type=Path, metavar="FILE", help="write the speeds of the run to this table")
    arguments = parser.parse_args(command_line)
    found, comments = of_run(arguments.results, arguments.start, arguments.end)
    of_experiment = measured()
    print("\n".join(compared(of_experiment, found)))
    if arguments.keep:
        keep(found, comments, arguments.keep)
    save_figure(draw(of_experiment, found), picture_of(arguments, "yue2020.png"))


if __name__ == "__main__":
    run_script(main)
