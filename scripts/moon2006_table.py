"""Prints what the runs of cases/moon2006 gave, as tables in Markdown for the README there.

The first table has a row for each stage of each run, measured over the end of the stage: mean gas force over the
bed's weight, largest stress on the plate over the weight per area, rms of plate stress + pressure drop - effective
gravity (equation (17)), lift-off (largest less smallest height of the bed's bottom), mean contacts per particle,
solids fraction of the bulk at the end, rms of its fluctuation, and the waves that spacetime.py finds. A vibrated bed is seen
from its centre of mass and averaged over a period of the plate first, so that waves are told from shaking; waves
of which less than two pass are marked as slow. The second table has the minimum fluidisation velocity of each ramp.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import Any

# First, because it says what to do if numpy is missing.
from talcum_results import Array, Profiles, ResultsError, Series, read_case, read_profiles, read_series, run_script

import numpy as np

import minimum_fluidisation
import spacetime

LONGEST_WINDOW = 60.0  # time units at the end of a stage that are measured, several periods of the waves at Bo 0
PART = 0.8  # of a stage that is measured, if that is less
LEAST_RMS = 0.02  # of the solids fraction along the bed: less is no wave
LARGEST_SPEED = 2.0  # of slow waves
LEAST_ROWS = 8
LEAST_NODES = 12
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
    vibrated: bool


def stages_of(case: dict[str, Any], last: float) -> list[Stage]:
    """The stages that a run of this case has come through or into, when its results end at `last`."""
    listed = case.get("stage") or [{"name": "whole", "duration": case.get("time", {}).get("end", last)}]
    stages, begin = [], 0.0
    vibrated = "vibration" in case
    for entry in listed:
        state = entry.get("vibration", vibrated)
        vibrated = state not in ("off", False) if isinstance(state, (str, bool)) else True
        end = begin + float(entry["duration"])
        reached = min(end, last)
        if reached > begin:
            window = min(LONGEST_WINDOW, PART * (reached - begin))
            stages.append(Stage(str(entry.get("name", "")), reached - window, reached, vibrated))
        begin = end
    return stages


def running_mean(values: Array, rows: int) -> Array:
    """The means over so many rows one after another; fewer rows than there were."""
    sums = np.cumsum(np.concatenate([np.zeros((1, *values.shape[1:])), values]), axis=0)
    return (sums[rows:] - sums[:-rows]) / rows


def without_shaking(profiles: Profiles, series: Series, period: float) -> Profiles:
    """The profiles as seen from the bed, which goes up and down with the plate, averaged over a period."""
    rows = max(1, round(period / float(np.median(np.diff(profiles.time)))))
    if rows >= len(profiles.time):
        raise spacetime.NoWave("less than one period of the plate")
    centre = np.interp(profiles.time, series.time, series["centre_height"])
    kept = slice((rows - 1) // 2, (rows - 1) // 2 + len(centre) - rows + 1)
    # The mean over a period at the record's ends is the one nearest to them.
    mean = np.interp(profiles.time, profiles.time[kept], running_mean(centre, rows))
    seen = [
        np.interp(profiles.height + shift, profiles.height, row, right=0.0)
        for shift, row in zip(centre - mean, profiles.solids_fraction)
    ]
    return Profiles(
        profiles.time[kept], profiles.height, running_mean(np.array(seen), rows), profiles.solids_velocity[kept],
        profiles.superficial_velocity[kept], profiles.units, profiles.attributes,
    )  # fmt: skip


def waves_in(profiles: Profiles, series: Series, period: float | None) -> tuple[str, str]:
    """Rms of the solids fraction's fluctuation, and the waves or why there are none."""
    try:
        profiles = spacetime.even_times(profiles)
        profiles = without_shaking(profiles, series, period) if period else profiles
        nodes = wavy_nodes(profiles)
        rms = f"{float(np.sqrt(np.mean(spacetime.fluctuation(profiles, nodes) ** 2))):.3f}"
    except (ResultsError, spacetime.NoWave) as reason:
        return "", f"not measured: {reason}"
    try:
        waves = spacetime.measure_waves(profiles, nodes)
    except spacetime.NoWave as reason:
        return rms, slow_waves(profiles, nodes) or f"none: {reason}"
    return rms, f"{waves.speed:.3g}, {abs(waves.wavelength):.3g}, {waves.period:.3g}"


