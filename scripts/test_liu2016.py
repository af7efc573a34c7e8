"""Tests of the curves and the page of Liu et al. (2016), on a made-up run, with negative controls."""

from __future__ import annotations

import shutil
import unittest
from pathlib import Path

import h5py
import numpy as np

from cases.liu2016.report import breakage, cases as table_2, companion, curves, drag, flow, pictures, tables
from cases.liu2016.report.breakage import share_kept
from cases.liu2016.report.paper import PAPER
from cases.liu2016.report.tables import SMALL, WHOLE, trends
from made_up_results import ScriptTest
from paper_report import command
from paper_report.tables import interval_of
from study_tables import Estimate, StudyTable, read_study_table
from talcum_results import ResultsError

HEAD = "# title: t\n# commit: 0123456789abcdef\n"
LAGS = np.array([0.01, 0.05, 0.1])
NUMBERS = np.array([200.0, 120.0, 20.0])
MEASURES = ("pressure_drop", "pressure_deviation", "gas_force", "weight", "coordination_number", "centre_height", "departed")


def write_table(file: h5py.File, name: str, columns: dict[str, np.ndarray]) -> None:
    """A table of an instrument."""
    for column, values in columns.items():
        file.create_dataset(f"{name}/{column}", data=values)


def made_table(columns: dict[str, tuple[float, ...]]) -> StudyTable:
    """A table of rows of rho250vdw20ug4."""
    rows = [dict(zip(columns, map(str, values))) | {"case": "rho250vdw20ug4", "seed": "1"} for values in zip(*columns.values())]
    return StudyTable(Path("made.csv"), {}, rows, {})


