"""Keeps the data of the runs themselves that the page of Moon, Kevrekidis & Sundaresan (2006) shows besides the tables of the studies: figures over
height and time, of the map and of the wave's frame, curves over the plate's cycle, the planeness of the waves in the wide bed, and run times.

    scripts/report moon2006 --keep cases/moon2006/results
"""

from __future__ import annotations

from pathlib import Path

from paper_report import run_times
from study_tables import write_study_table

from . import boxes, cycle, pictures, state_map, wide
from .tables import STUDIES


def keep(results: Path, folder: Path) -> None:
    """Keeps the data of the runs in the folder of results."""
    folder.mkdir(parents=True, exist_ok=True)
    pictures.keep(results, folder)
    state_map.keep(results, folder)
    for part in (boxes, cycle, wide):
        found = part.made(results)
        if found is not None:
            write_study_table(found, folder / part.KEPT)
    run_times.keep(results, folder, STUDIES)
