"""Tests of the page of Moon et al. (2006), of what all pages share, and of the tables of studies, with negative controls."""

from __future__ import annotations

import shutil
import unittest
from pathlib import Path

import h5py
import numpy as np

from cases.moon2006.report import boxes, cycle, fluidisation, paper, powder, state_map, tables, thresholds
from cases.moon2006.report.paper import PAPER
from made_up_results import CASE, COLUMNS as SERIES, ScriptTest, write_profiles, write_series
from paper_report import command, run_times
from study_tables import Estimate, read_study_table
from talcum_results import ResultsError

HEAD = "# title: t\n# commit: 0123456789abcdef\n# measure: one\n# measure: two\n"
COLUMNS = ("speed", "period", "wavelength", "gas_force", "front_speed")


def points(gas_force: float) -> str:
    """The table of points of the developed bed, with this gas force."""
    headings = [f"{name}{end}" for name in COLUMNS for end in (" [u]", "_lower [u]", "_upper [u]")]
    values = [number for name in COLUMNS for number in ((gas_force if name == "gas_force" else 0.4),) * 3]
    return f"{HEAD}point,runs,waves,{','.join(headings)}\n1,5,\"1 frozen, 4 waves\",{','.join(map(str, values))}\n"


class TestReport(ScriptTest):
    """A study of one point, with and without its runs."""

    def setUp(self) -> None:
        super().setUp()
        kept = tables.KEPT
        self.addCleanup(setattr, tables, "KEPT", kept)
        tables.KEPT = self.folder / "kept"  # none: only what this test writes

    def write_study(self, gas_force: float = 0.99) -> None:
        """The tables of the study."""
        folder = self.folder / "developed-bed"
        folder.mkdir(exist_ok=True)
        (folder / "points.csv").write_text(points(gas_force))
        (folder / "runs.csv").write_text(f"{HEAD}run,point,seed,state\nseed=1__abc,1,1,complete\n")

    def write_run(self) -> Path:
        """The profiles of its run."""
        run = self.folder / "developed-bed/runs/seed=1__abc"
        run.mkdir(parents=True)
        time, height = np.arange(0.0, 20.0), np.arange(0.0, 30.0, 1.5)
        write_profiles(run, time, height, np.full((len(time), len(height)), 0.5), CASE)
        return run

    def page(self) -> str:
        """The page of the studies in the folder."""
        command.main(PAPER, ["--results", str(self.folder)])
        return (self.folder / "moon2006.html").read_text()

    def test_statements_say_whether_they_agree(self) -> None:
        self.write_study()
        page = self.page()
        self.assertIn("<td>1 frozen, 4 waves</td>", page)
        self.assertIn("<td>0.4 (0.4 to 0.4; 5 seeds)</td>", page)
        self.assertIn('<tr class="agrees"><td>gas force over the weight</td>', page)
        self.assertIn('<a href="#fig-1-waves-without-cohesion">Fig. 1: waves without cohesion</a></td><td>1</td><td></td><td>4</td>', page)
        self.assertIn('<h2 id="fig-1-waves-without-cohesion">', page)
        self.assertIn("commit 0123456789)", page)
        self.assertNotIn("<img", page)  # the runs are not there
        self.write_study(gas_force=0.9)
        self.assertIn('<tr class="differs"><td>gas force over the weight</td>', self.page())

    def test_pictures_are_in_the_page(self) -> None:
        self.write_study()
        self.write_run()
        page = self.page()
        self.assertIn('src="data:image/png;base64,', page)
        self.assertNotIn('src="http', page)

    def test_kept_pictures_and_curves_stand_in_for_runs(self) -> None:
        self.write_study()
        run = self.write_run()
        shaken = self.folder / "fig8/runs/u=0__abc"
        shaken.mkdir(parents=True)
        (self.folder / "fig8/runs.csv").write_text(f"{HEAD}run,wall_bond_number,superficial_velocity,seed,state,digest\nu=0__abc,0,0,1,complete,d1\n")
        time = np.arange(62.5, 87.5, 0.125)
        wave = np.sin(2.0 * np.pi * 0.16 * time)
        write_series(shaken, {name: wave for name in SERIES} | {"time": time, "plate_stress": 2.0 * wave, "effective_gravity": 1.0 + 3.0 * wave})
        command.main(PAPER, ["--results", str(self.folder), "--keep", str(tables.KEPT)])
        shutil.rmtree(run)
        shutil.rmtree(shaken)
        self.assertIn('src="data:image/png;base64,', self.page())
        curves = cycle.curves(self.folder)
        assert curves is not None
        self.assertEqual(curves.provenance["fig8 u=0__abc"], "digest d1")
        self.assertAlmostEqual(max(curves.numbers("plate_stress")), 2.0, delta=0.01)
        self.assertIsNone(cycle.drawn(curves, "fig7", 0.0))
        # A velocity of sin(2 pi f t) moves the centre by 1 / (pi f) = 1.99 d, more than d.
        self.assertAlmostEqual(cycle.rises(curves, "fig8", 0.0)[0.0], 1.0 / (0.16 * np.pi), delta=0.01)
        self.assertEqual([lift.agrees for lift in cycle.lifts_off(curves, "fig8", 0.0, "stiff")], [False])
        self.assertEqual(cycle.lifts_off(curves, "fig7", 0.0, "soft"), [])

    def test_run_times_are_those_of_runs_made_in_one_go(self) -> None:
        table = "stage   seconds   share     largest over mean\nintegrate      8.25  10.4 %      1.00\ndecide (wait)   1.50   0.1 %       1.00\n"
        runs = {"one": f"starting anew\n{table}complete at time 9", "two": f"starting anew\nresuming from c.h5\n{table}complete at time 9", "three": "starting anew\n"}
        for name, output in runs.items():
            folder = self.folder / "fig3/runs" / name
            folder.mkdir(parents=True)
            (folder / "output.log").write_text(output)
        tables.KEPT.mkdir()
        (tables.KEPT / run_times.KEPT).write_text("study,runs,median [s],longest [s],all [h],processor\nfig2,3,7,8,0.1,old\nfig3,9,9,9,9,old\n")
        self.assertEqual(run_times.seconds_of(self.folder / "fig3/runs/one"), 9.75)
        self.assertIsNone(run_times.seconds_of(self.folder / "fig3/runs/two"))
        self.assertIsNone(run_times.seconds_of(self.folder / "fig3/runs/none"))
        command.main(PAPER, ["--results", str(self.folder), "--keep", str(tables.KEPT)])
        shutil.rmtree(self.folder / "fig3")
        page = self.page()
        self.assertIn("<td>fig2</td><td>not given</td><td>7 s; longest 8 s; runs that were not interrupted: 3, 0.1 h of one core (old)</td>", page)
        self.assertIn("<td>fig3</td><td>not given</td><td>10 s; longest 10 s; runs that were not interrupted: 1,", page)

    def test_the_bond_number_of_asperities_is_that_of_check(self) -> None:
        # What `talcum check cases/moon2006/fine-powder.toml` prints, to its five digits.
        self.assertAlmostEqual(powder.bond_number(4.25e-8) / 4.0200, 1.0, delta=2.0e-5)
        # The control: smooth spheres.
        self.assertGreater(powder.bond_number(0.0), 2000.0)

    def test_tables_are_read_by_heading(self) -> None:
        file = self.folder / "points.csv"
        file.write_text(f"{HEAD}gamma,cap,speed [c],speed_lower [c],speed_upper [c],speed_runs\n2.0,net,,,,0\n3,net,1,0.5,1.5,2\n")
        table = read_study_table(file)
        self.assertEqual(table.provenance["measure"], "one")
        self.assertEqual(str(table.estimates("speed")[0]), "none")
        self.assertEqual(table.where(gamma=3.0, cap="net").estimates("speed"), [Estimate(1.0, 0.5, 1.5, 2)])
        self.assertEqual(table.where(gamma=4.0).rows, [])
        with self.assertRaisesRegex(ResultsError, "no column spead"):
            table.numbers("spead")
        file.write_text("a,b\n1\n")
        with self.assertRaisesRegex(ResultsError, "1 cells in place of 2"):
            read_study_table(file)

    def test_tension_is_found_in_the_frame_of_the_void(self) -> None:
        for void in (1, 6):
            file = self.folder / f"void-{void}.h5"
            with h5py.File(file, "w") as measured:
                measured["phase"] = np.array([0.125, 0.375, 0.625, 0.875])
                measured["height"] = np.arange(8.0) + 0.5
                fraction, stress = np.full((1, 4, 8), 0.6), np.zeros((1, 4, 8, 3, 3))
                fraction[..., void] = 0.1
                stress[0, 1, (void + 2) % 8, 2, 2] = -0.9
                rows = measured.create_group("results")
                rows["solids_fraction"], rows["granular_temperature"] = fraction, np.full((1, 4, 8), 0.01)
                rows["kinetic"], rows["contact"], rows["cohesive"] = np.zeros_like(stress), stress, np.zeros_like(stress)
        files = [self.folder / f"void-{void}.h5" for void in (1, 6)]
        profiles = boxes.read_wave_profiles(files)
        assert profiles is not None
        self.assertEqual(profiles.tension(), (0.9, 0.375, 2.0))
        self.assertEqual(float(profiles.solids_fraction[0, 4]), 0.1)
        self.assertIsNone(boxes.read_wave_profiles([]))
        # The same from the table that is kept of these runs.
        for void, file in zip((1, 6), files):
            (self.folder / f"fig11/runs/r{void}").mkdir(parents=True)
            file.rename(self.folder / f"fig11/runs/r{void}/measure-profile.h5")
        (self.folder / "fig11/runs.csv").write_text(f"{HEAD}run,state,digest\nr1,complete,d1\nr6,complete,d6\n")
        command.main(PAPER, ["--results", str(self.folder), "--keep", str(tables.KEPT)])
        shutil.rmtree(self.folder / "fig11")
        kept = boxes.wave_profiles(self.folder)
        assert kept is not None
        self.assertEqual(kept.tension(), (0.9, 0.375, 2.0))
        np.testing.assert_allclose(kept.solids_fraction, profiles.solids_fraction)

    def test_parts_of_a_bed_are_given_by_their_means(self) -> None:
        file = self.folder / "points.csv"
        ends = ",".join(f"{name}{end}" for name in ("share", "frozen_share", "plug_share") for end in ("", "_lower", "_upper"))
        file.write_text(f"{HEAD}bond_number,runs,{ends}\n4,2,0.75,0.5,1,0.25,0,0.5,0,0,0\n8,2,0,0,0,0.5,0,1,0.5,0,1\n")
        expected = "4: waves 0.75, still 0.25, plug 0.00; 8: waves 0.00, still 0.50, plug 0.50"
        self.assertEqual(tables.parts(read_study_table(file), "bond_number"), expected)

    def test_waves_come_back_where_they_sweep_half_of_the_material(self) -> None:
        file = self.folder / "runs.csv"
        shares = {1: (0.0, 0.25, 0.75), 2: (0.1, 0.5, 0.9), 3: (0.2, 0.4, 0.6)}
        rows = "".join(f"{gamma},{seed},{share}\n" for seed, of_seed in shares.items() for gamma, share in zip((1, 2, 3), of_seed))
        file.write_text(f"{HEAD}gamma,seed,share\n{rows}")
        back = paper.returns(read_study_table(file), "share")
        self.assertAlmostEqual(back.mean, (2.5 + 2.0 + 2.5) / 3.0)
        self.assertEqual(back.runs, 3)
        # The control: waves that never sweep half come back nowhere.
        file.write_text(f"{HEAD}gamma,seed,share\n1,1,0.1\n2,1,0.4\n")
        self.assertEqual(paper.returns(read_study_table(file), "share").runs, 0)

    def test_critical_values_lie_on_a_line(self) -> None:
        folder = self.folder / "fig4"
        folder.mkdir()
        rows = "".join(f"{k},{gamma},5,{5 * gamma + off},1,{5 * gamma - 1},{5 * gamma + 1},0.5\n"
                       for k, (gamma, off) in enumerate([(2, 0.1), (3, -0.1), (4, 0.0)], 1))  # fmt: skip
        (folder / "points.csv").write_text(f"{HEAD}point,gamma,found,critical,deviation,lower,upper,resolution\n{rows}")
        page = self.page()
        self.assertIn("slope 4.95, intercept 0.15, R^2 1.000", page)
        self.assertIn('<tr class="agrees"><td>straight line</td>', page)

    def test_a_study_that_was_only_begun_does_not_hide_the_kept_table(self) -> None:
        self.write_study()
        tables.KEPT.mkdir()
        kept = tables.KEPT / "developed-bed-points.csv"
        kept.write_text(points(0.97))
        self.assertIn("0.99", self.page())
        begun = self.folder / "developed-bed/points.csv"
        begun.write_text(begun.read_text().replace("\n1,5,", "\n1,0,"))
        found = tables.table(self.folder, "developed-bed", "points")
        assert found is not None
        self.assertEqual(found.file, kept)
        kept.unlink()
        self.assertIsNone(tables.table(self.folder, "developed-bed", "points"))

    def test_the_map_shows_each_state(self) -> None:
        folder = self.folder / "map"
        folder.mkdir()
        head = "run,superficial_velocity,gamma,bond_number,seed,state,waves\n"
        rows = "".join(f"r{k},{k % 2},{k},8,1,complete,{state}\n" for k, state in enumerate(state_map.MARKS))
        (folder / "runs.csv").write_text(f"{HEAD}{head}{rows}r9,0,9,8,1,not complete,\n")
        figure = state_map.drawn(read_study_table(folder / "runs.csv").where(state="complete"), [])
        named = [{text.get_text() for text in panel.get_legend().get_texts()} for panel in figure.axes]
        self.assertEqual(len(named), 2)
        self.assertEqual(named[0] | named[1], {name for _, _, name in state_map.MARKS.values()})
        self.assertIn("The map of Bond number and Gamma", self.page())

    def test_the_work_of_parting_is_that_of_check(self) -> None:
        # What `talcum check` prints for k_n 2e5 at Bo 24.2 and for k_n 2e6 at Bo 45.8, to its five digits.
        for bond, stiffness, printed in ((24.2, 2.0e5, 6.0405e-4), (45.8, 2.0e6, 5.2731e-4)):
            self.assertAlmostEqual(state_map.work_of_parting(bond, stiffness) / printed, 1.0, delta=2.0e-5)
        # The control: the attraction alone.
        self.assertLess(state_map.work_of_parting(24.2, np.inf), 3.0e-4)

    def test_minimum_fluidisation_at_the_papers_packing_is_that_of_a_line_through_beds(self) -> None:
        # Errors of +e, -e, -e, +e about the line 0.022 - 0.7 (phi - 0.652): e / sqrt(2) at the middle, where the interval is 4.303 times as wide.
        packings, e = [0.642, 0.647, 0.657, 0.662], 1.0e-4
        velocities = [0.029 + e, 0.0255 - e, 0.0185 - e, 0.015 + e]
        found = fluidisation.at_the_papers_packing(packings, velocities)
        self.assertTrue(found.measured.startswith("0.0220 (0.0217 to 0.0223), by a line through 4 shaken beds"), found.measured)
        self.assertIs(found.agrees, True)
        self.assertIs(fluidisation.at_the_papers_packing(packings, [u + 5.0 * e for u in velocities]).agrees, False)
        self.assertIsNone(fluidisation.at_the_papers_packing(packings[:2], velocities[:2]).agrees)

    def test_the_speed_of_the_front_is_within_its_panel(self) -> None:
        tables.KEPT.mkdir()
        kept = Path(__file__).resolve().parent.parent / "cases/moon2006/results"
        for kind in ("points", "runs"):
            shutil.copy(kept / f"fig2-long-{kind}.csv", tables.KEPT)
        section = thresholds.long_times(self.folder)
        assert section is not None
        panel = section.figures[0][0].axes[-1]
        lower, upper = sorted(panel.get_ylim())
        speeds = [y for line in panel.get_lines() for y in line.get_ydata() if y == y]
        self.assertTrue(speeds and all(lower < y < upper for y in speeds), (lower, upper, speeds))

    def test_every_study_of_the_page_is_there(self) -> None:
        cases = Path(__file__).resolve().parent.parent / "cases/moon2006"
        studies = {path.stem for path in (cases / "studies").glob("*.toml")}
        scripts = (cases / "report").glob("*.py")
        page = "".join(path.read_text() for path in scripts if path.stem != "pictures")
        on_page = {study for study in studies if f'"{study}"' in page}
        self.assertEqual(studies - {"wide-bed"}, on_page)  # wide-bed is only the start of wide


class TestKept(ScriptTest):
    """The page of what is kept with the cases, without a run."""

    def test_the_kept_tables_fill_the_page(self) -> None:
        command.main(PAPER, ["--results", str(self.folder)])
        page = (self.folder / "moon2006.html").read_text()
        self.assertEqual(page.count("<h2"), len(PAPER.sections(self.folder)))
        self.assertGreater(page.count("<h2"), 15)


if __name__ == "__main__":
    unittest.main()