class TestCurves(ScriptTest):
    """A study with one complete run, of rho250vdw20ug4."""

    def setUp(self) -> None:
        super().setUp()
        for module in (curves, tables):
            self.addCleanup(setattr, module, "KEPT", module.KEPT)
            module.KEPT = self.folder / "kept"
        run = self.folder / "fig3-cases/runs/one"
        run.mkdir(parents=True)
        (run.parent.parent / "runs.csv").write_text(
            f"{HEAD}run,point,density [kg/m^3],adhesion [N],inlet_velocity [m/s],seed,state,digest\n"
            "one,1,250,1.7e-9,0.04,1,complete,abc\ntwo,1,250,1.7e-9,0.04,2,not complete,\n"
        )
        self.write_run(run)
        shutil.copytree(self.folder / "fig3-cases", self.folder / "breakage")
        shutil.copy(run / "measure-agglomerates.h5", self.folder / "breakage/runs/one/measure-rates.h5")

    def write_run(self, run: Path) -> None:
        """Its series and instruments: 20 ms of series, one window of three looks."""
        rows = [f"{0.001 * step:.3f},{1.0 + step},{2.0},{1.0e-3},{1.0e-12 * step},{1.0},{10 * step}" for step in range(21)]
        head = "time [s],grid_pressure_drop [1],coordination_number [1],centre_height [m],fluctuating_kinetic_energy [J],gas_force [1],departed [1]"
        (run / "series.csv").write_text("\n".join(["# title: t", head, *rows]) + "\n")
        ones = np.ones(3)
        with h5py.File(run / "measure-agglomerates.h5", "w") as file:
            names = ("mass_fraction", "members", "coordination_number", "packing_fraction", "fractal_dimension", "population_dimension")
            looks = {"time": 0.3 + LAGS, "lag": LAGS, "agglomerates": NUMBERS, "diameter": 2.0e-4 * ones} | {name: ones for name in names}
            write_table(file, "results", looks)
            window = {"time": 0.4, "reference_time": 0.3, "most": 0.01, "few": np.nan, "steady": 0.05, "mass_radius_dimension": 2.4}
            write_table(file, "windows", {name: np.array([value]) for name, value in window.items()})
            single = ("lag", "time", "members", "diameter", "coordination_number", "packing_fraction", "fractal_dimension")
            write_table(file, "agglomerates", {name: LAGS for name in single})
            file["size_limits"] = [15.0, 30.0, 60.0]
            by_size = ("observed", "lost", "lost_error", "gained", "gained_error")
            write_table(file, "rates", {"time": ones[:1], "crossing": 40.0 * ones[:1]} | {name: np.array([[4.0, 0.0]]) for name in by_size})
        with h5py.File(run / "measure-contacts.h5", "w") as file:
            write_table(file, "results", {"time": np.array([0.05]), "distribution": np.full((1, 13), 1.0 / 13.0)})
        with h5py.File(run / "measure-dispersion.h5", "w") as file:
            write_table(file, "results", {"time": 0.3 + LAGS, "lag": LAGS, "square_x": ones, "square_z": 4.0 * ones})
            write_table(file, "dispersion", {"time": np.array([0.4]), "secant_x": np.array([1.0e-7]), "secant_z": np.array([5.0e-7])})

    def write_fluidisation(self) -> None:
        """The same run in the study over the Bond number, in which the density does not vary."""
        study = self.folder / "fluidisation"
        shutil.copytree(self.folder / "fig3-cases", study)
        (study / "runs.csv").write_text(f"{HEAD}run,point,inlet_velocity,adhesion,state,digest\none,1,0.04,8.2e-9,complete,abc\n")

    def test_tables_hold_what_the_run_gives(self) -> None:
        shutil.copytree(self.folder / "fig3-cases", self.folder / "full-box")
        self.write_fluidisation()
        command.main(PAPER, ["--results", str(self.folder), "--keep", str(self.folder / "kept")])
        read = {name: read_study_table(self.folder / f"kept/{name}.csv") for name in curves.TABLES}
        # The interval of time 0.01 holds the rows 1 to 10, of 2 to 11.
        self.assertEqual(read["series"].numbers("pressure_drop"), [6.5, 16.5])
        self.assertEqual(read["agglomerates"].numbers("reference_time"), [0.3, 0.3, 0.3])
        self.assertEqual(read["displacements"].numbers("half_square_z"), [2.0, 2.0, 2.0])
        self.assertAlmostEqual(read["contacts"].numbers("with_7_or_more")[0], 6.0 / 13.0, places=5)
        self.assertEqual(len(read["singles"].rows), 1)  # those of the first lag alone
        self.assertEqual(read["critical"].numbers("steady"), [0.05])
        self.assertEqual(read["whole-agglomerates"].rows, read["agglomerates"].rows)  # the same run in another study
        self.assertEqual(read["dispersion"].numbers("start"), [0.3])
        self.assertEqual(read["rates"].numbers("crossing"), [40.0])  # sizes of which none were seen have no row
        (beds,) = read["fluidisation-in-time"].rows  # 20 ms lie in one interval of 50 ms
        self.assertEqual([beds["case"], float(beds["time"]), float(beds["departed"])], ["rho250vdw100ug4", 0.05, 200.0])
        # Of the rows 1 to 20: the start does not count. The deviation of 20 successive numbers is sqrt(20 * 21 / 12).
        self.assertEqual(float(beds["fluctuating_kinetic_energy"]), 1.05e-11)
        self.assertAlmostEqual(float(beds["pressure_deviation"]), 35.0**0.5, places=4)
        self.assertEqual(read["series"].provenance["studies"], "fig3-cases, other-cases")
        self.assertIn("rho250vdw20ug4 seed 1", read["series"].provenance)
        self.assertNotIn("rho250vdw20ug4 seed 2", read["series"].provenance)

    def test_a_folder_without_runs_is_refused(self) -> None:
        with self.assertRaisesRegex(ResultsError, "no complete run"):
            command.main(PAPER, ["--results", str(self.folder / "nowhere"), "--keep", str(self.folder / "kept")])

    def test_agglomerates_that_are_left(self) -> None:
        found = curves.table(self.folder, "agglomerates")
        assert found is not None
        self.assertEqual(share_kept(found, 0.05), [0.6])
        self.assertEqual(share_kept(found, 0.07), [])  # not looked at

    def test_lifetimes_are_given_by_t_0_where_there_are_several(self) -> None:
        found = curves.table(self.folder, "agglomerates")
        assert found is not None
        self.assertEqual(breakage.told_by_window(found, 0.05), "none")  # the control: one window
        later = [row | {"reference_time": "0.6", "agglomerates": "100"} for row in found.rows]
        both = StudyTable(found.file, found.provenance, found.rows + later, found.units)
        self.assertEqual(breakage.told_by_window(both, 0.05), "rho250vdw20ug4: 0.6 (0.3 s), 1 (0.6 s)")

    def test_properties_over_the_lag_leave_out_windows_without_agglomerates(self) -> None:
        found = curves.table(self.folder, "agglomerates")
        assert found is not None
        none = [row | {"reference_time": "0.6", "coordination_number": "nan"} for row in found.rows]
        both = StudyTable(found.file, found.provenance, found.rows + none, found.units)
        head, row = breakage.lag_table(both)
        self.assertEqual(dict(zip(head, row))["C_N, 50 ms"], "1.00")
        self.assertEqual(dict(zip(head, row))["C_N, 30 ms"], "")  # not looked at

    def test_coordination_numbers_in_time_and_their_distribution(self) -> None:
        series = made_table({"time": (0.1, 0.3), "coordination_number": (2.0, 1.5)})
        parts = {f"with_{number}": (0.9 if number == 0 else 0.1 / 6, 0.1) for number in range(7)}
        contacts = made_table({"time": (0.299, 0.349)} | parts | {"with_7_or_more": (0.0, 0.3)})
        head, row = flow.coordination_table(series, contacts)
        found = dict(zip(head, row))
        self.assertEqual([found["C_N at 0.1 s"], found["C_N at 0.2 s"], found["C_N at 0.3 s"]], ["2.00", "", "1.50"])
        # What was before 0.3 s is not in the distribution.
        self.assertEqual([found["with 0"], found["with 5 or more"]], ["0.10", "0.50"])

    def write_points(self, study: str = "fig3-cases") -> None:
        """Means of a study, 1.5 with an interval of 0.5 each."""
        ends = {"": 1.5, "_deviation": 0.1, "_lower": 1.0, "_upper": 2.0}
        columns = {f"{name}{end} [1]": value for name in MEASURES for end, value in ends.items()}
        head = ["point", "density [kg/m^3]", "adhesion [N]", "inlet_velocity [m/s]", "runs", *columns]
        row = [1, 250, 1.7e-9, 0.04, 2, *columns.values()]
        (self.folder / study / "points.csv").write_text(f"{HEAD}{','.join(head)}\n{','.join(map(str, row))}\n")

    def test_cases_stand_side_by_side(self) -> None:
        self.assertEqual(table_2.table(self.folder), [])  # no means yet
        self.write_points()
        head, *rows = table_2.table(self.folder)
        self.assertEqual(head, ["", "paper", "rho250 vdw20 ug4"])
        found = {row[0]: row[2] for row in rows}
        self.assertEqual(found["C_N of the bed"], "1.5 ± 0.5")
        self.assertEqual(found["left after 50 ms"], "0.6")  # one window has no interval
        self.assertEqual(found["d_agg [mm]"], "0.2")
        command.main(PAPER, ["--results", str(self.folder)])
        self.assertIn("<td>C_N of the bed</td><td>2 to 3</td><td>1.5 ± 0.5</td>", (self.folder / "liu2016.html").read_text())

    def write_channel(self) -> None:
        """A pressure drop of half of the weight in each box."""
        (self.folder / "empty-channel").mkdir()
        rows = [f'{number},"{beds.cells}",0.04,1,0.5,,,1.5,,' for number, beds in enumerate((SMALL, WHOLE))]
        measured = ",".join(f"{name}{end}" for name in ("pressure_drop", "weight") for end in ("", "_lower", "_upper"))
        head = f"point,cells,inlet_velocity,runs,{measured}"
        (self.folder / "empty-channel/points.csv").write_text("\n".join([HEAD + head, *rows]) + "\n")

    def test_the_whole_box_stands_beside_the_small_one(self) -> None:
        self.write_points()
        self.write_channel()
        self.assertEqual(table_2.boxes(self.folder), [])  # no run in the whole box
        shutil.copytree(self.folder / "fig3-cases", self.folder / "full-box")
        self.write_points("full-box")
        with h5py.File(self.folder / "full-box/runs/one/measure-agglomerates.h5", "a") as file:
            file["results/agglomerates"][:] = 8.0 * NUMBERS
        head, *rows = table_2.boxes(self.folder)
        self.assertEqual(head, ["", "paper", "12,500 particles", "100,000 particles"])
        found = {row[0]: row[2:] for row in rows}
        self.assertEqual(found["N_agg"], ["200", "1,600"])
        self.assertEqual(found["left after 50 ms"], ["0.6", "0.6"])
        self.assertEqual(found["pressure drop less the walls' over weight"], ["1 ± 0.5", "1 ± 0.5"])

    def write_snapshots(self) -> None:
        """Four snapshots of three particles: the first two are in the agglomerate 5 until they part, the third is in none."""
        with h5py.File(self.folder / "fig3-cases/runs/one/particles.vtkhdf", "w") as file:
            count = len(pictures.LAGS)
            root = file.create_group("VTKHDF")
            steps = root.create_group("Steps")
            steps.attrs["NSteps"] = count
            steps["Values"] = pictures.REFERENCE + np.array(pictures.LAGS)
            steps["PointOffsets"] = 3 * np.arange(count)
            root["NumberOfPoints"] = np.full(count, 3)
            root["Points"] = np.tile(4.0e-5 * np.array([[1.0, 1.0, 1.0], [2.0, 1.0, 1.0], [9.0, 1.0, 3.0]]), (count, 1))
            root["PointData/id"] = np.tile([5, 6, 7], count)
            root["PointData/agglomerate"] = np.concatenate([[5, 5, -1]] + [[-1, -1, -1]] * (count - 1))

    def test_agglomerates_have_colours_and_the_others_are_grey(self) -> None:
        self.assertIsNone(pictures.lags(self.folder))  # no snapshots
        self.write_snapshots()
        run = next(pictures.shown_runs(self.folder))
        first, second, *_ = pictures.snapshots(run)
        self.assertEqual([list(part) for part in first.sizes()], [[5], [2]])
        self.assertEqual(len(second.sizes()[0]), 0)
        colours = pictures.colours_of(first.agglomerates)
        self.assertEqual(tuple(colours[0]), tuple(colours[1]))
        self.assertNotEqual(tuple(colours[0]), pictures.GREY)
        self.assertEqual(tuple(colours[2]), pictures.GREY)
        figure = pictures.lags(self.folder)
        assert figure is not None
        self.assertEqual([panel.get_title() for panel in figure.axes], ["10 ms", "30 ms", "60 ms", "100 ms"])
        self.assertIsNone(pictures.cases(self.folder))  # one case of four

    def test_the_page_shows_beds_over_time(self) -> None:
        self.write_fluidisation()
        found = curves.table(self.folder, curves.IN_TIME)
        self.assertEqual(companion.last_energy(found, "rho250vdw100ug4"), "; energy in the last 50 ms 10.5 pJ")
        self.assertEqual(companion.last_energy(found, "rho250vdw50ug4"), "")
        assert found is not None
        left, right = companion.energies(found).axes
        self.assertEqual([len(left.lines), len(right.lines), right.get_yscale()], [0, 1, "log"])

    def test_the_page_compares_drag_from_agglomerates(self) -> None:
        self.assertIsNone(drag.drag(self.folder))  # no table
        curves.KEPT.mkdir()
        ways = {"one factor, 0.2": 0.2, "from agglomerates": 0.5, "one factor, 1": 1.0}
        rows = [",".join(["it", f'"{way}"', str(xi), *["4.0" if xi == 0.2 else "5.0"] * 6]) for way, xi in ways.items()]
        head = ",".join(["case", "drag", *drag.SHOWN])
        (curves.KEPT / drag.FILE).write_text("\n".join([HEAD + head, *rows]) + "\n")
        section = drag.drag(self.folder)
        assert section is not None
        self.assertEqual([statement.agrees for statement in section.statements[:1]], [False])  # 0.5 is not 0.2
        self.assertEqual(section.statements[1].measured, "it: 1.250")
        self.assertEqual(section.table[1][:4], ["it", "one factor, 0.2", "0.2", "4,000"])  # heights in mm

    def test_the_page_has_breakage(self) -> None:
        command.main(PAPER, ["--results", str(self.folder)])
        page = (self.folder / "liu2016.html").read_text()
        self.assertIn("<td>rho250vdw20ug4: 0.6</td>", page)
        self.assertIn("Fig. 8: breakage", page)
        self.assertNotIn('src="http', page)


