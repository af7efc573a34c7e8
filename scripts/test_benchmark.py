"""Tests of scripts/benchmark: what is read off programs, decks, states and tables; nothing is measured."""

from __future__ import annotations

import json
import re
import unittest
from dataclasses import replace
from pathlib import Path
from unittest import mock

import numpy as np

from benchmark import (
    agreement, coupled, floor, gas, instructions, instruments, kernels, peers, processor, ranks, runs, scaling, states, tables
)  # fmt: skip
from benchmark.beds import BEDS, ROOT, ContactLaw, beds_named
from benchmark.states import Particles
from made_up_results import ScriptTest

TALCUM_SAYS = """[INFO ] stage "settled" ends: 1000 steps, 7.60 million particle-steps/s, 7.91 at the median step
1000 steps in 3 s: 7.55 million particle-steps/s, 7.55 per rank
stage                      seconds   share     largest over mean
integrate                     0.18   5.7 %                  1.00
gas force                     0.04  94.3 %                  1.25
complete at time 25.25; the end state is in checkpoint-000000101000.h5
digest 9b7025bd5cf6209a24ad1192757b13fe
"""
LAMMPS_SAYS = """Step KinEng c_spin v_centre c_top
       0 0.00016635464  0.023199357    25.872626    51.826681
     500 0.00035026766  0.023296233    25.872507    51.826496
Loop time of 8 on 1 procs for 500 steps with 24000 atoms
Step KinEng c_spin v_centre c_top
    1500  0.0010349164  0.023270983    25.872605    51.826648
Loop time of 2.5 on 1 procs for 1000 steps with 24000 atoms
"""


def small_bed() -> Particles:
    """Two particles, one of them on the plate, in a box of 4 x 5 x 6."""
    position = np.array([[0.1, 0.2, 0.5], [3.0, 4.0, 1.5]])
    motion = np.arange(12.0).reshape(2, 6)
    return Particles(np.array([4.0, 5.0, 6.0]), position, motion[:, :3], motion[:, 3:], np.ones(2))


class TestReadingPrograms(unittest.TestCase):
    """Rates, stages, digests and energies."""

    def test_talcum(self) -> None:
        found = runs.read_talcum(TALCUM_SAYS)
        self.assertEqual((found.rate, found.median_rate), (7.60, 7.91))
        self.assertEqual(found.digest, "9b7025bd5cf6209a24ad1192757b13fe")
        self.assertEqual(found.stages, {"integrate": 0.057, "gas force": 0.943})
        self.assertEqual(found.imbalance["gas force"], 1.25)

    def test_the_last_loop_of_a_peer_counts(self) -> None:
        self.assertAlmostEqual(runs.read_peer(LAMMPS_SAYS).rate, 9.6)
        self.assertEqual(agreement.last_thermo_row(LAMMPS_SAYS).kinetic_energy, 0.0010349164)

    def test_words_without_numbers_are_an_error(self) -> None:
        for read in (runs.read_talcum, runs.read_peer, agreement.last_thermo_row):
            with self.assertRaises(runs.BenchmarkError):
                read("Segmentation fault")

    def test_a_program_that_fails_is_an_error_with_its_words(self) -> None:
        with self.assertRaisesRegex(runs.BenchmarkError, "no such bed"):
            runs.execute(["sh", "-c", "echo no such bed; exit 3"])

    def test_waiting_for_a_core_is_distinguished_from_sleeping(self) -> None:
        seen = runs.Watched(ran={1: (900, 100), 2: (1000, 0)}, memory=[5.0] * 5 + [7.0] * 4 + [9.0])
        self.assertEqual((seen.share_of_cores, seen.usual_memory), (0.95, 7.0))