def wavy_nodes(profiles: Profiles) -> Array:
    """The nodes of the bed from the lowest to the highest that fluctuates: waves may not have reached the rest."""
    nodes = spacetime.bed_rows(profiles)
    moving = np.flatnonzero(spacetime.fluctuation(profiles, nodes).std(axis=0) > LEAST_RMS)
    span = nodes[moving[0] : moving[-1] + 1] if len(moving) else nodes
    return span if len(span) >= LEAST_NODES else nodes


def slow_waves(profiles: Profiles, nodes: Array) -> str:
    """Speed and wavelength of waves that pass a height less than twice while they are watched; empty if none travel."""
    values = profiles.solids_fraction[:, nodes]
    values = values - values.mean(axis=1, keepdims=True)
    if np.mean(values**2) < LEAST_RMS**2:
        return ""
    interval = float(np.median(np.diff(profiles.time)))
    spacing = float(np.median(np.diff(profiles.height)))
    table = spacetime.correlation(values)
    try:
        wavelength = spacetime.find_period(table[len(values) - 1, len(nodes) - 1 :], spacing)
        # With height and time exchanged the ray's slowness is the speed, and the record of time may be short.
        speed = spacetime.find_slowness(table.T, 4.0 * LARGEST_SPEED * interval, spacing, interval)
    except spacetime.NoWave:
        return ""
    if abs(speed) * len(values) * interval < 0.25 * wavelength:
        return ""  # less than a quarter of a wave has passed
    return f"{speed:.2g}, {wavelength:.2g}, {wavelength / abs(speed):.2g} (slow)"


def bulk(profiles: Profiles, stage: Stage) -> str:
    """The solids fraction of the bulk at the end, if there is a bulk."""
    start = stage.end - 0.1 * (stage.end - stage.start)
    try:
        return f"{minimum_fluidisation.bulk_solids_fraction(profiles, start, stage.end):.3f}"
    except ResultsError:
        return ""


def row_of(name: str, stage: Stage, series: Series, profiles: Profiles, case: dict[str, Any]) -> list[str]:
    """A row of the first table."""
    rows = series.between(stage.start, stage.end)
    if len(rows.time) < LEAST_ROWS:
        raise ResultsError(f"{len(rows.time)} rows are too few")
    excess: Array = rows["plate_stress"] + rows["grid_pressure_drop"] - rows["effective_gravity"]
    bottom = rows["bed_bottom"]
    period = 1.0 / float(case["vibration"]["frequency"]) if stage.vibrated else None
    rms, waves = waves_in(profiles.between(stage.start, stage.end), rows, period)
    return [
        name,
        stage.name,
        f"{stage.start:g} to {stage.end:g}",
        f"{rows['superficial_velocity'].mean():.3g}",
        f"{rows['gas_force'].mean():.3f}",
        f"{rows['plate_stress'].max():.3f}",
        f"{np.sqrt(np.mean(excess**2)):.3f}",
        f"{np.nanmax(bottom) - np.nanmin(bottom):.2f}" if np.isfinite(bottom).any() else "",
        f"{rows['coordination_number'].mean():.3f}",
        bulk(profiles, stage),
        rms,
        waves,
    ]


def minimum_fluidisation_of(series: Series, profiles: Profiles, case: dict[str, Any]) -> list[str]:
    """The lines on the ramps of a run; none if its superficial velocity is constant or the ramp not far enough."""
    scale = minimum_fluidisation.velocity_scale(case, None, None)
    lines = []
    try:
        for branch in minimum_fluidisation.split_branches(series, "grid_pressure_drop"):
            fit = minimum_fluidisation.fit_branch(branch)
            phi = minimum_fluidisation.bulk_solids_fraction(profiles, *fit.fixed_bed)
            lines.append(minimum_fluidisation.report(fit, phi, scale, ""))
    except ResultsError as reason:
        lines.append(str(reason))
    return lines


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
                rows.append(line(row_of(folder.name, stage, series, profiles, case)))
            except ResultsError as reason:
                rows.append(line([folder.name, stage.name, f"not measured: {reason}"]))
        if is_ramp(case):
            ramps += [line([folder.name, words]) for words in minimum_fluidisation_of(series, profiles, case)]
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
