"""Tests of fluidised_bed.py on a made-up bed."""

from __future__ import annotations

import unittest

import h5py
import numpy as np

import fluidised_bed
from made_up_results import ScriptTest, write_series, write_two_particles
from talcum_results import ResultsError

TIMES = np.array([0.0, 1.0, 2.0])


class TestFluidisedBed(ScriptTest):
    """Two particles in a gas, of which the second rises."""

    def setUp(self) -> None:
        super().setUp()
        write_series(self.folder, {"time": TIMES, "grid_pressure_drop": np.array([0.9, 1.0, 1.1])})
        velocity = np.tile([[0.0, 0.0, 0.0], [0.0, 3.0, 4.0]], (3, 1))
        data = {"velocity": (velocity, "sqrt(g d)"), "radius": (np.full(6, 0.5), "d")}
        write_two_particles(self.folder, TIMES, data)
        with h5py.File(self.folder / "gas.vtkhdf", "w") as file:
            root = file.create_group("VTKHDF")
            root.attrs["Spacing"] = [1.0, 2.0, 2.0]
            root["Steps/Values"] = TIMES[:2]
            root["Steps"].attrs["NSteps"] = 2
            root["CellData/voidage"] = np.linspace(0.4, 1.0, 2 * 6 * 1 * 4).reshape(2, 6, 1, 4)
            root["CellData/velocity"] = np.ones((2, 6, 1, 4, 3))

    def test_the_last_time_in_both_files(self) -> None:
        bed = fluidised_bed.read_bed(self.folder, None)
        self.assertEqual(bed.time, 1.0)
        self.assertEqual(bed.lengths.tolist(), [4.0, 2.0, 12.0])
        self.assertEqual(bed.centres[:, 2].tolist(), [1.0, 3.0])
        self.assertEqual(bed.colours.tolist(), [0.0, 5.0])

    def test_picture_and_words(self) -> None:
        self.assertIn("mean 1.0000, standard deviation 0.0816", self.call(fluidised_bed))
        self.assert_picture("bed.png")

    def test_members_of_agglomerates(self) -> None:
        members = fluidised_bed.members_of(np.array([4, -1, 7, 4, -1, 4]))
        np.testing.assert_array_equal(members, [3.0, np.nan, 1.0, 3.0, np.nan, 3.0])
        with self.assertRaisesRegex(ResultsError, "has no agglomerates: see output.agglomerates"):
            self.call(fluidised_bed, "--colour", "members")
        with h5py.File(self.folder / "particles.vtkhdf", "r+") as file:
            file["VTKHDF/PointData/agglomerate"] = np.tile([0, 0], 3)
        self.call(fluidised_bed, "--colour", "members")
        self.assert_picture("bed.png")

    def test_a_time_before_the_first(self) -> None:
        with self.assertRaises(ResultsError):
            fluidised_bed.read_bed(self.folder, -1.0)


if __name__ == "__main__":
    unittest.main()
