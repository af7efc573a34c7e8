"""The periodic boxes of Moon, Kevrekidis & Sundaresan (2006): Figs 10 and 11."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from paper_report.page import Section, Statement
from paper_report.tables import over
from study_tables import StudyTable, table_of_rows
from talcum_results import BLUE, GREY, ORANGE, RED, Array, new_figure

import h5py
import numpy as np
from matplotlib.figure import Figure

from .tables import made_or_kept, source, table

PAPER_STRENGTH, PAPER_RUMPF = 0.8, 6.0
KEPT = "wave-profiles.csv"
PROFILES = {"solids_fraction": "1", "temperature": "g d", "pressure": "rho_s g d", "vertical": "rho_s g d"}
"""Columns of the kept profiles, the last the vertical normal stress, and their units."""


def figure_10(results: Path) -> Section | None:
    """Cohesive particles rain down as strings and agglomerates."""
    points = table(results, "fig10", "points")
    if points is None:
        return None
    statements = []
    found = {float(row["bond_number"]): points.estimate(row, "in_sets") for row in points.rows}
    text = "; ".join(f"Bo {bond:g}: {estimate}" for bond, estimate in found.items())
    most = found.get(4.0)
    agrees = None if most is None or 0.0 not in found else most.lower > found[0.0].upper and most.mean > 2.0 * found[0.0].mean
    statements.append(Statement("part of the particles in pairs, strings and agglomerates",
                                "strings and agglomerates at Bo 4, single particles at Bo 0: agrees if Bo 4 has more than twice as many", text, agrees))  # fmt: skip
    contacts = "; ".join(f"Bo {float(row['bond_number']):g}: {points.estimate(row, 'contacts')}" for row in points.rows)
    statements.append(Statement("contacts per particle", "not given", contacts, None))
    members = "; ".join(f"Bo {float(row['bond_number']):g}: {points.estimate(row, 'members')}" for row in points.rows)
    statements.append(Statement("mean number of members of such a set", "not given", members, None))
    quantities = {"in_sets": "part of the particles in sets", "members": "members of a set", "largest": "members of the largest"}
    figure = over(points, "bond_number", quantities, [("periodic box", points)])
    for panel in figure.axes:
        panel.set_yscale("log")
        panel.relim()
        panel.autoscale(axis="y")
    figures = [(figure, "Against the Bond number; means and intervals over seeds.")]
    text = (
        "A periodic box of 1,375 particles whose weight the gas carries; cohesion is switched on after 20 time units. From 20 time units "
        "later on: sets of two particles or more connected by contacts lasting at least 0.05 time units, 14 times as long as a collision."
    )
    return Section("Fig. 10: strings and agglomerates", text, statements, figures, [source("fig10", points)])


@dataclass
class WaveProfiles:
    """Means over seeds and rows in the frame of the wave, by phase of the cycle and height above the middle of the void."""

    phase: Array
    height: Array
    solids_fraction: Array
    temperature: Array
    pressure: Array
    vertical: Array

    def tension(self) -> tuple[float, float, float]:
        """The largest tension, its phase, and its height above the middle of the void."""
        phase, layer = np.unravel_index(np.argmin(self.vertical), self.vertical.shape)
        return -float(self.vertical[phase, layer]), float(self.phase[phase]), float(self.height[layer])


def centred(values: Array, shift: int) -> Array:
    """Layers moved up by a number of layers, around the periodic box."""
    return np.roll(values, shift, axis=-1)


def read_wave_profiles(files: list[Path]) -> WaveProfiles | None:
    """The profiles of some runs, each of whose rows is moved so that its void, averaged over the cycle, lies in the middle."""
    stacks: dict[str, list[Array]] = {"solids_fraction": [], "granular_temperature": [], "pressure": [], "vertical": []}
    phase = height = np.zeros(0)
    for file in files:
        with h5py.File(file) as measured:
            phase, height = measured["phase"][:], measured["height"][:]
            rows = measured["results"]
            stress = rows["kinetic"][:] + rows["contact"][:] + rows["cohesive"][:]
            fields = {"pressure": np.trace(stress, axis1=-2, axis2=-1) / 3.0, "vertical": stress[..., 2, 2]}
            fields |= {name: rows[name][:] for name in ("solids_fraction", "granular_temperature")}
        angle = 2.0 * np.pi * height / (height[-1] + height[0])
        for row, fraction in enumerate(fields["solids_fraction"]):
            mode = np.sum(-fraction.mean(axis=0) * np.exp(1j * angle))
            layer = round(np.angle(mode) / (2.0 * np.pi) * len(height) - 0.5)
            for name, values in fields.items():
                stacks[name].append(centred(values[row], len(height) // 2 - layer))
    if not stacks["vertical"]:
        return None
    mean = {name: np.mean(rows, axis=0) for name, rows in stacks.items()}
    above = height - height[len(height) // 2]
    return WaveProfiles(phase, above, mean["solids_fraction"], mean["granular_temperature"], mean["pressure"], mean["vertical"])


def drawn(profiles: WaveProfiles) -> Figure:
    """Solids fraction, temperature and pressure over height at five phases of the cycle."""
    shown = range(0, len(profiles.phase), max(len(profiles.phase) // 5, 1))
    figure, panels = new_figure(1, len(shown), size=(2.4 * len(shown), 4.6))
    lines = (
        (profiles.solids_fraction, BLUE, r"solids fraction $\phi$"),
        (profiles.temperature, ORANGE, r"granular temperature $T$ [$g d$]"),
        (profiles.pressure, RED, r"solids pressure $p$ [$\rho_s g d$]"),
    )
    for panel, phase in zip(panels[0], shown):
        for values, colour, words in lines:
            panel.plot(values[phase], profiles.height, color=colour, label=words)
        panel.set_title(rf"$f t$ = {profiles.phase[phase]:.2f}")
        panel.set(xlim=(-0.8, 3.2), ylim=(profiles.height[0], profiles.height[-1]), xlabel=r"$\phi$, $T$, $p$")
        panel.axvline(0.0, color=GREY, linewidth=0.8)
        if panel is not panels[0, 0]:
            panel.tick_params(labelleft=False)
    panels[0, 0].set_ylabel("height above the middle of the void [$d$]")
    figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=3, frameon=False)
    return figure


def wave_profiles(results: Path) -> WaveProfiles | None:
    """The profiles of Fig. 11 of the runs that are here, else the kept ones; None if there are neither."""
    found = made_or_kept(made(results), KEPT)
    return profiles_of(found) if found else None


def made(results: Path) -> StudyTable | None:
    """A table of the profiles of the runs that are here."""
    profiles = read_wave_profiles(sorted((results / "fig11/runs").glob("*/measure-profile.h5")))
    runs = table(results, "fig11", "runs")
    if profiles is None or runs is None:
        return None
    rows = [
        {"phase": f"{phase:.4g}", "height [d]": f"{height:.6g}"}
        | {f"{name} [{unit}]": f"{getattr(profiles, name)[at, layer]:.6g}" for name, unit in PROFILES.items()}
        for at, phase in enumerate(profiles.phase)
        for layer, height in enumerate(profiles.height)
    ]
    provenance = {"title": "Fig. 11: means over cycles and seeds in the frame of the wave, by height above the middle of the void"}
    provenance |= {"commit": runs.provenance.get("commit", "unknown")} | {row["run"]: f"digest {row['digest']}" for row in runs.rows}
    return table_of_rows(results / KEPT, provenance, rows)


def profiles_of(found: StudyTable) -> WaveProfiles:
    """The profiles of a table."""
    phase, height = (np.unique(found.numbers(name)) for name in ("phase", "height"))
    return WaveProfiles(phase, height, *(np.array(found.numbers(name)).reshape(len(phase), len(height)) for name in PROFILES))


def figure_11(results: Path) -> Section | None:
    """Stress and granular temperature in the frame of the wave."""
    points = table(results, "fig11", "points")
    if points is None:
        return None
    row = points.rows[0]
    strength, rumpf = points.estimate(row, "strength"), points.estimate(row, "rumpf")
    within_two = 0.5 * PAPER_STRENGTH <= strength.mean <= 2.0 * PAPER_STRENGTH
    ratio = rumpf.mean / strength.mean
    statements = [
        Statement("largest tension of the bed", "about 0.8: agrees within a factor of 2", str(strength), within_two),
        Statement("Rumpf's estimate", "about 6, an order of magnitude more: agrees above 5 times", f"{rumpf}: {ratio:.1f} times as much", ratio > 5.0),
    ]
    profiles = wave_profiles(results)
    if profiles is not None:
        tension, phase, height = profiles.tension()
        told = f"{tension:.3g} at phase {phase:.2f}, {height:.1f} d above the middle of the void"
        # g_eff = 1 + Gamma sin(2 pi phase) is largest at 0.25.
        statements.append(Statement("when and where", "in the upper plug, near the maximum of g_eff (phase 0.25)", told,
                                    abs(phase - 0.25) <= 0.1 and height > 0.0))  # fmt: skip
    caption = "Profiles in the frame of the wave, with the void in the middle; means over cycles and seeds."
    figures = [(drawn(profiles), caption)] if profiles else []
    text = (
        "The periodic box at Bo 20, vibrated with Gamma 3 and f 0.16: one wave of 18 d. Profiles move with the wave, and are "
        "averaged over ten cycles at each of ten phases; the tension is the largest over all phases and layers of these means."
    )
    return Section("Fig. 11: stress in the frame of the wave", text, statements, figures, [source("fig11", points)])
