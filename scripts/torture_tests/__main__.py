"""Tries each kind of torture for a while and prints how it went."""

from __future__ import annotations

import argparse
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from . import damage, decompositions, interruptions
from .program import ROOT, Broken, Context

KINDS = {
    "kills": interruptions.kills,
    "kills-at-calls": interruptions.kills_at_calls,
    "faults": interruptions.faults,
    "two-at-once": interruptions.two_at_once,
    "checkpoints": damage.checkpoints,
    "results": damage.results,
    "inputs": damage.inputs,
    "decompositions": decompositions.decompositions,
}


def build_library(folder: Path) -> Path:
    """The library that makes calls fail."""
    path = folder / "failing_calls.so"
    source = ROOT / "tests" / "program" / "faults" / "failing_calls.c"
    subprocess.run(["cc", "-O1", "-shared", "-fPIC", "-o", path, source, "-ldl"], check=True)
    return path


def torture(kind: str, context: Context, seconds: float) -> tuple[Counter[str], list[str]]:
    """One kind for so many seconds, once at least."""
    counts: Counter[str] = Counter()
    broken: list[str] = []
    deadline = time.monotonic() + seconds
    while True:
        try:
            counts.update(KINDS[kind](context))
        except Broken as error:
            broken.append(str(error))
            print(f"{kind}: BROKEN: {error}", flush=True)
        if time.monotonic() >= deadline:
            return counts, broken


def main() -> int:
    """All kinds that are asked for."""
    parser = argparse.ArgumentParser(prog="scripts/torture", description=__doc__)
    parser.add_argument("--minutes", type=float, default=2.0, help="for each kind (default: 2)")
    parser.add_argument("--only", help=f"kinds, with commas between: {', '.join(KINDS)}")
    parser.add_argument("--seed", type=int, default=None, help="of the random choices (default: of the clock)")
    parser.add_argument("--program", type=Path, default=ROOT / "target" / "release" / "talcum")
    wanted = parser.parse_args()
    kinds = wanted.only.split(",") if wanted.only else list(KINDS)
    unknown = [kind for kind in kinds if kind not in KINDS]
    if unknown:
        parser.error(f"unknown: {', '.join(unknown)}; there are {', '.join(KINDS)}")
    seed = time.time_ns() % 1_000_000 if wanted.seed is None else wanted.seed
    folder = Path(tempfile.mkdtemp(prefix="talcum-torture-"))
    library = build_library(folder)
    print(f"seed {seed}; {wanted.minutes:g} minutes each; what breaks is kept in {folder}", flush=True)
    all_broken: list[str] = []
    for kind in kinds:
        # Each kind has its own sequence, whatever ran before it.
        context = Context(wanted.program, library, folder, random.Random(f"{seed} {kind}"))
        counts, broken = torture(kind, context, 60.0 * wanted.minutes)
        all_broken += broken
        for name, count in sorted(counts.items()):
            print(f"{kind}: {count} {name}", flush=True)
        print(f"{kind}: {len(broken)} broken", flush=True)
    if not all_broken:
        shutil.rmtree(folder)
    return 1 if all_broken else 0


if __name__ == "__main__":
    sys.exit(main())
