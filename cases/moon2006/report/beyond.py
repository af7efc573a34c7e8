"""Extensions that Moon, Kevrekidis & Sundaresan (2006) propose: a distributor and a compressible gas; wide.py has three dimensions."""

from __future__ import annotations

from pathlib import Path

from paper_report.page import Section, Statement
from paper_report.tables import over, within
from study_tables import StudyTable
from talcum_results import BLUE, GREY, ORANGE, RED, Array, new_figure

import numpy as np
from matplotlib.figure import Figure

from .tables import source, table

GAMMA = 0.1
SUSPENSION = (0.393, 30.8, 7.0)
"""Numbers of the study `compressible`: the plate's acceleration, and the initial solids fraction, height and Stokes number of the bed."""


def distributor(results: Path) -> Section | None:
    """A plenum and a distributor below the shaken bed."""
    points = table(results, "distributor", "points")
    if points is None:
        return None
    resistances = sorted(set(points.numbers("linear_resistance")))
    groups = [(f"resistance {resistance:g}", points.where(linear_resistance=resistance)) for resistance in resistances]
    flow = {name: group.estimates("flow_swing") for name, group in groups}
    text = "; ".join(f"{name}: " + ", ".join(f"{e.mean:.2g}" for e in found) for name, found in flow.items())
    heights = ", ".join(f"{height:g}" for height in groups[0][1].numbers("height"))
    # Without a distributor the bed on a high plenum is thrown about, and its cycles differ.
    steady = [group for resistance, (_, group) in zip(resistances, groups) if resistance > 0.0]
    sums = [a.mean + b.mean for group in steady
            for a, b in zip(group.estimates("plate_stress"), group.estimates("gas_force"))]  # fmt: skip
    statements = [
        Statement(f"swing of U_s over the cycle, plenums {heights} d high", "0: U_s is taken as constant", text, None),
        Statement("mean plate stress + gas force with a distributor", "1, by eq. (17)", f"{min(sums):.4f} to {max(sums):.4f}",
                  all(within(total, 1.0, 0.01) for total in sums)),
    ]  # fmt: skip
    quantities = {"flow_swing": "swing of U_s [sqrt(g d)]", "flow": "mean U_s [sqrt(g d)]", "peak": "peak of plate stress / weight"}
    figure = over(points, "height", quantities, groups)
    for panel in figure.axes:
        panel.set_xscale("log")
        panel.set_yscale("log", nonpositive="clip")
        means = [y for line in panel.lines for y in np.asarray(line.get_ydata(), float) if y > 0.0]
        panel.set_ylim(0.5 * min(means), 2.0 * max(means))
        panel.set_xlabel("height of the plenum [d]")
    introduction = (
        "The paper takes U_s as constant in the frame of the plate and proposes a distributor of finite resistance. Here gas flows "
        "at 0.016 into a plenum at atmospheric pressure (2.3e5 in these units) below the bed of Figs 6 to 9, and through a "
        "distributor of linear resistance; that of the bed is about 1,800. U_s follows the cycle if the plenum is high and the "
        "distributor weak."
    )
    caption = "Over the height of the plenum, for three resistances; means and intervals over seeds."
    return Section("Beyond the paper: a distributor and a plenum", introduction, statements, [(figure, caption)],
                   [source("distributor", points)])  # fmt: skip


def response(frequency: Array, pressure: float, phi: float, height: float, stokes: float) -> Array:
    """Amplitude of the pressure below a bed that hangs in a compressible gas, over that of its weight on the shaken plate.

    tanh(kH) / (kH) / (1 + i w tau), (kH)^2 = -(w H / c)^2 / (1 + i w tau), c^2 = P / (phi (1 - phi)), tau = (St / 18) (1 - phi)^4.65
    the time in which the particles follow the gas (rho_s = d = g = 1); for P -> infinity 1 / (1 + i w tau).
    """
    omega = 2.0 * np.pi * frequency
    drag = 1.0 + 1j * omega * stokes / 18.0 * (1.0 - phi) ** 4.65
    wave = np.sqrt(-((omega * height) ** 2) * phi * (1.0 - phi) / pressure / drag)
    return np.abs(np.tanh(wave) / wave / drag)


