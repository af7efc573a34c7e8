"""Draws figures of the results of `[measure.NAME]`, `talcum analyse` and the ledger of energies; instruments_gallery.py makes the runs."""

from __future__ import annotations

from typing import Any

# First, because it says what to do if numpy is missing.
from talcum_results import BLACK, BLUE, GREEN, GREY, ORANGE, RED, Array, axis_label, draw_spheres, new_figure, read_series

import numpy as np
import talcum
from matplotlib.collections import EllipseCollection, LineCollection
from matplotlib.figure import Figure

STANDARD_ERRORS = 2.0
"""Half of the width of a band, in standard errors: an interval of about 95 %."""
WIDE = (10.0, 4.2)
HIGHEST_FREQUENCY = 40.0
LAST_CYCLES = 25.0
"""The time of five cycles of the plate."""
PARTS = (("kinetic", "kinetic", ORANGE), ("contact", "contacts", BLUE), ("cohesive", "cohesion", GREEN))


def band(panel: Any, places: Array, mean: Array, error: Array, colour: str, words: str, across: bool = False) -> None:
    """A line of means with a band of standard errors; `across` for means along the horizontal axis."""
    low, high = mean - STANDARD_ERRORS * error, mean + STANDARD_ERRORS * error
    fill, line = (panel.fill_betweenx, (mean, places)) if across else (panel.fill_between, (places, mean))
    fill(places, low, high, color=colour, alpha=0.25, linewidth=0.0)
    panel.plot(*line, color=colour, label=words)


UNITS = {"d sqrt(g d)": r"$d \sqrt{g d}$", "d": "$d$", "sqrt(d/g)": r"$\sqrt{d/g}$", "rho_s g d": r"$\rho_s g d$", "rho_s g d^4": r"$\rho_s g d^4$"}


def label(words: str, unit: str) -> str:
    """Words with a unit, whose symbols are set as in a formula."""
    return axis_label(words, UNITS.get(unit, unit))


def over_rows(values: Array) -> tuple[Array, Array]:
    """Mean over the rows, and its standard error from their spread."""
    rows = np.count_nonzero(np.isfinite(values), axis=0)
    return np.nanmean(values, axis=0), np.nanstd(values, axis=0, ddof=1) / np.sqrt(rows)


def closed(values: Array) -> Array:
    """Values over the phase with the first repeated at the end of the cycle."""
    return np.append(values, values[0])


def phase_average(bed: talcum.Bed) -> Figure:
    """Forces, and lift and centre of mass, over a cycle of the plate."""
    cycle = bed.instrument("cycle")
    rows = cycle["results"]
    phase = np.append(cycle.constants["phase"], 1.0)
    figure, panels = new_figure(1, 2, WIDE)
    forces, heights = panels[0]
    named = (("plate_stress", "stress on the plate", ORANGE), ("pressure_drop", "pressure drop", BLUE))
    for name, words, colour in named:
        band(forces, phase, closed(rows[name][-1]), closed(rows[f"{name}_error"][-1]), colour, words)
    forces.set_ylabel(r"over the bed's weight per area")
    centre = rows["centre_height"][-1]
    for name, mean, words, colour in (
        ("bed_bottom", rows["bed_bottom"][-1], "bottom of the bed", RED),
        ("centre_height", centre - centre.min(), "centre of mass above its lowest place", BLACK),
    ):
        band(heights, phase, closed(mean), closed(rows[f"{name}_error"][-1]), colour, words)
    heights.set_ylabel(label("height $z$ above the plate", rows.units["bed_bottom"]))
    for panel in panels[0]:
        panel.set(xlim=(0.0, 1.0), xlabel="phase $f t$ of the plate")
        panel.legend(frameon=False)
    return figure


