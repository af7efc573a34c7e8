"""Tests of the package talcum: the examples of docs/python.md as they stand there, a small run, made-up files.

Examples that need a library that is not installed (pandas, xarray, pyvista) are left out.
"""

from __future__ import annotations

import contextlib
import importlib.util
import io
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import h5py
import numpy as np

from made_up_results import SCRIPTS, ScriptTest, write_profiles, write_series
from talcum_results import program

sys.path.insert(0, str(SCRIPTS.parent / "python"))
import talcum  # noqa: E402  (found by the line above)
from talcum.program import error_in, toml_value  # noqa: E402

PAGE = (SCRIPTS.parent / "docs" / "python.md").read_text(encoding="utf-8")
CASE = re.findall(r"^```toml\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)[0]
EXAMPLES = re.findall(r"^```python\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)
HAS_PANDAS, HAS_XARRAY, HAS_MATPLOTLIB = (
    importlib.util.find_spec(name) is not None for name in ("pandas", "xarray", "matplotlib")
)
# As scripts/install sets them: Open MPI refuses root, and more ranks than cores.
RANKS_OF_MPI = {
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "PRTE_ALLOW_RUN_AS_ROOT": "1",
    "PRTE_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
}


def dataset_names(path: Path) -> list[str]:
    """The datasets of a file, by their paths."""
    names: list[str] = []
    with h5py.File(path, "r") as file:
        file.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
    return names


def replace_dataset(path: Path, name: str, other: object) -> None:
    """Puts something else in the place of a dataset: an empty group for `None`."""
    with h5py.File(path, "r+") as file:
        del file[name]
        if other is None:
            file.create_group(name)
        else:
            file[name] = other


@contextlib.contextmanager
def inside(folder: Path):
    """Works in a folder for a while."""
    before = os.getcwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)


class TestRun(unittest.TestCase):
    """One small run, shared by the tests: the case and the examples of the page."""

    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = Path(tempfile.mkdtemp(prefix="talcum-package-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.case = cls.folder / "grains.toml"
        cls.case.write_text(CASE, encoding="utf-8")
        names: dict = {}
        with inside(cls.folder), contextlib.redirect_stdout(io.StringIO()):
            for example in EXAMPLES:
                needed = re.match(r"# needs (\w+)", example)
                if needed is None or importlib.util.find_spec(needed.group(1)):
                    exec(compile(example, "docs/python.md", "exec"), names)
        cls.names = names
        cls.bed = talcum.open(cls.folder / "results" / "grains")

    def test_the_examples_say_what_the_page_says(self) -> None:
        self.assertEqual(len(EXAMPLES), 10)
        self.assertTrue((self.folder / "series.png").read_bytes().startswith(b"\x89PNG"))
        self.assertEqual(self.names["particles"].time, 2.0)
        self.assertEqual(list(self.names["late"]["time"]), [2.0, 2.5, 3.0, 3.5, 4.0])

    def test_the_digest_is_that_of_the_program(self) -> None:
        printed = subprocess.run([program(), "info", str(self.bed.newest_checkpoint)], capture_output=True, text=True)
        self.assertIn(f"digest {self.bed.digest}", printed.stdout)
        self.assertRegex(self.bed.digest, "^[0-9a-f]{32}$")

    def test_what_was_set_is_in_the_case(self) -> None:
        if sys.version_info >= (3, 11):
            self.assertEqual(self.bed.case["gas"]["superficial_velocity"], 0.02)

    def test_particles_fit_the_checkpoint(self) -> None:
        """The last snapshot is of the time of the last checkpoint: the same bits."""
        particles = self.bed.particles()
        self.assertEqual(particles.time, 4.0)
        with h5py.File(self.bed.newest_checkpoint) as file:
            for name in ["position", "velocity", "radius", "id"]:
                np.testing.assert_array_equal(particles[name], file["particles"][name][:])
        self.assertEqual(particles.units["position"], "d")
        first = self.bed.particles(0.0)
        self.assertFalse(np.array_equal(first.position, particles.position))

    def test_times_that_are_there_and_not(self) -> None:
        self.assertEqual(list(self.bed.times), [0.0, 1.0, 2.0, 3.0, 4.0])
        self.assertEqual(self.bed.particles(2.8).time, 3.0)
        self.assertEqual(self.bed.particles(3.0 + 1e-13, exact=True).time, 3.0)
        with self.assertRaisesRegex(talcum.ResultsError, "nothing at time 2.8; the nearest is 3"):
            self.bed.particles(2.8, exact=True)

    def test_contacts_of_instrument_and_checkpoint_are_the_same_pairs(self) -> None:
        lines, kept, early = self.bed.contacts(4.0), self.bed.contacts(4.0, checkpoint=True), self.bed.contacts(1.0)
        self.assertGreater(lines.rows, 10)
        pairs = [set(zip(table["lower"].tolist(), table["higher"].tolist())) for table in (lines, kept, early)]
        self.assertEqual(pairs[0], pairs[1])
        self.assertNotEqual(pairs[0], pairs[2])
        self.assertIn("normal_force", lines)
        with self.assertRaisesRegex(talcum.ResultsError, "no column 'normal_force'.*tangential_spring"):
            kept["normal_force"]
        # From centre to centre: the length of a line is that of two radii less the overlap.
        length = np.linalg.norm(lines["ends"][:, 1] - lines["ends"][:, 0], axis=1)
        np.testing.assert_allclose(length, 1.0 - lines["overlap"], atol=1e-12)

    def test_tables_of_text(self) -> None:
        walls = self.bed.walls
        plate = walls.where((walls["wall"] == "base plate") & np.isnan(walls["diameter"]))
        self.assertLess(plate["force_z"][-1], 0.0)
        self.assertEqual(walls.units["force_z"], "rho_s g d^3")
        self.assertEqual(self.bed.energy["time"][-1], 4.0)
        with self.assertRaisesRegex(talcum.ResultsError, "has no column 'bed_topp'; it has time, "):
            self.bed.series["bed_topp"]

    def test_instruments(self) -> None:
        self.assertEqual(self.bed.instruments, {"grains": "agglomerates", "network": "contacts"})
        grains = self.bed.agglomerates()
        self.assertEqual(grains["results"].rows, 8)
        self.assertIn("largest", grains.scalars)
        self.assertEqual(grains["results"]["number_by_size"].shape, (8, len(grains.constants["size_limits"]) - 1))
        with self.assertRaisesRegex(talcum.ResultsError, "no table 'result'; it has agglomerates"):
            grains["result"]
        with self.assertRaisesRegex(talcum.ResultsError, "no instrument 'network' of kind agg.*there are: grains"):
            self.bed.agglomerates("network")

    def test_the_same_bits_on_two_ranks(self) -> None:
        if shutil.which("mpirun") is None:
            self.skipTest("no mpirun")
        with mock.patch.dict(os.environ, RANKS_OF_MPI):
            try:
                two = talcum.run(self.case, 2, set={"gas.superficial_velocity": 0.02}, output=self.folder / "two")
            except talcum.TalcumError as error:
                if "MPI" in str(error):
                    self.skipTest(f"a program without MPI: {error}")
                raise
        self.assertEqual(two.digest, self.bed.digest)

    def test_the_same_bits_on_two_threads(self) -> None:
        changes = {"gas.superficial_velocity": 0.02}
        two = talcum.run(self.case, threads=2, set=changes, output=self.folder / "threads")
        self.assertEqual(two.digest, self.bed.digest)

    def test_a_run_stopped_before_its_end_goes_on(self) -> None:
        changes, folder = {"gas.superficial_velocity": 0.02}, self.folder / "parts"
        begun = talcum.run(self.case, set=changes, output=folder, until=2)
        self.assertNotEqual(begun.digest, self.bed.digest)
        with self.assertRaisesRegex(talcum.TalcumError, "--resume"):
            talcum.run(self.case, set=changes, output=folder)
        ended = talcum.run(self.case, set=changes, output=folder, resume=True)
        self.assertEqual((ended.digest, ended.is_complete), (self.bed.digest, True))

    def test_messages_are_shown_if_wanted(self) -> None:
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            talcum.restart(self.bed.checkpoints[0], output=self.folder / "again", quiet=False)
        self.assertIn(f"digest {self.bed.digest}", printed.getvalue())

    def test_results_are_read_while_a_program_has_them_open(self) -> None:
        writer = "import h5py, sys; f = h5py.File(sys.argv[1], 'r+'); print('open', flush=True); sys.stdin.read()"
        for name, read in [
            ("particles.vtkhdf", lambda: self.bed.particles().rows),
            ("profiles.h5", lambda: len(self.bed.profiles.time)),
            ("measure-grains.h5", lambda: self.bed.agglomerates()["results"].rows),
            ("measure-network.vtkhdf", lambda: self.bed.contacts().rows),
        ]:
            command = [sys.executable, "-c", writer, str(self.bed.folder / name)]
            expected = read()
            with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
                self.assertEqual(process.stdout.readline(), "open\n")
                self.assertEqual(read(), expected)
                process.communicate()

    def test_a_checkpoint_is_the_state_of_its_time(self) -> None:
        state = self.bed.checkpoint(2.2)
        self.assertEqual((state.time, state.step, self.names["state"].digest), (2.0, 2000, state.digest))
        np.testing.assert_array_equal(state.particles.position, self.bed.particles(2.0, exact=True).position)
        pairs = self.bed.contacts(2.0, checkpoint=True)
        np.testing.assert_array_equal(state.contacts["tangential_spring"], pairs["tangential_spring"])
        self.assertGreater(state.wall_contacts.rows, 0)
        self.assertEqual((state.gas.rows, state.particles.units["mass"]), (0, "rho_s d^3"))
        self.assertEqual(state.attributes["title"], self.bed.checkpoint().attributes["title"])
        self.assertEqual(self.bed.checkpoint().digest, self.bed.digest)
        with self.assertRaisesRegex(talcum.ResultsError, "nothing at time 2.2; the nearest is 2"):
            self.bed.checkpoint(2.2, exact=True)
        with self.assertRaisesRegex(talcum.ResultsError, "nowhere.h5: there is no such file"):
            talcum.read_checkpoint("nowhere.h5")

    def test_a_restart_replaces_results_if_it_must(self) -> None:
        again = self.folder / "forced"
        talcum.restart(self.bed.checkpoints[0], output=again)
        with self.assertRaisesRegex(talcum.TalcumError, "--force"):
            talcum.restart(self.bed.checkpoints[0], output=again)
        self.assertEqual(talcum.restart(self.bed.checkpoints[0], output=again, force=True).digest, self.bed.digest)

    def test_a_study_is_run_and_read(self) -> None:
        text = 'title = "grains"\ncase = "grains.toml"\n[[axis]]\nkey = "cohesion.bond_number"\nvalues = [0.0, 4.0]\n'
        text += '[measure.top]\ncolumn = "bed_top"\nstatistic = "mean"\nwindow = { last = 1.0 }\n'
        (self.folder / "study.toml").write_text(text, encoding="utf-8")
        study = talcum.run_study(self.folder / "study.toml", output=self.folder / "study", at_a_time=1)
        self.assertEqual(study.points.numbers("bond_number"), [0.0, 4.0])
        self.assertEqual(study.runs.texts("state"), ["complete", "complete"])
        self.assertEqual((study.points.units["top"], talcum.read_study(study.folder)), ("d", study))
        with self.assertRaisesRegex(talcum.TalcumError, "nowhere.toml"):
            talcum.run_study("nowhere.toml", output=self.folder / "none")

    @unittest.skipUnless(HAS_MATPLOTLIB, "matplotlib is not installed")
    def test_particles_are_drawn(self) -> None:
        drawn = self.bed.plot_particles(self.folder / "particles.png", start=1.0, colour="rise", panels=2)
        self.assertTrue(drawn.read_bytes().startswith(b"\x89PNG"))
        with self.assertRaisesRegex(talcum.ResultsError, "has no agglomerate, only"):
            self.bed.plot_particles(self.folder / "none.png", colour="agglomerate")

    def test_an_unfinished_snapshot_is_left_out(self) -> None:
        copy = self.folder / "unfinished"
        shutil.copytree(self.bed.folder, copy)
        with h5py.File(copy / "particles.vtkhdf", "r+") as file:
            for name in ["Points", "PointData/id", "Steps/Values"]:
                dataset = file["VTKHDF"][name]
                dataset.resize(len(dataset) + 1, axis=0)
        self.assertEqual(talcum.open(copy).particles().time, 4.0)
        self.assertEqual(talcum.open(copy).particles().rows, 60)

    @unittest.skipUnless(HAS_PANDAS, "pandas is not installed")
    def test_whole_files_of_other_shapes_are_refused_in_words(self) -> None:
        """A scalar, a group or texts in the place of each array: an error of the package, or the array is not read."""
        folder = self.folder / "other-shapes"
        shutil.copytree(self.bed.folder, folder)
        bed = talcum.open(folder)
        checkpoint = bed.newest_checkpoint.name
        readers = {
            "profiles.h5": lambda: bed.profiles.between(1.0, 2.0),
            "particles.vtkhdf": lambda: (bed.times, bed.particles(1.0).rows),
            "measure-grains.h5": lambda: [table.rows for table in bed.instrument("grains").tables.values()],
            "measure-network.vtkhdf": lambda: bed.contacts(4.0).rows,
            checkpoint: lambda: (bed.checkpoint().contacts.rows, bed.contacts(4.0, checkpoint=True).rows),
        }
        for name, read in readers.items():
            refused = 0
            for dataset in dataset_names(folder / name):
                for other in (1.0, None, ["a", "b", "c", "d", "e", "f"]):
                    shutil.copy(self.bed.folder / name, folder / name)
                    replace_dataset(folder / name, dataset, other)
                    with self.subTest(file=name, dataset=dataset, other=other), mock.patch("talcum.files.ATTEMPTS", 1):
                        try:
                            read()
                        except talcum.ResultsError as error:
                            self.assertIn(name, str(error))
                            refused += 1
            shutil.copy(self.bed.folder / name, folder / name)
            read()
            self.assertGreater(refused, 10, name)

    def test_vectors_in_pandas(self) -> None:
        frame = self.bed.particles().to_pandas()
        np.testing.assert_array_equal(frame["velocity_z"], self.bed.particles().velocity[:, 2])


class TestFields(unittest.TestCase):
    """The gas of a short run in three dimensions, and an instrument on its cells."""

    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = Path(tempfile.mkdtemp(prefix="talcum-fields-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        page = (SCRIPTS.parent / "docs/how-to/gas-in-three-dimensions.md").read_text(encoding="utf-8")
        case = cls.folder / "beads.toml"
        case.write_text(re.findall(r"^```toml\n(.*?)^```", page, re.MULTILINE | re.DOTALL)[0], encoding="utf-8")
        changes = {"particles.count": 60, "stage.pour.duration": 0.01, "output.gas": 0.005, "measure.stress.kind": "stress"}
        changes |= {"measure.stress.every": 0.01, "measure.stress.cells": [3, 1, 9]}
        cls.bed = talcum.run(case, set=changes, output=cls.folder / "beads", until=0.02)

    def test_fields_are_those_of_the_file(self) -> None:
        gas = self.bed.gas(0.0151)
        self.assertEqual((round(gas.time, 9), gas.time in self.bed.gas_times), (0.015, True))
        step = int(np.flatnonzero(self.bed.gas_times == gas.time)[0])
        with h5py.File(self.bed.folder / "gas.vtkhdf") as file:
            for name in gas.keys():
                np.testing.assert_array_equal(gas[name], file["VTKHDF/CellData"][name][step])
        self.assertEqual(gas["velocity"].shape, (18, 1, 6, 3))
        np.testing.assert_allclose(gas.x, np.arange(0.0025, 0.03, 0.005), atol=1e-15)
        self.assertEqual((len(gas.y), round(gas.z[-1], 9), gas.units["z"], gas.units["pressure"]), (1, 0.0875, "m", "Pa"))
        self.assertEqual(self.bed.gas().time, 0.02)
        with self.assertRaisesRegex(talcum.ResultsError, "has no field 'presure'; it has pressure, "):
            gas["presure"]
        with self.assertRaisesRegex(talcum.ResultsError, "nothing at time 0.016"):
            self.bed.gas(0.016, exact=True)

    def test_tensors_of_an_instrument(self) -> None:
        stress = self.bed.fields("stress")
        self.assertEqual((stress["contact"].shape, stress["velocity"].shape), ((9, 1, 3, 3, 3), (9, 1, 3, 3)))
        # The vertical component is the third of the third row: that of beads that lie on each other.
        with h5py.File(self.bed.folder / "measure-stress.vtkhdf") as file:
            np.testing.assert_array_equal(stress["contact"][..., 2, 2], file["VTKHDF/CellData/contact"][-1][..., 8])

    @unittest.skipUnless(HAS_PANDAS, "pandas is not installed")
    def test_a_row_for_each_cell(self) -> None:
        gas = self.bed.gas()
        frame = gas.to_pandas()
        self.assertEqual(len(frame), 108)
        row = frame[np.isclose(frame["x"], gas.x[4]) & np.isclose(frame["z"], gas.z[7])]
        self.assertEqual(row["velocity_z"].item(), gas["velocity"][7, 0, 4, 2])
        self.assertEqual(frame.attrs["units"]["pressure"], "Pa")
        self.assertIn("contact_8", self.bed.fields("stress").to_pandas())

    @unittest.skipUnless(HAS_XARRAY, "xarray is not installed")
    def test_dimensions_have_names(self) -> None:
        gas = self.bed.gas()
        fields = gas.to_xarray()
        self.assertEqual(fields.voidage.dims, ("z", "y", "x"))
        upwards = fields.velocity.sel(component="z").sel(x=0.0225, z=0.0375, y=0.002, method="nearest")
        self.assertEqual(float(upwards), gas["velocity"][7, 0, 4, 2])
        self.assertEqual(self.bed.fields("stress").to_xarray().contact.dims, ("z", "y", "x", "row", "component"))


class TestCalls(ScriptTest):
    """Values for `set`, errors of the program, and a program that is not there."""

    def test_values_of_toml(self) -> None:
        for value, expected in [
            (True, "true"),
            (3, "3"),
            (8.0e-6, "8e-06"),
            (float("inf"), "inf"),
            (np.float64(0.5), "0.5"),
            ("a\"b\\c\n\x7f é", '"a\\"b\\\\c\\n\\u007f é"'),
            ("true", '"true"'),
            ((1, 2.5, "x"), '[1, 2.5, "x"]'),
            (np.array([1.0, 2.0]), "[1.0, 2.0]"),
            ({"lower": "wall", "a b": [False]}, '{ lower = "wall", "a b" = [false] }'),
        ]:
            self.assertEqual(toml_value(value, "key"), expected)
            if sys.version_info >= (3, 11):
                import tomllib

                read = tomllib.loads(f"key = {expected}")["key"]
                np.testing.assert_equal(read, list(value) if isinstance(value, (tuple, np.ndarray)) else value)
        with self.assertRaisesRegex(talcum.TalcumError, "set: box.x = None: must be"):
            toml_value(None, "box.x")

    def test_values_reach_the_program(self) -> None:
        case = self.folder / "grains.toml"
        case.write_text(CASE, encoding="utf-8")
        faces = {"lower": "wall", "upper": "open"}
        changes = {"title": 'of "two" \\ words', "box.lengths": [4, 4, 12.5], "box.z": faces}
        report = talcum.check(case, set=changes)
        self.assertIn('of "two" \\ words', report)
        self.assertIn("box: 4 x 4 x 12.5", report)
        self.assertIn("z: lower wall, upper open", report)

    def test_errors_of_a_case_have_file_line_and_key(self) -> None:
        case = self.folder / "bad.toml"
        case.write_text(CASE.replace("restitution = 0.5", "restitution = 1.5"), encoding="utf-8")
        line = 1 + CASE.splitlines().index("restitution = 0.5")
        for attempt in (talcum.check, talcum.run):
            with self.assertRaises(talcum.TalcumError) as caught:
                attempt(case)
            self.assertEqual(str(caught.exception).split(" = ")[0], f"{case}:{line}: contact.restitution")

    def test_wrong_wishes(self) -> None:
        case = self.folder / "grains.toml"
        case.write_text(CASE, encoding="utf-8")
        for words, wish in [
            ("output.seris = 1: unknown key: did you mean series", {"set": {"output.seris": 1}}),
            ("a key must not contain an equals sign", {"set": {"a=b": 1}}),
            ("ranks = 0: must be 1 or more", {"ranks": 0}),
            ("give one of them", {"ranks": 2, "threads": 2}),
        ]:
            with self.assertRaisesRegex(talcum.TalcumError, words):
                talcum.check(case, **wish)
        with self.assertRaisesRegex(talcum.TalcumError, "nowhere.toml"):
            talcum.check(self.folder / "nowhere.toml")
        for call in (talcum.check, talcum.run, talcum.restart, talcum.run_study):
            with self.assertRaisesRegex(talcum.TalcumError, "-h: "):
                call("-h")
        for call in (talcum.run, talcum.restart, talcum.run_study):
            with self.assertRaisesRegex(talcum.TalcumError, "output = '': must be the name of a folder"):
                call(case, output="")

    def test_a_program_that_is_not_there(self) -> None:
        with mock.patch.dict(os.environ, {"TALCUM": "/nowhere/talcum"}):
            with self.assertRaisesRegex(talcum.TalcumError, "/nowhere/talcum: cannot be started"):
                talcum.check("x.toml")
        elsewhere = self.folder / "scripts" / "talcum_results.py"
        nothing = {"TALCUM": "", "PATH": ""}
        with mock.patch.dict(os.environ, nothing), mock.patch("talcum_results.__file__", str(elsewhere)):
            with mock.patch("talcum_results.sysconfig.get_path", return_value=str(self.folder)):
                with self.assertRaisesRegex(talcum.ResultsError, "no program talcum .*TALCUM.*PATH"):
                    talcum.check("x.toml")

    def test_the_error_is_found_among_messages_of_mpirun(self) -> None:
        dashes = "-" * 60
        error = "a.toml:3: box: wrong\na.toml:4: gas: wrong"
        self.assertEqual(error_in(f"[INFO ] begun\nerror: {error}\n{dashes}\nmpirun says\n{dashes}\n", 1), error)
        self.assertEqual(error_in("killed", 137), "the program ended with exit code 137: killed")
        self.assertIn("it printed nothing", error_in("", 9))


class TestFiles(ScriptTest):
    """Made-up files, and files that are not there."""

    def test_missing_files_name_what_makes_them(self) -> None:
        with self.assertRaisesRegex(talcum.ResultsError, "is not a folder of results"):
            talcum.open(self.folder)
        (self.folder / "case.toml").write_text("", encoding="utf-8")
        bed = talcum.open(self.folder)
        self.assertEqual((bed.is_complete, bed.instruments, bed.checkpoints), (False, {}, []))
        for words, read in [
            ("output.series", lambda: bed.series),
            ("output.walls", lambda: bed.walls),
            ("output.energy", lambda: bed.energy),
            ("output.profiles", lambda: bed.profiles),
            ("output.particles", lambda: bed.times),
            (r"\[measure.x\]", lambda: bed.instrument("x")),
            ('kind = "agglomerates"', lambda: bed.agglomerates()),
            ("checkpoint", lambda: bed.digest),
            ("checkpoint", lambda: bed.contacts()),
            ("checkpoint", lambda: bed.checkpoint()),
            ("output.gas", lambda: bed.gas()),
            (r"\[measure.x\] on cells", lambda: bed.fields("x")),
        ]:
            with self.assertRaisesRegex(talcum.ResultsError, words):
                read()

    def test_made_up_series_and_profiles(self) -> None:
        write_profiles(self.folder, np.arange(3.0), np.arange(4.0), np.full((3, 4), 0.5))
        write_series(self.folder, {"time": np.arange(3.0), "bed_top": np.array([5.0, 6.0, 7.0])})
        bed = talcum.open(self.folder)
        self.assertEqual(list(bed.series.between(1.0)["bed_top"]), [6.0, 7.0])
        self.assertEqual(bed.profiles.between(1.0, 2.0).solids_fraction.shape, (2, 4))
        with open(self.folder / "series.csv", "a", encoding="utf-8") as file:
            file.write("1,2\n")
        with self.assertRaisesRegex(talcum.ResultsError, "a row has 2 cells"):
            bed.series

    def test_damaged_files(self) -> None:
        (self.folder / "case.toml").write_text("", encoding="utf-8")
        (self.folder / "particles.vtkhdf").write_bytes(b"no HDF5")
        with mock.patch("talcum.files.PAUSE", 0.0), self.assertRaisesRegex(talcum.ResultsError, "is damaged"):
            talcum.open(self.folder).particles()
        with h5py.File(self.folder / "particles.vtkhdf", "w") as file:
            file["other"] = 1
        with mock.patch("talcum.files.PAUSE", 0.0), self.assertRaisesRegex(talcum.ResultsError, "not such a file of"):
            talcum.open(self.folder).particles()

    def test_a_file_in_the_middle_of_a_write_is_tried_again(self) -> None:
        write_profiles(self.folder, np.arange(3.0), np.arange(4.0), np.full((3, 4), 0.5))
        file = self.folder / "profiles.h5"
        whole = file.read_bytes()
        file.write_bytes(whole[: len(whole) // 2])
        with mock.patch("talcum.files.time.sleep", side_effect=lambda _: file.write_bytes(whole)) as waited:
            self.assertEqual(len(talcum.open(self.folder).profiles.time), 3)
        self.assertEqual(waited.call_count, 1)

    def test_a_library_that_is_not_installed(self) -> None:
        write_series(self.folder, {"time": np.arange(3.0)})
        with mock.patch.dict(sys.modules, {"pandas": None}):
            with self.assertRaisesRegex(talcum.ResultsError, "to_pandas needs .* pip install pandas"):
                talcum.open(self.folder).series.to_pandas()

    def test_matplotlib_is_needed_for_drawing_only(self) -> None:
        code = "import sys, talcum; sys.exit('matplotlib' in sys.modules)"
        paths = {**os.environ, "PYTHONPATH": str(SCRIPTS.parent / "python")}
        self.assertEqual(subprocess.run([sys.executable, "-c", code], env=paths).returncode, 0)

    def test_study(self) -> None:
        with self.assertRaisesRegex(talcum.ResultsError, "runs.csv: there is no such file"):
            talcum.read_study(self.folder)
        (self.folder / "runs.csv").write_text("# study: s\nrun,particles.seed,top [d]\na,1,5\nb,2,7\n")
        points = "# study: s\nbond_number,runs,top [d],top_lower [d],top_upper [d]\n4,2,6,5,7\n"
        (self.folder / "points.csv").write_text(points)
        study = talcum.read_study(self.folder)
        self.assertEqual(study.runs.numbers("top"), [5.0, 7.0])
        estimate = study.points.where(bond_number=4.0).estimates("top")[0]
        self.assertEqual((estimate.mean, estimate.lower, estimate.runs), (6.0, 5.0, 2))
        self.assertEqual(study.points.where(runs=2).units["top_lower"], "d")
        if HAS_PANDAS:
            frame = study.runs.to_pandas()
            self.assertEqual((frame["run"].tolist(), frame["top"].mean(), frame.attrs["units"]["top"]), (["a", "b"], 6.0, "d"))


if __name__ == "__main__":
    unittest.main()
