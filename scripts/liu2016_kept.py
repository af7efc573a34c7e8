"""Keeps what the page of Liu et al. (2016) shows of the runs themselves beside the tables of the studies: curves over time and lag, pictures of
beds and agglomerates, and how long runs took. Of a study that was not run here what is kept stays as it is.

    talcum study cases/liu2016/studies/fig3-cases.toml
    talcum study cases/liu2016/studies/other-cases.toml
    talcum study cases/liu2016/studies/breakage.toml
    talcum study cases/liu2016/studies/full-box.toml
    talcum study cases/liu2016/studies/fluidisation.toml
    .venv/bin/python scripts/liu2016_kept.py results --keep cases/liu2016/results
"""

from __future__ import annotations

from pathlib import Path

# First, because it says what to do if numpy is missing.
from talcum_results import ResultsError, run_script

import liu2016_curves
import liu2016_pictures
import paper_tables
import run_times
from liu2016_curves import ALL_STUDIES
from study_tables import write_study_table


def main(command_line: list[str] | None = None) -> None:
    """Keeps what the runs in the folder give."""
    results, folder = paper_tables.keeping(__doc__, command_line)
    if not liu2016_curves.runs_of(results) and not run_times.made(results, ALL_STUDIES):
        raise ResultsError(f"{results}: no complete run of {', '.join(ALL_STUDIES)}")
    folder.mkdir(parents=True, exist_ok=True)
    for name in liu2016_curves.TABLES:
        found = liu2016_curves.made(results, name)
        if found:
            write_study_table(found, folder / f"{name}.csv")
    liu2016_pictures.keep(results, folder)
    run_times.keep(results, folder, ALL_STUDIES)


if __name__ == "__main__":
    run_script(main)
