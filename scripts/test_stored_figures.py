"""Tests of stored_figures.py on made-up figures, with a control: an ordinary palette tints greys."""

from __future__ import annotations

import tempfile
import unittest
from pathlib import Path

import numpy as np
from PIL import Image

import stored_figures


def figure() -> Image.Image:
    """Cells of grey beside many colours, as the gas stands beside particles with smooth edges."""
    greys = np.repeat(np.linspace(80, 255, 120).astype(np.uint8)[:, None], 3, axis=1)
    colours = np.random.default_rng(3).integers(0, 256, (40, 400, 3), dtype=np.uint8)
    return Image.fromarray(np.concatenate([np.tile(greys, (40, 1, 1)), colours], axis=1))


def tint(image: Image.Image) -> int:
    """The largest difference between red, green and blue where the figure is grey."""
    return int(np.ptp(np.asarray(image.convert("RGB"))[:, :120].astype(int), axis=2).max())


class StoredFigures(unittest.TestCase):
    """What is stored, beside what was drawn."""

    def test_greys_stay_grey(self) -> None:
        drawn = figure()
        for colours in (128, 256):
            stored = stored_figures.with_palette(drawn, colours)
            self.assertLessEqual(tint(stored), stored_figures.STEEPEST)
            self.assertGreater(tint(drawn.quantize(colours)), 8)  # the control
            greys = [np.asarray(image.convert("RGB"))[:, :120].astype(int) for image in (stored, drawn)]
            self.assertLessEqual(np.abs(greys[0] - greys[1]).max(), 255 // min(stored_figures.GREYS, colours // 4))

    def test_white_is_kept(self) -> None:
        stored = stored_figures.with_palette(Image.new("RGB", (20, 20), "white"))
        self.assertEqual(stored.convert("RGB").getpixel((3, 3)), (255, 255, 255))

    def test_no_figure_is_larger_than_the_book_needs(self) -> None:
        for size in [(3000, 500), (500, 3000), (300, 200)]:
            stored = stored_figures.smaller(Image.new("RGB", size, "white"))
            self.assertLessEqual(stored.width, stored_figures.WIDEST)
            self.assertLessEqual(stored.height, stored_figures.HIGHEST)
            self.assertAlmostEqual(stored.width / stored.height, size[0] / size[1], delta=0.02 * size[0] / size[1])
        self.assertEqual(stored.size, (300, 200))

    def test_a_file_is_stored_anew(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "drawn.png"
            figure().save(file)
            stored_figures.store(file, 100)
            with Image.open(file) as stored:
                self.assertEqual((stored.width, stored.mode), (100, "P"))


if __name__ == "__main__":
    unittest.main()
