"""Results of the runs of Liu et al. (2016) over time and lag, as small tables that
`scripts/report liu2016 --keep` keeps with the cases.

A table has a row for each run and time, and names the run by the paper's name of its case and by its seed. `table` reads the
results of the runs in a folder, or the kept tables if there are no runs.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from paper_report.tables import made_or_kept, studies_of
from study_tables import StudyTable, read_study_table, table_of_rows
from talcum_results import Array, read_series, result_file

import h5py
import numpy as np

KEPT = Path(__file__).resolve().parent.parent / "results"
STUDIES = ("fig3-cases", "other-cases")
"""The studies that have curves."""
BREAKAGE = ("breakage",)
"""The studies that have critical times and rates."""
WHOLE_BOX = ("full-box",)
"""The paper's box, which has agglomerates and dispersion; the tables are kept as `whole-agglomerates` and so on."""
WHOLE_PREFIX = "whole-"
FLUIDISATION = ("fluidisation",)
"""The companion paper's beds over the Bond number, with means over intervals of time."""
ALL_STUDIES = studies_of(KEPT)
INTERVAL = 0.01
"""Interval over which the series is averaged [s]."""
LONG_INTERVAL = 0.05
"""The interval for the companion paper's beds [s]."""
FOLLOWED = "rho250vdw20ug4"
"""The case of which the paper shows distributions."""
PARTICLE = 40.0e-6
"""Diameter of the simple agglomerates [m]."""
GRAVITY = 9.81
HEAVY = 250.0
"""Density of the case that all studies begin with [kg/m^3]: that of a study in which it does not vary."""


@dataclass
class Run:
    """A complete run of a study."""

    case: str
    seed: int
    folder: Path
    digest: str
    commit: str

    def rows(self, instrument: str, group: str) -> dict[str, Array]:
        """The columns of a table of an instrument."""
        with h5py.File(result_file(self.folder, f"measure-{instrument}.h5")) as file:
            return {name: column[()] for name, column in file[group].items()}


def case_name(density: float, adhesion: float, velocity: float) -> str:
    """The paper's name of a case, for example rho250vdw20ug4: density, Bond number, gas velocity in cm/s."""
    return f"rho{density:.0f}vdw{nominal_bond_number(density, adhesion)}ug{100.0 * velocity:.0f}"


def nominal_bond_number(density: float, adhesion: float) -> int:
    """The Bond number that the paper names: a multiple of 5, since it gives forces to one digit or two."""
    weight = density * np.pi / 6.0 * PARTICLE**3 * GRAVITY
    return 5 * round(adhesion / weight / 5.0)


def runs_of(results: Path, studies: tuple[str, ...] = STUDIES) -> list[Run]:
    """The complete runs of some studies below a folder of results."""
    found = []
    for study in studies:
        file = results / study / "runs.csv"
        if not file.exists():
            continue
        table = read_study_table(file)
        for row in table.rows:
            if row["state"] != "complete":
                continue
            density = float(row.get("density") or HEAVY)
            adhesion, velocity = float(row["adhesion"]), float(row["inlet_velocity"])
            seed = int(row.get("seed") or 1)
            folder = results / study / "runs" / row["run"]
            if folder.exists():
                found.append(Run(case_name(density, adhesion, velocity), seed, folder, row["digest"], table.provenance.get("commit", "unknown")))
    return sorted(found, key=lambda run: (run.case, run.seed))


def shows_agglomerates(run: Run) -> bool:
    """Whether snapshots of the particles are there and tell in which agglomerate each is."""
    file = run.folder / "particles.vtkhdf"
    if not file.exists():
        return False
    with h5py.File(file) as snapshots:
        return "agglomerate" in snapshots["VTKHDF/PointData"]


Rows = Iterator[dict[str, float]]
IN_TIME = "fluidisation-in-time"


def series(run: Run) -> Rows:
    """Means over intervals: the whole bed over time (Figs 4 and 6a)."""
    found = read_series(run.folder)
    names = {"grid_pressure_drop": "pressure_drop", "coordination_number": "coordination_number", "centre_height": "centre_height [m]"}
    for end, rows in intervals(found.time, INTERVAL):
        yield {"time [s]": end} | {to: float(np.mean(found[name][rows])) for name, to in names.items()}


def intervals(time: Array, length: float) -> Iterator[tuple[float, Array]]:
    """The end of each interval of time, and which rows are in it: those after its start, up to its end."""
    number = np.ceil(np.round(time / length, 6)).astype(int)
    for found in np.unique(number[number > 0]):
        yield float(found * length), number == found


def in_time(run: Run) -> Rows:
    """Means of a bed over intervals of 50 ms, which show whether it keeps moving or comes to rest (companion paper)."""
    found = read_series(run.folder)
    names = {
        "fluctuating_kinetic_energy": "fluctuating_kinetic_energy [J]", "grid_pressure_drop": "pressure_drop", "gas_force": "gas_force",
        "coordination_number": "coordination_number", "centre_height": "centre_height [m]",
    }  # fmt: skip
    for end, rows in intervals(found.time, LONG_INTERVAL):
        means = {to: float(np.mean(found[name][rows])) for name, to in names.items()}
        deviation = float(np.std(found["grid_pressure_drop"][rows], ddof=1))
        yield {"time [s]": end} | means | {"pressure_deviation": deviation, "departed": float(found["departed"][rows][-1])}


