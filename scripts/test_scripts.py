"""Tests of the scripts on made-up results whose answers are known, with negative controls.

Called by scripts/test; by hand: .venv/bin/python scripts/test_scripts.py. With TALCUM_KEEP_PICTURES=FOLDER the
pictures are kept there, to be looked at.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path
from typing import Callable

SCRIPTS = Path(__file__).resolve().parent
sys.path.insert(0, str(SCRIPTS))

import h5py  # noqa: E402
import numpy as np  # noqa: E402

import cycle  # noqa: E402
import minimum_fluidisation  # noqa: E402
import series  # noqa: E402
import spacetime  # noqa: E402
import talcum_results  # noqa: E402
from talcum_results import ResultsError  # noqa: E402

COLUMNS = {
    "time": "sqrt(d/g)",
    "superficial_velocity": "sqrt(g d)",
    "grid_pressure_drop": "1",
    "gas_force": "1",
    "plate_stress": "1",
    "effective_gravity": "1",
    "centre_height": "d",
    "centre_velocity": "sqrt(g d)",
    "bed_bottom": "d",
    "bed_top": "d",
    "mean_kinetic_energy": "rho_s g d^4",
    "fluctuating_kinetic_energy": "rho_s g d^4",
    "coordination_number": "1",
    "momentum_error": "1",
    "mass_error": "1",
    "particles": "1",
    "departed": "1",
}
CASE = """
units = "dimensionless"
[particles]
diameter = 1.0
density = 1.0
[gravity]
magnitude = 1.0
[gas]
stokes_number = 55
"""
PICTURE = b"\x89PNG"


def write_series(folder: Path, columns: dict[str, np.ndarray]) -> None:
    """Writes a series.csv; columns that are not given are zero."""
    rows = len(columns["time"])
    table = np.column_stack([columns.get(name, np.zeros(rows)) for name in COLUMNS])
    with open(folder / "series.csv", "w", encoding="utf-8") as file:
        file.write("# talcum 0.1.0\n# title: made up\n")
        file.write(",".join(f"{name} [{unit}]" for name, unit in COLUMNS.items()) + "\n")
        for row in table:
            file.write(",".join(repr(float(value)) for value in row) + "\n")


def write_profiles(folder: Path, time: np.ndarray, height: np.ndarray, phi: np.ndarray, case: str = CASE) -> None:
    """Writes a profiles.h5 with units and provenance."""
    data = {
        "time": (time, "sqrt(d/g)"),
        "height": (height, "d"),
        "solids_fraction": (phi, "1"),
        "solids_velocity": (np.zeros_like(phi), "sqrt(g d)"),
        "superficial_velocity": (np.zeros_like(time), "sqrt(g d)"),
    }
    with h5py.File(folder / "profiles.h5", "w") as file:
        file.attrs["title"] = "made up"
        file.attrs["case"] = case
        for name, (values, unit) in data.items():
            file.create_dataset(name, data=values).attrs["unit"] = np.bytes_(unit)


def bed(time: np.ndarray, height: np.ndarray, top: float, wave: Callable) -> np.ndarray:
    """A bed of solids fraction 0.5 plus wave(z, t) below `top`, nothing above."""
    z, t = np.meshgrid(height, time)
    return np.where(z < top, 0.5 + wave(z, t), 0.0)


class ScriptTest(unittest.TestCase):
    """A temporary results folder, and calls of the scripts' main functions."""

    def setUp(self) -> None:
        self.folder = Path(tempfile.mkdtemp(prefix="talcum-scripts-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def call(self, script, *arguments: str) -> str:
        """Runs a script's main on the results folder and returns what it printed."""
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            script.main([str(self.folder), *arguments])
        return printed.getvalue()

    def assert_picture(self, name: str) -> None:
        """A picture was written; it is copied to TALCUM_KEEP_PICTURES if that is set."""
        picture = self.folder / name
        self.assertEqual(picture.read_bytes()[:4], PICTURE)
        self.assertEqual([file for file in self.folder.iterdir() if file.name.startswith(".")], [])
        keep = os.environ.get("TALCUM_KEEP_PICTURES")
        if keep:
            shutil.copy(picture, Path(keep) / f"{self.id().split('.')[-1]}-{name}")


class TestSpacetime(ScriptTest):
    """Waves of known speed, and fluctuations that are no travelling waves."""

    def setUp(self) -> None:
        super().setUp()
        self.time = np.arange(0.0, 150.0, 0.25)
        self.height = np.arange(0.0, 100.1, 1.5)
        self.noise = np.random.default_rng(5)

    def measure(self, wave: Callable, noise: float = 0.03, *arguments: str) -> str:
        """Writes profiles with a wave and noise, and measures them."""
        phi = bed(self.time, self.height, 60.0, wave)
        phi += np.where(phi > 0.0, noise * self.noise.standard_normal(phi.shape), 0.0)
        write_profiles(self.folder, self.time, self.height, phi)
        return self.call(spacetime, *arguments)

    def numbers(self, printed: str) -> tuple[float, float, float, float]:
        """The four numbers of the line that is printed."""
        found = re.search(r"wave speed (\S+) .*wavelength (\S+) .*period (\S+) .*rms of phi (\S+)", printed)
        self.assertIsNotNone(found, printed)
        speed, wavelength, period, rms = (float(value) for value in found.groups())
        return speed, wavelength, period, rms

    def check_wave(self, speed: float, wavelength: float) -> None:
        """A sine wave must be found with its speed, wavelength, period and amplitude."""
        printed = self.measure(lambda z, t: 0.1 * np.sin(2.0 * np.pi * (z - speed * t) / wavelength))
        found = self.numbers(printed)
        # 2 %: the record holds about ten periods, its noise is 0.4 of the signal's rms.
        self.assertAlmostEqual(found[0] / speed, 1.0, delta=0.02)
        self.assertAlmostEqual(found[1] / wavelength, 1.0, delta=0.02)
        self.assertAlmostEqual(found[2] * abs(speed) / wavelength, 1.0, delta=0.02)
        self.assertAlmostEqual(found[3], np.hypot(0.1 / np.sqrt(2.0), 0.03), delta=0.003)

    def test_rising_wave(self) -> None:
        self.check_wave(1.7, 18.0)
        self.assert_picture("spacetime.png")

    def test_wave_longer_than_the_bed(self) -> None:
        self.check_wave(6.0, 90.0)

    def test_sinking_wave_has_a_negative_speed(self) -> None:
        self.check_wave(-1.1, 25.0)

    def test_plugs_and_voids(self) -> None:
        """Narrow voids between dense plugs, as in a real bed, with amplitudes that grow upwards."""
        speed, wavelength = 2.2, 21.0

        def wave(z: np.ndarray, t: np.ndarray) -> np.ndarray:
            return 0.1 - 0.35 * (0.3 + 0.7 * z / 60.0) * np.exp(4 * np.cos(2 * np.pi * (z - speed * t) / wavelength) - 4)

        found = self.numbers(self.measure(wave))
        self.assertAlmostEqual(found[0] / speed, 1.0, delta=0.03)
        self.assertAlmostEqual(found[1] / wavelength, 1.0, delta=0.03)
        self.assert_picture("spacetime.png")

    def test_noise_is_no_wave(self) -> None:
        self.assertIn("no wave found", self.measure(lambda z, t: 0.0 * z, 0.1))
        self.assert_picture("spacetime.png")

    def test_slow_noise_is_no_wave(self) -> None:
        """Noise that remembers, in time and height, may not be taken for a wave."""
        raw = self.noise.standard_normal((len(self.time), len(self.height)))
        window = np.outer(np.hanning(13), np.hanning(7))
        pad = np.fft.irfft2(np.fft.rfft2(raw) * np.fft.rfft2(window, raw.shape), raw.shape)
        self.assertIn("no wave found", self.measure(lambda z, t: 0.05 * pad / pad.std(), 0.0))

    def test_standing_wave_does_not_travel(self) -> None:
        printed = self.measure(lambda z, t: 0.1 * np.sin(2 * np.pi * z / 20.0) * np.sin(2 * np.pi * t / 9.0))
        self.assertIn("no wave found", printed)
        self.assertIn("no direction is preferred", printed)

    def test_bed_that_oscillates_as_a_whole_does_not_travel(self) -> None:
        self.assertIn("no wave found", self.measure(lambda z, t: 0.1 * np.sin(2 * np.pi * t / 6.25)))

    def test_bed_at_rest(self) -> None:
        self.assertIn("no wave found: the bed is at rest", self.measure(lambda z, t: 0.0 * z, 0.0))

    def test_part_of_the_record(self) -> None:
        """A start that settles differently is left out with --from."""

        def wave(z: np.ndarray, t: np.ndarray) -> np.ndarray:
            return np.where(t < 50.0, 0.2 * np.sin(z * t), 0.1 * np.sin(2.0 * np.pi * (z - 1.7 * t) / 18.0))

        printed = self.measure(wave, 0.03, "--from", "50", "--measure", "10", "50", "--height", "70")
        self.assertAlmostEqual(self.numbers(printed)[0], 1.7, delta=0.04)
        with self.assertRaisesRegex(ResultsError, "there are results of times 0 to 149.75"):
            self.call(spacetime, "--from", "1000")
        with self.assertRaisesRegex(ResultsError, "spans 2 heights; 8 are needed"):
            self.call(spacetime, "--measure", "10", "12.5")

    def test_unknown_colour_map(self) -> None:
        with self.assertRaisesRegex(ResultsError, "--colours rainbowish"):
            self.measure(lambda z, t: 0.0 * z, 0.1, "--colours", "rainbowish")


class TestReading(ScriptTest):
    """Results in progress, and files that are not what they should be."""

    def test_rows_not_finished_are_left_out(self) -> None:
        write_series(self.folder, {"time": np.arange(5.0)})
        with open(self.folder / "series.csv", "a", encoding="utf-8") as file:
            file.write(",".join(["7"] * (len(COLUMNS) - 1) + ["1"]))  # all columns, but maybe not all digits
        self.assertEqual(list(talcum_results.read_series(self.folder).time), [0.0, 1.0, 2.0, 3.0, 4.0])

    def test_profile_rows_not_filled_are_left_out(self) -> None:
        times = np.array([0.0, 1.0, 2.0, 0.0, 0.0])
        write_profiles(self.folder, times, np.arange(4.0), np.zeros((5, 4)))
        profiles = talcum_results.read_profiles(self.folder)
        self.assertEqual(profiles.solids_fraction.shape, (3, 4))
        self.assertEqual(profiles.units["height"], "d")

    def test_profiles_open_for_writing_can_be_read(self) -> None:
        write_profiles(self.folder, np.arange(3.0), np.arange(4.0), np.zeros((3, 4)))
        writer = "import h5py, sys; f = h5py.File(sys.argv[1], 'r+'); print('open', flush=True); sys.stdin.read()"
        command = [sys.executable, "-c", writer, str(self.folder / "profiles.h5")]
        with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
            self.assertEqual(process.stdout.readline(), "open\n")
            self.assertEqual(len(talcum_results.read_profiles(self.folder).time), 3)
            process.communicate()

    def test_words_for_bad_files(self) -> None:
        with self.assertRaisesRegex(ResultsError, "there is no such file"):
            talcum_results.read_series(self.folder)
        (self.folder / "profiles.h5").write_bytes(b"no HDF5")
        with self.assertRaisesRegex(ResultsError, "damaged"):
            talcum_results.read_profiles(self.folder)
        with h5py.File(self.folder / "profiles.h5", "w") as file:
            file["time"] = np.zeros(3)
        with self.assertRaisesRegex(ResultsError, "has no dataset height, solids_fraction"):
            talcum_results.read_profiles(self.folder)
        (self.folder / "series.csv").write_text("time [s],a [1]\n1,2\n3,x\n")
        with self.assertRaisesRegex(ResultsError, "row 2 below the header"):
            talcum_results.read_series(self.folder)
        (self.folder / "series.csv").write_text("# only\ntime [s],a [1]\n")
        with self.assertRaisesRegex(ResultsError, "holds no results yet"):
            talcum_results.read_series(self.folder)

    def test_errors_reach_the_user_in_words(self) -> None:
        """Exit code 1 and one line, no traceback; --help works everywhere."""
        for name in ["spacetime", "series", "minimum_fluidisation", "cycle"]:
            script = [sys.executable, str(SCRIPTS / f"{name}.py")]
            wrong = subprocess.run([*script, "/nowhere"], capture_output=True, text=True, timeout=120)
            self.assertEqual((wrong.returncode, wrong.stderr.count("\n")), (1, 1), wrong.stderr)
            self.assertTrue(wrong.stderr.startswith("error: /nowhere"), wrong.stderr)
            usage = subprocess.run([*script, "--help"], capture_output=True, text=True, timeout=120)
            self.assertEqual(usage.returncode, 0)
            self.assertIn("--from", usage.stdout)


class TestSeries(ScriptTest):
    """The panels of a series."""

    def test_picture(self) -> None:
        time = np.arange(0.0, 60.0, 0.25)
        wave = np.sin(time)
        columns = {
            "time": time,
            "plate_stress": np.abs(wave),
            "grid_pressure_drop": 1.0 - 0.3 * wave,
            "effective_gravity": np.ones_like(time),
            "centre_height": 27.0 + wave,
            "bed_top": 55.0 + 2.0 * wave,
            "mean_kinetic_energy": 1e-3 * wave**2,
            "fluctuating_kinetic_energy": 1e-5 * (1.1 + wave),
            "coordination_number": 4.0 + wave,
            "momentum_error": 1e-15 * wave,
        }
        write_series(self.folder, columns)
        self.assertIn("mean coordination number", self.call(series))
        self.assert_picture("series.png")

    def test_picture_of_one_row(self) -> None:
        write_series(self.folder, {"time": np.zeros(1)})
        self.call(series)
        self.assert_picture("series.png")


class TestMinimumFluidisation(ScriptTest):
    """Ramps and steps of a known U_mf, and results without one."""

    def write(self, velocity: np.ndarray, drop: Callable, phi: float = 0.62) -> None:
        """A run of a superficial velocity per time unit, and a bed of a solids fraction."""
        time = np.arange(len(velocity), dtype=float)
        height = np.arange(0.0, 60.1, 1.5)
        profile = np.where(height < 40.0, phi, 0.0)
        profile[0] *= 0.5
        columns = {"time": time, "superficial_velocity": velocity}
        columns["grid_pressure_drop"] = columns["gas_force"] = drop(velocity, time)
        write_series(self.folder, columns)
        write_profiles(self.folder, time, height, np.tile(profile, (len(time), 1)))

    def bed_of(self, least: float) -> Callable:
        """Pressure drop of a bed with U_mf `least`, with 2 % of noise."""
        noise = np.random.default_rng(7)
        return lambda velocity, time: np.minimum(velocity / least, 1.0) + 0.02 * noise.standard_normal(len(time))

    def found(self, printed: str, name: str) -> dict[str, float]:
        """The numbers of a branch's line."""
        line = next(line for line in printed.splitlines() if line.startswith(f"{name}:"))
        return {key: float(value) for key, value in re.findall(r"(U_mf|phi|force balance|ratio) ([\d.eE+-]+)", line)}

    def test_ramp_up_and_down(self) -> None:
        balance = 55.0 / 18.0 * (1.0 - 0.62) ** 4.65
        ramp = np.linspace(0.0, 0.06, 300)
        velocity = np.concatenate([np.zeros(40), ramp, np.full(20, 0.06), ramp[::-1], np.zeros(10)])
        self.write(velocity, self.bed_of(0.97 * balance))
        printed = self.call(minimum_fluidisation)
        for name in ["up", "down"]:
            numbers = self.found(printed, name)
            self.assertAlmostEqual(numbers["phi"], 0.62, delta=1e-3)
            self.assertAlmostEqual(numbers["force balance"], balance, delta=1e-4)
            self.assertAlmostEqual(numbers["ratio"], 0.97, delta=0.01)  # noise of 2 % over 300 rows
        self.assert_picture("minimum_fluidisation.png")

    def test_steps(self) -> None:
        """The first half of a step, in which the bed adapts, must not count."""
        velocity = np.repeat(np.arange(0.0, 0.0601, 0.003), 20)
        still = self.bed_of(0.025)
        self.write(velocity, lambda u, t: still(u, t) * np.where(t % 20 < 10, 0.5, 1.0))
        printed = self.call(minimum_fluidisation, "--pressure-drop", "force", "--scale", "2.0")
        self.assertAlmostEqual(self.found(printed, "up")["U_mf"], 0.025, delta=0.0005)
        self.assertAlmostEqual(self.found(printed, "up")["force balance"], 2.0 * 0.38**4.65, delta=1e-3)

    def test_overshoot_at_the_yield_does_not_count(self) -> None:
        velocity = np.linspace(0.0, 0.06, 400)
        self.write(velocity, lambda u, t: np.where(u < 0.0275, u / 0.025, 1.0))
        self.assertAlmostEqual(self.found(self.call(minimum_fluidisation), "up")["U_mf"], 0.025, delta=0.0002)

    def test_noise_has_no_minimum_fluidisation(self) -> None:
        noise = np.random.default_rng(3)
        self.write(np.linspace(0.0, 0.06, 300), lambda u, t: noise.uniform(0.0, 1.0, len(t)))
        with self.assertRaisesRegex(ResultsError, "no minimum fluidisation found|too few"):
            self.call(minimum_fluidisation)

    def test_fixed_bed_only(self) -> None:
        self.write(np.linspace(0.0, 0.02, 300), self.bed_of(0.025))
        with self.assertRaisesRegex(ResultsError, "plateau"):
            self.call(minimum_fluidisation)

    def test_constant_velocity(self) -> None:
        self.write(np.full(50, 0.1), self.bed_of(0.025))
        with self.assertRaisesRegex(ResultsError, "constant"):
            self.call(minimum_fluidisation)

    def test_velocity_scale_in_si(self) -> None:
        case = {
            "units": "si",
            "particles": {"diameter": 50e-6, "density": 900.0},
            "gravity": {"magnitude": 9.81},
            "gas": {"viscosity": 1.8e-5},
        }
        # rho_s g d^2 / (18 mu) = 900 * 9.81 * 2.5e-9 / 3.24e-4
        self.assertAlmostEqual(minimum_fluidisation.velocity_scale(case, None, None), 0.0681250, places=7)


class TestCycle(ScriptTest):
    """A plate of known frequency and Gamma, and one at rest."""

    def write(self, gamma: float, frequency: float, start: float = 3.1, interval: float = 0.1) -> None:
        """A bed that leaves the plate while the effective gravity is negative."""
        time = np.arange(0.0, 120.0, interval)
        gravity = 1.0 + gamma * np.sin(2.0 * np.pi * frequency * (time - start))
        noise = 0.05 * np.random.default_rng(11).standard_normal(len(time))
        columns = {
            "time": time,
            "effective_gravity": gravity,
            "plate_stress": np.maximum(gravity, 0.0),
            "grid_pressure_drop": np.minimum(gravity, 0.0) + noise,
            "bed_bottom": np.maximum(-gravity, 0.0),
        }
        write_series(self.folder, columns)

    def test_known_vibration(self) -> None:
        self.write(3.0, 0.16)
        found = re.search(r"f (\S+), Gamma (\S+), (\S+) cycles.*Gamma sin (\S+)", self.call(cycle))
        frequency, gamma, cycles, difference = (float(value) for value in found.groups())
        self.assertAlmostEqual(frequency, 0.16, places=5)
        self.assertAlmostEqual(gamma, 3.0, places=3)
        self.assertAlmostEqual(cycles, 19.2, delta=0.05)
        self.assertLess(difference, 0.03)  # noise of 0.05 averaged over 19 cycles, and the width of a bin
        self.assert_picture("cycle.png")

    def test_phase(self) -> None:
        """Phase 0 is where the effective gravity passes 1 upwards."""
        self.write(2.0, 0.1)
        results = talcum_results.read_series(self.folder)
        vibration = cycle.find_vibration(results, None)
        mean = cycle.average_over_phase(results, vibration, 40)
        self.assertAlmostEqual(mean.mean["effective_gravity"][mean.phase == 0.25][0], 3.0, delta=0.02)
        self.assertAlmostEqual(mean.mean["effective_gravity"][mean.phase == 0.75][0], -1.0, delta=0.02)

    def test_few_rows_at_equal_phases(self) -> None:
        """25 rows in every cycle: no phase is left out, none is drawn twice."""
        self.write(3.0, 0.16, 0.0, 0.25)
        self.call(cycle, "--bins", "50")
        results = talcum_results.read_series(self.folder)
        mean = cycle.average_over_phase(results, cycle.find_vibration(results, 0.16), 50)
        self.assertEqual(len(mean.phase), 25)
        theory = 1.0 + 3.0 * np.sin(2.0 * np.pi * mean.phase)
        np.testing.assert_allclose(mean.mean["effective_gravity"], theory, atol=1e-6)

    def test_words_for_what_cannot_be_averaged(self) -> None:
        self.write(0.0, 0.16)
        with self.assertRaisesRegex(ResultsError, "does not vibrate"):
            self.call(cycle)
        self.write(3.0, 0.16, 0.0, 1.0)
        with self.assertRaisesRegex(ResultsError, "rows per cycle are too few"):
            self.call(cycle)
        self.write(3.0, 0.16)
        with self.assertRaisesRegex(ResultsError, "cycles; at least 2"):
            self.call(cycle, "--to", "10")
        with self.assertRaisesRegex(ResultsError, "no sine of frequency"):
            self.call(cycle, "--frequency", "0.3")


FAKE_TALCUM = """#!/usr/bin/env bash
# Counts its calls; the first two stop at a signal with a newer checkpoint, the third completes the run.
output=$4
mkdir -p "$output"
calls=$(ls "$output"/checkpoint-*.h5 2>/dev/null | wc -l)
echo "$@" >>"$output/calls"
[ "$FAKE" = fail ] && exit 3
[ "$FAKE" = stuck ] && exit 0
if [ "$calls" -ge 2 ]; then touch "$output/complete"; echo "digest 0123"; exit 0; fi
trap 'sleep 0.5; touch "$output/checkpoint-00000000000$calls.h5"; echo stopped; exit 0' USR1
touch "$output/ready"
while :; do sleep 0.05; done
"""


class TestSlurmScript(ScriptTest):
    """jobs/talcum.slurm with stand-ins for srun, scontrol and talcum."""

    def setUp(self) -> None:
        super().setUp()
        self.tools = self.folder / "tools"
        self.tools.mkdir()
        self.program("srun", '#!/usr/bin/env bash\nexec "$@"\n')
        self.program("scontrol", f'#!/usr/bin/env bash\necho "$@" >>"{self.folder}/requeued"\n')
        self.program("talcum", FAKE_TALCUM)
        (self.folder / "case.toml").write_text("")
        self.output = self.folder / "output"

    def program(self, name: str, text: str) -> None:
        """Makes a stand-in that is found first."""
        (self.tools / name).write_text(text)
        (self.tools / name).chmod(0o755)

    def job(self, warning: signal.Signals | None, fake: str = "") -> tuple[int, str]:
        """Runs the job script, warns it once the run has begun, and returns exit code and output."""
        environment = os.environ | {
            "PATH": f"{self.tools}:{os.environ['PATH']}",
            "TALCUM": str(self.tools / "talcum"),
            "SLURM_JOB_ID": "17",
            "FAKE": fake,
        }
        command = ["bash", str(SCRIPTS.parent / "jobs/talcum.slurm"), str(self.folder / "case.toml"), str(self.output)]
        (self.output / "ready").unlink(missing_ok=True)
        with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as job:
            if warning is not None:
                for _ in range(400):
                    if (self.output / "ready").exists():
                        break
                    time.sleep(0.025)
                job.send_signal(warning)
            printed, _ = job.communicate(timeout=60)
        return job.returncode, printed

    def requeued(self) -> list[str]:
        """What scontrol was asked for."""
        file = self.folder / "requeued"
        return file.read_text().splitlines() if file.exists() else []

    def test_run_in_three_parts(self) -> None:
        for part in [1, 2]:
            code, printed = self.job(signal.SIGUSR1)
            self.assertEqual(code, 0, printed)
            self.assertIn("into the queue again", printed)
            self.assertEqual(self.requeued(), ["requeue 17"] * part)
        code, printed = self.job(None)
        self.assertEqual((code, len(self.requeued())), (0, 2), printed)
        self.assertIn("digest 0123", printed)
        self.assertIn("complete", self.job(None)[1])  # and nothing is run again
        calls = (self.output / "calls").read_text().splitlines()
        self.assertEqual(calls, [f"run {self.folder}/case.toml --output {self.output} --resume"] * 3)

    def test_failure_is_not_queued_again(self) -> None:
        code, printed = self.job(None, "fail")
        self.assertEqual((code, self.requeued()), (3, []), printed)

    def test_no_progress_is_not_queued_again(self) -> None:
        code, printed = self.job(None, "stuck")
        self.assertEqual((code, self.requeued()), (1, []), printed)
        self.assertIn("without a newer checkpoint", printed)

    def test_cancelled_job_is_not_queued_again(self) -> None:
        code, printed = self.job(signal.SIGTERM)
        self.assertEqual((code, self.requeued()), (0, []), printed)
        self.assertIn("ended from outside", printed)
        self.assertTrue((self.output / "checkpoint-000000000000.h5").exists())


if __name__ == "__main__":
    unittest.main(verbosity=1)
