"""Stores figures in the repository with few pixels and few colours, in which greys stay grey.

    .venv/bin/python scripts/stored_figures.py FIGURE ...     stores PNG files again, at most 1,000 pixels wide and 1,200 high
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from PIL import Image

WIDEST, HIGHEST = 1000, 1200
"""Pixels of the figures of the book."""
COLOURS = 256
"""Colours of a palette."""
FREQUENT = 8
"""The most frequent colours, such as white, are kept as they are."""
GREYS = 64
"""Levels of grey of a palette of all colours: a grey is stored within two of its 255 levels, within four in one of half as many."""
STEEPEST = 3
"""A colour whose red, green and blue differ by so little counts as grey: smoothing mixes a little colour into greys."""


def smaller(figure: Image.Image, widest: int = WIDEST, colours: int = COLOURS) -> Image.Image:
    """A figure that is no wider than a number of pixels, no higher than HIGHEST, and has a number of colours."""
    flat = figure.convert("RGB")
    scale = min(1.0, widest / flat.width, HIGHEST / flat.height)
    if scale < 1.0:
        flat = flat.resize((round(flat.width * scale), round(flat.height * scale)), Image.LANCZOS)
    return with_palette(flat, colours)


def with_palette(figure: Image.Image, count: int = COLOURS) -> Image.Image:
    """A figure in a few representative colours. A colour counts by the root of its area, so that small colour bars stay
    smooth; the most frequent, such as white, are kept as they are. Greys have their own part of the palette: if they were
    chosen like other colours, they would be tinted, and voidage is drawn in greys."""
    pixels = np.asarray(figure).reshape(-1, 3)
    colours, places, areas = np.unique(pixels, axis=0, return_inverse=True, return_counts=True)
    is_grey = np.ptp(colours.astype(int), axis=1) <= STEEPEST
    frequent = colours[np.argsort(-areas, kind="stable")[:FREQUENT]]
    levels = min(GREYS, count // 4)
    greys = np.repeat(np.linspace(0, 255, levels).round().astype(int)[:, np.newaxis], 3, axis=1)
    others = most_telling(colours[~is_grey], areas[~is_grey], count - FREQUENT - levels)
    palette = np.concatenate([frequent, greys, others]).astype(int)
    neutral = np.ptp(palette, axis=1) <= STEEPEST
    distances = ((colours[:, np.newaxis].astype(int) - palette) ** 2).sum(axis=2)
    distances[np.ix_(is_grey, ~neutral)] = np.iinfo(int).max
    numbers = distances.argmin(axis=1).astype(np.uint8)[places.ravel()]
    flat = Image.fromarray(numbers.reshape(figure.height, figure.width))
    flat.putpalette(palette.ravel().tolist())
    return flat


def most_telling(colours: np.ndarray, areas: np.ndarray, count: int) -> np.ndarray:
    """At most `count` representative colours, where each colour counts by the root of its area."""
    if len(colours) == 0:
        return np.zeros((0, 3), int)
    counted = Image.fromarray(np.repeat(colours, np.ceil(np.sqrt(areas)).astype(int), axis=0)[np.newaxis])
    return np.reshape(counted.quantize(count).getpalette() or [], (-1, 3))[:count]


def store(picture: Path, widest: int = WIDEST) -> None:
    """Stores a PNG file again."""
    with Image.open(picture) as figure:
        stored = smaller(figure, widest)
    stored.save(picture, "PNG", optimize=True)


if __name__ == "__main__":
    for name in sys.argv[1:]:
        store(Path(name))
