"""The real powders that correspond to the Bond numbers of Moon, Kevrekidis & Sundaresan (2006), beyond the paper."""

from __future__ import annotations

from pathlib import Path

from paper_report.page import Section, Statement
from paper_report.tables import within

import numpy as np

from .pictures import beds
from .tables import source, table

HAMAKER, RADIUS, DENSITY, CUT_OFF, GRAVITY = 1.0e-19, 25.0e-6, 900.0, 4.0e-10, 9.81
"""Parameters of the case: Hamaker's constant [J], radius [m] and density [kg/m3] of a particle, distance of contact [m], gravity [m/s2]."""
VELOCITY = (GRAVITY * 2.0 * RADIUS) ** 0.5
"""The paper's unit of velocity [m/s]."""


def bond_number(asperity: float) -> float:
    """Attraction of two spheres in contact at an asperity of this radius [m] (docs/laws.md, `rough`), over the weight of one; 0 for smooth ones."""
    touching = asperity / (asperity + RADIUS) if asperity else 1.0
    spheres = (CUT_OFF / (CUT_OFF + asperity)) ** 2 if asperity else 0.0
    force = HAMAKER * RADIUS / (12.0 * CUT_OFF**2) * (touching + spheres)
    return force / (4.0 / 3.0 * np.pi * RADIUS**3 * DENSITY * GRAVITY)


def fine_powder(results: Path) -> Section | None:
    """The bed as a powder in SI units, with asperities of several sizes."""
    points, usual = table(results, "fine-powder", "points"), table(results, "developed-bed", "points")
    if points is None or usual is None:
        return None
    before, expected = points.estimate(points.rows[0], "speed_before"), VELOCITY * usual.estimate(usual.rows[0], "speed").mean
    told = f"{1e3 * before.mean:.2f} mm/s ({1e3 * before.lower:.2f} to {1e3 * before.upper:.2f})"
    statements = [
        Statement("Bond number of smooth spheres", "not given", f"{bond_number(0.0):,.0f}", None),
        Statement("speed of the waves before cohesion is switched on", f"that of Fig. 1 above is {1e3 * expected:.2f} mm/s: agrees within 2 %", told,
                  within(before.mean, expected, 0.02)),
    ]  # fmt: skip
    for row in points.rows:
        asperity = float(row["asperity_radius"])
        speed, share, still = (points.estimate(row, name) for name in ("speed", "share", "frozen_share"))
        told = f"{row['waves'].replace('_', ' ')}; part with waves {share}, still {still.mean:.2g}"
        if speed.runs:
            told += f"; speed {1e3 * speed.mean:.2f} mm/s"
        name = f"asperities of {1e9 * asperity:.3g} nm: Bo {bond_number(asperity):.3g}"
        statements.append(Statement(name, "waves up to 4, intermittent at 6, one plug above 7", told, None))
    text = (
        "The paper's bed in SI units: particles of 50 um and 900 kg/m3 with Hamaker's constant 1e-19 J, which touch at asperities. Measured from "
        "0.17 to 0.34 s after cohesion was switched on, 75 to 150 of the paper's time units. Beyond the asperities the spheres attract each other over some "
        "40 nm, so that parting them takes more work than at the same Bond number with the paper's force."
    )
    return Section("Beyond the paper: which powder a Bond number means", text, statements, beds(results, "fine-powder"), [source("fine-powder", points)])
