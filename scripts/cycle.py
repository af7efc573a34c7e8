"""Draws a vibrated bed over one cycle of the plate: stress on the plate, pressure drop, their sum, and the bed's bottom.

Frequency, amplitude and phase follow from the effective gravity in series.csv, 1 + Gamma sin(2 pi f t); at
phase 0 it rises through 1. Rows of many cycles are averaged at equal phase; bands show one standard
deviation. The sum and the effective gravity differ by the acceleration of the bed's centre of mass.
"""

from __future__ import annotations

from dataclasses import dataclass

# First, because it says what to do if numpy is missing.
from talcum_results import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    RED,
    Array,
    ResultsError,
    Series,
    argument_parser,
    new_figure,
    picture_of,
    read_series,
    run_script,
    save_figure,
)

import numpy as np

LEAST_ROWS_PER_CYCLE = 8
LEAST_CYCLES = 2


@dataclass
class Vibration:
    """Frequency, Gamma, time of phase 0, and how well the effective gravity follows 1 + Gamma sin."""

    frequency: float
    gamma: float
    start: float

    def phase(self, time: Array) -> Array:
        """The phase of times, as a part of a cycle from 0 up to 1."""
        # Rounded, so that a phase of 0 does not become 1 - 1e-16.
        return np.round((time - self.start) * self.frequency, 9) % 1.0


@dataclass
class Cycle:
    """Means and standard deviations of columns at phases."""

    phase: Array
    mean: dict[str, Array]
    deviation: dict[str, Array]
    cycles: float


def fit_sine(time: Array, values: Array, frequency: float) -> tuple[Array, float]:
    """Fits 1, sin and cos at a frequency by least squares, and returns the coefficients and the rms of the residual."""
    angle = 2.0 * np.pi * frequency * time
    basis = np.column_stack([np.ones_like(time), np.sin(angle), np.cos(angle)])
    coefficients, *_ = np.linalg.lstsq(basis, values, rcond=None)
    return coefficients, float(np.sqrt(np.mean((values - basis @ coefficients) ** 2)))


def find_frequency(time: Array, values: Array) -> float:
    """The frequency of a sine: the strongest in the spectrum, refined by least squares."""
    interval = float(np.median(np.diff(time)))
    even = np.arange(time[0], time[-1], interval)
    strength = np.abs(np.fft.rfft(np.interp(even, time, values) - values.mean()))
    resolution = 1.0 / (len(even) * interval)
    frequency, width = float(np.argmax(strength)) * resolution, resolution
    while width > 1e-9 * frequency and width > 0.0:
        tries = frequency + width * np.linspace(-1.0, 1.0, 9)
        tries = tries[tries > 0.0]
        frequency = float(tries[np.argmin([fit_sine(time, values, value)[1] for value in tries])])
        width *= 0.4
    return frequency


def find_vibration(series: Series, frequency: float | None) -> Vibration:
    """Frequency, Gamma and phase from the effective gravity; an error if the plate is at rest."""
    gravity, time = series["effective_gravity"], series.time
    if len(time) < 2 * LEAST_ROWS_PER_CYCLE:
        raise ResultsError(f"{len(time)} rows of series.csv are too few")
    if np.ptp(gravity) < 1e-9:
        raise ResultsError("the effective gravity is constant: the plate does not vibrate in these results")
    origin = time[0]
    frequency = frequency or find_frequency(time - origin, gravity)
    (_, sine, cosine), left = fit_sine(time - origin, gravity, frequency)
    gamma = float(np.hypot(sine, cosine))
    if left > 0.01 * gamma:
        raise ResultsError(
            f"the effective gravity is not a sine of frequency {frequency:.6g} in these rows; choose with --from and "
            "--to a part with one Gamma and one frequency"
        )
    start = origin - np.arctan2(cosine, sine) / (2.0 * np.pi * frequency)
    return Vibration(frequency, gamma, float(start))


def average_over_phase(series: Series, vibration: Vibration, bins: int) -> Cycle:
    """Averages the rows at equal phase, in bins centred on 0, 1/bins, ..., each at the mean phase of its rows; bins without rows are left out."""
    rows_per_cycle = 1.0 / (vibration.frequency * float(np.median(np.diff(series.time))))
    cycles = (series.time[-1] - series.time[0]) * vibration.frequency
    if rows_per_cycle < LEAST_ROWS_PER_CYCLE:
        raise ResultsError(
            f"{rows_per_cycle:.1f} rows per cycle are too few: give output.series in the case an interval below "
            f"{1.0 / (vibration.frequency * 20):.3g}"
        )
    if cycles < LEAST_CYCLES:
        raise ResultsError(f"the results span {cycles:.2f} cycles; at least {LEAST_CYCLES} are needed")
    bins = min(bins, int(rows_per_cycle + 1e-6))
    phase = vibration.phase(series.time)
    # Rounded, so that rows on the edge of a bin all go one way.
    nearest = np.floor(np.round(phase * bins, 4) + 0.5).astype(int)
    place, aside = nearest % bins, phase - nearest / bins
    used = np.unique(place)
    mean, deviation = {}, {}
    for name, values in columns_of_a_cycle(series).items():
        mean[name] = np.array([np.nanmean(values[place == index]) for index in used])
        deviation[name] = np.array([np.nanstd(values[place == index]) for index in used])
    phases = np.array([index / bins + np.mean(aside[place == index]) for index in used])
    return Cycle(phases, mean, deviation, cycles)


