"""Runs the benches of the crate and makes tables of them."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

from .beds import ROOT
from .runs import BenchmarkError, execute
from .tables import table

CRITERION = ROOT / "target" / "criterion"


def read_criterion(folder: Path) -> dict[str, dict[int, float]]:
    """Median nanoseconds per item by name and size, from what criterion wrote."""
    found: dict[str, dict[int, float]] = {}
    for path in sorted(folder.glob("**/new/benchmark.json")):
        what = json.loads(path.read_text(encoding="utf-8"))
        estimates = json.loads((path.parent / "estimates.json").read_text(encoding="utf-8"))
        name, _, size = what["function_id"].rpartition("/")
        items = what["throughput"]["Elements"]
        found.setdefault(f"{what['group_id']}: {name}", {})[int(size)] = estimates["median"]["point_estimate"] / items
    if not found:
        raise BenchmarkError(f"{folder}: criterion has left no results")
    return found


def kernel_table(found: dict[str, dict[int, float]]) -> str:
    """A row for each kernel: nanoseconds in and out of cache, smallest and largest size."""
    rows = []
    for name, times in found.items():
        small, large = min(times), max(times)
        rows.append([name, f"{small:,}", f"{times[small]:.2f}", f"{large:,}", f"{times[large]:.2f}"])
    return table(["kernel", "small size", "ns", "large size", "ns"], rows)


def kernels() -> str:
    """Measures all kernels again."""
    shutil.rmtree(CRITERION, ignore_errors=True)
    execute(["cargo", "bench", "--bench", "kernels"])
    return kernel_table(read_criterion(CRITERION))


def printed_table(bench: str) -> str:
    """The table that a bench of the crate prints."""
    said = execute(["cargo", "bench", "--bench", bench]).words
    rows = [line for line in said.splitlines() if line.startswith("|")]
    if not rows:
        raise BenchmarkError(f"the bench {bench} has printed no table:\n{said[-2000:]}")
    return "\n".join(rows)


def messages() -> str:
    """Counts what ranks say to each other."""
    return printed_table("messages")


def machines() -> str:
    """Microseconds of a step of ranks whose messages are delayed, as between machines."""
    return printed_table("machines")