class TestInstructions(unittest.TestCase):
    def counted(self, *factors: float) -> str:
        """What is said if the kept beds take these factors of the instructions that are kept."""
        kept = json.loads(instructions.KEPT.read_text(encoding="utf-8")).values()
        counts = [factor * before for factor, before in zip(factors, kept)]
        with (
            mock.patch.object(instructions, "state"),
            mock.patch.object(instructions, "per_particle_step", side_effect=counts),
        ):
            return instructions.require_kept()

    def test_more_instructions_than_kept_are_an_error_that_names_the_bed(self) -> None:
        self.assertEqual(len(self.counted(1.0, 1.009, 0.5).splitlines()), 5)
        with self.assertRaisesRegex(runs.BenchmarkError, "^3,000 settled, gas and cohesion: more than 1 %"):
            self.counted(1.0, 1.011, 1.0)


class TestPlaces(unittest.TestCase):
    def test_each_part_has_its_place_in_the_tables(self) -> None:
        text = (ROOT / "docs" / "performance-tables.md").read_text(encoding="utf-8")
        # `__main__` measures when it is imported.
        source = (ROOT / "scripts" / "benchmark" / "__main__.py").read_text(encoding="utf-8")
        parts = re.findall(r'^    "([a-z]+)": ', source, re.MULTILINE)
        self.assertGreater(len(parts), 10)
        for part in parts:
            self.assertIn(f"<!-- {part} -->\n", text)
            self.assertIn(f"<!-- end of {part} -->", text)


class TestInstruments(unittest.TestCase):
    """What instruments cost."""

    def test_each_kind_stands_in_the_case_and_looks_at_the_interval(self) -> None:
        text = instruments.case_with(list(instruments.KINDS), 100)
        self.assertEqual(text.count("[measure."), len(instruments.KINDS))
        self.assertEqual(text.count("every = 0.025\n"), len(instruments.KINDS))
        self.assertNotIn("[measure.", instruments.case_with([], 100))

    def test_a_share_is_over_all_other_phases(self) -> None:
        run = runs.Measured(1.0, stages={"contact forces": 0.6, "instruments": 0.1, "output": 0.3})
        self.assertAlmostEqual(instruments.share(run), 0.1 / 0.6)
        self.assertEqual(instruments.share(runs.Measured(1.0, stages={"contact forces": 1.0})), 0.0)


class TestGas(unittest.TestCase):
    """Beds in a volume-averaged gas, and the step of the gas itself."""

    def test_the_time_of_all_steps_is_read(self) -> None:
        words = "40 steps in 6 s: 0.20 million particle-steps/s\ncoarse-grain, gas             5.12  99.1 %   1.00\n"
        self.assertAlmostEqual(gas.seconds_of_gas(words, 40), 5.12)
        for steps, said in ((40, "nothing"), (41, words)):
            with self.assertRaisesRegex(ValueError, "how the time of 4. steps divides"):
                gas.seconds_of_gas(said, steps)

    def test_the_start_of_a_run_does_not_count(self) -> None:
        with mock.patch.object(gas, "run", lambda edge, steps, first: 3.0 + 0.5 * steps):
            self.assertAlmostEqual(gas.measure(64, False), 0.5 / 64**3)

    def test_a_particle_stands_in_each_cell_of_the_lowest_eighth(self) -> None:
        text = gas.case_text(64, 30)
        self.assertIn("count = 32768\n", text)
        self.assertIn("lengths = [80.0, 80.0, 80.0]\n", text)

    def test_cases_are_there_and_have_as_many_particles_as_the_table_says(self) -> None:
        for bed in coupled.COUPLED:
            found = re.search(r"^count = ([\d_]+)", (ROOT / bed.case).read_text(encoding="utf-8"), re.MULTILINE)
            self.assertEqual(found and int(found[1]), bed.particles, bed.case)

    def test_a_row_compares_runs_of_the_same_round(self) -> None:
        alone = [runs.Measured(20.0), runs.Measured(10.0), runs.Measured(16.0)]
        two = [runs.Measured(30.0, stages={"contact forces": 0.4}), runs.Measured(18.0), runs.Measured(24.0)]
        row = coupled.line(coupled.COUPLED[0], 2, two, alone, [0.9 * run.rate for run in alone])
        self.assertEqual(row[1:7], ["2", "24.00", "12.00", "0.75", "-", "0.90"])
        self.assertEqual(coupled.line(coupled.COUPLED[0], 1, alone, alone, [])[4:7], ["1.00", "-", "-"])


