"""Tests of spacetime.py: it prints and draws what the program measures, and says where there are no waves."""

from __future__ import annotations

import re
import unittest
from typing import Callable

import numpy as np

import spacetime
import talcum_results
from made_up_results import ScriptTest, bed, write_profiles
from talcum_results import Analysis, ResultsError


class TestSpacetime(ScriptTest):
    """Waves of known speed, and a bed without."""

    def setUp(self) -> None:
        super().setUp()
        self.time = np.arange(0.0, 300.0, 0.5)
        self.height = np.arange(0.0, 100.1, 1.5)

    def measure(self, wave: Callable, *arguments: str) -> str:
        """Writes profiles with a wave and noise, and measures them."""
        phi = bed(self.time, self.height, 80.0, wave)
        noise = np.random.default_rng(5).standard_normal(phi.shape)
        write_profiles(self.folder, self.time, self.height, phi + np.where(phi > 0.0, 0.03 * noise, 0.0))
        return self.call(spacetime, *arguments)

    def test_waves_are_printed_and_their_rays_drawn(self) -> None:
        printed = self.measure(lambda z, t: 0.1 * np.sin(2.0 * np.pi * (z - 0.4 * t) / 9.0))
        speed = re.search(r"wave speed (\S+) \+- \S+ sqrt\(g d\)", printed)
        self.assertIsNotNone(speed, printed)
        # The tests of the program hold it to more: here it must be the same number.
        self.assertAlmostEqual(float(speed.group(1)), 0.4, delta=0.008)
        self.assertIn("state waves", printed)
        self.assert_picture("spacetime.png")
        windows = talcum_results.analyse(self.folder, ["waves"]).tables["waves/windows"]
        drawn = spacetime.rays(windows)
        self.assertGreater(len(drawn), 2)
        for times, heights in drawn:
            self.assertAlmostEqual((heights[1] - heights[0]) / (times[1] - times[0]), 0.4, delta=0.06)

    def test_a_bed_without_waves_has_no_rays(self) -> None:
        printed = self.measure(lambda z, t: 0.0 * z)
        self.assertIn("no wave found: ", printed)
        self.assert_picture("spacetime.png")
        windows = talcum_results.analyse(self.folder, ["waves"]).tables["waves/windows"]
        self.assertEqual(spacetime.rays(windows), [])

    def test_part_of_the_record(self) -> None:
        """A start that settles differently is left out with --from."""

        def wave(z: np.ndarray, t: np.ndarray) -> np.ndarray:
            return np.where(t < 100.0, 0.2 * np.sin(z * t), 0.1 * np.sin(2.0 * np.pi * (z - 0.4 * t) / 9.0))

        printed = self.measure(wave, "--from", "100", "--height", "90")
        self.assertIn("state waves", printed)
        # Times of a table are numbers of numpy, whose own text the program does not read.
        self.assertEqual(talcum_results.analyse(self.folder, ["waves"], np.float64(100.0)).text("waves.state"), "waves")
        self.assertIn("holds nothing between the times 1000", self.fails("--from", "1000"))

    def fails(self, *arguments: str) -> str:
        """The error, with what was printed before it if there is none."""
        try:
            return self.call(spacetime, *arguments)
        except ResultsError as reason:
            return str(reason) + talcum_results.analyse(self.folder, ["waves"], 1000.0).reasons["waves.state"]

    def test_a_front_without_a_speed_is_not_drawn(self) -> None:
        front = {"time": np.arange(4.0), "height": np.arange(4.0)}
        for error, drawn in [(0.1, True), (0.2, False)]:  # of a speed of 0.42: each is the control of the other
            found = Analysis({"waves.front_speed": 0.42}, {"waves.front_speed": error}, {}, {}, {"waves/front": front})
            self.assertEqual(spacetime.moving_front(found) is not None, drawn)
        self.assertIsNone(spacetime.moving_front(Analysis({}, {}, {}, {}, {})))

    def test_a_speed_without_an_error_stands_beside_one_with(self) -> None:
        numbers = {"waves.speed": 0.301, "waves.void_speed": 0.28}
        found = Analysis(numbers, {"waves.void_speed": 0.01}, {}, {}, {})
        self.assertEqual(spacetime.speed_of_waves(found), "0.301; single voids, 0.28 +- 0.01")
        found.errors["waves.speed"] = 0.02
        self.assertEqual(spacetime.speed_of_waves(found), "0.301 +- 0.02")

    def test_unknown_colour_map(self) -> None:
        with self.assertRaisesRegex(ResultsError, "--colours rainbowish"):
            self.measure(lambda z, t: 0.0 * z, "--colours", "rainbowish")


if __name__ == "__main__":
    unittest.main()