def stress(bed: talcum.Bed) -> Figure:
    """The parts of sigma_zz over height, and the sum at phases of the cycle."""
    profile = bed.instrument("stress")
    rows, height, phase = profile["results"], profile.constants["height"], profile.constants["phase"]
    parts = {name: rows[name][..., 2, 2] for name, _, _ in PARTS}
    figure, panels = new_figure(1, 2, (10.0, 4.8))
    means, phases = panels[0]
    total = sum(parts.values())
    for name, words, colour in PARTS:
        band(means, height, *over_rows(parts[name].mean(axis=1)), colour, words, across=True)
    band(means, height, *over_rows(total.mean(axis=1)), BLACK, "sum", across=True)
    means.set_title("mean over the cycle", loc="left")
    for number, colour in zip(range(0, len(phase), len(phase) // 4), (BLUE, ORANGE, RED, BLACK)):
        band(phases, height, *over_rows(total[:, number]), colour, f"{phase[number]:.3g}", across=True)
    phases.set_title("sum at phases of the cycle", loc="left")
    phases.legend(title="phase $f t$", frameon=False)
    means.legend(frameon=False)
    filled = height[rows["solids_fraction"].mean(axis=(0, 1)) > 0.01]
    for panel in panels[0]:
        panel.set(ylim=(0.0, filled[-1]), xlabel=label(r"vertical stress $\sigma_{zz}$", rows.units["contact"]))
        panel.axvline(0.0, color=GREY, linewidth=0.8)
    means.set_ylabel(label("height $z$", profile.constants.units["height"]))
    return figure


def coordination(bed: talcum.Bed) -> Figure:
    """The coordination number over time, and its distribution."""
    rows = bed.instrument("coordination")["results"].between(bed.series["time"][-1] - LAST_CYCLES)
    figure, panels = new_figure(1, 2, WIDE)
    mean, shares = panels[0]
    value, looks = rows["coordination_number"], rows["coordination_deviation"]
    mean.fill_between(rows["time"], value - looks, value + looks, color=BLUE, alpha=0.25, linewidth=0.0)
    mean.plot(rows["time"], value, color=BLUE)
    mean.set(xlabel=label("time $t$", rows.units["time"]), ylabel="coordination number $C_N$")
    share, error = over_rows(rows["distribution"])
    number = np.arange(len(share))
    shares.bar(number, share, color=BLUE, alpha=0.6, yerr=STANDARD_ERRORS * error, ecolor=BLACK, capsize=3)
    shares.set(xlabel="number of neighbours that a particle touches", ylabel="part of the particles", xticks=number[::2])
    return figure


def contact_network(bed: talcum.Bed) -> Figure:
    """The contacts of a heap as lines, the wider and darker the larger their force."""
    contacts, particles = bed.contacts(), bed.particles()
    force = np.maximum(contacts["normal_force"], 0.0)
    typical = force.mean()
    order = np.argsort(force)
    lines = contacts["ends"][order][:, :, [0, 2]]
    figure, panels = new_figure(1, 1, (10.0, 4.0))
    panel = panels[0, 0]
    spheres = draw_spheres(panel, particles.position[:, [0, 2]], 2.0 * particles.radius, np.full(particles.rows, np.nan))
    spheres.set(alpha=0.25)
    strength = force[order] / typical
    drawn = LineCollection(lines, linewidths=0.25 + 0.5 * np.minimum(strength, 6.0), cmap="inferno_r", capstyle="round")
    drawn.set_array(strength)
    drawn.set_clim(0.0, np.percentile(strength, 99.5))
    panel.add_collection(drawn)
    unit = particles.units["position"]
    high = particles.position[:, 2].max()
    panel.set(xlim=side(particles), ylim=(0.0, 1.1 * high), aspect="equal", xlabel=label("$x$", unit), ylabel=label("$z$", unit))
    panel.grid(False)
    scale = rf"$F_n / \langle F_n \rangle$, $\langle F_n \rangle$ = {typical:.2g} {contacts.units['normal_force']}"
    figure.colorbar(drawn, ax=panel, label=scale, extend="max", shrink=0.75, pad=0.015)
    return figure


def side(particles: Any) -> tuple[float, float]:
    """The limits of x, from the leftmost to the rightmost particle."""
    x, margin = particles.position[:, 0], float(particles.radius.max())
    return float(x.min() - margin), float(x.max() + margin)


def stress_in_cells(bed: talcum.Bed) -> Figure:
    """Pressure on cells, and the direction of the largest principal stress."""
    fields = bed.fields("stress")
    tensor = sum(fields[name][:, 0] for name, _, _ in PARTS)
    pressure = np.trace(tensor, axis1=-2, axis2=-1) / 3.0
    principal, directions = np.linalg.eigh(0.5 * (tensor + np.swapaxes(tensor, -2, -1))[..., ::2, ::2])
    figure, panels = new_figure(1, 1, (10.0, 4.0))
    panel = panels[0, 0]
    filled = fields["solids_fraction"][:, 0] > 0.2
    shown = np.ma.masked_where(~filled, pressure)
    mesh = panel.pcolormesh(fields.x, fields.z, shown, cmap="YlGnBu", vmin=0.0, shading="nearest")
    rows, columns = np.nonzero(filled & (pressure > 0.05 * shown.max()))
    along = directions[rows, columns, :, 1]
    length = 0.8 * (fields.x[1] - fields.x[0]) * np.sqrt(principal[rows, columns, 1] / principal[..., 1].max())
    middle = np.column_stack([fields.x[columns], fields.z[rows]])
    ends = np.stack([middle - 0.5 * along * length[:, None], middle + 0.5 * along * length[:, None]], axis=1)
    panel.add_collection(LineCollection(ends, colors=RED, linewidths=1.4))
    unit = fields.units["x"]
    top = fields.z[np.nonzero(filled)[0].max()] + fields.z[0]
    panel.set(ylim=(0.0, 1.1 * top), aspect="equal", xlabel=label("$x$", unit), ylabel=label("$z$", unit))
    panel.grid(False)
    pressed = label(r"pressure $\mathrm{tr}\,\sigma / 3$", fields.units["contact"])
    figure.colorbar(mesh, ax=panel, label=pressed, shrink=0.75, pad=0.015)
    return figure


def agglomerates(bed: talcum.Bed) -> Figure:
    """Agglomerates over time, and the distribution of their sizes at its end."""
    found = bed.agglomerates()
    rows, limits = found["results"], found.constants["size_limits"]
    ends = rows["lag"] > 0.99 * rows["lag"].max()
    figure, panels = new_figure(1, 2, WIDE)
    over_time, sizes = panels[0]
    time = rows["time"][ends]
    over_time.plot(time, rows["members"][ends], color=ORANGE, label=r"members of an agglomerate, $\langle n \rangle$ by mass")
    over_time.plot(time, rows["agglomerates"][ends], color=BLUE, label=r"agglomerates, $N_\mathrm{agg}$")
    over_time.set(xlabel=label("time $t$", rows.units["time"]), ylabel="number", yscale="log", ylim=(0.8, 6e3))
    over_time.legend(frameon=False, loc="upper right")
    late = ends & (rows["time"] > 0.9 * rows["time"][-1])
    edges = np.column_stack([limits[:-1], np.sqrt(limits[:-1] * limits[1:]), limits[1:]])
    named = (("number_by_size", "of the agglomerates", BLUE), ("mass_by_size", "of their mass", ORANGE))
    for side_by_side, (name, words, colour) in enumerate(named):
        shares = rows[name][late] / rows[name][late].sum(axis=1)[:, None]
        used = shares.max(axis=0) > 0.0
        low, high = edges[used, side_by_side], edges[used, side_by_side + 1]
        sizes.bar(low, shares.mean(axis=0)[used], high - low, align="edge", color=colour, alpha=0.6, edgecolor="white", label=words)
        spread = shares.std(axis=0, ddof=1)[used]
        sizes.errorbar(np.sqrt(low * high), shares.mean(axis=0)[used], spread, color=BLACK, linestyle="", capsize=3)
    sizes.set(xscale="log", xlabel="members $n$", ylabel="part", ylim=(0.0, None))
    sizes.legend(frameon=False)
    return figure


def mixing(bed: talcum.Bed, bubbling: talcum.Bed) -> Figure:
    """Half of the mean square displacement over the lag with the fitted lines, and the Lacey index over time of another bed."""
    figure, panels = new_figure(1, 2, WIDE)
    displacements(panels[0, 0], bed.instrument("spread"))
    rows = bubbling.instrument("mixing")["results"]
    mixed = panels[0, 1]
    spread = STANDARD_ERRORS * rows["lacey_error"].mean()
    mixed.axhspan(1.0 - spread, 1.0 + spread, color=GREY, alpha=0.25, label="random mixture")
    mixed.plot(rows["time"], rows["lacey_index"], color=BLUE)
    mixed.set(xlabel=label("time $t$", rows.units["time"]), ylabel="Lacey index $M$", ylim=(0.0, 1.1))
    mixed.legend(frameon=False, loc="lower right")
    return figure


def displacements(panel: Any, found: talcum.Instrument) -> None:
    """S^2 along x and y with bands from the spread of the windows, and the lines whose slopes are D."""
    rows, fits = found["results"], found["dispersion"]
    lags = np.unique(np.round(rows["lag"], 9))
    fitted = lags >= fits["fit_from"][-1]
    unit = UNITS[fits.units["dispersion_x"]]
    for axis, colour in (("x", BLUE), ("y", ORANGE)):
        half = np.array([windows_at(rows, lag, 0.5 * rows[f"square_{axis}"]) for lag in lags])
        mean, error = over_rows(half.T)
        value, spread = fits[f"dispersion_{axis}"][-1], fits[f"dispersion_{axis}_error"][-1]
        band(panel, lags, mean, error, colour, rf"$D_{axis}$ = ({value:.3f} $\pm$ {spread:.3f}) {unit}")
        line = mean[fitted].mean() + value * (lags[fitted] - lags[fitted].mean())
        panel.plot(lags[fitted], line, "--", color=BLACK, linewidth=1.4)
    panel.set(xlabel=label(r"lag $\tau$", rows.units["time"]), ylabel=label(r"$S^2 = \langle (\Delta r)^2 \rangle / 2$", "$d^2$"))
    panel.set(xlim=(0.0, lags[-1]), ylim=(0.0, None))
    panel.legend(frameon=False, loc="upper left")


def windows_at(rows: Any, lag: float, values: Array) -> Array:
    """Values of all complete windows at one lag."""
    count = np.count_nonzero(np.isclose(rows["lag"], rows["lag"].max()))
    found = values[np.isclose(rows["lag"], lag)]
    return found[:count]


def time_average(bed: talcum.Bed) -> Figure:
    """Mean voidage, and mean velocity of the solids where there are some."""
    fields = bed.fields("average")
    voidage, solids = fields["voidage"][:, 0], fields["solids_velocity"][:, 0]
    figure, panels = new_figure(1, 2, WIDE)
    shown = (("mean voidage", voidage, "gray", (0.4, 1.0)), ("its standard deviation", fields["voidage_deviation"][:, 0], "viridis", (0.0, None)))
    dense = voidage < 0.97
    top = fields.z[np.nonzero(dense)[0].max()] * 1.1
    unit, speed = fields.units["x"], fields.units["solids_velocity"]
    for panel, (words, values, colours, limits) in zip(panels[0], shown):
        mesh = panel.pcolormesh(fields.x, fields.z, values, cmap=colours, vmin=limits[0], vmax=limits[1], shading="nearest")
        figure.colorbar(mesh, ax=panel, label=words, shrink=0.85, pad=0.02)
        panel.set(ylim=(0.0, top), aspect="equal", xlabel=label("$x$", unit))
        panel.grid(False)
    panels[0, 0].set_ylabel(label("$z$", unit))
    arrows = np.where(dense[..., None], solids, np.nan)[..., ::2]
    fastest = np.nanpercentile(np.linalg.norm(arrows, axis=-1), 99.0)
    scale = fastest / (1.8 * (fields.z[1] - fields.z[0]))
    panels[0, 0].quiver(fields.x, fields.z, arrows[..., 0], arrows[..., 1], color=RED, pivot="mid", angles="xy",
                        scale_units="xy", scale=scale, width=0.008)  # fmt: skip
    panels[0, 0].set_title(label(f"velocity of the solids, to {fastest:.2g}", speed), loc="left")
    return figure


def probe(bed: talcum.Bed) -> Figure:
    """Pressure and voidage at a point over time."""
    rows = bed.instrument("point")["results"].between(bed.series["time"][-1] - 2.0)
    figure, panels = new_figure(2, 1, (10.0, 4.6))
    pressure, voidage = panels[:, 0]
    pressure.plot(rows["time"], rows["pressure"], color=BLUE)
    pressure.set_ylabel(label("pressure $p$", rows.units["pressure"]))
    voidage.plot(rows["time"], rows["voidage"], color=BLACK)
    voidage.set(ylabel=r"voidage $\varepsilon$", xlabel=label("time $t$", rows.units["time"]))
    for panel in panels[:, 0]:
        panel.set_xlim(rows["time"][0], rows["time"][-1])
    return figure


def bubbles(bed: talcum.Bed) -> Figure:
    """The voidage with the bubbles that were found in it, and the heights of bubbles over time."""
    found = bed.analyse(["bubbles"], bed.series["time"][-1] - 1.5)
    seen = found.tables["bubbles/seen"]
    gas = bed.gas(seen["time"][fullest(seen)])
    figure, panels = new_figure(1, 2, WIDE)
    section, heights = panels[0]
    mesh = section.pcolormesh(gas.x, gas.z, gas["voidage"][:, 0], cmap="gray", vmin=0.3, vmax=1.0, shading="nearest")
    here = np.isclose(seen["time"], gas.time)
    rings = EllipseCollection(seen["diameter"][here], seen["diameter"][here], np.zeros(here.sum()), units="xy",
                              offsets=np.column_stack([seen["x"][here], seen["z"][here]]), offset_transform=section.transData,
                              facecolor="none", edgecolor=RED, linewidth=2.0)  # fmt: skip
    section.add_collection(rings)
    top = 1.3 * float(seen["z"].max())
    section.set(xlim=(0.0, gas.x[0] + gas.x[-1]), ylim=(0.0, top), aspect="equal")
    section.set(xlabel=label("$x$", gas.units["x"]), ylabel=label("$z$", gas.units["x"]))
    section.set_title(label(f"time {gas.time:.4g}", "s"), loc="left")
    section.grid(False)
    figure.colorbar(mesh, ax=section, label=r"voidage $\varepsilon$", shrink=0.75, pad=0.02)
    tracks = found.tables["bubbles/tracks"]
    for start, end, height, speed in zip(*(tracks[name] for name in ("first_time", "last_time", "height", "rise_velocity"))):
        times = np.array([start, end])
        heights.plot(times, height + speed * (times - times.mean()), color=ORANGE, linewidth=3.0, alpha=0.8, zorder=1)
    marks = heights.scatter(seen["time"], seen["z"], c=1e3 * seen["diameter"], s=14.0, cmap="viridis", zorder=2)
    heights.plot([], [], color=ORANGE, linewidth=3.0, label=f"mean rise {plus_minus(found, 'bubbles.rise_velocity')}")
    heights.set(xlabel="time $t$ [s]", ylabel=label("height $z$ of bubbles", gas.units["x"]), ylim=(0.0, top))
    heights.legend(loc="upper right", frameon=False)
    figure.colorbar(marks, ax=heights, label="diameter [mm]", pad=0.02)
    return figure


def fullest(seen: dict[str, Array]) -> int:
    """A row of the time at which there are most bubbles."""
    times, counts = np.unique(seen["time"], return_counts=True)
    return int(np.flatnonzero(seen["time"] == times[np.argmax(counts)])[0])


def spectrum(bed: talcum.Bed) -> Figure:
    """The power spectra of the height of the centre of mass and of the fluctuations, with their bands of 95 %."""
    found = bed.analyse(["spectrum"], 0.65)
    figure, panels = new_figure(1, 2, WIDE)
    shown = (
        ("centre_height", "height of the centre of mass", "m$^2$ s", BLUE),
        ("fluctuating_kinetic_energy", "kinetic energy of the fluctuations", "J$^2$ s", GREEN),
    )
    for panel, (name, words, unit, colour) in zip(panels[0], shown):
        table = {column: values[1:] for column, values in found.tables[f"spectrum/{name}"].items()}
        table = {column: values[table["frequency"] < HIGHEST_FREQUENCY] for column, values in table.items()}
        panel.fill_between(table["frequency"], table["lower"], table["upper"], color=colour, alpha=0.25, linewidth=0.0)
        panel.plot(table["frequency"], table["density"], color=colour, label=words)
        peak = found.number(f"spectrum.{name}")
        panel.axvline(peak, color=BLACK, linestyle=":", label=f"peak at {plus_minus(found, f'spectrum.{name}')}")
        panel.set(xscale="log", yscale="log", xlim=(table["frequency"][0], HIGHEST_FREQUENCY))
        panel.set(xlabel="frequency $f$ [1/s]", ylabel=label("power spectral density", unit))
        panel.legend(frameon=False, loc="lower left")
    return figure


def plus_minus(found: talcum.Analysis, name: str) -> str:
    """A number with its standard error in two digits, and its unit."""
    value, error = found.number(name), found.errors[name]
    digits = max(0, 1 - int(np.floor(np.log10(error))))
    return rf"{value:.{digits}f} $\pm$ {error:.{digits}f} {found.units[name]}"


def ledger(bed: talcum.Bed) -> Figure:
    """Work by mechanism since the start, and what is stored with the error of the balance."""
    table = bed.energy
    figure, panels = new_figure(1, 2, WIDE)
    work, stored = panels[0]
    for name, words, colour in (("gravity", "gravity, in the frame of the plate", ORANGE), ("gas", "gas", BLUE),
                                ("dashpot", "dashpots", RED), ("friction", "friction", GREEN)):  # fmt: skip
        work.plot(table["time"], table[name], color=colour, label=words)
    work.set_ylabel(label("work $W$ since the start", table.units["gravity"]))
    for name, words, colour in (("kinetic", "kinetic energy", BLUE), ("elastic", "in springs", GREEN),
                                ("attraction", "of attraction", ORANGE), ("closure_error", "error of the balance", BLACK)):  # fmt: skip
        stored.plot(table["time"], table[name], color=colour, label=words)
    stored.set_ylabel(label("stored energy $E$", table.units["kinetic"]))
    stored.set_ylim(top=1.4 * table["kinetic"].max())  # room for the legend
    for panel in panels[0]:
        panel.set(xlabel=label("time $t$", table.units["time"]), xlim=(table["time"][0], table["time"][-1]))
        panel.axhline(0.0, color=GREY, linewidth=0.8)
        panel.legend(frameon=False)
    return figure


def points_of_studies(few: talcum.Study, many: talcum.Study) -> Figure:
    """The height of the bed at each point of a study: its runs, and means with Student's intervals, from few and from many seeds."""
    velocities = np.unique(many.points.numbers("superficial_velocity"))
    figure, panels = new_figure(1, len(velocities), WIDE)
    for panel, velocity in zip(panels[0], velocities):
        for study, colour, shift in ((few, GREY, -0.12), (many, BLUE, 0.12)):
            seeds = len(np.unique(study.runs.numbers("seed")))
            points = study.points.where(superficial_velocity=float(velocity))
            found = points.estimates("top")
            places = np.arange(len(found)) + shift
            mean = np.array([estimate.mean for estimate in found])
            ends = [[estimate.mean - estimate.lower for estimate in found], [estimate.upper - estimate.mean for estimate in found]]
            panel.errorbar(places, mean, ends, color=colour, linestyle="", marker="_", markersize=14, capsize=5, label=f"{seeds} seeds")
            for place, bond in zip(places, points.numbers("bond_number")):
                runs = study.runs.where(superficial_velocity=float(velocity), bond_number=bond).numbers("top")
                panel.plot(np.full(len(runs), place), runs, ".", color=colour, alpha=0.6)
        panel.set(xticks=range(len(found)), xticklabels=[f"{bond:g}" for bond in points.numbers("bond_number")], xlim=(-0.5, 1.5))
        panel.set(xlabel="Bond number $Bo$", ylabel=label("top of the bed $H$", "d"))
        panel.set_title(rf"$U_s$ = {velocity:g} $\sqrt{{g d}}$", loc="left")
    panels[0, 0].legend(frameon=False, loc="upper left")
    return figure
