"""A process that reads one case after another, so that a case costs a millisecond rather than the start of a program."""

from __future__ import annotations

import json
import os
import selectors
import subprocess
from dataclasses import dataclass
from pathlib import Path

from .program import Broken, Context, limit_memory

# A case is read, and a small bed of it made, within so many seconds of processor time, or something has gone astray; and
# within so many turns of a second, in case that it waits for something.
LONGEST, MOST_TURNS = 5.0, 60


@dataclass
class CaseReader:
    """The process, and how to ask it."""

    process: subprocess.Popen[bytes]

    @staticmethod
    def of(context: Context) -> "CaseReader":
        """The process of these attempts; a new one is started if the last has ended."""
        reader = context.case_reader
        if not isinstance(reader, CaseReader) or reader.process.poll() is not None:
            program = context.program.parent / "examples" / "case_reader"
            pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL}
            reader = CaseReader(subprocess.Popen([program], preexec_fn=limit_memory, **pipes))
            context.case_reader = reader
        return reader

    def ask(self, request: dict[str, object]) -> tuple[str, str]:
        """Outcome and message."""
        self.process.stdin.write(json.dumps(request).encode() + b"\n")
        self.process.stdin.flush()
        with selectors.DefaultSelector() as selector:
            selector.register(self.process.stdout, selectors.EVENT_READ)
            before = self.processor_time()
            turns = 0
            while not selector.select(1.0):
                turns += 1
                if self.processor_time() - before > LONGEST or turns > MOST_TURNS:
                    self.process.kill()
                    self.process.wait()
                    raise Broken(f"no answer within {LONGEST} s: {json.dumps(request)}")
        line = self.process.stdout.readline()
        if not line:
            code = self.process.wait()
            raise Broken(f"code {code} (more memory than allowed, or a crash): {json.dumps(request)}")
        answer = json.loads(line)
        if answer["outcome"] == "panic":
            raise Broken(f"panic, {answer['message']}: {json.dumps(request)}")
        return answer["outcome"], answer["message"]

    def processor_time(self) -> float:
        """Seconds of processor time that the process has used."""
        fields = Path(f"/proc/{self.process.pid}/stat").read_text(encoding="utf-8").rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def seal(self, path: Path) -> None:
        """Gives a file the checksum of a checkpoint."""
        self.ask({"seal": str(path)})
