"""Measures the minimum fluidisation velocity from a run whose superficial gas velocity goes up (and down again).

The velocity may be ramped or go in steps (then the later half of each step is averaged). On each branch a
straight line through the origin is fitted to the pressure drop of the fixed bed, and the plateau is the mean
pressure drop of the fluidised bed; the minimum fluidisation velocity U_mf is where line and plateau meet. With the
settled bed's solids fraction phi, taken from profiles.h5, it is compared with the balance of weight and
Wen-Yu drag of the settled bed, U = rho_s g d^2 / (18 mu) (1 - phi)^4.65, which is (St / 18) (1 - phi)^4.65 sqrt(g d).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

# First, because it says what to do if numpy is missing.
from talcum_results import (
    BLUE,
    GREY,
    ORANGE,
    Array,
    Profiles,
    ResultsError,
    Series,
    argument_parser,
    new_figure,
    picture_of,
    read_case,
    read_profiles,
    read_series,
    result_file,
    run_script,
    save_figure,
)

import numpy as np

FIT_BETWEEN = (0.1, 0.7)  # parts of the weight: below, the signal is small; above, the bed may move already
LEAST_DETERMINATION = 0.9  # R^2 below which the points are not called a line
BULK_FRACTION = 0.3  # solids fraction that bounds the bed
END_LAYERS = 4.0  # spacings left out at the plate and below the surface, where layers are half empty


@dataclass
class Branch:
    """Pressure drop over superficial velocity, while the velocity rises or falls; sorted by velocity."""

    name: str
    velocity: Array
    pressure_drop: Array
    time: Array


@dataclass
class Fit:
    """What was measured on a branch: U_mf, slope of the fixed bed, plateau, times of the fixed bed."""

    branch: Branch
    velocity: float
    slope: float
    plateau: float
    fixed_bed: tuple[float, float]


def split_branches(series: Series, drop: str) -> list[Branch]:
    """The rise to the greatest velocity, and the fall after it (where there is one)."""
    velocity = series["superficial_velocity"]
    highest, lowest = velocity.max(), velocity.min()
    if highest - lowest <= 1e-9 * max(abs(highest), 1e-300):
        raise ResultsError("the superficial velocity is constant: a run with a ramp or steps is needed")
    tops = np.flatnonzero(velocity >= highest * (1.0 - 1e-9))
    start = int(np.flatnonzero(velocity[: tops[0] + 1] <= velocity[: tops[0] + 1].min() + 1e-12)[-1])
    end = tops[-1] + int(np.argmin(velocity[tops[-1] :]))
    spans = [("up", start, int(tops[-1])), ("down", int(tops[0]), end)]
    return [
        make_branch(name, series, drop, slice(first, last + 1))
        for name, first, last in spans
        if last - first >= 3 and np.ptp(velocity[first : last + 1]) > 0.5 * (highest - lowest)
    ]


def make_branch(name: str, series: Series, drop: str, rows: slice) -> Branch:
    """The points of a branch; rows of one velocity become one point, the mean of their later half."""
    velocity, pressure, time = series["superficial_velocity"][rows], series[drop][rows], series.time[rows]
    changes = np.flatnonzero(np.abs(np.diff(velocity)) > 1e-9 * np.abs(velocity).max()) + 1
    groups = np.split(np.arange(len(velocity)), changes)
    later = [group[len(group) // 2 :] for group in groups]
    points = np.array([[velocity[g].mean(), np.nanmean(pressure[g]), time[g].mean()] for g in later])
    points = points[np.argsort(points[:, 0], kind="stable")]
    return Branch(name, *points.T)


def fit_branch(branch: Branch) -> Fit:
    """Line through the origin and plateau of a branch; an error in words if there is no such shape."""
    velocity, pressure = branch.velocity, branch.pressure_drop
    scale = float(np.median(pressure[velocity > 0.75 * velocity[-1]]))
    above = np.flatnonzero(pressure > FIT_BETWEEN[1] * scale)
    end = above[0] if len(above) else len(pressure)
    fixed = np.flatnonzero((pressure[:end] > FIT_BETWEEN[0] * scale) & (velocity[:end] > 0.0))
    if len(fixed) < 4:
        raise ResultsError(f"{branch.name}: {len(fixed)} points with a fixed bed are too few; 4 are needed")
    slope = float(velocity[fixed] @ pressure[fixed] / (velocity[fixed] @ velocity[fixed]))
    check_line(branch, fixed, slope)
    fluidised = velocity > 1.2 * scale / slope
    if fluidised.sum() < 2:
        raise ResultsError(
            f"{branch.name}: the velocity reaches {velocity[-1]:.4g} only, too little beyond the minimum "
            f"fluidisation velocity (about {scale / slope:.4g}) to see a plateau; go beyond 1.2 times that"
        )
    plateau = float(pressure[fluidised].mean())
    times = branch.time[fixed]
    return Fit(branch, plateau / slope, slope, plateau, (float(times.min()), float(times.max())))


def check_line(branch: Branch, fixed: Array, slope: float) -> None:
    """The points of the fixed bed must lie on a line through the origin."""
    pressure = branch.pressure_drop[fixed]
    left = np.sum((pressure - slope * branch.velocity[fixed]) ** 2)
    determination = 1.0 - left / max(np.sum((pressure - pressure.mean()) ** 2), 1e-300)
    if not determination > LEAST_DETERMINATION:
        raise ResultsError(
            f"{branch.name}: no minimum fluidisation found: the pressure drop does not rise in proportion to "
            f"the superficial velocity (R^2 = {determination:.2f})"
        )


def bulk_solids_fraction(profiles: Profiles, start: float, end: float) -> float:
    """Mean solids fraction of the settled bed between two times, without the layers at plate and surface."""
    rows = (profiles.time >= start) & (profiles.time <= end)
    if not rows.any():
        rows = np.abs(profiles.time - 0.5 * (start + end)) == np.abs(profiles.time - 0.5 * (start + end)).min()
    mean = profiles.solids_fraction[rows].mean(axis=0)
    bed = np.flatnonzero(mean > BULK_FRACTION)
    if len(bed) <= 2 * END_LAYERS:
        raise ResultsError("the settled bed spans too few heights of the profiles to measure its solids fraction")
    spacing = np.median(np.diff(profiles.height))
    height = profiles.height[bed]
    bulk = bed[(height > END_LAYERS * spacing) & (height < height[-1] - END_LAYERS * spacing)]
    return float(mean[bulk].mean())


def single_diameter(particles: dict[str, Any]) -> float:
    """The case's reference diameter, or its only one."""
    diameter = particles.get("reference_diameter", particles.get("diameter"))
    if not isinstance(diameter, (int, float)):
        raise ResultsError("particles differ in diameter: give --scale, rho_s g d^2 / (18 mu)")
    return float(diameter)


