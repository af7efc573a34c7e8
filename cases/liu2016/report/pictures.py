"""Pictures of the beds of Liu et al. (2016): agglomerates coloured by their number, in the bed and taken out singly, one that is tagged, and the flow."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import fluidised_bed
from paper_report.page import picture
from talcum_results import Array, draw_spheres, new_figure, result_file, snapshot_rows, snapshot_times

import h5py
import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.collections import EllipseCollection
from matplotlib.figure import Figure
from PIL import Image

from . import curves
from .curves import FOLLOWED, PARTICLE, STUDIES, WHOLE_BOX, Run
from .tables import SHOWN

REFERENCE = 0.3
"""The first t_0 [s]."""
LAGS = (0.01, 0.03, 0.06, 0.1)
"""Lags at which agglomerates are shown [s]."""
SINGLE = (np.inf, 200.0, 60.0, 20.0)
"""Numbers of members of the agglomerates that are taken out: the largest, and those nearest to some others."""
GREY = (0.88, 0.88, 0.88)
COLOURS = np.array([colour for colour in colormaps["tab20"].colors if np.ptp(colour) > 0.01])
"""The colours of a map that are not greys."""


@dataclass
class Snapshot:
    """Places, numbers and agglomerates of the particles at a time; the agglomerate is negative for those in none."""

    time: float
    places: Array
    ids: Array
    agglomerates: Array

    def sizes(self) -> tuple[Array, Array]:
        """The agglomerates, and how many members each has."""
        return np.unique(self.agglomerates[self.agglomerates >= 0], return_counts=True)


def snapshots(run: Run) -> list[Snapshot]:
    """The snapshots at the lags that are shown, those that are there."""
    found = []
    with h5py.File(result_file(run.folder, "particles.vtkhdf")) as file:
        root = file["VTKHDF"]
        times, data = snapshot_times(root), root["PointData"]
        for lag in LAGS:
            step = int(np.argmin(np.abs(times - REFERENCE - lag)))
            if abs(times[step] - REFERENCE - lag) < 1e-6:
                rows = snapshot_rows(root, step)
                found.append(Snapshot(float(times[step]), root["Points"][rows], data["id"][rows], data["agglomerate"][rows]))
    return found


def shown_runs(results: Path, studies: tuple[str, ...] = STUDIES) -> Iterator[Run]:
    """The first run of each case that is shown, where it is here with its snapshots."""
    for case in SHOWN:
        for run in curves.runs_of(results, studies):
            if run.case == case and run.seed == 1 and curves.shows_agglomerates(run):
                yield run
                break


def colours_of(agglomerates: Array) -> Array:
    """A colour for each particle: neighbouring numbers have colours far apart, and what is in none is grey."""
    return np.where(agglomerates[:, None] < 0, GREY, COLOURS[agglomerates * 7 % len(COLOURS)])


def draw_coloured(panel: Axes, places: Array, agglomerates: Array) -> None:
    """Spheres from the side, darker the farther they are behind; agglomerates are not hidden by what is in none."""
    order = np.lexsort((-places[:, 1], agglomerates >= 0))
    colours = colours_of(agglomerates)
    depth = places[order, 1] - places[:, 1].min()
    shade = 1.0 - 0.45 * depth / max(depth.max(initial=0.0), PARTICLE)
    diameters = np.full(len(order), PARTICLE)
    spheres = EllipseCollection(diameters, diameters, np.zeros(len(order)), units="xy", offsets=places[order][:, [0, 2]],
                                offset_transform=panel.transData, facecolors=colours[order] * shade[:, None],
                                edgecolors="black", linewidths=0.15)  # fmt: skip
    panel.add_collection(spheres)
    panel.grid(False)
    panel.set_aspect("equal")
    panel.set_xticks([])
    panel.set_yticks([])


def draw_beds(shown: list[tuple[str, Snapshot]], width: float = 2.0e-3) -> Figure:
    """Beds side by side, their particles coloured by agglomerate."""
    top = max(float(np.percentile(snapshot.places[:, 2], 99.5)) for _, snapshot in shown) + PARTICLE
    figure, panels = new_figure(1, len(shown), size=(2.9 * len(shown), 0.5 + 2.7 * top / width))
    for panel, (title, snapshot) in zip(panels[0], shown):
        draw_coloured(panel, snapshot.places, snapshot.agglomerates)
        panel.set(xlim=(0.0, width), ylim=(0.0, top))
        panel.set_title(title, fontsize=9)
    return figure


def cases(results: Path) -> Figure | None:
    """The cases of Fig. 3 at the first lag."""
    found = [(run.case, snapshots(run)) for run in shown_runs(results)]
    known = [(f"{case}, {shots[0].time:.2f} s", shots[0]) for case, shots in found if shots]
    return draw_beds(known) if len(known) == len(SHOWN) else None


def lags(results: Path, studies: tuple[str, ...] = STUDIES, width: float = 2.0e-3) -> Figure | None:
    """Fig. 1: the agglomerates of one t_0 that are left at later times, in a box of some width."""
    for run in shown_runs(results, studies):
        if run.case == FOLLOWED:
            return draw_beds([(f"{1e3 * (shot.time - REFERENCE):.0f} ms", shot) for shot in snapshots(run)], width)
    return None


def singly(results: Path) -> Figure | None:
    """Agglomerates of each case that has some, taken out of the bed at the first lag."""
    shots = [(run, found[0]) for run in shown_runs(results) if (found := snapshots(run))]
    runs = [(run, shot) for run, shot in shots if len(shot.sizes()[0])]
    if len(shots) < len(SHOWN) or not runs:
        return None
    figure, panels = new_figure(len(runs), len(SINGLE), size=(3.0 * len(SINGLE), 3.1 * len(runs)))
    for row, (run, shot) in zip(panels, runs):
        names, counts = shot.sizes()
        properties = run.rows("agglomerates", "agglomerates")
        for panel, size in zip(row, SINGLE):
            chosen = np.argmax(counts) if np.isinf(size) else np.argmin(np.abs(counts - size))
            draw_single(panel, shot, int(names[chosen]))
            panel.set_title(told(properties, shot.time, int(names[chosen])), fontsize=8)
        row[0].set_ylabel(run.case)
    return figure


def draw_single(panel: Axes, shot: Snapshot, name: int) -> None:
    """One agglomerate, with a bar of five diameters of its members."""
    members = shot.agglomerates == name
    places = shot.places[members]
    draw_coloured(panel, places, shot.agglomerates[members])
    middle = 0.5 * (places.max(axis=0) + places.min(axis=0))
    half = 0.55 * float(np.ptp(places, axis=0)[[0, 2]].max()) + PARTICLE
    panel.set(xlim=(middle[0] - half, middle[0] + half), ylim=(middle[2] - half, middle[2] + half))
    begin, height = middle[0] - 0.95 * half, middle[2] - 0.95 * half
    panel.plot([begin, begin + 5.0 * PARTICLE], [height, height], color="black", linewidth=2.0)


def told(properties: dict[str, Array], time: float, name: int) -> str:
    """The measured properties of an agglomerate, as text."""
    row = int(np.flatnonzero((np.abs(properties["time"] - time) < 1e-6) & (properties["label"] == name))[0])
    found = {key: float(properties[key][row]) for key in ("members", "diameter", "coordination_number", "packing_fraction", "fractal_dimension")}
    return (
        f"{found['members']:.0f} members, d_agg {1e3 * found['diameter']:.2f} mm\n"
        f"C_N {found['coordination_number']:.1f}, p {found['packing_fraction']:.2f}, D_f {found['fractal_dimension']:.2f}"
    )


def tagged(results: Path) -> Figure | None:
    """Fig. 7: the particles of the largest agglomerate of the first lag, tagged, later on; a fifth of the other particles."""
    complete = [(run.case, shots) for run in shown_runs(results) if len(shots := snapshots(run)) == len(LAGS)]
    runs = [(case, shots) for case, shots in complete if len(shots[0].sizes()[0])]
    if len(complete) < len(SHOWN) or not runs:
        return None
    figure, panels = new_figure(len(runs), len(LAGS), size=(2.2 * len(LAGS), 5.2 * len(runs)))
    for row, (case, shots) in zip(panels, runs):
        names, counts = shots[0].sizes()
        members = shots[0].ids[shots[0].agglomerates == names[np.argmax(counts)]]
        for panel, shot in zip(row, shots):
            mark = np.isin(shot.ids, members)
            for rows, value in ((np.flatnonzero(~mark)[::5], np.nan), (np.flatnonzero(mark), 0.0)):
                draw_spheres(panel, shot.places[rows][:, [0, 2]], np.full(len(rows), PARTICLE), np.full(len(rows), value))
            panel.set(xlim=(0.0, 2.0e-3), ylim=(0.0, 5.0e-3), aspect="equal", title=f"{shot.time:.2f} s")
            panel.set_xticks([])
            panel.set_yticks([])
            panel.grid(False)
        row[0].set_ylabel(case)
    return figure


def flow(results: Path, case: str) -> Figure | None:
    """Particles and gas of a case at the end of its first run."""
    for run in shown_runs(results):
        if run.case == case and (run.folder / "gas.vtkhdf").exists():
            return fluidised_bed.draw(fluidised_bed.read_bed(run.folder, None))
    return None


PICTURES: dict[str, Callable[[Path], Figure | None]] = {"cases": cases, "lags": lags, "box": partial(lags, studies=WHOLE_BOX, width=4.0e-3), "singly": singly, "tagged": tagged} | {
    f"flow-{case}": lambda results, case=case: flow(results, case) for case in SHOWN
}
"""The figures by the names of the kept files."""


def pictured(results: Path, name: str) -> Figure | None:
    """A picture of the runs made here, else the one that is kept; None if there is neither."""
    drawn, kept = PICTURES[name](results), curves.KEPT / f"{name}.png"
    return drawn or (picture(kept) if kept.exists() else None)


def keep(results: Path, folder: Path) -> None:
    """Stores all pictures whose runs are here."""
    for name, draw in PICTURES.items():
        drawn = draw(results)
        if drawn is not None:
            save(drawn, folder / f"{name}.png")


def save(drawn: Figure, file: Path) -> None:
    """Stores a picture with 128 colours, which takes a quarter of the room; those of few pixels are kept."""
    image = io.BytesIO()
    drawn.savefig(image, format="png", dpi=80, bbox_inches="tight")
    colours = Image.open(image).convert("RGB").quantize(128, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    colours.save(file, optimize=True)
    print(f"figure: {file}")
