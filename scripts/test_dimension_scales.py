"""Tests that the program's files show other tools which dataset holds times and heights."""

from __future__ import annotations

import subprocess
import tempfile
import unittest
from pathlib import Path

import h5py

from talcum_results import program

ROOT = Path(__file__).resolve().parent.parent


class TestDimensionScales(unittest.TestCase):
    """The files of a short run, by h5py, which asks the HDF5 library as xarray's readers do."""

    def test_profiles_have_times_and_heights(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            case = ROOT / "cases/smoke/walls.toml"
            subprocess.run([program(), "run", str(case), "--output", folder, "--force", "--set", "output.profiles=0.1"],
                           capture_output=True, check=True)  # fmt: skip
            with h5py.File(Path(folder) / "profiles.h5") as file:
                self.assertTrue(file["time"].is_scale and file["height"].is_scale)
                for name in ("solids_fraction", "solids_velocity"):
                    self.assertEqual([dimension[0].name for dimension in file[name].dims], ["/time", "/height"])
                self.assertEqual(file["superficial_velocity"].dims[0][0].name, "/time")
                # Negative control: a table is no scale.
                self.assertFalse(file["solids_fraction"].is_scale)

    def test_tables_of_instruments_have_times_and_what_their_arrays_run_along(self) -> None:
        measure = '\n[measure.stress]\nkind = "stress"\nevery = 0.02\naverage = 0.1\nlayers = 10\n'
        with tempfile.TemporaryDirectory() as folder:
            case = Path(folder) / "case.toml"
            case.write_text((ROOT / "cases/smoke/walls.toml").read_text(encoding="utf-8") + measure, encoding="utf-8")
            results = Path(folder) / "results"
            subprocess.run([program(), "run", str(case), "--output", str(results), "--until", "0.5"],
                           capture_output=True, check=True)  # fmt: skip
            with h5py.File(results / "measure-stress.h5") as file:
                table = file["results"]
                self.assertEqual(table["looks"].dims[0][0].name, "/results/time")
                contact = table["contact"].dims
                self.assertEqual([contact[0][0].name, contact[1][0].name], ["/results/time", "/height"])
                # The components of a tensor run along nothing.
                self.assertEqual([len(contact[2]), len(contact[3])], [0, 0])


if __name__ == "__main__":
    unittest.main()