class TestRanks(unittest.TestCase):
    """Strong and weak scaling, from rates that are given."""

    def test_efficiency_is_the_rate_per_rank_over_that_of_the_bed_beside(self) -> None:
        wanted = [row for row in ranks.rows(2) if "24,000" in row.bed.name and "agitated" not in row.bed.name]
        rates = {("24,000 settled", 1): 20.0, ("24,000 settled", 2): 38.0, ("24,000 per rank, settled", 2): 30.0}
        found: ranks.Rates = {}
        for row in wanted:
            ours = rates[row.bed.name, row.bed.ranks]
            found[tables.TALCUM, row.bed] = [runs.Measured(ours, 1.1 * ours if row.bed.ranks == 1 else 1.2 * ours)]
            found[tables.LAMMPS, row.bed] = [runs.Measured(5.0 if row.bed.ranks == 1 else 8.0)]
            if row.bed.ranks > 1:
                found[ranks.COPIES, row.bed] = [runs.Measured(18.0)]
        lines = ranks.scaling_table(wanted, found).splitlines()[2:]
        expected = "| 24,000 settled | 2 | 38.00 | 19.00 | 24,000 settled | 0.95 | 1.04 | 0.90 | 0.0 % | 0.80 | 4.75 |"
        self.assertEqual(lines[1], expected)
        self.assertEqual(lines[2].split(" | ")[5:6], ["0.75"])
        del found[tables.LAMMPS, wanted[0].bed]
        self.assertIn("| - |", ranks.scaling_table(wanted, found).splitlines()[3])

    def test_the_largest_bed_stands_beside_one_out_of_cache_and_without_peers(self) -> None:
        largest = [row for row in ranks.rows(2) if row.bed.particles > 1_000_000]
        self.assertEqual([row.bed.ranks for row in largest], [1, 2])
        self.assertTrue(all(row.beside.particles == 216_000 and not row.with_peers for row in largest))
        self.assertEqual([row.bed.ranks for row in ranks.rows(1)], [1] * 5)


class TestDecks(ScriptTest):
    """The peers are given Talcum's law."""

    def test_the_law_is_that_of_the_cases(self) -> None:
        law = ContactLaw()
        for case in (ROOT / "cases" / "benchmark").glob("bed-*.toml"):
            text = case.read_text(encoding="utf-8")
            names = ("normal_stiffness", "poisson_ratio", "restitution", "friction")
            found = [float(re.search(rf"^{name} = (.*)$", text, re.MULTILINE)[1]) for name in names]
            self.assertEqual(found, [law.normal_stiffness, law.poisson_ratio, law.restitution, law.friction])

    def test_the_dashpot_gives_the_restitution(self) -> None:
        # x'' = -(k/m*) x - gamma x': the speed falls by exp(-gamma T / 2) over half a period T.
        law, reduced = ContactLaw(), 0.25 * np.pi / 3.0
        gamma = law.pair_damping
        period = np.pi / np.sqrt(law.normal_stiffness / reduced - 0.25 * gamma**2)
        self.assertAlmostEqual(np.exp(-0.5 * gamma * period), law.restitution, places=12)
        # Negative control: the dashpot of the wall is another.
        self.assertNotAlmostEqual(np.exp(-0.5 * law.wall_damping * period), law.restitution, places=3)

    def test_decks_are_complete(self) -> None:
        for bed in BEDS:
            for peer in peers.PEERS:
                text = peers.deck(peer, bed, Path("bed.data"), 0.05)
                self.assertIn(f"run {bed.steps}", text)
                self.assertEqual("*sin(" in text, bed.vibration is not None)
        with self.assertRaisesRegex(ValueError, "@skin@"):
            peers.fill("neighbor @skin@ bin", {})

    def test_data_files_keep_the_bits(self) -> None:
        bed, path = small_bed(), self.folder / "bed.data"
        states.write_lammps_data(bed, 2, 7.0, path)
        text = path.read_text(encoding="utf-8")
        self.assertIn("2 atoms\n2 atom types\n\n0 4.0 xlo xhi\n0 5.0 ylo yhi\n0 7.0 zlo zhi\n", text)
        self.assertIn("1 1 1.0 1.0 0.1 0.2 0.5\n", text)
        self.assertIn("2 6.0 7.0 8.0 9.0 10.0 11.0\n", text)


