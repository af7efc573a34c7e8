"""Tests of contact_loop.py on made-up loops, with negative controls."""

from __future__ import annotations

import contextlib
import io
import re
import unittest
from pathlib import Path

import numpy as np

import contact_loop
from made_up_results import ScriptTest
from talcum_results import ResultsError


class TestContactLoop(ScriptTest):
    """Numbers and pictures of loops whose area is known."""

    def write(self, name: str, stiffness: float, unloading: float, pull: float = 0.0, unit: str = "m") -> Path:
        """Loads along one line to 1, unloads along another, not below a pull."""
        up, down = np.linspace(0.0, 1.0, 2001), np.linspace(1.0, 0.0, 2001)
        forces = [stiffness * up, np.maximum(stiffness - unloading * (1.0 - down), -pull)]
        path = self.folder / name
        with open(path, "w", encoding="utf-8") as file:
            file.write(f"# talcum 0.1.0\n# title: made up\noverlap [{unit}],force [N],part [1]\n")
            for part, (ways, force) in enumerate(zip([up, down], forces)):
                for row in zip(ways, force):
                    file.write(f"{float(row[0])!r},{float(row[1])!r},{part}\n")
        return path

    def printed(self, *arguments: object) -> str:
        """What the script prints."""
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            contact_loop.main([str(argument) for argument in arguments])
        return out.getvalue()

    def lost(self, printed: str) -> list[float]:
        """The energies lost."""
        return [float(number) for number in re.findall(r", ([\d.-]+) of the work", printed)]

    def test_elastic_and_plastic(self) -> None:
        elastic = self.write("elastic.csv", 2.0, 2.0)
        plastic = self.write("plastic.csv", 2.0, 4.0)
        adhesive = self.write("adhesive.csv", 2.0, 4.0, pull=0.5)
        printed = self.printed(elastic, plastic, adhesive)
        # Given back: 1 of 1; 2^2 / (2 4) = 1/2; less the pull of 1/2 over 1/2, a triangle of 1/16 apart.
        for found, expected in zip(self.lost(printed), [0.0, 0.5, 0.5 + 0.25 - 0.03125]):
            self.assertAlmostEqual(found, expected, delta=1e-3)
        self.assertIn("largest pull 0.5 N", printed)
        self.assert_picture("elastic.png")

    def test_a_loop_that_gives_more_than_it_gets_is_seen(self) -> None:
        self.assertLess(self.lost(self.printed(self.write("wrong.csv", 2.0, 1.0)))[0], -0.4)

    def test_what_is_no_loop_is_refused_in_words(self) -> None:
        with self.assertRaisesRegex(ResultsError, "talcum contact CASE.toml"):
            self.printed(self.folder / "absent.csv")
        other = self.folder / "series.csv"
        other.write_text("time [s]\n1.0\n", encoding="utf-8")
        with self.assertRaisesRegex(ResultsError, "no column overlap, force, part"):
            self.printed(other)
        tables = [self.write("a.csv", 1.0, 1.0), self.write("b.csv", 1.0, 1.0, unit="d")]
        with self.assertRaisesRegex(ResultsError, "its units"):
            self.printed(*tables)


if __name__ == "__main__":
    unittest.main()
