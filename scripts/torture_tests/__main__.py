"""Tries each kind of torture for a while, or a given number of times, and prints the results."""

from __future__ import annotations

import argparse
import random
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Callable, NamedTuple

from . import (damage, decompositions, disks, inputs, interruptions, laws, names, numbers, options, readers, streams, studies,
               terminals, visitors)  # fmt: skip
from .campaign import Campaign
from .program import ROOT, TIMES, Broken, Context


class Kind(NamedTuple):
    """A kind of torture: an attempt or several at once, and how many a campaign has."""

    attempt: Callable[[Context], dict[str, int]]
    goal: int


KINDS = {
    "kills": Kind(interruptions.kills, 8_000),
    "kills-at-calls": Kind(interruptions.kills_at_calls, 2_000),
    "faults": Kind(interruptions.faults, 2_000),
    "two-at-once": Kind(interruptions.two_at_once, 200),
    "checkpoints": Kind(damage.checkpoints, 6_000),
    "contents": Kind(damage.contents, 2_000),
    "results": Kind(damage.results, 2_000),
    "inputs": Kind(inputs.inputs, 2_000),
    "cases": Kind(inputs.cases, 100_000),
    "decompositions": Kind(decompositions.decompositions, 2_000),
    "study-kills": Kind(studies.kills, 3_000),
    "study-kills-at-calls": Kind(studies.kills_at_calls, 2_000),
    "study-faults": Kind(studies.faults, 2_000),
    "study-damage": Kind(studies.damage, 1_000),
    "numbers": Kind(numbers.numbers, 8_000),
    "full-disks": Kind(disks.disks, 500),
    "requests": Kind(visitors.requests, 10_000),
    "terminals": Kind(terminals.terminals, 500),
    "streams": Kind(streams.streams, 2_000),
    "limits": Kind(streams.limits, 1_000),
    "options": Kind(options.options, 2_000),
    "names": Kind(names.names, 500),
    "readers": Kind(readers.readings, 10_000),
    "laws": Kind(laws.laws, 1_000),
}
# A kind that breaks so often in one call is abandoned, because the reason is mostly the same.
MOST_BROKEN = 20
# The folder in which files cost least to write.
MEMORY = Path("/dev/shm")


def build_library(folder: Path) -> Path:
    """The library that makes calls fail."""
    path = folder / "failing_calls.so"
    source = ROOT / "tests" / "program" / "faults" / "failing_calls.c"
    subprocess.run(["cc", "-O1", "-shared", "-fPIC", "-o", path, source, "-ldl"], check=True)
    return path


def torture(kind: str, context: Context, campaign: Campaign, seconds: float, goal: float, pause: Path | None) -> int:
    """Tries one kind for some seconds, at least once, or until there are enough attempts; returns how many broke."""
    tally, began, broken = campaign.of(kind), time.monotonic(), 0
    while tally.attempts < goal and broken < MOST_BROKEN:
        while pause is not None and pause.exists():
            time.sleep(1.0)
        start = time.monotonic()
        try:
            tally.counts.update(KINDS[kind].attempt(context))
        except Broken as error:
            broken += 1
            tally.broken.append(str(error))
            print(f"{kind}: BROKEN: {error}", flush=True)
        now = time.monotonic()
        tally.seconds += now - start
        if now - began >= seconds:
            break
    return broken


def read_options() -> argparse.Namespace:
    """The command-line arguments."""
    parser = argparse.ArgumentParser(prog="scripts/torture", description=__doc__)
    parser.add_argument("--minutes", type=float, default=2.0, help="for each kind (default: 2)")
    parser.add_argument("--only", help=f"kinds, with commas between: {', '.join(KINDS)}")
    parser.add_argument("--seed", type=int, default=None, help="of the random choices (default: of the clock)")
    parser.add_argument("--campaign", type=Path, metavar="FILE",
                        help="keep the counts in this file, continue from those in it, and repeat until each"
                             " kind was tried as often as a campaign requires")  # fmt: skip
    parser.add_argument("--patience", type=float, default=1.0,
                        help="allow this many times as long for a run to end, on a machine that does other work")  # fmt: skip
    parser.add_argument("--mpirun", default="mpirun --bind-to none -n", help="starts ranks, followed by their number")
    parser.add_argument("--alone", type=float, default=0.9, help="share of the runs that are started without it (default: 0.9)")
    parser.add_argument("--pause", type=Path, metavar="FILE",
                        help="wait while this file exists, for example while the machine is needed to measure times")  # fmt: skip
    parser.add_argument("--program", type=lambda path: Path(path).resolve(), default=ROOT / "target" / "release" / "talcum")
    wanted = parser.parse_args()
    wanted.kinds = wanted.only.split(",") if wanted.only else list(KINDS)
    unknown = [kind for kind in wanted.kinds if kind not in KINDS]
    if unknown:
        parser.error(f"unknown: {', '.join(unknown)}; there are {', '.join(KINDS)}")
    return wanted


def main() -> int:
    """Tries all kinds asked for; in a campaign in turn, until all have enough attempts."""
    wanted = read_options()
    TIMES[0] = wanted.patience
    campaign = Campaign.read(wanted.campaign)
    seed = time.time_ns() % 1_000_000 if wanted.seed is None else wanted.seed
    campaign.seeds.append(seed)
    folder = Path(tempfile.mkdtemp(prefix="talcum-torture-", dir=MEMORY if MEMORY.is_dir() else None))
    library = build_library(folder)
    print(f"seed {seed}; {wanted.minutes:g} minutes each; runs that break are kept in {folder}", flush=True)
    # Each kind has its own random sequence, whatever ran before it.
    def context(kind: str) -> Context:
        launcher = tuple(shlex.split(wanted.mpirun))
        return Context(wanted.program, library, folder, random.Random(f"{seed} {kind}"), launcher, wanted.alone)
    contexts = {kind: context(kind) for kind in wanted.kinds}
    goals = {kind: KINDS[kind].goal if wanted.campaign else float("inf") for kind in wanted.kinds}
    all_broken, left = 0, list(wanted.kinds)
    while left:
        for kind in left:
            broken = torture(kind, contexts[kind], campaign, 60.0 * wanted.minutes, goals[kind], wanted.pause)
            all_broken += broken
            campaign.write()
            for name, count in sorted(campaign.of(kind).counts.items()):
                print(f"{kind}: {count} {name}", flush=True)
            print(f"{kind}: {campaign.of(kind)}", flush=True)
            if not wanted.campaign or broken >= MOST_BROKEN:
                goals[kind] = 0
        left = [kind for kind in left if campaign.of(kind).attempts < goals[kind]]
    if not all_broken:
        shutil.rmtree(folder)
    return 1 if all_broken else 0


if __name__ == "__main__":
    sys.exit(main())