class TestStates(ScriptTest):
    """Beds made of the settled one."""

    def test_tiles_keep_distances_and_fill_the_box(self) -> None:
        bed = states.tiled(small_bed(), (3, 3))
        self.assertEqual(bed.count, 18)
        self.assertEqual(bed.box.tolist(), [12.0, 15.0, 6.0])
        self.assertEqual(len(np.unique(bed.position.round(9), axis=0)), 18)
        self.assertTrue((bed.position < bed.box).all())

    def test_agitated(self) -> None:
        bed = replace(small_bed(), velocity=np.zeros((2, 3)))
        agitated = states.agitated(bed)
        # The lowest stays on the plate, the other is lifted by a tenth of its height above it.
        np.testing.assert_allclose(agitated.position[:, 2], [0.5, 1.6])
        many = Particles(bed.box, np.ones((9000, 3)), np.zeros((9000, 3)), np.zeros((9000, 3)), np.ones(9000))
        # Its standard error is T sqrt(2 / 27000) = 0.0009.
        self.assertAlmostEqual(float(np.mean(states.agitated(many).velocity ** 2)), 0.1, delta=0.004)

    def test_case_and_file(self) -> None:
        csv, case = self.folder / "bed.csv", self.folder / "bed.toml"
        states.write_csv(small_bed(), csv)
        states.write_case(small_bed(), csv, case)
        self.assertEqual(csv.read_text(encoding="utf-8").splitlines()[1], "0,0.1,0.2,0.5,0.0,1.0,2.0,3.0,4.0,5.0,1.0")
        text = case.read_text(encoding="utf-8")
        self.assertEqual(states.box_lengths(text).tolist(), [4.0, 5.0, 6.0])
        self.assertIn("normal_stiffness = 2.0e5", text)
        self.assertNotIn("[cohesion]", text)

    def test_settled_times(self) -> None:
        self.assertEqual(states.settled_time(states.CASES / "bed-24000.toml"), 25.0)


class TestTables(ScriptTest):
    """Medians, ratios and their place."""

    def test_ratios_are_of_runs_of_the_same_round(self) -> None:
        self.assertEqual(tables.ratio([4.0, 9.0, 2.0], [2.0, 3.0, 2.0]), 2.0)
        self.assertIsNone(tables.ratio([1.0], []))

    def test_rates(self) -> None:
        run = {"rate": 20.0, "stages": {"contact forces": 0.8}, "imbalance": {"contact forces": 1.1}}
        results = {"24,000 settled": {"Talcum": [run], tables.LAMMPS: [run | {"rate": 10.0}]}}
        results["24,000 settled, 2 ranks"] = {"Talcum": [run | {"rate": 38.0}]}
        beds = [bed for bed in BEDS if bed.name in results]
        rows = tables.rate_table(beds, results).splitlines()
        self.assertEqual(rows[2], "| 24,000 settled | 20.00 | 20.00 | 10.00 | 2.00 | 2.5 | - |")
        self.assertEqual(rows[3], "| 24,000 settled, 2 ranks | 38.00 | 19.00 | - | - | 2.4 | 1.90 |")
        self.assertIn("| 80.0 | 1.10 |", tables.stage_table(beds, results))

    def test_markers(self) -> None:
        path = self.folder / "page.md"
        path.write_text("above\n<!-- beds -->\nold\n<!-- end of beds -->\nbelow\n", encoding="utf-8")
        tables.write_between_markers(path, "beds", "new")
        expected = "above\n<!-- beds -->\n\nnew\n\n<!-- end of beds -->\nbelow\n"
        self.assertEqual(path.read_text(encoding="utf-8"), expected)
        with self.assertRaisesRegex(ValueError, "no place"):
            tables.write_between_markers(path, "others", "new")

    def test_beds_by_name(self) -> None:
        self.assertEqual([bed.name for bed in beds_named(["24000 ranks"])], ["24,000 settled, 2 ranks"])
        self.assertEqual(beds_named([]), list(BEDS))
        with self.assertRaisesRegex(ValueError, "no bed"):
            beds_named(["5000"])