def columns_of_a_cycle(series: Series) -> dict[str, Array]:
    """The columns that are averaged: some of the series, and the sum of plate stress and pressure drop."""
    names = ["plate_stress", "grid_pressure_drop", "gas_force", "effective_gravity", "bed_bottom", "centre_velocity"]
    columns = {name: series[name] for name in names}
    columns["sum"] = series["plate_stress"] + series["grid_pressure_drop"]
    return columns


def describe(vibration: Vibration, cycle: Cycle, series: Series) -> str:
    """The line of numbers that is printed."""
    difference = cycle.mean["sum"] - cycle.mean["effective_gravity"]
    bottom = cycle.mean["bed_bottom"]
    peak = int(np.argmax(cycle.mean["plate_stress"]))
    return (
        f"f {vibration.frequency:.6g}, Gamma {vibration.gamma:.4g}, {cycle.cycles:.1f} cycles, mean pressure drop "
        f"{series['grid_pressure_drop'].mean():.4g}, peak plate stress {cycle.mean['plate_stress'][peak]:.4g} at phase "
        f"{cycle.phase[peak]:.3g}, greatest height of the bottom {np.nanmax(bottom):.4g}, rms of plate stress + "
        f"pressure drop - 1 - Gamma sin {np.sqrt(np.mean(difference**2)):.3g}"
    )


def draw_line(panel, cycle: Cycle, name: str, words: str, colour: str, style: str = "-") -> None:
    """A mean over the cycle, closed to phase 1, with a band of one standard deviation."""
    phase = np.append(cycle.phase, cycle.phase[0] + 1.0)
    mean = np.append(cycle.mean[name], cycle.mean[name][0])
    deviation = np.append(cycle.deviation[name], cycle.deviation[name][0])
    panel.fill_between(phase, mean - deviation, mean + deviation, color=colour, alpha=0.18, linewidth=0.0)
    panel.plot(phase, mean, style, color=colour, label=words)


def draw(series: Series, vibration: Vibration, cycle: Cycle):
    """Draws stresses (above) and the bed's bottom (below) over one cycle."""
    figure, panels = new_figure(2, 1, size=(8.5, 8.0))
    stresses, bottom = panels[:, 0]
    phase = np.linspace(0.0, 1.0, 201)
    draw_line(stresses, cycle, "plate_stress", "stress on the plate", ORANGE)
    draw_line(stresses, cycle, "grid_pressure_drop", "pressure drop", BLUE)
    draw_line(stresses, cycle, "sum", "sum of both", BLACK)
    theory = 1.0 + vibration.gamma * np.sin(2.0 * np.pi * phase)
    stresses.plot(phase, theory, "--", color=GREY, label=r"$1 + \Gamma \sin 2\pi f t$")
    stresses.set_ylabel("over the bed's weight per area")
    stresses.legend(loc="best", framealpha=0.8)
    draw_line(bottom, cycle, "bed_bottom", "bottom of the bed", RED)
    bottom.set_ylabel(series.label("bed_bottom", "bottom of the bed"))
    velocity = bottom.twinx()
    velocity.grid(False)
    velocity.spines["right"].set_visible(True)
    draw_line(velocity, cycle, "centre_velocity", "velocity of the centre of mass", GREEN, "--")
    velocity.set_ylabel(series.label("centre_velocity", "velocity of the centre of mass"), color=GREEN)
    for panel in (stresses, bottom):
        panel.set_xlim(0.0, 1.0)
    bottom.set_xlabel("phase of the plate, $f t$")
    stresses.set_title(rf"$\Gamma$ = {vibration.gamma:.3g}, $f$ = {vibration.frequency:.3g}")
    return figure


def main(command_line: list[str] | None = None) -> None:
    """Reads, averages, draws."""
    parser = argument_parser(__doc__, "cycle.png")
    parser.add_argument("--frequency", type=float, metavar="F", help="frequency (default: found in the series)")
    parser.add_argument("--bins", type=int, default=50, metavar="N", help="phases in a cycle (default: 50)")
    arguments = parser.parse_args(command_line)
    if arguments.bins < LEAST_ROWS_PER_CYCLE:
        raise ResultsError(f"--bins {arguments.bins}: at least {LEAST_ROWS_PER_CYCLE} are needed")
    if arguments.frequency is not None and not arguments.frequency > 0.0:
        raise ResultsError(f"--frequency {arguments.frequency:g}: must be positive")
    series = read_series(arguments.results).between(arguments.start, arguments.end)
    vibration = find_vibration(series, arguments.frequency)
    cycle = average_over_phase(series, vibration, arguments.bins)
    print(describe(vibration, cycle, series))
    save_figure(draw(series, vibration, cycle), picture_of(arguments, "cycle.png"))


if __name__ == "__main__":
    run_script(main)
