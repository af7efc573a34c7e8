"""Tests of talcum_results.py, and of what all scripts say to a user."""

from __future__ import annotations

import os
import subprocess
import sys
import unittest

import h5py
import numpy as np

import talcum_results
from made_up_results import COLUMNS, SCRIPTS, ScriptTest, write_profiles, write_series
from talcum_results import ResultsError


class TestReading(ScriptTest):
    """Results in progress, and files that are not what they should be."""

    def test_rows_not_finished_are_left_out(self) -> None:
        write_series(self.folder, {"time": np.arange(5.0)})
        with open(self.folder / "series.csv", "a", encoding="utf-8") as file:
            file.write(",".join(["7"] * (len(COLUMNS) - 1) + ["1"]))  # all columns, but maybe not all digits
        self.assertEqual(list(talcum_results.read_series(self.folder).time), [0.0, 1.0, 2.0, 3.0, 4.0])

    def test_numpy_reads_the_rows_below_the_case(self) -> None:
        write_series(self.folder, {"time": np.arange(5.0), "bed_top": np.arange(5.0) ** 2})
        file = self.folder / "series.csv"
        lines = file.read_text(encoding="utf-8").splitlines()
        self.assertIn("# case: stokes_number = 55", lines)
        header = next(index for index, line in enumerate(lines) if not line.startswith("#"))
        table = np.genfromtxt(file, delimiter=",", skip_header=header + 1)
        self.assertEqual(table.shape, (5, len(COLUMNS)))
        self.assertEqual(list(table[:, list(COLUMNS).index("bed_top")]), [0.0, 1.0, 4.0, 9.0, 16.0])

    def test_profile_rows_not_filled_are_left_out(self) -> None:
        times = np.array([0.0, 1.0, 2.0, 0.0, 0.0])
        write_profiles(self.folder, times, np.arange(4.0), np.zeros((5, 4)))
        profiles = talcum_results.read_profiles(self.folder)
        self.assertEqual(profiles.solids_fraction.shape, (3, 4))
        self.assertEqual(profiles.units["height"], "d")

    def test_profiles_open_for_writing_can_be_read(self) -> None:
        write_profiles(self.folder, np.arange(3.0), np.arange(4.0), np.zeros((3, 4)))
        writer = "import h5py, sys; f = h5py.File(sys.argv[1], 'r+'); print('open', flush=True); sys.stdin.read()"
        command = [sys.executable, "-c", writer, str(self.folder / "profiles.h5")]
        with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
            self.assertEqual(process.stdout.readline(), "open\n")
            self.assertEqual(len(talcum_results.read_profiles(self.folder).time), 3)
            process.communicate()

    def test_words_for_bad_files(self) -> None:
        with self.assertRaisesRegex(ResultsError, "there is no such file"):
            talcum_results.read_series(self.folder)
        (self.folder / "profiles.h5").write_bytes(b"no HDF5")
        with self.assertRaisesRegex(ResultsError, "damaged"):
            talcum_results.read_profiles(self.folder)
        with h5py.File(self.folder / "profiles.h5", "w") as file:
            file["time"] = np.zeros(3)
        with self.assertRaisesRegex(ResultsError, "has no dataset height, solids_fraction"):
            talcum_results.read_profiles(self.folder)
        (self.folder / "series.csv").write_text("time [s],a [1]\n1,2\n3,x\n")
        with self.assertRaisesRegex(ResultsError, "row 2 below the header"):
            talcum_results.read_series(self.folder)
        (self.folder / "series.csv").write_text("# only\ntime [s],a [1]\n")
        with self.assertRaisesRegex(ResultsError, "holds no results yet"):
            talcum_results.read_series(self.folder)

    def test_errors_reach_the_user_in_words(self) -> None:
        """Exit code 1 and one line, no traceback; --help works everywhere."""
        for name in ["spacetime", "series", "minimum_fluidisation", "cycle"]:
            script = [sys.executable, str(SCRIPTS / f"{name}.py")]
            wrong = subprocess.run([*script, "/nowhere"], capture_output=True, text=True, timeout=120)
            self.assertEqual((wrong.returncode, wrong.stderr.count("\n")), (1, 1), wrong.stderr)
            self.assertTrue(wrong.stderr.startswith("error: /nowhere"), wrong.stderr)
            usage = subprocess.run([*script, "--help"], capture_output=True, text=True, timeout=120)
            self.assertEqual(usage.returncode, 0)
            self.assertIn("--from", usage.stdout)

    def test_a_reader_that_has_gone_ends_a_script_quietly(self) -> None:
        code = "from talcum_results import run_script; run_script(lambda _: print('x' * 100000))"
        reading, writing = os.pipe()
        os.close(reading)
        paths = {**os.environ, "PYTHONPATH": str(SCRIPTS)}
        ended = subprocess.run([sys.executable, "-c", code], stdout=writing, stderr=subprocess.PIPE, env=paths)
        os.close(writing)
        self.assertEqual((ended.returncode, ended.stderr), (0, b""))


if __name__ == "__main__":
    unittest.main()
