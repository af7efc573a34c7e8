"""Keeps what the page of Moon, Kevrekidis & Sundaresan (2006) shows of the runs themselves beside the tables of the studies: pictures over height
and time, of the map and of the wave's frame, curves over the plate's cycle, how plane the waves of the wide bed are, and how long runs took.

    .venv/bin/python scripts/moon2006_kept.py results --keep cases/moon2006/results
"""

from __future__ import annotations

import argparse
from pathlib import Path

# First, because it says what to do if numpy is missing.
from talcum_results import run_script

import moon2006_boxes
import moon2006_cycle
import moon2006_map
import moon2006_pictures
import moon2006_wide
import run_times
from moon2006_tables import STUDIES
from study_tables import write_study_table


def main(command_line: list[str] | None = None) -> None:
    """Keeps what the runs in the folder give."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=Path, help="the folder in which the studies' results are")
    parser.add_argument("--keep", type=Path, required=True, metavar="FOLDER", help="where they go")
    arguments = parser.parse_args(command_line)
    arguments.keep.mkdir(parents=True, exist_ok=True)
    moon2006_pictures.keep(arguments.results, arguments.keep)
    moon2006_map.keep(arguments.results, arguments.keep)
    for part in (moon2006_boxes, moon2006_cycle, moon2006_wide):
        found = part.made(arguments.results)
        if found is not None:
            write_study_table(found, arguments.keep / part.KEPT)
    run_times.keep(arguments.results, arguments.keep, STUDIES)


if __name__ == "__main__":
    run_script(main)
