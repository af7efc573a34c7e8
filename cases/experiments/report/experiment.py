"""What the comparisons with experiments share: where the measured values are, and where those of a run come from."""

from __future__ import annotations

from pathlib import Path

from talcum_results import complete_lines, read_series

MEASURED = Path(__file__).resolve().parent.parent / "measured"


def provenance(results: Path) -> list[str]:
    """Comment lines on a run, or on a table that was kept of one: program, machine, title, and the digest of the end if it came to it."""
    said = [f"# {line}" for line in read_series(results).provenance if not line.startswith("case:")]
    end = results / "complete"
    return said + [f"# {line}" for line in complete_lines(end) if line.startswith("digest")] if end.exists() else said
