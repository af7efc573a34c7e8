"""Compares the flat bed of van Wachem et al. (2001) with its experiment: pressure, voidage and height over time, and the spectrum.

    talcum run cases/experiments/van-wachem2001.toml
    scripts/report van-wachem2001 results/van-wachem2001

The measured values are in cases/experiments/measured. With --keep the signals of the run are also written to a small table, which
this script reads in place of a run.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

# First, because it says what to do if numpy is missing.
from talcum_results import (
    BLACK,
    BLUE,
    ORANGE,
    Array,
    ResultsError,
    argument_parser,
    new_figure,
    picture_of,
    read_series,
    result_file,
    run_script,
    save_figure,
    snapshot_rows,
    snapshot_times,
)

import h5py
import numpy as np
from matplotlib import mlab
from matplotlib.figure import Figure

from .experiment import MEASURED, provenance

STEADY = 2.2
"""Time from which the run counts if nothing else is asked: 2 s after the gas was turned on, as in the experiment's record."""
INTERVAL = 0.01
"""Interval of the signals that are compared and kept."""
DECLINE = (4.0, 20.0)
"""Frequencies over which the spectrum falls as a power [Hz]."""
NORMAL_QUANTILE = 1.96
"""Quantile of the normal distribution, for a confidence of 95 %."""


@dataclass
class Quantity:
    """The signals that are compared."""

    record: str
    """The experiment's record."""
    unit: str
    words: str


SIGNALS = {
    "pressure": Quantity("pressure", "Pa", "pressure"),
    "voidage": Quantity("voidage", "1", "voidage"),
    "top": Quantity("height", "m", "height, by a solids fraction of 0.3"),
    "reach": Quantity("height", "m", "height, of 99 % of the beads"),
}
RECORDS = {"pressure": "pressure less its mean [Pa]", "voidage": "voidage", "height": "height of the bed [m]"}
"""The experiment's records and their labels."""
COLOURS = {"pressure": BLUE, "voidage": BLUE, "top": BLUE, "reach": ORANGE}


@dataclass
class Signal:
    """A number over time."""

    time: Array
    values: Array

    @property
    def duration(self) -> float:
        """The duration from the first to the last time."""
        return float(self.time[-1] - self.time[0])

    @property
    def deviation(self) -> float:
        """Standard deviation over time."""
        return float(np.std(self.values))

    @property
    def cycle_frequency(self) -> float:
        """Cycles per time: from each rise through the mean, with a quarter of the deviation as hysteresis, to the next."""
        swing, margin = self.values - np.mean(self.values), 0.25 * self.deviation
        rises, is_high = [], bool(swing[0] > margin)
        for time, value in zip(self.time, swing):
            if value > margin and not is_high:
                rises.append(time)
            is_high = value > margin if abs(value) > margin else is_high
        return (len(rises) - 1) / (rises[-1] - rises[0]) if len(rises) > 1 else float("nan")

    def at(self, time: Array) -> Signal:
        """The signal at other times, by linear interpolation."""
        return Signal(time, np.interp(time, self.time, self.values))

    def even(self) -> Signal:
        """The signal at equal intervals."""
        return self.at(np.arange(self.time[0], self.time[-1] + 1e-9, INTERVAL))

    def windows(self, duration: float) -> list[Signal]:
        """All windows of this duration that fit."""
        rows = round(duration / INTERVAL)
        firsts = range(0, len(self.time) - rows + 1, rows)
        return [Signal(self.time[first : first + rows], self.values[first : first + rows]) for first in firsts]


Signals = dict[str, Signal]


def measured() -> Signals:
    """The signals of the experiment, at equal intervals."""
    return {name: columns(MEASURED / f"van-wachem2001-{name}.csv", [name])[name].even() for name in RECORDS}


def columns(file: Path, names: list[str], along: str = "time") -> Signals:
    """Columns of a table over another one of it, the time."""
    table = read_series(file)
    return {name: Signal(table[along], table[name]) for name in names}


