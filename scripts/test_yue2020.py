"""Tests of yue2020.py on made-up particles, with negative controls."""

from __future__ import annotations

import unittest

import h5py
import numpy as np

from cases.experiments.report import yue2020
from made_up_results import ScriptTest, write_series
from talcum_results import ResultsError
from cases.experiments.report.yue2020 import Profile

TIMES = np.array([0.5, 1.5, 2.0])


def speed_at(place: np.ndarray, time: float) -> np.ndarray:
    """A spout of 0.6 m/s, 20 mm wide; twice as fast before the run counts."""
    return np.where(np.abs(place) < 0.01, 0.6, 0.02) * (2.0 if time < yue2020.STEADY else 1.0)


class TestBesideExperiment(ScriptTest):
    """A bed whose speeds are known; hidden particles in its middle are three times as fast."""

    def setUp(self) -> None:
        super().setUp()
        write_series(self.folder, {"time": TIMES})
        place, height = np.meshgrid(np.arange(-0.138, 0.1381, 0.001), np.arange(0.002, 0.2, 0.002))
        place, height = place.ravel(), height.ravel()
        with h5py.File(self.folder / "particles.vtkhdf", "w") as file:
            root = file.create_group("VTKHDF")
            points, velocities = [], []
            for time in TIMES:
                for depth, factor in ((0.002, 1.0), (0.02, 3.0)):
                    points.append(np.column_stack([yue2020.MIDDLE + place, np.full(len(place), depth), height]))
                    up = factor * speed_at(place, time)
                    velocities.append(np.column_stack([np.zeros(len(place)), np.full(len(place), 7.0), up]))
            root["NumberOfPoints"] = np.full(len(TIMES), 2 * len(place))
            root["Steps/PointOffsets"] = 2 * len(place) * np.arange(len(TIMES))
            root["Steps/Values"] = TIMES
            root["Steps"].attrs["NSteps"] = len(TIMES)
            root["Points"], root["PointData/velocity"] = np.concatenate(points), np.concatenate(velocities)

    def test_speeds_are_those_seen_from_the_front(self) -> None:
        found, comments = yue2020.of_run(self.folder, None, None)
        self.assertEqual(comments[-1], "# mean of 2 snapshots from 1.5 to 2 s")
        for profile in found.values():
            self.assertAlmostEqual(profile.peak, 0.6, delta=1e-9)
            self.assertAlmostEqual(float(profile.speed[0]), 0.02, delta=1e-9)
            # Places are 7 mm apart and see 7 mm: the edge is known to about that.
            self.assertAlmostEqual(profile.width, 0.02, delta=0.004)
        before, _ = yue2020.of_run(self.folder, 0.0, 1.0)  # the control: another time is another speed
        self.assertAlmostEqual(before[0.3].peak, 1.2, delta=1e-9)

    def test_the_table_that_was_kept_gives_what_the_run_gave(self) -> None:
        kept = self.folder / "kept.csv"
        of_run = self.call(yue2020, "--keep", str(kept))
        self.assert_picture("yue2020.png")
        self.folder = kept
        rows = [line for line in of_run.splitlines() if line.startswith("|")]
        self.assertEqual([line for line in self.call(yue2020).splitlines() if line.startswith("|")], rows)
        self.assertEqual(len(rows), 2 + 6)

    def test_width_of_known_profiles(self) -> None:
        place = np.linspace(-0.1, 0.1, 81)
        triangle = Profile(place, np.maximum(0.0, 1.0 - np.abs(place) / 0.05))
        self.assertAlmostEqual(triangle.width, 0.05, delta=0.001)
        beside = Profile(place, triangle.speed + 0.8 * (place > 0.08))  # fast elsewhere: no part of the spout
        self.assertAlmostEqual(beside.width, 0.05, delta=0.001)

    def test_the_experiment(self) -> None:
        found = yue2020.measured()
        self.assertEqual(list(found), [0.15, 0.3, 0.45, 0.6, 0.75, 0.8])
        self.assertEqual([profile.peak for profile in found.values()], [0.4367, 0.58073, 0.73303, 0.7223, 0.80739, 0.86056])

    def test_a_time_without_snapshots_is_refused(self) -> None:
        with self.assertRaisesRegex(ResultsError, "no results between"):
            yue2020.main([str(self.folder), "--from", "3"])


if __name__ == "__main__":
    unittest.main()
