"""Draws the solids fraction over height and time, with the rays of the waves where they were measured.

`talcum analyse` takes the measurements (docs/analyse.md), and the script prints its numbers. Each line is a ray with the measured
speed, in the window of height and time in which it was measured. A moving front between waves and still bed is dotted.
"""

from __future__ import annotations

import textwrap
from pathlib import Path

# First, because it says what to do if numpy is missing.
from talcum_results import (
    Analysis,
    Array,
    Profiles,
    ResultsError,
    analyse,
    argument_parser,
    axis_label,
    new_figure,
    picture_of,
    read_profiles,
    run_script,
    save_figure,
)

import numpy as np
from matplotlib import colormaps

NUMBERS = ("speed", "period", "wavelength", "amplitude", "void_speed", "front_speed", "share", "swept_share", "frozen_share", "plug_share")
FREEBOARD = 0.02  # solids fraction below which nothing is drawn
FRONT_MOVES = 3.0  # a front is drawn from so many standard errors of its speed on; below, it may stand still or be chance


def describe(found: Analysis) -> str:
    """The lines to print: the wave speed, the state of the bed, and the other numbers."""
    reason = found.reasons.get("waves.state")
    if reason:
        return f"nothing measured: {reason}"
    speed = found.text("waves.speed")
    first = f"wave speed {speed}" if "waves.speed" in found.values else f"no wave found: {found.reasons['waves.speed']}"
    lines = [first, f"state {found.text('waves.state')}"]
    lines += [f"{name.replace('_', ' ')} {found.text('waves.' + name)}" for name in NUMBERS[1:]]
    return "\n".join(lines)


def rays(windows: dict[str, Array]) -> list[tuple[list[float], list[float]]]:
    """Times and heights of the ends of a ray for windows with waves that do not overlap."""
    taken: list[tuple[float, float]] = []
    lines = []
    waves = [row for row, state in enumerate(windows["state"]) if state == "waves"]
    for row in waves + [row for row, state in enumerate(windows["state"]) if state == "intermittent"]:
        height, time, speed = windows["height"][row], windows["time"][row], windows["speed"][row]
        across, along = windows["window_height"][row], windows["window_duration"][row]
        if any(abs(height - z) < 0.95 * across and abs(time - t) < 0.95 * along for z, t in taken):
            continue
        taken.append((height, time))
        half = min(0.4 * along, 0.4 * across / abs(speed))
        lines.append(([time - half, time + half], [height - speed * half, height + speed * half]))
    return lines


def scale(profiles: Profiles) -> tuple[float, float]:
    """The solids fractions between which colours change, which cover nearly all of the bed."""
    inside = profiles.solids_fraction[profiles.solids_fraction > FREEBOARD]
    low, high = np.percentile(inside, [2.0, 99.5]) if len(inside) else (0.0, 0.65)
    return (float(low), float(high)) if high - low > 0.02 else (float(low) - 0.05, float(high) + 0.05)


def draw(profiles: Profiles, found: Analysis, top: float | None, colours: str, picture: Path) -> None:
    """Draws solids fraction over time and height, with the rays of the waves."""
    figure, panels = new_figure(size=(11.0, 5.5))
    panel = panels[0, 0]
    panel.grid(False)
    low, high = scale(profiles)
    bed = np.ma.masked_less(profiles.solids_fraction, FREEBOARD)
    mesh = panel.pcolormesh(
        profiles.time, profiles.height, bed.T, cmap=colours, vmin=low, vmax=high, shading="nearest", rasterized=True,
    )  # fmt: skip
    dense = np.flatnonzero(profiles.solids_fraction.max(axis=0) > FREEBOARD)
    highest = profiles.height[dense[-1]] * 1.05 if len(dense) else profiles.height[-1]
    panel.set_ylim(profiles.height[0], top if top is not None else highest)
    panel.set_xlim(profiles.time[0], profiles.time[-1])
    panel.set_xlabel(axis_label("time", profiles.units["time"]))
    panel.set_ylabel(axis_label("height", profiles.units["height"]))
    panel.set_title(textwrap.fill(str(profiles.attributes.get("title", "")), 90), loc="left")
    figure.colorbar(mesh, ax=panel, label="solids fraction", extend="both", pad=0.015)
    draw_measured(panel, found)
    save_figure(figure, picture)


def speed_of_waves(found: Analysis) -> str:
    """The speed; if a record has too few windows for its error, the speed of single voids too, which has an error."""
    speed = found.text("waves.speed")
    if "waves.speed" in found.errors or "waves.void_speed" not in found.errors:
        return speed
    return f"{speed}; single voids, {found.text('waves.void_speed')}"


def moving_front(found: Analysis) -> dict[str, Array] | None:
    """Times and heights of the front between waves and still bed, if its speed is more than chance."""
    speed, error = found.number("waves.front_speed"), found.errors.get("waves.front_speed", np.inf)
    return found.tables.get("waves/front") if abs(speed) > FRONT_MOVES * error else None


def draw_measured(panel, found: Analysis) -> None:
    """The rays, and the front."""
    windows = found.tables.get("waves/windows")
    lines = rays(windows) if windows else []
    for number, (times, heights) in enumerate(lines):
        label = f"measured waves, {speed_of_waves(found)}" if number == 0 else None
        panel.plot(times, heights, color="white", linewidth=4.0, solid_capstyle="round")
        panel.plot(times, heights, color="#d4005a", linewidth=2.2, solid_capstyle="round", label=label)
    front = moving_front(found)
    if front:
        label = f"front, {found.text('waves.front_speed')}"
        panel.plot(front["time"], front["height"], linestyle="", marker="o", markersize=3.0, color="black", label=label)
    if lines or front:
        panel.legend(loc="upper left", facecolor="white", framealpha=0.95)


def main(command_line: list[str] | None = None) -> None:
    """Analyses the run with `talcum analyse`, prints and draws."""
    parser = argument_parser(__doc__, "spacetime.png")
    parser.add_argument("--height", type=float, metavar="Z", help="top of the figure (default: top of the bed)")
    parser.add_argument(
        "--colours", default="YlGnBu", help="a colour map of matplotlib; viridis, cividis and "
        "gray_r are perceptually uniform"
    )  # fmt: skip
    arguments = parser.parse_args(command_line)
    if arguments.colours not in colormaps:
        raise ResultsError(f"--colours {arguments.colours}: matplotlib has no such colour map")
    found = analyse(arguments.results, ["waves"], arguments.start, arguments.end)
    print(describe(found))
    profiles = read_profiles(arguments.results).between(arguments.start, arguments.end)
    draw(profiles, found, arguments.height, arguments.colours, picture_of(arguments, "spacetime.png"))


if __name__ == "__main__":
    run_script(main)