def of_run(results: Path, start: float, end: float) -> Signals:
    """The signals of a run, or of the table that was kept of one, at equal intervals."""
    if results.is_file():
        return {name: between(signal, start, end) for name, signal in columns(results, list(SIGNALS)).items()}
    series = read_series(results)
    with h5py.File(result_file(results, "measure-centre.h5")) as probe:
        rows = probe["results"]
        time = rows["time"][()]
        found = {name: Signal(time, rows[name][: len(time)]) for name in ("pressure", "voidage")}
    found["top"] = Signal(series.time, series["bed_top"])
    found["reach"] = reach(result_file(results, "particles.vtkhdf"))
    steady = {name: between(signal, start, end) for name, signal in found.items()}
    first = max(signal.time[0] for signal in steady.values())
    last = min(signal.time[-1] for signal in steady.values())
    time = np.arange(first, last + 1e-9, INTERVAL)
    return {name: signal.at(time) for name, signal in steady.items()}


def reach(file: Path) -> Signal:
    """Height below which 99 % of the particles lie, from snapshots."""
    with h5py.File(file) as snapshots:
        root = snapshots["VTKHDF"]
        time = snapshot_times(root)
        heights = [np.quantile(root["Points"][snapshot_rows(root, step), 2], 0.99) for step in range(len(time))]
    return Signal(time, np.array(heights))


def between(signal: Signal, start: float, end: float) -> Signal:
    """The part between two times."""
    rows = (signal.time >= start - 1e-9) & (signal.time <= end + 1e-9)
    if np.count_nonzero(rows) < 2:
        raise ResultsError(f"the run has not reached {start:g} s, from which it is compared")
    return Signal(signal.time[rows], signal.values[rows])


def keep(found: Signals, comments: list[str], file: Path) -> None:
    """Writes the signals as a table."""
    head = ",".join(["time [s]", *(f"{name} [{quantity.unit}]" for name, quantity in SIGNALS.items())])
    table = np.column_stack([found["pressure"].time, *(found[name].values for name in SIGNALS)])
    lines = [",".join(f"{value:.5g}" for value in row) for row in table]
    file.write_text("\n".join([*comments, head, *lines]) + "\n", encoding="utf-8")
    print(f"table: {file}")


def compared(of_experiment: Signals, found: Signals) -> list[str]:
    """The rows of the table: the experiment's record, and the lowest and highest of as long windows of the run."""
    statistics = {
        "mean": lambda signal: float(np.mean(signal.values)),
        "standard deviation": lambda signal: signal.deviation,
        "cycles per second": lambda signal: signal.cycle_frequency,
    }
    lines = ["| quantity | experiment | Talcum |", "| --- | --- | --- |"]
    for name, quantity in SIGNALS.items():
        record = of_experiment[quantity.record]
        windows = found[name].windows(record.duration)
        if not windows:
            raise ResultsError(f"the run is shorter than the experiment's record of {record.duration:.3g} s")
        for words, of in statistics.items():
            if name == "pressure" and words == "mean":
                continue  # the experiment's has none
            values = [of(window) for window in windows]
            talcum = f"{of(found[name]):.3g} ({min(values):.3g} to {max(values):.3g})"
            unit = "" if quantity.unit == "1" or words == "cycles per second" else f" [{quantity.unit}]"
            lines.append(f"| {quantity.words}: {words}{unit} | {of(record):.3g} | {talcum} |")
    return lines


@dataclass
class Spectrum:
    """Power spectral density over its integral, at ascending frequencies."""

    frequency: Array
    density: Array
    freedom: float = np.inf
    """Degrees of freedom of each density, as far as they are known."""

    @property
    def band(self) -> tuple[Array, Array]:
        """Lower and upper end of the densities' interval of 95 %: over a density, freedom times its estimate is distributed as chi
        square. Its quantiles by Wilson & Hilferty (1931, doi:10.1073/pnas.17.12.684), within 1 % for the freedom here."""
        spread = 2.0 / (9.0 * self.freedom)
        low, high = ((1.0 - spread + sign * NORMAL_QUANTILE * np.sqrt(spread)) ** 3 for sign in (-1.0, 1.0))
        return self.density / high, self.density / low

    @property
    def peak(self) -> float:
        """The frequency of the highest density."""
        return float(self.frequency[np.argmax(self.density)])

    @property
    def slope(self) -> float:
        """Slope of a straight line through the logarithms, over the frequencies of DECLINE."""
        rows = (self.frequency >= DECLINE[0]) & (self.frequency <= DECLINE[1])
        return float(np.polyfit(np.log(self.frequency[rows]), np.log(self.density[rows]), 1)[0])


