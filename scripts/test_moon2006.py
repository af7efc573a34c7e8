"""Tests of moon2006_table.py on made-up results, with negative controls."""

from __future__ import annotations

import unittest
from pathlib import Path

import numpy as np

import moon2006_table
from made_up_results import CASE, ScriptTest, write_profiles, write_series
from talcum_results import ResultsError

STAGES = """
[vibration]
gamma = 3.0
frequency = 0.16
[[stage]]
name = "fluidise"
duration = 60.0
vibration = "off"
[[stage]]
name = "vibrate"
duration = 90.0
vibration = "on"
[[stage]]
name = "later"
duration = 50.0
"""
RAMP = """
[[stage]]
name = "up"
duration = 100.0
[stage.gas]
superficial_velocity = { from = 0.0, to = 0.1 }
"""
PERIOD = 6.25


class TestTable(ScriptTest):
    """Waves in a bed that is shaken from time 60 on, and a ramp."""

    def setUp(self) -> None:
        super().setUp()
        self.time = np.arange(0.0, 150.1, 0.25)
        self.height = np.arange(0.0, 100.1, 1.5)

    def write(self, name: str, wave: float, case: str, speed: float = 1.0) -> Path:
        """A run with waves of a speed and wavelength 10, whose bed goes up and down with the plate after 60."""
        folder = self.folder / name
        folder.mkdir()
        shaking = np.where(self.time > 60.0, np.sin(2.0 * np.pi * self.time / PERIOD), 0.0)
        columns = {
            "time": self.time,
            "plate_stress": 0.5 + shaking,
            "grid_pressure_drop": np.full_like(self.time, 0.5),
            "effective_gravity": 1.0 + shaking,
            "gas_force": np.full_like(self.time, 0.5),
            "bed_bottom": 2.0 + 0.7 * shaking,
            "centre_height": 30.0 + 3.0 * shaking,
            "coordination_number": np.full_like(self.time, 4.5),
        }
        write_series(folder, columns)
        # As the plate carries it, the whole bed goes up and down by 3.
        z, t = np.meshgrid(self.height, self.time)
        z = z - 3.0 * shaking[:, None]
        phase = 2.0 * np.pi * (z - speed * t) / 10.0
        phi = np.where((z > 4.0) & (z < 64.0), 0.5 + wave * np.sin(phase), 0.0)
        write_profiles(folder, self.time, self.height, phi, case)
        return folder

    def cells(self, printed: str, stage: str) -> list[str]:
        """The cells of a stage's row."""
        rows = [row.strip("| ").split(" | ") for row in printed.splitlines()]
        return next(row for row in rows if len(row) > 2 and row[1] == stage)

    def test_waves_and_shaking(self) -> None:
        self.write("waves", 0.1, CASE + STAGES)
        printed = self.call(moon2006_table)
        self.assertNotIn("later", printed)
        for stage, times, lift in [("fluidise", "12 to 60", "0.00"), ("vibrate", "90 to 150", "1.40")]:
            cells = self.cells(printed, stage)
            self.assertEqual((cells[2], cells[6], cells[7], cells[8]), (times, "0.000", lift, "4.500"))
            speed, wavelength, period = (float(word) for word in cells[11].split(", "))
            # 5 %: the record holds about five waves; the shaking is averaged out.
            self.assertAlmostEqual(speed, 1.0, delta=0.05)
            self.assertAlmostEqual(wavelength, 10.0, delta=0.5)
            self.assertAlmostEqual(period, 10.0, delta=0.5)
        # Rows are 0.25 apart: a phase of 7 degrees at most from the crest.
        self.assertAlmostEqual(float(self.cells(printed, "vibrate")[5]), 1.5, delta=0.01)

    def test_shaking_alone_is_no_wave(self) -> None:
        self.write("still", 0.0, CASE + STAGES)
        for stage in ["fluidise", "vibrate"]:
            self.assertTrue(self.cells(self.call(moon2006_table), stage)[11].startswith("none: "))

    def test_ramp(self) -> None:
        folder = self.write("ramp", 0.0, CASE + RAMP)
        velocity = 0.001 * self.time
        drop = np.minimum(velocity / 0.03, 1.0)
        centre = np.full_like(self.time, 30.0)
        columns = {"time": self.time, "superficial_velocity": velocity, "grid_pressure_drop": drop, "centre_height": centre}
        write_series(folder, columns)
        self.assertIn("| ramp | up: U_mf 0.03", self.call(moon2006_table))

    def test_what_is_missing_is_said(self) -> None:
        with self.assertRaisesRegex(ResultsError, "holds no output folders"):
            self.call(moon2006_table)
        folder = self.write("short", 0.1, CASE + STAGES)
        (folder / "profiles.h5").unlink()
        self.assertIn("| short | no results: ", self.call(moon2006_table))


if __name__ == "__main__":
    unittest.main()
