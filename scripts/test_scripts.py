"""Tests of series.py, minimum_fluidisation.py and cycle.py on made-up results, with negative controls."""

from __future__ import annotations

import re
import unittest
from typing import Callable

import numpy as np

import cycle
import minimum_fluidisation
import series
import talcum_results
from made_up_results import ScriptTest, write_profiles, write_series
from talcum_results import ResultsError


class TestSeries(ScriptTest):
    """The panels of a series."""

    def test_picture(self) -> None:
        time = np.arange(0.0, 60.0, 0.25)
        wave = np.sin(time)
        columns = {
            "time": time,
            "plate_stress": np.abs(wave),
            "grid_pressure_drop": 1.0 - 0.3 * wave,
            "effective_gravity": np.ones_like(time),
            "centre_height": 27.0 + wave,
            "bed_top": 55.0 + 2.0 * wave,
            "kinetic_energy_of_mean_motion": 1e-3 * wave**2,
            "fluctuating_kinetic_energy": 1e-5 * (1.1 + wave),
            "coordination_number": 4.0 + wave,
            "momentum_error": 1e-15 * wave,
        }
        write_series(self.folder, columns)
        self.assertIn("mean coordination number", self.call(series))
        self.assert_picture("series.png")

    def test_picture_of_one_row(self) -> None:
        write_series(self.folder, {"time": np.zeros(1)})
        self.call(series)
        self.assert_picture("series.png")


class TestMinimumFluidisation(ScriptTest):
    """A ramp of a known U_mf, and results without one, which are drawn all the same."""

    def write(self, velocity: np.ndarray, drop: Callable, phi: float = 0.62) -> None:
        """A run of a superficial velocity per time unit, and a bed of a solids fraction."""
        time = np.arange(len(velocity), dtype=float)
        height = np.arange(0.0, 60.1, 1.5)
        profile = np.where(height < 40.0, phi, 0.0)
        columns = {"time": time, "superficial_velocity": velocity, "centre_height": np.full_like(time, 20.0)}
        columns["grid_pressure_drop"] = drop(velocity, time)
        write_profiles(self.folder, time, height, np.tile(profile, (len(time), 1)))
        write_series(self.folder, columns)

    def bed_of(self, least: float) -> Callable:
        """Pressure drop of a bed with U_mf `least`, with 2 % of noise."""
        noise = np.random.default_rng(7)
        return lambda velocity, time: np.minimum(velocity / least, 1.0) + 0.02 * noise.standard_normal(len(time))

    def test_ramp_up_and_down(self) -> None:
        balance = 55.0 / 18.0 * (1.0 - 0.62) ** 4.65
        ramp = np.linspace(0.0, 0.06, 300)
        velocity = np.concatenate([np.zeros(40), ramp, np.full(20, 0.06), ramp[::-1], np.zeros(10)])
        self.write(velocity, self.bed_of(0.97 * balance))
        printed = self.call(minimum_fluidisation)
        for name in ["up", "down"]:
            line = next(line for line in printed.splitlines() if line.startswith(f"{name}:"))
            ratio = re.search(r"ratio ([\d.]+)", line)
            self.assertIsNotNone(ratio, line)
            self.assertAlmostEqual(float(ratio.group(1)), 0.97, delta=0.01)  # noise of 2 % over 300 rows
            self.assertIn("phi 0.62", line)
        self.assert_picture("minimum_fluidisation.png")

    def test_a_way_that_a_run_does_not_go_is_not_missed(self) -> None:
        found = talcum_results.Analysis({"u_mf": 0.03, "u_mf.up": 0.03}, {}, {}, {}, {})
        rises, swings = np.linspace(0.0, 0.06, 9), np.array([0.0, 0.06, 0.0])
        self.assertFalse(minimum_fluidisation.goes(rises, "down", found))
        self.assertTrue(minimum_fluidisation.goes(swings, "down", found))
        nothing = talcum_results.Analysis({}, {}, {}, {}, {})
        self.assertTrue(minimum_fluidisation.goes(rises, "down", nothing))

    def test_the_picture_is_drawn_where_no_value_can_be_given(self) -> None:
        noise = np.random.default_rng(3)
        for velocity, drop, reason in [
            (np.linspace(0.0, 0.02, 300), self.bed_of(0.025), "plateau"),
            (np.linspace(0.0, 0.06, 300), lambda u, t: noise.uniform(0.0, 1.0, len(t)), "up: no value can be given"),
            (np.full(50, 0.1), self.bed_of(0.025), "constant"),
        ]:
            (self.folder / "minimum_fluidisation.png").unlink(missing_ok=True)
            self.write(velocity, drop)
            self.assertIn(reason, self.call(minimum_fluidisation))
            self.assert_picture("minimum_fluidisation.png")


