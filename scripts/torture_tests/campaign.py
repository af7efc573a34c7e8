"""Counts of many attempts over many calls: what was tried, with which seeds, and what broke."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from .program import NOT_COUNTED


@dataclass
class Tally:
    """How attempts of one kind went."""

    counts: Counter[str] = field(default_factory=Counter)
    seconds: float = 0.0
    broken: list[str] = field(default_factory=list)

    @property
    def attempts(self) -> int:
        """All attempts that count."""
        return sum(count for name, count in self.counts.items() if not name.endswith(NOT_COUNTED))

    def __str__(self) -> str:
        return f"{self.attempts} in {self.seconds:.0f} s, {len(self.broken)} broken"


@dataclass
class Campaign:
    """The tallies of all kinds, kept in a file if there is one."""

    path: Path | None = None
    seeds: list[int] = field(default_factory=list)
    tallies: dict[str, Tally] = field(default_factory=dict)

    @staticmethod
    def read(path: Path | None) -> "Campaign":
        """The counts of earlier calls, or none yet."""
        campaign = Campaign(path)
        if path is not None and path.exists():
            stored = json.loads(path.read_text(encoding="utf-8"))
            campaign.seeds = stored["seeds"]
            for kind, tally in stored["kinds"].items():
                campaign.tallies[kind] = Tally(Counter(tally["counts"]), tally["seconds"], tally["broken"])
        return campaign

    def of(self, kind: str) -> Tally:
        """The tally of a kind."""
        return self.tallies.setdefault(kind, Tally())

    def write(self) -> None:
        """Writes the counts to the file in one step."""
        if self.path is None:
            return
        kinds = {kind: {"attempts": tally.attempts, **vars(tally)} for kind, tally in self.tallies.items()}
        partial = self.path.with_suffix(".partial")
        partial.write_text(json.dumps({"seeds": self.seeds, "kinds": kinds}, indent=1), encoding="utf-8")
        partial.replace(self.path)