def agglomerates(run: Run) -> Rows:
    """Agglomerates over the lag since t_0 (Figs 8a, 8b and 9)."""
    found = run.rows("agglomerates", "results")
    names = {
        "lag": "lag [s]", "agglomerates": "agglomerates", "mass_fraction": "mass_fraction", "members": "members",
        "diameter": "diameter [m]", "coordination_number": "coordination_number", "packing_fraction": "packing_fraction",
        "fractal_dimension": "fractal_dimension", "population_dimension": "population_dimension",
    }  # fmt: skip
    for row in range(len(found["time"])):
        start = round(float(found["time"][row] - found["lag"][row]), 9)
        yield {"reference_time [s]": start} | {to: float(found[name][row]) for name, to in names.items()}


def dispersion(run: Run) -> Rows:
    """Dispersion coefficients of each window (Fig. 5b)."""
    found = run.rows("dispersion", "dispersion")
    length = float(np.max(run.rows("dispersion", "results")["lag"]))
    for time, x, z in zip(found["time"], found["secant_x"], found["secant_z"]):
        yield {"start [s]": round(float(time) - length, 9), "secant_x [m^2/s]": float(x), "secant_z [m^2/s]": float(z)}


def critical(run: Run) -> Rows:
    """Critical times of each window, from samples every 2 ms (Fig. 8c)."""
    found = run.rows("agglomerates", "windows")
    for row, reference in enumerate(found["reference_time"]):
        yield {"reference_time [s]": float(reference)} | {f"{name} [s]": float(found[name][row]) for name in ("most", "few", "steady")}


def displacements(run: Run) -> Rows:
    """Half of the mean square displacement over the lag (Fig. 5a)."""
    found = run.rows("dispersion", "results")
    for row in range(len(found["time"])):
        lag = float(found["lag"][row])
        yield {
            "start [s]": round(float(found["time"][row]) - lag, 9),
            "lag [s]": lag,
            "half_square_x [m^2]": 0.5 * float(found["square_x"][row]),
            "half_square_z [m^2]": 0.5 * float(found["square_z"][row]),
        }


def contacts(run: Run) -> Rows:
    """Part of the particles with 0 to 6 and with 7 or more neighbours, averaged over 50 ms (Fig. 6b)."""
    found = run.rows("contacts", "results")
    for time, parts in zip(found["time"], found["distribution"]):
        few = {f"with_{number}": float(parts[number]) for number in range(7)}
        yield {"time [s]": float(time)} | few | {"with_7_or_more": float(np.sum(parts[7:]))}


def singles(run: Run) -> Rows:
    """The single agglomerates of the followed case at the first look after each t_0 (Fig. 10)."""
    if run.case != FOLLOWED:
        return
    found = run.rows("agglomerates", "agglomerates")
    first = float(np.min(found["lag"])) if len(found["lag"]) else 0.0
    for row in np.flatnonzero(found["lag"] <= first * (1.0 + 1e-6)):
        yield {
            "time [s]": float(found["time"][row]),
            "members": float(found["members"][row]),
            "diameter [m]": float(found["diameter"][row]),
            "coordination_number": float(found["coordination_number"][row]),
            "packing_fraction": float(found["packing_fraction"][row]),
            "fractal_dimension": float(found["fractal_dimension"][row]),
        }


def rates(run: Run) -> Rows:
    """Members that an agglomerate loses and gains over time, by its size, of all windows of 10 ms; and where the two are equal."""
    with h5py.File(result_file(run.folder, "measure-rates.h5")) as file:
        limits = file["size_limits"][()]
    found = run.rows("rates", "rates")
    if not len(found["time"]):
        return
    crossing = float(found["crossing"][-1])
    for size in np.flatnonzero(found["observed"][-1]):
        row = {name: float(found[name][-1, size]) for name in ("observed", "lost", "lost_error", "gained", "gained_error")}
        units = {name: name if name == "observed" else f"{name} [1/s]" for name in row}
        yield {"from_members": float(limits[size])} | {units[name]: value for name, value in row.items()} | {"crossing": crossing}


TABLES = {table.__name__: (STUDIES, table) for table in (series, agglomerates, dispersion, displacements, contacts, singles)} | {
    table.__name__: (BREAKAGE, table) for table in (critical, rates)
} | {f"{WHOLE_PREFIX}{table.__name__}": (WHOLE_BOX, table) for table in (agglomerates, dispersion)} | {IN_TIME: (FLUIDISATION, in_time)}
"""The studies of each table, and the function that gives its rows for a run."""


def made(results: Path, name: str) -> StudyTable | None:
    """A table of the runs below a folder of results; None if there are none."""
    studies, rows_of = TABLES[name]
    runs = runs_of(results, studies)
    rows = [{"case": run.case, "seed": str(run.seed)} | {key: f"{value:.6g}" for key, value in row.items()}
            for run in runs for row in rows_of(run)]  # fmt: skip
    if not rows:
        return None
    provenance = {"studies": ", ".join(studies)} | {f"{run.case} seed {run.seed}": f"digest {run.digest}, commit {run.commit}" for run in runs}
    return table_of_rows(results / f"{name}.csv", provenance, rows)


def table(results: Path, name: str) -> StudyTable | None:
    """A table of the runs that were made here, else the one that is kept; None if there is neither."""
    return made_or_kept(made(results, name), KEPT / f"{name}.csv")