def amplitudes(group: StudyTable) -> Array:
    """Amplitude of the pressure below the bed over that of its weight, from the deviation of a sine."""
    return np.sqrt(2.0) * np.array([e.mean for e in group.estimates("deviation")]) / GAMMA


def resonance_figure(points: StudyTable, bed: tuple[float, float, float]) -> Figure:
    """Amplitude of the gas force over the frequency, for each pressure; lines: linear theory."""
    phi, height, stokes = bed
    figure, panels = new_figure(size=(7.5, 4.4))
    panel = panels[0, 0]
    for pressure, colour in zip(sorted(set(points.numbers("pressure"))), (BLUE, ORANGE, RED, GREY)):
        group = points.where(pressure=pressure)
        frequency, found = np.array(group.numbers("frequency")), amplitudes(group)
        name = f"P = {pressure:g}" if pressure < 1.0e8 else "P = 1e9: incompressible"
        panel.plot(frequency, found, "o", color=colour, label=name)
        fine = np.geomspace(frequency[0], frequency[-1], 400)
        panel.plot(fine, response(fine, pressure, phi, height, stokes), "-", color=colour)
        sound = (pressure / (phi * (1.0 - phi))) ** 0.5
        if sound / (4.0 * height) < frequency[-1]:
            panel.axvline(sound / (4.0 * height), color=colour, linestyle=":")
    panel.set_xscale("log")
    panel.set_xticks([0.2, 0.5, 1.0, 2.0], ["0.2", "0.5", "1", "2"])
    panel.minorticks_off()
    panel.set_ylim(bottom=0.0)
    panel.set_xlabel("frequency of the plate [sqrt(g/d)]")
    panel.set_ylabel("pressure below the bed / (Gamma weight)")
    panel.legend()
    return figure


def compressible(results: Path) -> Section | None:
    """Resonance of a suspended bed with a compressible gas."""
    points = table(results, "compressible", "points")
    if points is None:
        return None
    phi, height, stokes = SUSPENSION
    statements = []
    for pressure in sorted(set(points.numbers("pressure"))):
        group = points.where(pressure=pressure)
        frequency = np.array(group.numbers("frequency"))
        found = amplitudes(group)
        expected = response(frequency, pressure, phi, height, stokes)
        resonance = (pressure / (phi * (1.0 - phi))) ** 0.5 / (4.0 * height)
        error = float(np.max(np.abs(found - expected)) / np.max(expected))
        peak = int(np.argmax(found))
        told = f"highest, {found[peak]:.2f}, at {frequency[peak]:g}; off linear theory by up to {100.0 * error:.1f} % of its peak"
        expectation = f"c / (4 H) = {resonance:.3g}"
        if resonance > frequency[-1]:
            told, expectation = f"off linear theory by up to {100.0 * error:.1f} %", "incompressible limit, no resonance"
        statements.append(Statement(f"pressure below the bed, P = {pressure:g}", f"linear theory in place of the paper: {expectation}; agrees within 10 % of its peak", told, error < 0.1))
    introduction = (
        "The paper proposes a compressible gas, for the resonance of vibrated beds. Here 448 particles (phi 0.393, 30.8 d "
        "high, St 7) hang in the gas that carries them, above a plate that is shaken with Gamma 0.1. Without contacts the bed is a "
        "fluid with the speed of sound c = sqrt(P / (rho_s phi (1 - phi))), and resonates when a quarter of a wave is in it."
    )
    caption = "Points: runs. Lines: linear theory with the drag of the bed. Dotted: c / (4 H)."
    return Section("Beyond the paper: a compressible gas", introduction, statements,
                   [(resonance_figure(points, SUSPENSION), caption)], [source("compressible", points)])  # fmt: skip
