"""Checks the links of documents: that the target of each relative link or image exists, and so does the heading after a #.

    python scripts/check_links.py                  the Markdown files of the repository
    python scripts/check_links.py target/book      the pages of the built book

In the repository, pages of the book (docs/) may link only to pages of the book, since the built book has no other files. They name
a file of the repository as code instead.
"""

from __future__ import annotations

import re
import sys
import unicodedata
from html.parser import HTMLParser
from pathlib import Path
from typing import NamedTuple
from urllib.parse import unquote

ROOT = Path(__file__).resolve().parent.parent
DOCUMENTS = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md", "docs/**/*.md", "cases/**/*.md", "notes/*.md"]
GENERATED = {"tests.md"}
"""Pages that exist only while the book is built (scripts/book)."""
MEANT_FOR_OTHERS = re.compile(r"[a-z]+:|//", re.IGNORECASE)


class Page(NamedTuple):
    """The links of a page, and its anchors."""

    links: list[str]
    anchors: set[str]


class Reader(HTMLParser):
    """Links and anchors of a page of HTML."""

    def __init__(self) -> None:
        super().__init__()
        self.page = Page([], set())

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name == "id" and value:
                self.page.anchors.add(value)
            elif name == "href" and value and tag == "a" or name == "src" and value:
                self.page.links.append(value)


def html_page(text: str) -> Page:
    """A page of HTML."""
    reader = Reader()
    reader.feed(text)
    return reader.page


def anchor_of(heading: str) -> str:
    """The anchor that forges and mdBook give a heading: lower-case letters, digits, `_` and `-`, and `-` for spaces."""
    shown = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading)
    kept = (c for c in shown if c in "_- " or unicodedata.category(c)[0] in "LN")
    return "".join(kept).strip().replace(" ", "-").lower()


def markdown_page(text: str) -> Page:
    """A page of Markdown, without its code."""
    prose = re.sub(r"^```.*?^```$|<!--.*?-->", "", text, flags=re.MULTILINE | re.DOTALL)
    anchors: set[str] = set()
    for heading in re.findall(r"^#+ +(.*?) *$", prose, re.MULTILINE):
        anchor, number = anchor_of(heading), 1
        while anchor in anchors:
            anchor, number = f"{anchor_of(heading)}-{number}", number + 1
        anchors.add(anchor)
    prose = re.sub(r"`[^`]*`", "", prose)
    links = re.findall(r"\]\(([^)\s]+)\)", prose) + re.findall(r"<(?:img|a)\b[^>]*?\b(?:src|href)=\"([^\"]+)\"", prose)
    return Page(links, anchors)


def read(path: Path) -> Page:
    """A page by the ending of its name."""
    text = path.read_text(encoding="utf-8")
    return html_page(text) if path.suffix == ".html" else markdown_page(text)


def broken(paths: list[Path], root: Path, book: Path) -> list[str]:
    """Errors in the links of pages, all below `root`; pages in the folder `book` may link only inside it."""
    pages = {path: read(path) for path in paths}
    wrong = []
    for path, page in pages.items():
        for link in page.links:
            if MEANT_FOR_OTHERS.match(link):
                continue
            name, _, anchor = unquote(link).partition("#")
            target = (path.parent / name).resolve() if name else path
            where = f"{path.relative_to(root)}: {link}"
            if book in path.parents and book not in target.parents:
                wrong.append(f"{where}: leads out of the book: name the file as code instead")
            elif not target.is_file() and target not in {book / page for page in GENERATED}:
                wrong.append(f"{where}: there is no such file")
            elif anchor and target in pages and anchor not in pages[target].anchors:
                wrong.append(f"{where}: there is no such heading")
    return wrong


def not_in_summary(docs: Path) -> list[str]:
    """Pages of the book that are not in its table of contents."""
    listed = {(docs / link).resolve() for link in read(docs / "SUMMARY.md").links}
    pages = (path.resolve() for path in docs.rglob("*.md") if path.name != "SUMMARY.md")
    return [f"{path.relative_to(docs)}: is not in SUMMARY.md" for path in pages if path not in listed]


def main() -> int:
    """Prints the errors; returns 1 if there are any."""
    if len(sys.argv) > 1:
        root = book = Path(sys.argv[1]).resolve()
        # The page for printing repeats all others in one place, where their relative links need not work.
        paths = [path for path in sorted(root.rglob("*.html")) if path.name not in {"print.html", "toc.html"}]
        wrong = []
    else:
        root, book = ROOT, ROOT / "docs"
        paths = sorted(path for pattern in DOCUMENTS for path in root.glob(pattern))
        wrong = not_in_summary(book)
    wrong += broken(paths, root, book)
    for line in wrong:
        print(line, file=sys.stderr)
    print(f"{len(paths)} pages, {len(wrong)} broken links" if wrong else f"{len(paths)} pages: all links lead somewhere")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
