"""Keeps what the page of Moon, Kevrekidis & Sundaresan (2006) shows of the runs themselves beside the tables of the studies: pictures over height
and time, of the map and of the wave's frame, curves over the plate's cycle, how plane the waves of the wide bed are, and how long runs took.

    scripts/report moon2006 --keep cases/moon2006/results
"""

from __future__ import annotations

from pathlib import Path

from paper_report import run_times
from study_tables import write_study_table

from . import boxes, cycle, pictures, state_map, wide
from .tables import STUDIES


def keep(results: Path, folder: Path) -> None:
    """Keeps what the runs in the folder of results give."""
    folder.mkdir(parents=True, exist_ok=True)
    pictures.keep(results, folder)
    state_map.keep(results, folder)
    for part in (boxes, cycle, wide):
        found = part.made(results)
        if found is not None:
            write_study_table(found, folder / part.KEPT)
    run_times.keep(results, folder, STUDIES)
