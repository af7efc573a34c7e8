"""Code that the comparisons with experiments share: the folder of measured values, and the provenance of a run's values."""

from __future__ import annotations

from pathlib import Path

from talcum_results import complete_lines, read_series

MEASURED = Path(__file__).resolve().parent.parent / "measured"


def provenance(results: Path) -> list[str]:
    """Comment lines about a run, or about its kept table: program, machine, title, and the digest of the end if the run reached it."""
    said = [f"# {line}" for line in read_series(results).provenance if not line.startswith("case:")]
    end = results / "complete"
    return said + [f"# {line}" for line in complete_lines(end) if line.startswith("digest")] if end.exists() else said