class TestModels(ScriptTest):
    """The scaling model, the floor, and what criterion writes."""

    def test_ghosts_of_columns_and_cubes(self) -> None:
        load = scaling.Load(particles=24_000)
        side, _, height = load.sides
        self.assertAlmostEqual(side * side * height * load.density, 24_000)
        first, second = load.ghosts_per_message()
        self.assertAlmostEqual(first, load.density * scaling.LAYER * side * height)
        self.assertAlmostEqual(second / first, 1.0 + 2.0 * scaling.LAYER / side)
        self.assertEqual(len(replace(load, columns=False).ghosts_per_message()), 3)

    def test_a_rank_alone_only_computes(self) -> None:
        load, network = scaling.Load(particles=1_000.0, gas_nodes=70), scaling.Network()
        parts = scaling.step_parts(load, 1, network)
        self.assertEqual([name for name, seconds in parts.items() if seconds > 0.0], ["compute"])

    def test_only_latencies_grow_with_the_ranks(self) -> None:
        load, network = scaling.Load(particles=1_000.0, gas_nodes=70), scaling.Network()
        few, many = (scaling.step_parts(load, ranks, network) for ranks in (1_000, 1_000_000))
        # Twice as many rounds of reductions and of the barriers; messages are those of the blocks around, with more time to arrive.
        self.assertEqual(*(load.blocks_ahead(ranks) for ranks in (1_000, 1_000_000)))
        self.assertLessEqual(many["halo"], few["halo"])
        self.assertAlmostEqual(many["decide"], 2.0 * few["decide"])
        self.assertLess(many["rebuild"], 2.0 * few["rebuild"])
        latencies = (2 + scaling.REDUCTIONS_PER_REBUILD) * 10 * network.latency
        grown = load.steps_per_rebuild * (many["rebuild"] - few["rebuild"])
        self.assertAlmostEqual(grown / latencies, 1.0, places=2)

    def test_what_a_sum_over_the_bed_takes_beyond_decide_is_waited_for(self) -> None:
        load, network = scaling.Load(particles=1_000.0, gas_nodes=70), scaling.Network()
        left = scaling.gas_sum(load, 1_000, network)
        decide = network.all_reduce(1_000, scaling.DECISION_BYTES)
        self.assertAlmostEqual(left + decide, network.all_reduce(1_000, 16 * 70))
        # Numbers that are as few as those of decide come with these.
        self.assertEqual(scaling.gas_sum(replace(load, gas_nodes=4), 1_000, network), 0.0)

    def test_velocities_travel_while_ranks_decide_and_forces_while_pairs_are_computed(self) -> None:
        load, network = scaling.Load(particles=100_000.0), scaling.Network()
        # What a processor does for eight messages, four each way, and what the velocities take beyond the decision.
        processor = 8 * network.overhead
        beyond = scaling.travel(load, network) - network.all_reduce(64, scaling.DECISION_BYTES)
        self.assertGreater(beyond, 0.0)
        self.assertAlmostEqual(scaling.halo(load, 64, network), processor + beyond)
        # A network that is slow enough is waited for.
        slow = scaling.Network(node_bandwidth=9.2e7)
        waited = scaling.halo(load, 64, slow)
        self.assertGreater(waited, 2.0 * processor)
        self.assertLess(waited, 2.0 * scaling.travel(load, slow) + processor)

    def test_shared_pairs_and_copies_of_a_cube(self) -> None:
        load = scaling.Load(particles=8_000.0, columns=False)
        side = load.sides[0]
        self.assertAlmostEqual(load.shared_pairs, 3.0 / side)
        self.assertAlmostEqual(load.copies, 0.5 * load.density * ((side + 2.0 * scaling.LAYER) ** 3 - side**3))

    def test_samples_in_the_program_are_computing(self) -> None:
        report = """# Overhead;     Samples;Shared Object  ;Symbol
 35.92% ; 6287       ;talcum         ;[.] talcum::numbers::simd::avx2::run
  3.83% ; 671        ;libc.so.6      ;[.] __memmove_avx_unaligned_erms
  2.71% ; 13         ;talcum         ;[.] talcum::parallel::particle_halo::ParticleHalo::begin
"""
        self.assertEqual(processor.samples(report, "talcum"), 6300)
        self.assertEqual(processor.samples(report, "libmpi.so"), 0)
        with self.assertRaisesRegex(runs.BenchmarkError, "no samples"):
            processor.samples("# no lines", "talcum")

    def test_what_copies_cost_beyond_the_share_of_one_rank(self) -> None:
        # Of a column of 10 x 10 there are copies in half of the layer around it.
        around = (10.0 + 2.0 * scaling.LAYER) ** 2 - 10.0**2
        held = 0.5 * scaling.PART_IN_PAIRS * 60.0 * around
        self.assertAlmostEqual(processor.copies(4), held)
        self.assertEqual(processor.copies(1), 0.0)
        # A particle takes 25 ns, and each copy half of that.
        lines = processor.table_of({1: 600e-6, 4: 150e-6 + 12.5e-9 * held}).splitlines()
        self.assertTrue(lines[2].endswith("| 600.0 | 600.0 | 0 | - |"))
        self.assertTrue(lines[3].endswith(f"| 150.0 | {held:.0f} | 0.50 |"), lines[3])

    def test_copies_cost_the_more_the_smaller_blocks_are(self) -> None:
        def over_compute(particles: float) -> float:
            parts = scaling.step_parts(scaling.Load(particles=particles), 64, scaling.Network())
            return parts["copies"] / parts["compute"]

        load = scaling.Load(particles=1_000.0)
        self.assertAlmostEqual(over_compute(1_000.0), scaling.COPY_COST * scaling.PART_IN_PAIRS * load.copies / 1_000.0)
        self.assertGreater(over_compute(1_000.0), 3.0 * over_compute(10_000.0))

    def test_the_sweep_over_everything_needs_least(self) -> None:
        self.assertLess(floor.FUSED.size, sum(each.size for each in floor.PASSES))
        self.assertGreater(floor.FUSED.flops, floor.CONTACTS * floor.CONTACT_FLOPS)

    def test_criterion(self) -> None:
        for size, time in (1_000, 5_000.0), (125_000, 1_250_000.0):
            folder = self.folder / "step" / f"pairs_{size}" / "new"
            folder.mkdir(parents=True)
            what = {"group_id": "step", "function_id": f"pairs per contact/{size}", "throughput": {"Elements": size}}
            (folder / "benchmark.json").write_text(json.dumps(what))
            (folder / "estimates.json").write_text(json.dumps({"median": {"point_estimate": time}}))
        found = kernels.read_criterion(self.folder)
        self.assertEqual(found, {"step: pairs per contact": {1_000: 5.0, 125_000: 10.0}})
        self.assertIn("| step: pairs per contact | 1,000 | 5.00 | 125,000 | 10.00 |", kernels.kernel_table(found))
        with self.assertRaisesRegex(runs.BenchmarkError, "no results"):
            kernels.read_criterion(self.folder / "nothing")


if __name__ == "__main__":
    unittest.main()
