"""Made-up results for the tests of the scripts: series and profiles whose answers are known.

With TALCUM_KEEP_PICTURES=FOLDER the figures that the tests draw are kept in this folder.
"""

from __future__ import annotations

import contextlib
import io
import os
import shutil
import tempfile
import unittest
from pathlib import Path
from typing import Callable

import h5py
import numpy as np

SCRIPTS = Path(__file__).resolve().parent
COLUMNS = {
    "time": "sqrt(d/g)",
    "superficial_velocity": "sqrt(g d)",
    "grid_pressure_drop": "1",
    "gas_force": "1",
    "plate_stress": "1",
    "effective_gravity": "1",
    "centre_height": "d",
    "centre_velocity": "sqrt(g d)",
    "bed_bottom": "d",
    "bed_top": "d",
    "kinetic_energy_of_mean_motion": "rho_s g d^4",
    "fluctuating_kinetic_energy": "rho_s g d^4",
    "coordination_number": "1",
    "momentum_error": "1",
    "mass_error": "1",
    "particles": "1",
    "departed": "1",
}
CASE = """
title = "made up"
units = "dimensionless"
[box]
lengths = [5.0, 5.0, 100.5]
x = "periodic"
y = "periodic"
z = "wall"
[particles]
count = 500
diameter = 1.0
density = 1.0
seed = 1
[particles.start]
kind = "lattice"
spacing = 1.1
jitter = 0.9
[gravity]
magnitude = 1.0
[contact]
law = "linear_spring_dashpot"
normal_stiffness = 2.0e4
poisson_ratio = 0.3
restitution = 0.9
friction = 0.1
friction_cap = "contact"
[gas]
kind = "column"
stokes_number = 55
drag = "wen_yu_creeping"
spacing = 1.5
superficial_velocity = 0.1
[output]
series = 0.25
[time]
step = 8.0e-4
"""
WHOLE = CASE + "end = 1000.0\n"
PICTURE = b"\x89PNG"


def write_series(folder: Path, columns: dict[str, np.ndarray]) -> None:
    """Writes a series.csv, and a case if there is none; columns that are not given are zero."""
    if not (folder / "case.toml").exists():
        (folder / "case.toml").write_text(WHOLE, encoding="utf-8")
    rows = len(columns["time"])
    table = np.column_stack([columns.get(name, np.zeros(rows)) for name in COLUMNS])
    with open(folder / "series.csv", "w", encoding="utf-8") as file:
        file.write("# talcum_version: 0.1.0\n# title: made up\n")
        file.write("".join(f"# case: {line}".rstrip() + "\n" for line in WHOLE.splitlines()))
        file.write(",".join(f"{name} [{unit}]" for name, unit in COLUMNS.items()) + "\n")
        for row in table:
            file.write(",".join(repr(float(value)) for value in row) + "\n")


def write_profiles(folder: Path, time: np.ndarray, height: np.ndarray, phi: np.ndarray, case: str = WHOLE) -> None:
    """Writes a profiles.h5 with units and provenance, and its case."""
    (folder / "case.toml").write_text(case, encoding="utf-8")
    data = {
        "time": (time, "sqrt(d/g)"),
        "height": (height, "d"),
        "solids_fraction": (phi, "1"),
        "solids_velocity": (np.zeros_like(phi), "sqrt(g d)"),
        "superficial_velocity": (np.zeros_like(time), "sqrt(g d)"),
    }
    with h5py.File(folder / "profiles.h5", "w") as file:
        file.attrs["title"] = "made up"
        file.attrs["case"] = case
        for name, (values, unit) in data.items():
            file.create_dataset(name, data=values).attrs["unit"] = np.bytes_(unit)


def write_two_particles(folder: Path, times: np.ndarray, data: dict[str, tuple[np.ndarray, str]]) -> None:
    """Writes a particles.vtkhdf of two particles, with these data and their units; the second particle is higher by the time."""
    points = np.array([[1.0, 1.0, 1.0], [2.0, 1.0, 2.0]] * len(times))
    points[1::2, 2] += times
    with h5py.File(folder / "particles.vtkhdf", "w") as file:
        root = file.create_group("VTKHDF")
        root["NumberOfPoints"] = np.full(len(times), 2)
        root["Steps/PointOffsets"] = 2 * np.arange(len(times))
        of_points = {f"PointData/{name}": values for name, values in data.items()}
        for name, (values, unit) in {"Points": (points, "d"), "Steps/Values": (times, "sqrt(d/g)"), **of_points}.items():
            root[name] = values
            root[name].attrs["unit"] = unit
        root["Steps"].attrs["NSteps"] = len(times)


def bed(time: np.ndarray, height: np.ndarray, top: float, wave: Callable) -> np.ndarray:
    """A bed of solids fraction 0.5 plus wave(z, t) below `top`, nothing above."""
    z, t = np.meshgrid(height, time)
    return np.where(z < top, 0.5 + wave(z, t), 0.0)


class ScriptTest(unittest.TestCase):
    """A temporary results folder, and calls of the scripts' main functions."""

    def setUp(self) -> None:
        self.folder = Path(tempfile.mkdtemp(prefix="talcum-scripts-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def call(self, script, *arguments: str) -> str:
        """Runs a script's main on the results folder and returns what it printed."""
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            script.main([str(self.folder), *arguments])
        return printed.getvalue()

    def assert_picture(self, name: str) -> None:
        """Checks that a figure was written, and copies it to TALCUM_KEEP_PICTURES if this is set."""
        picture = self.folder / name
        self.assertEqual(picture.read_bytes()[:4], PICTURE)
        self.assertEqual([file for file in self.folder.iterdir() if file.name.startswith(".")], [])
        keep = os.environ.get("TALCUM_KEEP_PICTURES")
        if keep:
            shutil.copy(picture, Path(keep) / f"{self.id().split('.')[-1]}-{name}")
