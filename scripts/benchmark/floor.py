"""The least time of a particle-step that memory and arithmetic of this machine allow, compared with measurements."""

from __future__ import annotations

import os
import re
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .tables import table

NUMBER = 8
# Contacts per particle of the settled bed, each pair once, and pairs in the list of skin 0.08.
CONTACTS, LISTED = 2.64, 3.4
# The tangential spring, read and written; the linear law keeps no largest overlap.
CONTACT_MEMORY = 2 * 3 * NUMBER


@dataclass(frozen=True)
class Pass:
    """One sweep over all particles: numbers per particle that must come from memory or go there."""

    name: str
    read: float
    written: float
    flops: float

    @property
    def size(self) -> float:
        """Bytes."""
        return NUMBER * (self.read + self.written)


# Flops are counted in the formulas: a contact has 13 for the distance, 30 for the relative velocity, 45 for the law, 40
# for forces, torques and their rounding, of which a division or a root counts as one.
CONTACT_FLOPS, CANDIDATE_FLOPS = 128.0, 9.0
PASSES = (
    Pass("kicks, drift, weight", 17, 15, 71.0),
    Pass("pairs", 11 + 6 + (0.75 * LISTED + 0.5 * CONTACTS * CONTACT_MEMORY / NUMBER),
         6 + 0.5 * CONTACTS * CONTACT_MEMORY / NUMBER, CONTACTS * CONTACT_FLOPS + LISTED * CANDIDATE_FLOPS),
)  # fmt: skip
# All in one sweep: what is read and written at least once.
FUSED = Pass("all in one sweep", 20 + 0.5 * LISTED + 0.5 * CONTACTS * CONTACT_MEMORY / NUMBER,
             15 + 0.5 * CONTACTS * CONTACT_MEMORY / NUMBER, sum(each.flops for each in PASSES))  # fmt: skip


def bandwidth(repeats: int = 7, megabytes: int = 256) -> float:
    """Bytes per second of one core that adds two arrays into a third: three numbers moved, one of them twice."""
    count = megabytes * 10**6 // NUMBER
    a, b, c = (np.full(count, value) for value in (1.0, 2.0, 0.0))
    best = float("inf")
    for _ in range(repeats):
        begin = time.process_time()  # others may have the core meanwhile
        np.add(a, b, out=c)
        best = min(best, time.process_time() - begin)
    # The array written to is first read.
    return 4.0 * NUMBER * count / best


def peak() -> float:
    """Flops per second of one core: two additions and two multiplications of a whole vector per cycle, not fused."""
    words = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    clock = max(float(found) for found in re.findall(r"cpu MHz\s*:\s*([\d.]+)", words)) * 1.0e6
    lanes = 8 if re.search(r"\bavx512f\b", words) else 4 if re.search(r"\bavx2\b", words) else 2
    return 4.0 * lanes * clock


def floor(rate: float) -> str:
    """A table of passes and the floor in nanoseconds; `rate` in million particle-steps per second."""
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    moved, computed = bandwidth(), peak()
    rows = []
    total = Pass("sum of the passes", sum(p.read for p in PASSES), sum(p.written for p in PASSES), FUSED.flops)
    for each in (*PASSES, total, FUSED):
        memory, arithmetic = 1.0e9 * each.size / moved, 1.0e9 * each.flops / (0.25 * computed)
        rows.append([each.name, f"{each.size:.0f}", f"{each.flops:.0f}", f"{memory:.1f}", f"{arithmetic:.1f}"])
    head = ["pass", "bytes", "flops", "ns from memory", "ns at a quarter of peak"]
    measured = 1.0e3 / rate
    least = max(1.0e9 * total.size / moved, 1.0e9 * total.flops / (0.25 * computed))
    words = (
        f"Memory moves {moved * 1e-9:.1f} GB/s for one core, a core computes at most {computed * 1e-9:.0f} Gflop/s "
        f"without fused operations. Measured: {measured:.0f} ns per particle-step of the bed of 216,000, "
        f"{measured / least:.1f} times the larger of the two for these passes."
    )
    return f"{table(head, rows)}\n\n{words}"
