"""Keeps what the page of Moon, Kevrekidis & Sundaresan (2006) shows of the runs themselves beside the tables of the studies: pictures over height
and time, of the map and of the wave's frame, curves over the plate's cycle, how plane the waves of the wide bed are, and how long runs took.

    .venv/bin/python scripts/moon2006_kept.py results --keep cases/moon2006/results
"""

from __future__ import annotations

from pathlib import Path

# First, because it says what to do if numpy is missing.
from talcum_results import run_script

import moon2006_boxes
import moon2006_cycle
import moon2006_map
import moon2006_pictures
import moon2006_wide
import paper_tables
import run_times
from moon2006_tables import STUDIES
from study_tables import write_study_table


def main(command_line: list[str] | None = None) -> None:
    """Keeps what the runs in the folder give."""
    results, folder = paper_tables.keeping(__doc__, command_line)
    folder.mkdir(parents=True, exist_ok=True)
    moon2006_pictures.keep(results, folder)
    moon2006_map.keep(results, folder)
    for part in (moon2006_boxes, moon2006_cycle, moon2006_wide):
        found = part.made(results)
        if found is not None:
            write_study_table(found, folder / part.KEPT)
    run_times.keep(results, folder, STUDIES)


if __name__ == "__main__":
    run_script(main)
