"""Keeps the data of the runs themselves that the page of Liu et al. (2016) shows besides the tables of the studies: curves over time and lag,
figures of beds and agglomerates, and run times. If a study was not run here, its kept data stay unchanged.

    talcum study cases/liu2016/studies/fig3-cases.toml
    talcum study cases/liu2016/studies/other-cases.toml
    talcum study cases/liu2016/studies/breakage.toml
    talcum study cases/liu2016/studies/full-box.toml
    talcum study cases/liu2016/studies/fluidisation.toml
    scripts/report liu2016 --keep cases/liu2016/results
"""

from __future__ import annotations

from pathlib import Path

from paper_report import run_times
from study_tables import write_study_table
from talcum_results import ResultsError

from . import curves, pictures
from .curves import ALL_STUDIES


def keep(results: Path, folder: Path) -> None:
    """Keeps the data of the runs in the folder of results."""
    if not curves.runs_of(results) and not run_times.made(results, ALL_STUDIES):
        raise ResultsError(f"{results}: no complete run of {', '.join(ALL_STUDIES)}")
    folder.mkdir(parents=True, exist_ok=True)
    for name in curves.TABLES:
        found = curves.made(results, name)
        if found:
            write_study_table(found, folder / f"{name}.csv")
    pictures.keep(results, folder)
    run_times.keep(results, folder, ALL_STUDIES)
