"""Beds without cohesion of Moon, Kevrekidis & Sundaresan (2006): minimum fluidisation (III A), and the waves of Fig. 1."""

from __future__ import annotations

import math
from pathlib import Path

from paper_report.page import Section, Statement
from paper_report.tables import student, within

import numpy as np

from .pictures import beds
from .tables import source, sources, table

PAPER_U_MF, PAPER_PACKING = 0.022, 0.652
GAS = 0.12
"""Gas velocity of the developed bed; the study `fig1` has the other two velocities of Fig. 1."""


def minimum_fluidisation(results: Path) -> Section | None:
    """U_mf of beds that are packed differently: poured, and compacted by shaking."""
    poured, shaken = table(results, "u-mf", "points"), table(results, "u-mf-compact", "points")
    rows = [(points, row, f"poured with friction {float(row['friction']):g}") for points in (poured,) if points for row in points.rows]
    rows += [(points, row, f"shaken for {float(row['duration']):g}") for points in (shaken,) if points for row in points.rows]
    if not rows:
        return None
    statements = []
    for points, row, how in rows:
        velocity, packing, ratio = (points.estimate(row, name) for name in ("u_mf", "solids_fraction", "ratio"))
        told = f"{ratio}, with U_mf {velocity.mean:.4f} at phi {packing.mean:.4f}"
        statements.append(Statement(f"U_mf over that of the force balance, {how}", "0.97: measured 0.022 for 0.023; asked here: within 3 % of 1", told,
                                    within(ratio.mean, 1.0, 0.03)))  # fmt: skip
    beds = table(results, "u-mf-compact", "runs")
    if beds is not None:
        statements.append(at_the_papers_packing(beds.numbers("solids_fraction"), beds.numbers("u_mf")))
    text = (
        "U_s is raised slowly from 0 through beds that were poured without gas, and through beds that were then compacted by "
        "shaking them hard. U_mf lies where the line of the packed bed meets the plateau; the force balance is "
        "(St / 18) (1 - phi)^4.65, with phi of the bulk of that bed."
    )
    return Section("III A: minimum fluidisation", text, statements, [], sources(("u-mf", poured), ("u-mf-compact", shaken)))


def at_the_papers_packing(packings: list[float], velocities: list[float]) -> Statement:
    """U_mf at the paper's packing by a line through shaken beds on both sides of it, with its interval of 95 %."""
    quantity = f"U_mf at phi {PAPER_PACKING}"
    away = np.array(packings) - PAPER_PACKING
    if len(away) < 3 or not away.min() < 0.0 < away.max():
        return Statement(quantity, f"{PAPER_U_MF}", "no beds on both sides of it", None)
    terms = np.stack([np.ones_like(away), away], axis=1)
    line, squares, *_ = np.linalg.lstsq(terms, np.array(velocities), rcond=None)
    half = student(len(away) - 2) * math.sqrt(squares[0] / (len(away) - 2) * np.linalg.inv(terms.T @ terms)[0, 0])
    there = float(line[0])
    told = f"{there:.4f} ({there - half:.4f} to {there + half:.4f}), by a line through {len(away)} shaken beds of phi {min(packings):.3f} to {max(packings):.3f}"
    return Statement(quantity, f"{PAPER_U_MF}", told, abs(there - PAPER_U_MF) <= half)


def lower_velocities(results: Path) -> Section | None:
    """Speed and amplitude of the waves over the gas velocity."""
    points, fast = (table(results, study, "points") for study in ("fig1", "developed-bed"))
    if points is None or not points.rows:
        return None
    found = [(float(row["superficial_velocity"]), points, row) for row in points.rows]
    if fast is not None and fast.rows:
        found.append((GAS, fast, fast.rows[0]))
    statements = []
    for velocity, read, row in found:
        values = [read.estimate(row, name) for name in ("speed", "amplitude", "wavelength")]
        told = f"{row['waves']}; speed {values[0]}, amplitude {values[1]}, wavelength {values[2]}".replace("_", " ")
        statements.append(Statement(f"waves at U_s {velocity:g}", "plugs and voids alternate and rise", told, None))
    for name in ("speed", "amplitude"):
        means = [read.estimate(row, name).mean for _, read, row in found]
        means = [mean for mean in means if mean == mean]
        grows = all(later > earlier for earlier, later in zip(means, means[1:])) if len(means) > 1 else None
        told = " to ".join(f"{mean:.3g}" for mean in means)
        statements.append(Statement(f"{name} over U_s", "grows with U_s", told, grows))
    text = "As above, with less gas and for 400 time units, because waves climb through the poured bed more slowly: measured from 325 on."
    return Section("Fig. 1: three gas velocities", text, statements, beds(results, "fig1"), [source("fig1", points)])


def other_sections(results: Path) -> Section | None:
    """Compares the waves in a deeper and in a wider bed."""
    points, fast = table(results, "fig1-sections", "points"), table(results, "developed-bed", "points")
    if points is None or fast is None or not points.rows:
        return None
    usual = fast.estimate(fast.rows[0], "speed")
    statements = [Statement("speed with 3,000 particles in 5 x 5 x 240 d", "not given in the text", str(usual), None)]
    for row in points.rows:
        speed = points.estimate(row, "speed")
        lengths = " x ".join(f"{float(length):g}" for length in row["lengths"].strip("[]").split(","))
        name = f"speed with {int(float(row['count'])):,} particles in {lengths} d"
        statements.append(Statement(name, "the same", f"{speed} ({row['waves'].replace('_', ' ')})", within(speed.mean, usual.mean, 0.05)))
    text = "Twice as deep, and four times as wide. Speeds within 5 % of each other are called the same."
    return Section("Fig. 1: other sections", text, statements, beds(results, "fig1-sections"), [source("fig1-sections", points)])


def choices(results: Path) -> Section | None:
    """Compares the waves with half of the time step, and with drag in all directions."""
    points, fast = table(results, "fig1-choices", "points"), table(results, "developed-bed", "points")
    if points is None or fast is None:
        return None
    usual, strength = (fast.estimate(fast.rows[0], name) for name in ("speed", "amplitude"))
    statements = [Statement("speed with a time step of 2.5e-4 and vertical drag", "not stated", f"{usual}; amplitude {strength}", None)]
    for row in points.rows:
        speed, amplitude = points.estimate(row, "speed"), points.estimate(row, "amplitude")
        drag = "drag in all directions" if row["lateral_drag"] == "true" else "vertical drag"
        told = f"{speed}, {speed.mean / usual.mean:.3f} times the first; amplitude {amplitude}, {amplitude.mean / strength.mean:.3f} times"
        statements.append(Statement(f"speed with a time step of {float(row['step']):g} and {drag}", "not stated", told, None))
    text = "Half of the time step, and drag that acts sideways too."
    return Section("Fig. 1: time step and lateral drag", text, statements, [], [source("fig1-choices", points)])
