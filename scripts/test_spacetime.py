"""Tests of spacetime.py: waves of known speed, and fluctuations that are no travelling waves."""

from __future__ import annotations

import re
import unittest
from typing import Callable

import numpy as np

import spacetime
from made_up_results import ScriptTest, bed, write_profiles
from talcum_results import ResultsError


class TestSpacetime(ScriptTest):
    """Waves of known speed, and fluctuations that are no travelling waves."""

    def setUp(self) -> None:
        super().setUp()
        self.time = np.arange(0.0, 150.0, 0.25)
        self.height = np.arange(0.0, 100.1, 1.5)
        self.noise = np.random.default_rng(5)

    def measure(self, wave: Callable, noise: float = 0.03, *arguments: str) -> str:
        """Writes profiles with a wave and noise, and measures them."""
        phi = bed(self.time, self.height, 60.0, wave)
        phi += np.where(phi > 0.0, noise * self.noise.standard_normal(phi.shape), 0.0)
        write_profiles(self.folder, self.time, self.height, phi)
        return self.call(spacetime, *arguments)

    def numbers(self, printed: str) -> tuple[float, float, float, float]:
        """The four numbers of the line that is printed."""
        found = re.search(r"wave speed (\S+) .*wavelength (\S+) .*period (\S+) .*rms of phi (\S+)", printed)
        self.assertIsNotNone(found, printed)
        speed, wavelength, period, rms = (float(value) for value in found.groups())
        return speed, wavelength, period, rms

    def check_wave(self, speed: float, wavelength: float) -> None:
        """A sine wave must be found with its speed, wavelength, period and amplitude."""
        printed = self.measure(lambda z, t: 0.1 * np.sin(2.0 * np.pi * (z - speed * t) / wavelength))
        found = self.numbers(printed)
        # 2 %: the record holds about ten periods, its noise is 0.4 of the signal's rms.
        self.assertAlmostEqual(found[0] / speed, 1.0, delta=0.02)
        self.assertAlmostEqual(found[1] / wavelength, 1.0, delta=0.02)
        self.assertAlmostEqual(found[2] * abs(speed) / wavelength, 1.0, delta=0.02)
        self.assertAlmostEqual(found[3], np.hypot(0.1 / np.sqrt(2.0), 0.03), delta=0.003)

    def test_rising_wave(self) -> None:
        self.check_wave(1.7, 18.0)
        self.assert_picture("spacetime.png")

    def test_wave_longer_than_the_bed(self) -> None:
        self.check_wave(6.0, 90.0)

    def test_sinking_wave_has_a_negative_speed(self) -> None:
        self.check_wave(-1.1, 25.0)

    def test_plugs_and_voids(self) -> None:
        """Narrow voids between dense plugs, as in a real bed, with amplitudes that grow upwards."""
        speed, wavelength = 2.2, 21.0

        def wave(z: np.ndarray, t: np.ndarray) -> np.ndarray:
            return 0.1 - 0.35 * (0.3 + 0.7 * z / 60.0) * np.exp(4 * np.cos(2 * np.pi * (z - speed * t) / wavelength) - 4)

        found = self.numbers(self.measure(wave))
        self.assertAlmostEqual(found[0] / speed, 1.0, delta=0.03)
        self.assertAlmostEqual(found[1] / wavelength, 1.0, delta=0.03)
        self.assert_picture("spacetime.png")

    def test_noise_is_no_wave(self) -> None:
        self.assertIn("no wave found", self.measure(lambda z, t: 0.0 * z, 0.1))
        self.assert_picture("spacetime.png")

    def test_slow_noise_is_no_wave(self) -> None:
        """Noise that remembers, in time and height, may not be taken for a wave."""
        raw = self.noise.standard_normal((len(self.time), len(self.height)))
        window = np.outer(np.hanning(13), np.hanning(7))
        pad = np.fft.irfft2(np.fft.rfft2(raw) * np.fft.rfft2(window, raw.shape), raw.shape)
        self.assertIn("no wave found", self.measure(lambda z, t: 0.05 * pad / pad.std(), 0.0))

    def test_standing_wave_does_not_travel(self) -> None:
        printed = self.measure(lambda z, t: 0.1 * np.sin(2 * np.pi * z / 20.0) * np.sin(2 * np.pi * t / 9.0))
        self.assertIn("no wave found", printed)
        self.assertIn("no direction is preferred", printed)

    def test_bed_that_oscillates_as_a_whole_does_not_travel(self) -> None:
        self.assertIn("no wave found", self.measure(lambda z, t: 0.1 * np.sin(2 * np.pi * t / 6.25)))

    def test_bed_at_rest(self) -> None:
        self.assertIn("no wave found: the bed is at rest", self.measure(lambda z, t: 0.0 * z, 0.0))

    def test_part_of_the_record(self) -> None:
        """A start that settles differently is left out with --from."""

        def wave(z: np.ndarray, t: np.ndarray) -> np.ndarray:
            return np.where(t < 50.0, 0.2 * np.sin(z * t), 0.1 * np.sin(2.0 * np.pi * (z - 1.7 * t) / 18.0))

        printed = self.measure(wave, 0.03, "--from", "50", "--measure", "10", "50", "--height", "70")
        self.assertAlmostEqual(self.numbers(printed)[0], 1.7, delta=0.04)
        with self.assertRaisesRegex(ResultsError, "there are results of times 0 to 149.75"):
            self.call(spacetime, "--from", "1000")
        with self.assertRaisesRegex(ResultsError, "spans 2 heights; 8 are needed"):
            self.call(spacetime, "--measure", "10", "12.5")

    def test_unknown_colour_map(self) -> None:
        with self.assertRaisesRegex(ResultsError, "--colours rainbowish"):
            self.measure(lambda z, t: 0.0 * z, 0.1, "--colours", "rainbowish")

if __name__ == "__main__":
    unittest.main()
