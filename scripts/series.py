"""Draws the time series of a run: pressure drops and plate stress, heights, energies, contacts, balance errors."""

from __future__ import annotations

# First, because it says what to do if numpy is missing.
from talcum_results import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    RED,
    Series,
    argument_parser,
    new_figure,
    picture_of,
    read_series,
    run_script,
    save_figure,
)

import numpy as np

# Panels: title, label of the vertical axis, its scale, and the lines: column, label, colour.
PANELS = [
    (
        "forces",
        "over the bed's weight",
        "linear",
        [
            ("plate_stress", "stress on the plate", ORANGE),
            ("grid_pressure_drop", "pressure drop", BLUE),
            ("gas_force", "gas force on the particles", GREEN),
            ("effective_gravity", "effective gravity over g", GREY),
        ],
    ),
    (
        "heights",
        "height",
        "linear",
        [
            ("bed_top", "top of the bed", BLUE),
            ("centre_height", "centre of mass", BLACK),
            ("bed_bottom", "bottom of the bed", RED),
        ],
    ),
    (
        "kinetic energy",
        "energy",
        "log",
        [
            ("kinetic_energy_of_mean_motion", "of the mean motion", BLUE),
            ("fluctuating_kinetic_energy", "of the fluctuations", ORANGE),
        ],
    ),
    ("contacts", "mean coordination number", "linear", [("coordination_number", "mean coordination number", BLACK)]),
    ("gas", "superficial velocity", "linear", [("superficial_velocity", "superficial velocity", BLUE)]),
    (
        "balance errors",
        "absolute error",
        "log",
        [
            ("momentum_error", "of momentum, over the weight", RED),
            ("mass_error", "of mass", BLUE),
        ],
    ),
]


def draw_panel(panel, series: Series, scale: str, lines: list[tuple[str, str, str]]) -> None:
    """Draws one panel over time; on a logarithmic scale it shows absolute values and no zeros."""
    drawn = 0
    for name, words, colour in lines:
        values = series[name]
        if scale == "log":
            values = np.where(np.abs(values) > 0.0, np.abs(values), np.nan)
        if np.isfinite(values).any():
            panel.plot(series.time, values, color=colour, label=words, linewidth=1.0)
            drawn += 1
    if drawn == 0:
        panel.text(0.5, 0.5, "zero throughout", transform=panel.transAxes, ha="center", color=GREY)
        return
    if scale == "log":
        panel.set_yscale("log")
    if len(lines) > 1:
        panel.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, frameon=False, borderpad=0.0)


def draw(series: Series):
    """All panels, two in a row, above one axis of time."""
    figure, panels = new_figure(3, 2, size=(13.0, 10.5))
    for panel, (title, words, scale, lines) in zip(panels.flat, PANELS):
        panel.set_title(title, loc="left", fontweight="bold")
        panel.set_ylabel(series.label(lines[0][0], words))
        draw_panel(panel, series, scale, lines)
        panel.set_xlim(series.time[0], max(series.time[-1], np.nextafter(series.time[0], np.inf)))
    for panel in panels[-1]:
        panel.set_xlabel(series.label("time"))
    return figure


def summary(series: Series) -> str:
    """A line of numbers: the range of times, and means of fluctuating columns."""
    means = [
        f"mean {words} {np.nanmean(series[name]):.4g}"
        for name, words in [
            ("grid_pressure_drop", "pressure drop over weight"),
            ("plate_stress", "plate stress over weight"),
            ("coordination_number", "coordination number"),
        ]
    ]
    departed = int(np.nan_to_num(series["departed"][-1]))
    return f"times {series.time[0]:g} to {series.time[-1]:g}: {', '.join(means)}, departed particles {departed}"


def main(command_line: list[str] | None = None) -> None:
    """Reads and draws."""
    arguments = argument_parser(__doc__, "series.png").parse_args(command_line)
    series = read_series(arguments.results).between(arguments.start, arguments.end)
    print(summary(series))
    save_figure(draw(series), picture_of(arguments, "series.png"))


if __name__ == "__main__":
    run_script(main)