def spectrum_of(pressure: Signal, segment: float) -> Spectrum:
    """Mean over segments that overlap by half, each with a Hann window (Welch's method)."""
    rows = round(segment / INTERVAL)
    density, frequency = mlab.psd(pressure.values, rows, 1.0 / INTERVAL, detrend="mean", noverlap=rows // 2)
    count = (len(pressure.values) - rows) // (rows // 2) + 1
    # Neighbouring segments share half of their values: of a Hann window's squares that is a correlation of 1/36 (Welch 1967).
    freedom = 2.0 * count / (1.0 + 2.0 * (1.0 - 1.0 / count) / 36.0)
    return Spectrum(frequency[1:], density[1:] / integral(frequency, density), freedom)


def measured_spectrum() -> Spectrum:
    """The experiment's spectrum, as printed except for its units."""
    found = columns(MEASURED / "van-wachem2001-spectrum.csv", ["density"], along="frequency")["density"]
    return Spectrum(found.time, found.values / integral(found.time, found.values))


def integral(places: Array, values: Array) -> float:
    """The integral by the trapezoidal rule."""
    return float(np.sum(0.5 * np.diff(places) * (values[1:] + values[:-1])))


def compared_spectra(of_experiment: Spectrum, found: Spectrum) -> list[str]:
    """The rows of the table about the spectrum."""
    return [
        f"| spectrum of the pressure, highest peak [Hz] | {of_experiment.peak:.3g} | {found.peak:.3g} |",
        f"| its exponent from {DECLINE[0]:g} to {DECLINE[1]:g} Hz | {of_experiment.slope:.3g} | {found.slope:.3g} |",
    ]


def draw(of_experiment: Signals, found: Signals, spectra: list[Spectrum]) -> Figure:
    """Each signal over the time of the experiment's record, and the spectrum of the pressure."""
    figure, panels = new_figure(2, 2, size=(13.0, 8.0))
    for panel, (record, label) in zip(panels.flat, RECORDS.items()):
        shown = [(of_experiment[record], BLACK, "experiment")]
        shown += [(found[name], COLOURS[name], f"Talcum: {q.words}") for name, q in SIGNALS.items() if q.record == record]
        for signal, colour, words in shown:
            level = np.mean(signal.values) if record == "pressure" else 0.0
            panel.plot(signal.time, signal.values - level, color=colour, linewidth=1.3, label=words)
        panel.set_xlim(of_experiment[record].time[0], of_experiment[record].time[-1])
        panel.set_xlabel("time [s]")
        panel.set_ylabel(label)
        panel.legend(fontsize=8)
    panel = panels[1, 1]
    for spectrum, colour in zip(spectra, (BLACK, BLUE)):
        panel.loglog(spectrum.frequency, spectrum.density, color=colour, linewidth=1.3)
        panel.fill_between(spectrum.frequency, *spectrum.band, color=colour, alpha=0.25, linewidth=0.0)
    panel.set_xlim(0.3, 50.0)
    panel.set_xlabel("frequency [Hz]")
    panel.set_ylabel("spectrum of the pressure\nover its integral [1/Hz]")
    return figure


def main(command_line: list[str] | None = None) -> None:
    """Prints the table, draws, keeps the signals if asked."""
    parser = argument_parser(__doc__, "van-wachem2001.png")
    parser.add_argument("--keep", type=Path, metavar="FILE", help="write the signals of the run to this table")
    arguments = parser.parse_args(command_line)
    start = STEADY if arguments.start is None else arguments.start
    found = of_run(arguments.results, start, np.inf if arguments.end is None else arguments.end)
    of_experiment = measured()
    print("\n".join(compared(of_experiment, found)))
    spectra = [measured_spectrum(), spectrum_of(found["pressure"], of_experiment["pressure"].duration)]
    print("\n".join(compared_spectra(*spectra)))
    if arguments.keep:
        keep(found, provenance(arguments.results), arguments.keep)
    save_figure(draw(of_experiment, found, spectra), picture_of(arguments, "van-wachem2001.png"))


if __name__ == "__main__":
    run_script(main)
