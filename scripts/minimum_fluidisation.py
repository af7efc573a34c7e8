"""Draws the pressure drop of a run whose superficial gas velocity rises (and falls again), with the measured U_mf.

`talcum analyse` splits the run into its ramps, fits Ergun's form to the packed bed and a plateau to the fluidised bed
(docs/analyse.md), and compares U_mf with the force balance by the case's drag law. If it can give no value, the figure is
still drawn, and gives the reason.
"""

from __future__ import annotations

import textwrap

# First, because it says what to do if numpy is missing.
from talcum_results import (
    BLUE,
    GREY,
    ORANGE,
    Analysis,
    Array,
    Series,
    analyse,
    argument_parser,
    new_figure,
    picture_of,
    read_series,
    run_script,
    save_figure,
)

import numpy as np

WAYS = {"up": (BLUE, "o"), "down": (ORANGE, "s")}


def report(found: Analysis, way: str) -> str:
    """The line of numbers of a ramp, or the reason why there are none."""
    if f"u_mf.{way}" not in found.values:
        return f"{way}: no value can be given: {found.reasons.get(f'u_mf.{way}', 'not analysed')}"
    named = {"plateau": "plateau", "overshoot": "overshoot", "solids_fraction": "phi", "balance": "force balance"}
    parts = [f"{shown} {found.text(f'u_mf.{way}_{name}')}" for name, shown in named.items()]
    ratio = f"ratio {found.text(f'u_mf.{way}_ratio')}"
    return f"{way}: U_mf {found.text(f'u_mf.{way}')}, {', '.join(parts)}, {ratio}"


def fitted(fit: dict[str, Array], highest: float) -> tuple[Array, Array]:
    """Velocities and pressure drops of the fitted form up to U_mf, and of the plateau beyond."""
    packed = np.linspace(0.0, fit["velocity"][0], 50)
    drops = fit["linear"][0] * packed + fit["quadratic"][0] * packed**2
    end = max(highest, fit["velocity"][0])
    return np.append(packed, end), np.append(drops, fit["plateau"][0])


def goes(velocity: Array, way: str, found: Analysis) -> bool:
    """Whether a missing value matters: it does not if the run only ramps the other way and has a value there."""
    steps = np.diff(velocity) * (1.0 if way == "up" else -1.0)
    return bool(np.any(steps > 0.0)) or "u_mf" not in found.values


def draw(series: Series, found: Analysis):
    """Pressure drop over superficial velocity, with the fits."""
    figure, panels = new_figure(size=(8.5, 5.5))
    panel = panels[0, 0]
    velocity = series["superficial_velocity"]
    if not any(f"u_mf/{way}" in found.tables for way in WAYS):
        panel.plot(velocity, series["grid_pressure_drop"], ".", color=GREY, markersize=3.5, label="all rows")
    for way, (colour, marker) in WAYS.items():
        points, fit = found.tables.get(f"u_mf/{way}"), found.tables.get(f"u_mf/fit_{way}")
        if points is None:
            continue
        value = f"U_mf {found.text(f'u_mf.{way}')}" if fit else "no value"
        style = {"linestyle": "", "marker": marker, "markersize": 3.5, "alpha": 0.6, "color": colour}
        panel.plot(points["superficial_velocity"], points["pressure_drop"], label=f"{way}: {value}", **style)
        if fit:
            panel.plot(*fitted(fit, points["superficial_velocity"].max()), color=colour, linewidth=1.6)
            panel.axvline(fit["velocity"][0], color=colour, linestyle=":", linewidth=1.2)
    missing = [report(found, way) for way in WAYS if f"u_mf.{way}" not in found.values and goes(velocity, way, found)]
    panel.set_title(textwrap.fill("; ".join(missing), 90), loc="left", fontsize=9)
    panel.axhline(1.0, color=GREY, linewidth=0.8)
    panel.set_xlim(left=0.0)
    panel.set_ylim(bottom=0.0)
    panel.set_xlabel(series.label("superficial_velocity", "superficial velocity $U_s$"))
    panel.set_ylabel("pressure drop over the bed's weight")
    panel.legend(loc="lower right")
    return figure


def main(command_line: list[str] | None = None) -> None:
    """Analyses the run with `talcum analyse`, prints and draws."""
    arguments = argument_parser(__doc__, "minimum_fluidisation.png").parse_args(command_line)
    found = analyse(arguments.results, ["u_mf"], arguments.start, arguments.end)
    for way in WAYS:
        print(report(found, way))
    series = read_series(arguments.results).between(arguments.start, arguments.end)
    save_figure(draw(series, found), picture_of(arguments, "minimum_fluidisation.png"))


if __name__ == "__main__":
    run_script(main)
