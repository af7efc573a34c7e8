"""Draws the solids fraction over height and time, and measures the waves that travel through the bed.

The waves are measured by the two-dimensional correlation of the solids fraction's fluctuation with itself,
shifted in height and time. The period is the time shift after which the fluctuation at one height
resembles itself again; the speed is that of the straight ray through height and time shifts along which the
resemblance lasts best; the wavelength is the product of both. Waves that rise have positive speeds.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

# First, because it says what to do if numpy is missing.
from talcum_results import (
    BLUE,
    Array,
    Profiles,
    ResultsError,
    argument_parser,
    axis_label,
    new_figure,
    picture_of,
    read_profiles,
    run_script,
    save_figure,
    velocity_unit,
)

import numpy as np
from matplotlib import colormaps

# Below these correlations a fluctuation is taken for noise. Independent rows of a long record stay below 0.1.
LEAST_CORRELATION = 0.2
# A wave is said to travel if its own direction correlates at least so much better than the opposite one; both
# are equal in a standing wave.
LEAST_CONTRAST = 1.5


@dataclass
class Waves:
    """Measured waves: speed (positive: rising), wavelength, period."""

    speed: float
    wavelength: float
    period: float


class NoWave(Exception):
    """Why no wave was found, in words."""


def bed_rows(profiles: Profiles) -> Array:
    """The nodes within the bed: denser on average than half the densest, without a twentieth at either end."""
    mean = profiles.solids_fraction.mean(axis=0)
    inside = np.flatnonzero(mean > 0.5 * mean.max())
    if mean.max() <= 0.0 or len(inside) < 8:
        raise ResultsError("the bed spans fewer than 8 heights of the profiles: too few to measure waves in")
    trim = max(1, len(inside) // 20)
    return np.arange(inside[0] + trim, inside[-1] + 1 - trim)


def fluctuation(profiles: Profiles, nodes: Array) -> Array:
    """Solids fraction less its straight-line trend in time at each height; array [time][height]."""
    values = profiles.solids_fraction[:, nodes]
    time = profiles.time - profiles.time.mean()
    slope = time @ (values - values.mean(axis=0)) / (time @ time)
    return values - values.mean(axis=0) - np.outer(time, slope)


def correlation(values: Array) -> Array:
    """Correlation C[time shift][height shift], shifts from -(n-1) to n-1, 1 at no shift.

    C(t, z) = <a(t', z') a(t' + t, z' + z)> / <a^2>, the mean over all t', z' for which both lie in the record.
    """
    rows, nodes = values.shape
    shape = (2 * rows, 2 * nodes)
    spectrum = np.fft.rfft2(values, shape)
    products = np.fft.irfft2(np.abs(spectrum) ** 2, shape)
    products = np.roll(products, (rows - 1, nodes - 1), axis=(0, 1))[: 2 * rows - 1, : 2 * nodes - 1]
    overlaps = np.outer(
        rows - np.abs(np.arange(1 - rows, rows)), nodes - np.abs(np.arange(1 - nodes, nodes))
    )
    return products / overlaps / np.mean(values**2)


def peak_position(values: Array, index: int) -> float:
    """The place of a maximum between points, by the parabola through three of them."""
    if index <= 0 or index >= len(values) - 1:
        return float(index)
    before, here, after = values[index - 1 : index + 2]
    curvature = before - 2.0 * here + after
    return index + (0.5 * (before - after) / curvature if curvature < 0.0 else 0.0)


def find_period(in_time: Array, interval: float) -> float:
    """The period, from the correlation over time shifts 0, 1, 2 ... at one height."""
    half = in_time[: len(in_time) // 2 + 1]
    negative = np.flatnonzero(half < 0.0)
    if len(negative) == 0:
        raise NoWave("the solids fraction does not oscillate within the record")
    beyond = half[negative[0] :]
    highest = beyond.max()
    if highest < LEAST_CORRELATION:
        raise NoWave(f"no period: the solids fraction resembles itself by {highest:.2f} at most")
    peaks = [
        index
        for index in range(negative[0] + 1, len(half) - 1)
        if half[index - 1] <= half[index] >= half[index + 1] and half[index] >= 0.7 * highest
    ]
    if not peaks:
        raise NoWave("no period: the record is too short for one")
    return peak_position(half, peaks[0]) * interval


def ray_means(table: Array, slownesses: Array, interval: float, spacing: float) -> Array:
    """Mean correlation along rays (time shift = slowness * height shift), over height shifts up to half the bed."""
    rows, nodes = (table.shape[0] + 1) // 2, (table.shape[1] + 1) // 2
    total = np.zeros(len(slownesses))
    shifts = range(1, max(2, nodes // 2) + 1)
    places = np.arange(1 - rows, rows) * interval
    for shift in shifts:
        total += np.interp(slownesses * shift * spacing, places, table[:, nodes - 1 + shift], left=0.0, right=0.0)
    return total / len(shifts)


def find_slowness(table: Array, period: float, interval: float, spacing: float) -> float:
    """The slowness (1 / speed) of the ray along which the correlation lasts best."""
    nodes = (table.shape[1] + 1) // 2
    steepest = period / (4.0 * spacing)  # a wavelength of four grid spacings
    step = min(0.5 * interval / (spacing * max(2, nodes // 2)), steepest / 50.0)
    count = int(np.ceil(steepest / step))
    slownesses = np.arange(-count, count + 1) * step
    means = ray_means(table, slownesses, interval, spacing)
    best = int(np.argmax(means))
    if means[best] < LEAST_CORRELATION:
        raise NoWave(f"the oscillation does not travel: correlation along the best ray is {means[best]:.2f}")
    if means[best] < LEAST_CONTRAST * means[len(means) - 1 - best]:
        raise NoWave("the oscillation stands, or the bed oscillates as a whole: no direction is preferred")
    return (peak_position(means, best) - count) * step


def measure_waves(profiles: Profiles, nodes: Array) -> Waves:
    """Speed, wavelength and period of the waves in the bed; NoWave if there are none."""
    values = fluctuation(profiles, nodes)
    if len(profiles.time) < 16:
        raise NoWave(f"{len(profiles.time)} times are too few to measure waves in")
    if np.mean(values**2) < 1e-12:
        raise NoWave("the bed is at rest")
    interval = float(np.median(np.diff(profiles.time)))
    spacing = float(np.median(np.diff(profiles.height)))
    table = correlation(values)
    rows = len(profiles.time)
    period = find_period(table[rows - 1 :, len(nodes) - 1], interval)
    slowness = find_slowness(table, period, interval, spacing)
    return Waves(1.0 / slowness, abs(period / slowness), period)


def even_times(profiles: Profiles) -> Profiles:
    """The profiles at even intervals of time (a stage's end may fall between two)."""
    intervals = np.diff(profiles.time)
    if len(intervals) == 0 or np.allclose(intervals, intervals[0], rtol=1e-6):
        return profiles
    step = float(np.median(intervals))
    wanted = np.arange(profiles.time[0], profiles.time[-1] + 0.5 * step, step)
    after = np.clip(np.searchsorted(profiles.time, wanted), 1, len(profiles.time) - 1)
    nearest = after - (wanted - profiles.time[after - 1] < profiles.time[after] - wanted)
    return Profiles(
        wanted,
        profiles.height,
        profiles.solids_fraction[nearest],
        profiles.solids_velocity[nearest],
        profiles.superficial_velocity[nearest],
        profiles.units,
        profiles.attributes,
    )


def describe(waves: Waves, rms: float, profiles: Profiles) -> str:
    """The line of numbers that is printed."""
    length, time = profiles.units["height"], profiles.units["time"]
    return (
        f"wave speed {waves.speed:.4g} {velocity_unit(length, time)}, wavelength {waves.wavelength:.4g} {length}, "
        f"period {waves.period:.4g} {time}, rms of phi {rms:.4g}"
    )


def draw(profiles: Profiles, waves: Waves | None, top: float | None, colours: str, picture: Path) -> None:
    """Draws solids fraction over time and height, with a line of the measured speed."""
    figure, panels = new_figure(size=(10.0, 5.5))
    panel = panels[0, 0]
    panel.grid(False)
    mesh = panel.pcolormesh(
        profiles.time, profiles.height, profiles.solids_fraction.T,
        cmap=colours, vmin=0.0, vmax=0.65, shading="nearest", rasterized=True,
    )  # fmt: skip
    dense = np.flatnonzero(profiles.solids_fraction.max(axis=0) > 0.02)
    highest = profiles.height[dense[-1]] * 1.05 if len(dense) else profiles.height[-1]
    panel.set_ylim(profiles.height[0], top if top is not None else highest)
    panel.set_xlabel(axis_label("time", profiles.units["time"]))
    panel.set_ylabel(axis_label("height", profiles.units["height"]))
    panel.set_title(str(profiles.attributes.get("title", "")), loc="left")
    figure.colorbar(mesh, ax=panel, label="solids fraction", extend="max")
    if waves is not None:
        draw_speed(panel, profiles, waves)
    save_figure(figure, picture)


def draw_speed(panel, profiles: Profiles, waves: Waves) -> None:
    """A line that rises (or sinks) with the waves' speed, to hold against the bands."""
    lower, upper = panel.get_ylim()
    left, right = profiles.time[0], profiles.time[-1]
    rise = min(0.6 * (upper - lower), 0.6 * (right - left) * abs(waves.speed))
    start = left + 0.08 * (right - left)
    foot = lower + 0.15 * (upper - lower) if waves.speed > 0 else lower + 0.15 * (upper - lower) + rise
    unit = velocity_unit(profiles.units["height"], profiles.units["time"])
    times = [start, start + rise / abs(waves.speed)]
    heights = [foot, foot + np.sign(waves.speed) * rise]
    panel.plot(times, heights, color="white", linewidth=4.0, solid_capstyle="round")
    panel.plot(times, heights, color=BLUE, linewidth=2.0, label=f"wave speed {waves.speed:.3g} {unit}")
    panel.legend(loc="lower right", facecolor="white", framealpha=0.9)


def measured_nodes(profiles: Profiles, between: list[float] | None) -> Array:
    """The nodes that waves are measured in: those that the user named, or the bed's."""
    if between is None:
        return bed_rows(profiles)
    nodes = np.flatnonzero((profiles.height >= between[0]) & (profiles.height <= between[1]))
    if len(nodes) < 8:
        raise ResultsError(f"--measure {between[0]:g} {between[1]:g} spans {len(nodes)} heights; 8 are needed")
    return nodes


def main(command_line: list[str] | None = None) -> None:
    """Reads, measures, draws."""
    parser = argument_parser(__doc__, "spacetime.png")
    parser.add_argument("--height", type=float, metavar="Z", help="top of the picture (default: top of the bed)")
    parser.add_argument(
        "--measure", type=float, nargs=2, metavar=("LOW", "HIGH"),
        help="measure between these heights (default: the bed)",
    )  # fmt: skip
    parser.add_argument(
        "--colours", default="magma_r", help="a colour map of matplotlib; perceptually uniform are "
        "magma_r (default), viridis, cividis, gray_r"
    )  # fmt: skip
    arguments = parser.parse_args(command_line)
    if arguments.colours not in colormaps:
        raise ResultsError(f"--colours {arguments.colours}: matplotlib has no such colour map")
    profiles = read_profiles(arguments.results).between(arguments.start, arguments.end)
    even = even_times(profiles)
    nodes = measured_nodes(even, arguments.measure)
    rms = float(np.sqrt(np.mean(fluctuation(even, nodes) ** 2)))
    try:
        waves: Waves | None = measure_waves(even, nodes)
        print(describe(waves, rms, even))
    except NoWave as reason:
        waves = None
        print(f"no wave found: {reason}; rms of phi {rms:.4g}")
    draw(even, waves, arguments.height, arguments.colours, picture_of(arguments, "spacetime.png"))


if __name__ == "__main__":
    run_script(main)
