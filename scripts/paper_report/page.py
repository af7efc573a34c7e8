"""The page of a paper, one self-contained file that compares the paper's statements with measurements."""

from __future__ import annotations

import base64
import html
import io
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

# First, because it says what to do if numpy is missing.
from talcum_results import ResultsError

import matplotlib.pyplot as plt
from matplotlib.figure import Figure
from matplotlib.image import imread

STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; color: #1b1f24; }
h1 { line-height: 1.2; } h2 { margin-top: 2.5rem; border-top: 1px solid #d0d7de; padding-top: 1rem; }
table { border-collapse: collapse; width: 100%; font-size: 0.9rem; margin: 1rem 0; }
th, td { border: 1px solid #d0d7de; padding: 0.35rem 0.6rem; text-align: left; vertical-align: top; }
th { background: #f3f5f7; } tr.agrees td:last-child { background: #e6f4ea; } tr.differs td:last-child { background: #fdecea; }
img { max-width: 100%; } figure { margin: 1rem 0; } figcaption, .source { color: #57606a; font-size: 0.85rem; }
code { background: #f3f5f7; padding: 0.1rem 0.3rem; }
"""


VERDICTS = ("agrees", "differs", "reported only")
"""The page's words for a statement."""


@dataclass
class Statement:
    """A paper's statement about a quantity, the measured value, and whether the two agree; None if it is only reported."""

    quantity: str
    paper: str
    measured: str
    agrees: bool | None

    @property
    def verdict(self) -> str:
        """Whether the two agree, as text."""
        return dict(zip((True, False, None), VERDICTS))[self.agrees]

    def row(self) -> str:
        """Its row of a table."""
        cells = "".join(f"<td>{html.escape(text)}</td>" for text in (self.quantity, self.paper, self.measured, self.verdict))
        return f'<tr class="{self.verdict}">{cells}</tr>'


@dataclass
class Section:
    """A part of the page: the paper's result, the measurements, a table whose first row is its head, figures, and how to repeat it."""

    title: str
    text: str
    statements: list[Statement] = field(default_factory=list)
    figures: list[tuple[Figure, str]] = field(default_factory=list)
    sources: list[str] = field(default_factory=list)
    table: list[list[str]] = field(default_factory=list)

    @property
    def anchor(self) -> str:
        """The name of its anchor."""
        return re.sub(r"[^a-z0-9]+", "-", self.title.lower()).strip("-")

    def summary(self) -> str:
        """Its row of the table of all parts: how many statements agree, differ, and are reported only."""
        verdicts = [statement.verdict for statement in self.statements]
        counts = "".join(f"<td>{verdicts.count(verdict) or ''}</td>" for verdict in VERDICTS)
        return f'<tr><td><a href="#{self.anchor}">{html.escape(self.title)}</a></td>{counts}</tr>'

    def html(self) -> str:
        """Its part of the page."""
        parts = [f'<h2 id="{self.anchor}">{html.escape(self.title)}</h2>', f"<p>{html.escape(self.text)}</p>"]
        if self.statements:
            head = "<tr><th>quantity</th><th>paper</th><th>Talcum</th><th></th></tr>"
            rows = "".join(statement.row() for statement in self.statements)
            parts.append(f"<table>{head}{rows}</table>")
        if self.table:
            lines = (row_of(cells, "td" if number else "th") for number, cells in enumerate(self.table))
            parts.append(f"<table>{''.join(lines)}</table>")
        for figure, caption in self.figures:
            described = html.escape(caption)
            parts.append(
                f'<figure><img alt="{described}" src="{embedded(figure)}"><figcaption>{described}</figcaption></figure>'
            )
        parts += [f'<p class="source">{html.escape(source)}</p>' for source in self.sources]
        return "\n".join(parts)


@dataclass(frozen=True)
class Paper:
    """A paper: its folder in cases, the head of its page, the parts of the page from a folder of results, and the function that keeps data of runs."""

    name: str
    title: str
    introduction: str
    sections: Callable[[Path], list[Section]]
    keep: Callable[[Path, Path], None]


def row_of(cells: list[str], tag: str) -> str:
    """A row of a table."""
    return "<tr>" + "".join(f"<{tag}>{html.escape(cell)}</{tag}>" for cell in cells) + "</tr>"


def picture(file: Path) -> Figure:
    """A stored picture as a figure."""
    pixels = imread(file)
    figure = Figure(figsize=(pixels.shape[1] / 110.0, pixels.shape[0] / 110.0))
    panel = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    panel.imshow(pixels)
    panel.axis("off")
    return figure


def embedded(figure: Figure) -> str:
    """A figure as a data URL, so that the page is one file."""
    image = io.BytesIO()
    figure.savefig(image, format="png", dpi=110, bbox_inches="tight")
    plt.close(figure)
    return "data:image/png;base64," + base64.b64encode(image.getvalue()).decode()


def page(paper: Paper, results: Path) -> str:
    """The whole page, from a folder of results and from kept data."""
    sections = paper.sections(results)
    head = "".join(f"<th>{text}</th>" for text in ("part", *VERDICTS))
    summary = "\n".join(section.summary() for section in sections)
    body = "\n".join([f"<table><tr>{head}</tr>\n{summary}</table>", *(section.html() for section in sections)])
    return (
        f'<!DOCTYPE html>\n<html lang="en-GB"><head><meta charset="utf-8"><title>{html.escape(paper.title)}</title>'
        f"<style>{STYLE}</style></head><body>\n<h1>{html.escape(paper.title)}</h1>\n<p>{html.escape(paper.introduction)}</p>\n"
        f"{body}\n</body></html>\n"
    )


def write(path: Path, text: str) -> None:
    """Writes the page."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    except OSError as error:
        raise ResultsError(f"{path}: cannot be written: {error}") from error
    print(f"page: {path}")
