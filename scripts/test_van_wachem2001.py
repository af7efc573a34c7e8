"""Tests of van_wachem2001.py on made-up signals, with negative controls."""

from __future__ import annotations

import unittest

import h5py
import numpy as np

from cases.experiments.report import van_wachem2001
from made_up_results import ScriptTest, write_series, write_two_particles
from talcum_results import ResultsError
from cases.experiments.report.van_wachem2001 import Signal


def swing(frequency: float, amplitude: float, end: float = 12.2) -> Signal:
    """A sine with noise of a twentieth of its amplitude."""
    time = np.arange(0.2, end, 0.001)
    noise = np.random.default_rng(1).normal(0.0, 0.05 * amplitude, len(time))
    return Signal(time, amplitude * np.sin(2.0 * np.pi * frequency * time) + noise)


class TestBesideExperiment(ScriptTest):
    """A run whose bed swings a given number of times."""

    def write_run(self, frequency: float, end: float = 12.2) -> None:
        """The series and the probe of a run."""
        pressure = swing(frequency, 100.0, end)
        time = pressure.time
        write_series(self.folder, {"time": time, "bed_top": 0.12 + 1e-4 * pressure.values})
        times = np.arange(0.0, end + 1e-9, 0.02)
        write_two_particles(self.folder, times, {})
        with h5py.File(self.folder / "measure-centre.h5", "w") as file:
            for name, values in {"time": time, "pressure": 500.0 + pressure.values, "voidage": 0.5 + 1e-3 * pressure.values}.items():
                file[f"results/{name}"] = values

    def row(self, printed: str, quantity: str) -> list[str]:
        """Experiment, and what was found."""
        return next(line for line in printed.splitlines() if quantity in line).split("|")[2:4]

    def test_frequency_and_deviation_are_those_of_the_signal(self) -> None:
        for frequency in (2.0, 3.1):  # each is the control of the other
            self.write_run(frequency)
            printed = self.call(van_wachem2001)
            found = float(self.row(printed, "pressure: cycles per second")[1].split()[0])
            self.assertLess(abs(found - frequency), 0.02 * frequency)  # some 20 cycles, of which noise shifts the ends
            deviation = float(self.row(printed, "pressure: standard deviation")[1].split()[0])
            self.assertLess(abs(deviation - 100.0 / np.sqrt(2.0)), 1.5)  # 1 % of the cycles' ends, and the noise
        self.assert_picture("van-wachem2001.png")

    def test_the_table_that_was_kept_gives_what_the_run_gave(self) -> None:
        self.write_run(2.0)
        kept = self.folder / "kept.csv"
        of_run = self.call(van_wachem2001, "--keep", str(kept))
        self.folder = kept
        of_table = self.call(van_wachem2001)
        rows = lambda printed: [line for line in printed.splitlines() if line.startswith("|")]  # noqa: E731
        self.assertEqual(rows(of_table), rows(of_run))
        self.assertGreater(len(rows(of_run)), 5)

    def test_the_band_of_a_spectrum_is_that_of_its_freedom(self) -> None:
        # Chi square with 10 degrees of freedom: 3.247 and 20.483 bound 95 % (tables).
        lower, upper = van_wachem2001.Spectrum(np.ones(1), np.ones(1), 10.0).band
        self.assertAlmostEqual(lower[0], 10.0 / 20.483, delta=0.005)
        self.assertAlmostEqual(upper[0], 10.0 / 3.247, delta=0.03)
        # White noise, whose density is even: the bands of 19 of 20 frequencies hold its mean.
        noise = Signal(np.arange(1001) * 0.01, np.random.default_rng(2).standard_normal(1001))
        spectrum = van_wachem2001.spectrum_of(noise, 2.98)
        lower, upper = spectrum.band
        even = spectrum.density.mean()
        self.assertGreater(np.mean((lower < even) & (even < upper)), 0.88)
        narrow = van_wachem2001.Spectrum(spectrum.frequency, spectrum.density, 4.0 * spectrum.freedom).band  # the control
        self.assertLess(np.mean((narrow[0] < even) & (even < narrow[1])), 0.88)

    def test_noise_about_the_mean_is_no_cycle(self) -> None:
        signal = swing(2.0, 100.0).even()
        without = Signal(signal.time, np.where(np.abs(signal.values) < 20.0, 0.0, signal.values))
        self.assertAlmostEqual(signal.cycle_frequency, without.cycle_frequency, delta=0.02)

    def test_the_record_of_the_experiment(self) -> None:
        # Peaks of the pressure at 3.43, 3.90, 4.35, 4.82, 5.29, 5.68 and 5.99 s: 6 cycles in 2.56 s.
        pressure = van_wachem2001.measured()["pressure"]
        self.assertAlmostEqual(pressure.cycle_frequency, 6.0 / 2.56, delta=0.3)
        self.assertLess(abs(np.mean(pressure.values)), 15.0)

    def test_spectra(self) -> None:
        # Peak at 2.4 Hz in the paper's figure; it falls by 6.7 in the logarithm from 4.31 to 21.2 Hz: an exponent of -4.2.
        of_experiment = van_wachem2001.measured_spectrum()
        self.assertAlmostEqual(of_experiment.peak, 2.415, delta=0.01)
        self.assertAlmostEqual(of_experiment.slope, -4.2, delta=0.3)
        for frequency in (2.0, 5.0):  # each is the control of the other
            found = van_wachem2001.spectrum_of(swing(frequency, 100.0).even(), 3.0)
            self.assertAlmostEqual(found.peak, frequency, delta=0.34)  # a third of a hertz apart
            self.assertAlmostEqual(van_wachem2001.integral(found.frequency, found.density), 1.0, delta=0.01)

    def test_a_run_that_has_hardly_begun_is_refused(self) -> None:
        self.write_run(2.0, end=2.0)
        with self.assertRaisesRegex(ResultsError, "has not reached 2.2 s"):
            van_wachem2001.main([str(self.folder)])
        self.write_run(2.0, end=4.0)
        with self.assertRaisesRegex(ResultsError, "shorter than the experiment's record"):
            van_wachem2001.main([str(self.folder)])


if __name__ == "__main__":
    unittest.main()
