"""Draws the force of a contact over its overlap, from tables that `talcum contact CASE.toml` prints.

    talcum contact CASE.toml > loop.csv
    .venv/bin/python scripts/contact_loop.py loop.csv

The arrows of the loop show a contact that is pressed to half the largest overlap, separated to a twentieth of it, pressed to
the largest overlap, and separated. For each table the script prints a line of numbers: the largest force, the largest pull,
and the energy that the loop encloses, also divided by the work of pressing if this is positive.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

# First, because it says what to do if numpy is missing.
from talcum_results import (
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    RED,
    Array,
    ResultsError,
    Series,
    new_figure,
    read_series,
    run_script,
    save_figure,
)

import numpy as np

COLOURS = [BLUE, ORANGE, GREEN, RED]


@dataclass
class Loop:
    """A force over an overlap, in the order in which the contact went through it."""

    name: str
    title: str
    table: Series

    @property
    def overlap(self) -> Array:
        """Overlaps; negative: separations."""
        return self.table["overlap"]

    @property
    def force(self) -> Array:
        """Forces; positive: pushing apart."""
        return self.table["force"]

    def work(self) -> Array:
        """Work done on the contact between each point and the next."""
        return 0.5 * (self.force[1:] + self.force[:-1]) * np.diff(self.overlap)


def read_loop(path: Path) -> Loop:
    """Reads a table of `talcum contact`."""
    if not path.is_file():
        raise ResultsError(f"{path}: there is no such file; make it with: talcum contact CASE.toml > {path}")
    table = read_series(path)
    absent = [name for name in ["overlap", "force", "part"] if name not in table.columns]
    if absent:
        raise ResultsError(f"{path}: has no column {', '.join(absent)}; is it a table of `talcum contact`?")
    titles = [line.removeprefix("title:").strip() for line in table.provenance if line.startswith("title:")]
    return Loop(path.stem, titles[0] if titles else path.stem, table)


def describe(loop: Loop) -> str:
    """The line of numbers of a loop."""
    force, length = loop.table.units.get("force", ""), loop.table.units.get("overlap", "")
    work = loop.work()
    pressed = work[np.diff(loop.overlap) > 0.0].sum()
    share = f", {work.sum() / pressed:.4f} of the work of pressing" if pressed > 0.0 else ""
    return (
        f"{loop.name}: largest force {loop.force.max():.4g} {force}, largest pull {max(0.0, -loop.force.min()):.4g} "
        f"{force}, energy lost {work.sum():.4g} {force} x {length}{share}"
    )


def draw_loop(panel, loop: Loop, colour: str, label: str | None) -> None:
    """One loop, with an arrow in the middle of each of its parts."""
    panel.plot(loop.overlap, loop.force, color=colour, label=label)
    for part in np.unique(loop.table["part"]):
        rows = np.flatnonzero(loop.table["part"] == part)
        middle = rows[len(rows) // 2]
        if middle + 1 < len(loop.force):
            ends = [(loop.overlap[row], loop.force[row]) for row in (middle, middle + 1)]
            arrow = {"arrowstyle": "-|>", "color": colour, "mutation_scale": 16}
            panel.annotate("", xy=ends[1], xytext=ends[0], arrowprops=arrow)


def draw(loops: list[Loop], picture: Path) -> None:
    """All loops in one figure."""
    figure, panels = new_figure(size=(8.0, 5.5))
    panel = panels[0, 0]
    panel.axhline(0.0, color=GREY, linewidth=0.8)
    panel.axvline(0.0, color=GREY, linewidth=0.8)
    for index, loop in enumerate(loops):
        label = loop.name if len(loops) > 1 else None
        draw_loop(panel, loop, COLOURS[index % len(COLOURS)], label)
    panel.set_xlabel(loops[0].table.label("overlap"))
    panel.set_ylabel(loops[0].table.label("force", "normal force"))
    if len(loops) > 1:
        panel.legend()
    else:
        panel.set_title(loops[0].title, loc="left")
    save_figure(figure, picture)


def require_same_units(loops: list[Loop]) -> None:
    """Tables of different units cannot share axes."""
    for loop in loops[1:]:
        if loop.table.units != loops[0].table.units:
            raise ResultsError(f"{loop.name}: its units are not those of {loops[0].name}")


def main(command_line: list[str] | None = None) -> None:
    """Reads, measures, draws."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tables", type=Path, nargs="+", help="tables of `talcum contact`")
    parser.add_argument("--output", type=Path, metavar="FILE", help="the figure (default: in the folder of the first table)")
    arguments = parser.parse_args(command_line)
    loops = [read_loop(path) for path in arguments.tables]
    require_same_units(loops)
    for loop in loops:
        print(describe(loop))
    draw(loops, arguments.output or arguments.tables[0].with_suffix(".png"))


if __name__ == "__main__":
    run_script(main)
