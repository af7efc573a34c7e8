"""Tests of instruments_gallery.py: its cases, its figures in the book, and one run that is made and drawn."""

from __future__ import annotations

import tempfile
import unittest
from pathlib import Path
from unittest import mock

import instruments_gallery
import talcum
from instruments_gallery import DOCS, DRAWN, RUNS, Run
from PIL import Image
from talcum_results import ResultsError

LARGEST = 150_000
"""Bytes of a figure: the book and the repository stay small."""


class InstrumentsGallery(unittest.TestCase):
    """The figures of instruments and analyses."""

    def test_every_figure_stands_in_the_book(self) -> None:
        pages = "".join(page.read_text(encoding="utf-8") for page in DOCS.glob("*.md"))
        for name in DRAWN:
            self.assertIn(f"({name}.png)", pages)
            self.assertLess((DOCS / f"{name}.png").stat().st_size, LARGEST)

    def test_every_case_is_accepted(self) -> None:
        runs = {name: run for name, run in RUNS.items() if isinstance(run, Run)}
        self.assertGreater(len(runs), 5)
        for name, run in runs.items():
            with self.subTest(name):
                talcum.check(run.path, set=run.values)
        wrong = Run("gallery/heap.toml", {"measure.stress.kind": "strain"})  # the control
        with self.assertRaisesRegex(talcum.TalcumError, "measure.stress.kind"):
            talcum.check(wrong.path, set=wrong.values)

    def test_every_run_is_drawn(self) -> None:
        self.assertEqual({name for drawn in DRAWN.values() for name in drawn.runs}, set(RUNS))
        with self.assertRaisesRegex(ResultsError, "bed: there is no such run: vibrated, ledger"):
            instruments_gallery.main(["bed"])

    def test_a_run_is_made_and_drawn(self) -> None:
        with tempfile.TemporaryDirectory() as folder, mock.patch.object(instruments_gallery, "DOCS", Path(folder)):
            instruments_gallery.main(["ledger", "--results", folder])
            with Image.open(Path(folder) / "energy-ledger.png") as drawn:
                self.assertGreater(len(drawn.convert("RGB").getcolors(1 << 24)), 20)


if __name__ == "__main__":
    unittest.main()
