"""Reads particles.vtkhdf in OVITO's Python module (`pip install ovito h5py`):

    from ovito.io import import_file
    from ovito_talcum import TalcumReader
    pipeline = import_file("results/CASE/particles.vtkhdf", input_format=TalcumReader)

This was tried with OVITO 3.17.2. A bed can then be analysed and rendered like any other file of particles.
"""

from __future__ import annotations

from typing import Any, Callable

import h5py
import numpy as np
from ovito.data import DataCollection
from ovito.io import FileReaderInterface

STANDARD = {"id": "Particle Identifier", "velocity": "Velocity", "angular_velocity": "Angular Velocity", "radius": "Radius"}
"""OVITO's names of the datasets that it knows; other datasets keep their names."""


class TalcumReader(FileReaderInterface):
    """Snapshots of the particles of a run, a frame for each."""

    @staticmethod
    def detect(filename: str) -> bool:
        """Whether this is a file of snapshots of particles."""
        try:
            with h5py.File(filename) as file:
                return "talcum" in file and "VTKHDF/PointData/radius" in file
        except OSError:
            return False

    def scan(self, filename: str, register_frame: Callable[..., Any]) -> None:
        """Names the frames: one for each time."""
        with h5py.File(filename) as file:
            steps = file["VTKHDF/Steps"]
            for number, time in enumerate(steps["Values"][: int(steps.attrs["NSteps"])]):
                register_frame(frame_info=number, label=f"time {time:g}")

    def parse(self, data: DataCollection, *, filename: str, frame_info: int, **_: Any) -> None:
        """Reads a frame."""
        with h5py.File(filename) as file:
            root = file["VTKHDF"]
            first, count = int(root["Steps/PointOffsets"][frame_info]), int(root["NumberOfPoints"][frame_info])
            rows = slice(first, first + count)
            particles = data.create_particles(count=count)
            particles.create_property("Position", data=root["Points"][rows])
            for name, values in root["PointData"].items():
                particles.create_property(STANDARD.get(name, name), data=np.asarray(values[rows]))
            data.attributes["Time"] = float(root["Steps/Values"][frame_info])
            corner = root["Points"][rows].max(axis=0) if count else np.ones(3)
            # The file has no box, so the box of the particles is used, from the origin, where boxes of Talcum begin.
            matrix = np.zeros((3, 4))
            matrix[:, :3] = np.diag(np.maximum(corner, 1e-12))
            data.create_cell(matrix, pbc=(False, False, False))
