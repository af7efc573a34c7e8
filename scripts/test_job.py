"""Tests of the Slurm script in jobs/, with stand-ins for Slurm and talcum."""

from __future__ import annotations

import os
import signal
import subprocess
import time
import unittest

from made_up_results import SCRIPTS, ScriptTest

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

    def job(self, warning: signal.Signals | None, fake: str = "", options: tuple[str, ...] = ()) -> tuple[int, str]:
        """Runs the job script, warns it once the run has begun, and returns exit code and output."""
        environment = os.environ | {
            "PATH": f"{self.tools}:{os.environ['PATH']}",
            "TALCUM": str(self.tools / "talcum"),
            "SLURM_JOB_ID": "17",
            "FAKE": fake,
        }
        script = SCRIPTS.parent / "jobs/talcum.slurm"
        command = ["bash", str(script), str(self.folder / "case.toml"), str(self.output), *options]
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

    def test_options_go_to_talcum(self) -> None:
        self.job(None, "fail", ("--set", "gas.kind=column", "--until", "3.0"))
        calls = (self.output / "calls").read_text().splitlines()
        options = "--resume --set gas.kind=column --until 3.0"
        self.assertEqual(calls, [f"run {self.folder}/case.toml --output {self.output} {options}"])

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


class TestScalingScript(ScriptTest):
    """jobs/scaling.slurm with stand-ins for srun and talcum."""

    def test_ranks_beds_and_table(self) -> None:
        tools = self.folder / "tools"
        tools.mkdir()
        said = "stage ends: 9 steps, 8.00 million particle-steps/s\ndigest 0123"
        (tools / "srun").write_text(f'#!/usr/bin/env bash\necho "ranks: $*" >>"{self.folder}/calls"\necho "{said}"\n')
        (tools / "srun").chmod(0o755)
        environment = os.environ | {
            "PATH": f"{tools}:{os.environ['PATH']}", "SLURM_NTASKS": "4", "SLURM_SUBMIT_DIR": str(self.folder),
            "SLURM_JOB_ID": "17",
        }  # fmt: skip
        command = ["bash", str(SCRIPTS.parent / "jobs/scaling.slurm"), "100"]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60, check=True)
        rows = [line.split(" | ") for line in done.stdout.splitlines()[2:]]
        self.assertEqual([row[:3] for row in rows], [
            ["| weak", "1", "16000"], ["| weak", "2", "32000"], ["| weak", "4", "64000"],
            ["| strong", "1", "64000"], ["| strong", "2", "64000"], ["| strong", "4", "64000"],
        ])  # fmt: skip
        self.assertEqual(rows[2][3:], ["8.00", "2.000", "0123 |"])
        calls = (self.folder / "calls").read_text().splitlines()
        self.assertIn("-n 4 ", calls[2])
        self.assertIn("--ranks 2,2,1 --set box.lengths=[40.0, 40.0, 60.0] --set particles.count=64000", calls[2])
        self.assertIn("--set time.end=0.025", calls[2])


if __name__ == "__main__":
    unittest.main()
