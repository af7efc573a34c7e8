"""An extension that Moon, Kevrekidis & Sundaresan (2006) propose: three dimensions. A wide bed without and with cohesion and vibration."""

from __future__ import annotations

from pathlib import Path

from paper_report.page import Section, Statement
from study_tables import StudyTable, table_of_rows
from talcum_results import snapshot_times

import h5py
import numpy as np

from .pictures import beds
from .tables import made_or_kept, source, table

STEADY = 25.0
LAYERS = slice(2, 12)
"""Layers of cells of 2 d that lie within the bed: from 4 d to 24 d."""
KEPT = "wide-layers.csv"


def layers(results: Path) -> StudyTable | None:
    """How the voidage varies over time in means of layers, and across layers; of the runs that are here, else the kept table."""
    return made_or_kept(made(results), KEPT)


def made(results: Path) -> StudyTable | None:
    """The values of the runs that are here."""
    runs = table(results, "wide", "runs")
    rows: list[dict[str, str]] = []
    provenance = {"title": "Voidage of the wide bed over time in means of layers, and across layers: standard deviations"}
    provenance |= {"commit": runs.provenance.get("commit", "unknown")} if runs else {}
    for run in runs.rows if runs else []:
        file = results / "wide/runs" / run["run"] / "gas.vtkhdf"
        if file.exists():
            over_time, across = deviations(file)
            named = {name: run[name] for name in ("bond_number", "gamma", "seed")}
            rows.append(named | {"over_time [1]": f"{over_time:.4g}", "across [1]": f"{across:.4g}"})
            provenance[run["run"]] = f"digest {run['digest']}"
    return table_of_rows(results / KEPT, provenance, rows) if rows else None


def deviations(file: Path) -> tuple[float, float]:
    """Standard deviation of the voidage over time in means of layers, and across a layer at one time; root mean squares over layers."""
    with h5py.File(file) as snapshots:
        root = snapshots["VTKHDF"]
        later = np.flatnonzero(snapshot_times(root) >= STEADY)
        voidage = root["CellData/voidage"][later[0] :, LAYERS]
    over_time = voidage.mean(axis=(2, 3)).std(axis=0)
    across = voidage.std(axis=(2, 3))
    return float(np.sqrt(np.mean(over_time**2))), float(np.sqrt(np.mean(across**2)))


def wide_bed(results: Path) -> Section | None:
    """The wide bed with each cohesion and vibration."""
    points, found = table(results, "wide", "points"), layers(results)
    if points is None:
        return None
    statements = []
    for row in points.rows:
        bond, gamma = (float(row[name]) for name in ("bond_number", "gamma"))
        share, bubbles = (points.estimate(row, name) for name in ("share", "bubbles"))
        text = f"{row['waves'].replace('_', ' ')}; waves sweep {share.mean:.2g} of the material; bubbles at a time {bubbles.mean:.2g}"
        same = found.where(bond_number=bond, gamma=gamma) if found else None
        if same is not None and same.rows:
            over_time, across = (float(np.mean(same.numbers(name))) for name in ("over_time", "across"))
            text += f"; voidage of a layer varies by {over_time:.2g} over time and by {across:.2g} across the layer"
        statements.append(Statement(f"Bo {bond:g}, Gamma {gamma:g}", "not done: the paper's gas is one-dimensional", text, None))
    text = (
        "The paper proposes beds of higher dimensions. This bed is 20 d x 20 d wide, some 27 d deep at rest and 31 d fluidised, in a gas in three dimensions on "
        "cells of 2 d with a filter of 3 d; it is fluidised for 100 time units before cohesion and vibration are switched on. Measured from 25 "
        "time units later on. A wave is plane if the voidage varies over time much more than across a layer (layers from 4 d to 24 d)."
    )
    return Section("Beyond the paper: three dimensions", text, statements, beds(results, "wide"), [source("wide", points)])