def velocity_scale(case: dict[str, Any], stokes: float | None, scale: float | None) -> float | None:
    """rho_s g d^2 / (18 mu) in the units of the series, from the options or the case; None if unknown."""
    if scale is not None:
        return scale
    dimensionless = case.get("units", "dimensionless") == "dimensionless"
    gas, particles = case.get("gas", {}), case.get("particles", {})
    stokes = stokes if stokes is not None else gas.get("stokes_number")
    if stokes is not None and dimensionless:
        return float(stokes) / 18.0
    if not gas or not particles:
        return None
    diameter, gravity = single_diameter(particles), float(case["gravity"]["magnitude"])
    if stokes is not None:
        return float(stokes) / 18.0 * float(np.sqrt(gravity * diameter))
    if "viscosity" not in gas:
        return None
    return float(particles.get("density", 1.0)) * gravity * diameter**2 / (18.0 * float(gas["viscosity"]))


def report(fit: Fit, phi: float | None, scale: float | None, unit: str) -> str:
    """The line of numbers of a branch."""
    words = f"{fit.branch.name}: U_mf {fit.velocity:.4g}{unit}, plateau {fit.plateau:.4g} of the weight"
    if phi is not None:
        words += f", phi {phi:.4f}"
    if phi is not None and scale is not None:
        balance = scale * (1.0 - phi) ** 4.65
        words += f", force balance {balance:.4g}{unit}, ratio {fit.velocity / balance:.4f}"
    return words


def draw(series: Series, fits: list[Fit], drop: str):
    """Pressure drop over superficial velocity, with the fitted lines."""
    figure, panels = new_figure(size=(8.5, 5.5))
    panel = panels[0, 0]
    for fit, colour, marker in zip(fits, (BLUE, ORANGE), ("o", "s")):
        branch = fit.branch
        label = f"{branch.name}: U_mf {fit.velocity:.3g}"
        panel.plot(branch.velocity, branch.pressure_drop, marker, color=colour, markersize=3.5, alpha=0.6, label=label)
        panel.plot(
            [0.0, fit.velocity, max(branch.velocity[-1], fit.velocity)], [0.0, fit.plateau, fit.plateau],
            color=colour, linewidth=1.6,
        )  # fmt: skip
        panel.axvline(fit.velocity, color=colour, linestyle=":", linewidth=1.2)
    panel.axhline(1.0, color=GREY, linewidth=0.8)
    panel.set_xlim(left=0.0)
    panel.set_ylim(bottom=0.0)
    panel.set_xlabel(series.label("superficial_velocity"))
    panel.set_ylabel(f"{drop.replace('_', ' ')} over the bed's weight")
    panel.legend(loc="lower right")
    return figure


def options():
    """The options of this script."""
    parser = argument_parser(__doc__, "minimum_fluidisation.png")
    parser.add_argument("--stokes", type=float, metavar="ST", help="Stokes number (default: from the case)")
    parser.add_argument("--scale", type=float, help="rho_s g d^2 / (18 mu) in the units of the series")
    parser.add_argument(
        "--pressure-drop", choices=["grid", "force"], default="grid",
        help="the grid integral (default), or the gas force on the particles",
    )  # fmt: skip
    return parser


def main(command_line: list[str] | None = None) -> None:
    """Reads, fits, draws."""
    arguments = options().parse_args(command_line)
    drop = "grid_pressure_drop" if arguments.pressure_drop == "grid" else "gas_force"
    series = read_series(arguments.results).between(arguments.start, arguments.end)
    fits = [fit_branch(branch) for branch in split_branches(series, drop)]
    if not fits:
        raise ResultsError("the run is not far enough for a rise or fall of the superficial velocity")
    profiles = None
    try:
        result_file(arguments.results, "profiles.h5")
        if arguments.results.is_dir():
            profiles = read_profiles(arguments.results)
    except ResultsError as reason:
        print(f"solids fraction unknown: {reason}")
    scale = velocity_scale(read_case(profiles, arguments.results), arguments.stokes, arguments.scale)
    unit = series.units["superficial_velocity"]
    for fit in fits:
        phi = bulk_solids_fraction(profiles, *fit.fixed_bed) if profiles is not None else None
        print(report(fit, phi, scale, f" {unit}" if unit not in ("", "1") else ""))
    save_figure(draw(series, fits, drop), picture_of(arguments, "minimum_fluidisation.png"))


if __name__ == "__main__":
    run_script(main)