class TestNumbers(unittest.TestCase):
    """Names, means and trends."""

    def test_cases_have_the_names_of_the_paper(self) -> None:
        keys = [(137.0, 0.9e-9, 0.02), (250.0, 1.7e-9, 0.03), (250.0, 0.8e-9, 0.04), (250.0, 0.4e-9, 0.04)]
        names = [curves.case_name(*values) for values in keys]
        self.assertEqual(names, ["rho137vdw20ug2", "rho250vdw20ug3", "rho250vdw10ug4", "rho250vdw5ug4"])

    def test_bond_numbers_are_rounded_to_those_of_the_paper(self) -> None:
        self.assertEqual([curves.nominal_bond_number(250.0, force) for force in (0.0, 1.7e-9, 4.1e-9, 8.2e-9)], [0, 20, 50, 100])
        self.assertEqual(curves.nominal_bond_number(137.0, 1.7e-9), 40)  # the control: of a lighter particle it is larger

    def test_trends_are_given_in_the_unit_that_is_asked_for(self) -> None:
        values = {case: Estimate(mean, mean, mean, 1) for case, mean in (("rho250vdw5ug4", 2.0e-6), ("rho250vdw10ug4", 3.0e-6))}
        self.assertEqual(trends("it", values, {"Bond number": True}, 1.0e6)[0].measured, "2 to 3")
        self.assertEqual(trends("it", values, {"Bond number": True})[0].measured, "2e-06 to 3e-06")

    def test_intervals_are_those_of_student(self) -> None:
        found = interval_of([1.0, 2.0, 3.0])
        # 4.303 sigma / sqrt(n), of tables with four digits.
        self.assertAlmostEqual(found.upper, 2.0 + 4.303 / 3.0**0.5, places=3)
        self.assertEqual(interval_of([]).runs, 0)

    def test_a_trend_needs_every_step(self) -> None:
        def values(*means: float) -> dict[str, Estimate]:
            return {case: Estimate(mean, mean, mean, 1) for case, mean in zip(("rho250vdw5ug4", "rho250vdw10ug4", "rho250vdw20ug4"), means)}

        self.assertTrue(trends("it", values(1.0, 2.0, 3.0), {"Bond number": True})[0].agrees)
        self.assertFalse(trends("it", values(1.0, 3.0, 2.0), {"Bond number": True})[0].agrees)
        self.assertIsNone(trends("it", {}, {"Bond number": True})[0].agrees)


class TestKept(ScriptTest):
    """The page of what is kept with the cases, without a run."""

    def test_the_kept_tables_fill_the_page(self) -> None:
        command.main(PAPER, ["--results", str(self.folder)])
        page = (self.folder / "liu2016.html").read_text()
        self.assertGreater(page.count("<h2"), 10)


if __name__ == "__main__":
    unittest.main()
