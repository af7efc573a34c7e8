"""Prints what the runs of cases/moon2006 gave, as tables in Markdown for the README there.

The first table has a row for each stage of each run, measured over the end of the stage: mean gas force over the
bed's weight, largest stress on the plate over the weight per area, rms of plate stress + pressure drop - effective
gravity (equation (17)), lift-off (largest less smallest height of the bed's bottom), mean contacts per particle,
solids fraction of the bulk at the end, rms of its fluctuation, and the waves. The last three, and the minimum fluidisation
velocity of each ramp in the second table, are those of `talcum analyse` (docs/analyse.md).
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import Any

# First, because it says what to do if numpy is missing.
from talcum_results import Array, ResultsError, Series, analyse, read_case, read_profiles, read_series, run_script

import numpy as np

import minimum_fluidisation

LONGEST_WINDOW = 60.0  # time units at the end of a stage that are measured, several periods of the waves at Bo 0
PART = 0.8  # of a stage that is measured, if that is less
LEAST_ROWS = 8
HEADINGS = (
    "case", "stage", "times", "U_s", "gas force", "plate stress, largest", "(17), rms", "lift-off",
    "contacts per particle", "phi of the bulk", "rms of phi", "waves: speed, wavelength, period",
)  # fmt: skip


@dataclass
class Stage:
    """A stage of a run: its name, and the times at its end that are measured."""

    name: str
    start: float
    end: float


def stages_of(case: dict[str, Any], last: float) -> list[Stage]:
    """The stages that a run of this case has come through or into, when its results end at `last`."""
    listed = case.get("stage") or [{"name": "whole", "duration": case.get("time", {}).get("end", last)}]
    stages, begin = [], 0.0
    for entry in listed:
        end = begin + float(entry["duration"])
        reached = min(end, last)
        if reached > begin:
            window = min(LONGEST_WINDOW, PART * (reached - begin))
            stages.append(Stage(str(entry.get("name", "")), reached - window, reached))
        begin = end
    return stages


def waves_in(folder: Path, stage: Stage) -> tuple[str, str]:
    """Rms of the solids fraction's fluctuation where the bed is, and the waves or why there are none."""
    found = analyse(folder, ["waves"], stage.start, stage.end)
    if "waves.state" in found.reasons:
        return "", f"not measured: {found.reasons['waves.state']}"
    deviations = found.tables["waves/windows"]["deviation"]
    rms = f"{float(np.sqrt(np.mean(deviations**2))):.3f}" if len(deviations) else ""
    if "waves.speed" not in found.values:
        return rms, f"none: {found.text('waves.state')}"
    numbers = (found.number(f"waves.{name}") for name in ("speed", "wavelength", "period"))
    return rms, ", ".join(f"{number:.3g}" for number in numbers)


def bulk(folder: Path, stage: Stage) -> str:
    """The solids fraction of the bulk at the end, if there is a bulk."""
    start = stage.end - 0.1 * (stage.end - stage.start)
    phi = analyse(folder, ["bed"], start, stage.end).number("bed.solids_fraction")
    return f"{phi:.3f}" if np.isfinite(phi) else ""


def row_of(folder: Path, stage: Stage, series: Series) -> list[str]:
    """A row of the first table."""
    rows = series.between(stage.start, stage.end)
    if len(rows.time) < LEAST_ROWS:
        raise ResultsError(f"{len(rows.time)} rows are too few")
    excess: Array = rows["plate_stress"] + rows["grid_pressure_drop"] - rows["effective_gravity"]
    bottom = rows["bed_bottom"]
    rms, waves = waves_in(folder, stage)
    return [
        folder.name,
        stage.name,
        f"{stage.start:g} to {stage.end:g}",
        f"{rows['superficial_velocity'].mean():.3g}",
        f"{rows['gas_force'].mean():.3f}",
        f"{rows['plate_stress'].max():.3f}",
        f"{np.sqrt(np.mean(excess**2)):.3f}",
        f"{np.nanmax(bottom) - np.nanmin(bottom):.2f}" if np.isfinite(bottom).any() else "",
        f"{rows['coordination_number'].mean():.3f}",
        bulk(folder, stage),
        rms,
        waves,
    ]


def minimum_fluidisation_of(folder: Path) -> list[str]:
    """The lines on the ramps of a run."""
    found = analyse(folder, ["u_mf"])
    return [minimum_fluidisation.report(found, way) for way in minimum_fluidisation.WAYS]


def is_ramp(case: dict[str, Any]) -> bool:
    """Whether some stage changes the superficial velocity gradually from or to zero."""
    gases = [stage.get("gas") for stage in case.get("stage", [])]
    velocities = [gas.get("superficial_velocity") for gas in gases if isinstance(gas, dict)]
    return any(isinstance(ramp, dict) and 0.0 in (ramp.get("from"), ramp.get("to")) for ramp in velocities)


def line(cells: list[str] | tuple[str, ...]) -> str:
    """A line of a table in Markdown."""
    return f"| {' | '.join(cells)} |"


def tables(folders: list[Path]) -> tuple[list[str], list[str]]:
    """The lines of both tables; what cannot be measured is said in its place."""
    rows, ramps = [], []
    for folder in folders:
        try:
            series, profiles = read_series(folder), read_profiles(folder)
        except ResultsError as reason:
            rows.append(line([folder.name, f"no results: {reason}"]))
            continue
        case = read_case(profiles, folder)
        for stage in stages_of(case, float(series.time[-1])):
            try:
                rows.append(line(row_of(folder, stage, series)))
            except ResultsError as reason:
                rows.append(line([folder.name, stage.name, f"not measured: {reason}"]))
        if is_ramp(case):
            ramps += [line([folder.name, words]) for words in minimum_fluidisation_of(folder)]
    return rows, ramps


def main(command_line: list[str] | None = None) -> None:
    """Reads, measures, prints."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", type=Path, help="folder that holds the output folders of the runs")
    parser.add_argument("cases", nargs="*", help="names of output folders (default: all)")
    arguments = parser.parse_args(command_line)
    if not arguments.results.is_dir():
        raise ResultsError(f"{arguments.results}: there is no such folder")
    found = sorted(path for path in arguments.results.iterdir() if (path / "series.csv").is_file())
    folders = [arguments.results / name for name in arguments.cases] or found
    if not folders:
        raise ResultsError(f"{arguments.results}: holds no output folders of runs")
    rows, ramps = tables(folders)
    print("\n".join([line(HEADINGS), line(["---"] * len(HEADINGS)), *rows]))
    if ramps:
        print("\n".join(["", line(["case", "minimum fluidisation"]), line(["---", "---"]), *ramps]))


if __name__ == "__main__":
    run_script(main)