class TestCycle(ScriptTest):
    """A plate of known frequency and Gamma, and one at rest."""

    def write(self, gamma: float, frequency: float, start: float = 3.1, interval: float = 0.1) -> None:
        """A bed that leaves the plate while the effective gravity is negative."""
        time = np.arange(0.0, 120.0, interval)
        gravity = 1.0 + gamma * np.sin(2.0 * np.pi * frequency * (time - start))
        noise = 0.05 * np.random.default_rng(11).standard_normal(len(time))
        columns = {
            "time": time,
            "effective_gravity": gravity,
            "plate_stress": np.maximum(gravity, 0.0),
            "grid_pressure_drop": np.minimum(gravity, 0.0) + noise,
            "bed_bottom": np.maximum(-gravity, 0.0),
        }
        write_series(self.folder, columns)

    def test_known_vibration(self) -> None:
        self.write(3.0, 0.16)
        found = re.search(r"f (\S+), Gamma (\S+), (\S+) cycles.*Gamma sin (\S+)", self.call(cycle))
        frequency, gamma, cycles, difference = (float(value) for value in found.groups())
        self.assertAlmostEqual(frequency, 0.16, places=5)
        self.assertAlmostEqual(gamma, 3.0, places=3)
        self.assertAlmostEqual(cycles, 19.2, delta=0.05)
        self.assertLess(difference, 0.03)  # noise of 0.05 averaged over 19 cycles, and the width of a bin
        self.assert_picture("cycle.png")

    def test_phase(self) -> None:
        """Phase 0 is where the effective gravity passes 1 upwards."""
        self.write(2.0, 0.1)
        results = talcum_results.read_series(self.folder)
        vibration = cycle.find_vibration(results, None)
        mean = cycle.average_over_phase(results, vibration, 40)
        for phase, expected in ((0.25, 3.0), (0.75, -1.0)):
            nearest = np.argmin(np.abs(mean.phase - phase))
            self.assertAlmostEqual(mean.mean["effective_gravity"][nearest], expected, delta=0.02)

    def test_rows_on_the_edges_of_bins(self) -> None:
        """100 rows in every cycle and 50 bins, so that each second row lies on an edge: two for each bin, at their own mean phase."""
        self.write(3.0, 0.16, 0.0, 0.0625)
        results = talcum_results.read_series(self.folder)
        mean = cycle.average_over_phase(results, cycle.find_vibration(results, None), 50)
        self.assertEqual(len(mean.phase), 50)
        # A mean over two rows 0.01 of a cycle apart lowers a sine by 5e-4 of it; a phase that is off by a quarter of a bin shifts it by 0.09.
        expected = 1.0 + 3.0 * np.sin(2.0 * np.pi * mean.phase)
        self.assertLess(np.max(np.abs(mean.mean["effective_gravity"] - expected)), 0.01)

    def test_few_rows_at_equal_phases(self) -> None:
        """25 rows in every cycle: no phase is left out, none is drawn twice."""
        self.write(3.0, 0.16, 0.0, 0.25)
        self.call(cycle, "--bins", "50")
        results = talcum_results.read_series(self.folder)
        mean = cycle.average_over_phase(results, cycle.find_vibration(results, 0.16), 50)
        self.assertEqual(len(mean.phase), 25)
        theory = 1.0 + 3.0 * np.sin(2.0 * np.pi * mean.phase)
        np.testing.assert_allclose(mean.mean["effective_gravity"], theory, atol=1e-6)

    def test_words_for_what_cannot_be_averaged(self) -> None:
        self.write(0.0, 0.16)
        with self.assertRaisesRegex(ResultsError, "does not vibrate"):
            self.call(cycle)
        self.write(3.0, 0.16, 0.0, 1.0)
        with self.assertRaisesRegex(ResultsError, "rows per cycle are too few"):
            self.call(cycle)
        self.write(3.0, 0.16)
        with self.assertRaisesRegex(ResultsError, "cycles; at least 2"):
            self.call(cycle, "--to", "10")
        with self.assertRaisesRegex(ResultsError, "not a sine of frequency"):
            self.call(cycle, "--frequency", "0.3")

if __name__ == "__main__":
    unittest.main()
