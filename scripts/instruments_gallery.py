"""Makes the runs for the figures of docs/instruments.md, analyse.md, files.md and study.md, and draws the figures.

    scripts/instruments_gallery.py                  all runs, one after another: some ten minutes
    scripts/instruments_gallery.py vibrated heap    only these runs and their figures
    scripts/instruments_gallery.py --draw-only      only the figures, from earlier runs

Each run is a case of the repository with other values for some keys, as with `talcum run CASE --set KEY=VALUE`.
"""

from __future__ import annotations

# First, because it says what to do if numpy is missing.
from talcum_results import ResultsError, run_script, save_figure

import argparse
import shutil
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
sys.path.insert(0, str(ROOT / "python"))

import instruments_figures as figures
import minimum_fluidisation
import talcum
from matplotlib.figure import Figure
from stored_figures import store


@dataclass
class Run:
    """A case, and the keys that take other values."""

    case: str
    values: dict[str, Any]

    @property
    def path(self) -> Path:
        """The case file."""
        return ROOT / "cases" / self.case

    def make(self, folder: Path) -> None:
        """Runs it again."""
        talcum.run(self.path, set=self.values, output=folder, force=True)


@dataclass
class FirstStudy:
    """The first study of docs/study.md, with so many seeds."""

    seeds: int

    def make(self, folder: Path) -> None:
        """Runs it again."""
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        text = (ROOT / "tests/program/study/study.toml").read_text(encoding="utf-8")
        text = text.replace('"bed.toml"', f'"{ROOT / "tests/program/study/bed.toml"}"').replace("seeds = 2", f"seeds = {self.seeds}")
        (folder / "study.toml").write_text(text, encoding="utf-8")
        talcum.run_study(folder / "study.toml", output=folder)


def instrument(name: str, **values: Any) -> dict[str, Any]:
    """The keys of a `[measure.NAME]`."""
    return {f"measure.{name}.{key}": value for key, value in values.items()}


# A thicker gas holds the bed on the plate; at this Stokes number it is thrown up and lands in every cycle.
SHAKEN = {"vibration.frequency": 0.2, "gas.stokes_number": 500.0}
RUNS: dict[str, Run | FirstStudy] = {
    "vibrated": Run(
        "instruments/vibrated.toml",
        SHAKEN
        | {"particles.count": 800, "time.end": 150.0, "output.series": 0.05}
        | instrument("cycle", start=25.0, cycles=24)
        | instrument("stress", start=25.0, average=25.0, frame="phase", phases=8)
        | instrument("coordination", average=0.5)
        | instrument("spread", kind="mixing", every=0.1, start=25.0, window=10.0, about="mean"),
    ),
    "ledger": Run("instruments/vibrated.toml", SHAKEN | {"time.end": 10.0, "output.energy": 0.05}),
    "heap": Run(
        "gallery/heap.toml",
        instrument("network", kind="contacts", every=0.1)
        | instrument("stress", kind="stress", every=0.01, start=1.0, average=0.2, cells=[30, 1, 15]),
    ),
    "bubbling-bed": Run(
        "gallery/bubbling-bed.toml",
        {"stage.fluidise.duration": 4.0, "output.gas": 0.01}
        | instrument("mixing", kind="mixing", every=0.005, start=0.65, window=0.5, tracers="region", lower_corner=[0.0, 0.0, 0.0],
                  upper_corner=[0.06, 0.0045, 0.018], cells=[12, 1, 12])
        | instrument("point", kind="probe", every=0.002, at="point", point=[0.03, 0.00225, 0.02], radius=0.004)
        | instrument("average", kind="time_average", every=0.005, start=0.65, average=3.5),
    ),
    "agglomerates": Run("gallery/agglomerates.toml", {}),
    "ramp": Run(
        "moon2006/slow-ramp.toml",
        {"particles.count": 1000, "contact.normal_stiffness": 5.0e4, "time.step": 5.0e-4, "output.series": 2.5},
    ),
    "study-2": FirstStudy(2),
    "study-5": FirstStudy(5),
}  # fmt: skip
"""The runs by the names of their folders."""


@dataclass
class Drawn:
    """A figure, and the runs that it shows."""

    runs: tuple[str, ...]
    draw: Callable[..., Figure]


def ramp(bed: talcum.Bed) -> Figure:
    """The pressure drop over the superficial velocity, as `python -m talcum.minimum_fluidisation` draws it."""
    return minimum_fluidisation.draw(figures.read_series(bed.folder), bed.analyse(["u_mf"]))


DRAWN = {
    "measure-phase-average": Drawn(("vibrated",), figures.phase_average),
    "measure-stress": Drawn(("vibrated",), figures.stress),
    "measure-coordination": Drawn(("vibrated",), figures.coordination),
    "measure-contacts": Drawn(("heap",), figures.contact_network),
    "measure-stress-cells": Drawn(("heap",), figures.stress_in_cells),
    "measure-agglomerates": Drawn(("agglomerates",), figures.agglomerates),
    "measure-mixing": Drawn(("vibrated", "bubbling-bed"), figures.mixing),
    "measure-probe": Drawn(("bubbling-bed",), figures.probe),
    "measure-time-average": Drawn(("bubbling-bed",), figures.time_average),
    "analyse-bubbles": Drawn(("bubbling-bed",), figures.bubbles),
    "analyse-spectrum": Drawn(("bubbling-bed",), figures.spectrum),
    "analyse-minimum-fluidisation": Drawn(("ramp",), ramp),
    "energy-ledger": Drawn(("ledger",), figures.ledger),
    "study-points": Drawn(("study-2", "study-5"), figures.points_of_studies),
}
"""The figures by the names of their files in docs."""


def results_of(name: str, folder: Path) -> talcum.Bed | talcum.Study:
    """The results of a run or a study."""
    return talcum.read_study(folder / name) if isinstance(RUNS[name], FirstStudy) else talcum.open(folder / name)


def main(words: list[str] | None = None) -> None:
    """Runs and draws."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", help=f"which runs: {', '.join(RUNS)} (default: all)")
    parser.add_argument("--results", type=Path, default=ROOT / "results/instruments", metavar="FOLDER", help="the folder in which they are run")
    parser.add_argument("--draw-only", action="store_true", help="draw the results of earlier runs")
    arguments = parser.parse_args(words)
    names = arguments.names or list(RUNS)
    if unknown := [name for name in names if name not in RUNS]:
        raise ResultsError(f"{unknown[0]}: there is no such run: {', '.join(RUNS)}")
    for name in [] if arguments.draw_only else names:
        print(f"== {name}")
        try:
            RUNS[name].make(arguments.results / name)
        except talcum.ResultsError as failed:
            raise ResultsError(f"{name}: {failed}") from failed
    for file, drawn in DRAWN.items():
        if any(name in names for name in drawn.runs):
            picture = DOCS / f"{file}.png"
            save_figure(drawn.draw(*(results_of(name, arguments.results) for name in drawn.runs)), picture)
            store(picture)


if __name__ == "__main__":
    run_script(main)
