"""Writes the page of the book that says what each file of tests shows, and by which tests. It uses the comments at the heads of
the files and the names of the tests. `scripts/book` puts the page into the book.

    python scripts/index_of_tests.py docs/tests.md
"""

from __future__ import annotations

import itertools
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
INTRODUCTION = """\
# What the tests show

This page lists every file of tests, what it shows, and the names of its tests. `scripts/test` runs them all; CONTRIBUTING.md says
how to run some of them. Measured numbers are in [verification.md](verification.md).
"""


def claim(text: str) -> str:
    """The first paragraph of the comment at the head of a file of Rust."""
    head = itertools.takewhile(lambda line: line.startswith("//!"), text.splitlines())
    paragraph = itertools.takewhile(bool, (line[3:].strip() for line in head))
    return " ".join(paragraph)


def tests_in(text: str) -> list[str]:
    """The names of the tests in a file: functions after `#[test]`, with other attributes and comments in between."""
    names, is_test = [], False
    for line in map(str.strip, text.splitlines()):
        if line == "#[test]":
            is_test = True
        elif line.startswith("fn "):
            if is_test:
                names.append(line[3:].partition("(")[0].partition("<")[0])
            is_test = False
    return names


def files_with_tests(root: Path) -> list[Path]:
    """All files of Rust with tests."""
    files = sorted(file for folder in ("tests", "src") for file in (root / folder).rglob("*.rs"))
    return [file for file in files if tests_in(file.read_text(encoding="utf-8"))]


def parts(root: Path) -> list[tuple[str, Path]]:
    """The programs of tests, and the unit tests next to the code: the heading of each part of the page, and its folder or file."""
    programs = [file.parent for file in sorted((root / "tests").glob("*/main.rs"))] + sorted((root / "tests").glob("*.rs"))
    named = [(f"`cargo test --test {place.stem}`", place) for place in programs]
    return [*named, ("Unit tests, next to the code: `cargo test --lib`", root / "src")]


def without_claim(root: Path) -> list[str]:
    """Files with tests that have no comment at their head."""
    return [str(file.relative_to(root)) for file in files_with_tests(root) if not claim(file.read_text(encoding="utf-8"))]


def entry(file: Path, root: Path) -> str:
    """The description of a file, and its tests."""
    text = file.read_text(encoding="utf-8")
    names = "".join(f"* {name.replace('_', ' ')}\n" for name in tests_in(text))
    return f"\n**`{file.relative_to(root)}`**: {claim(text)}\n\n{names}"


def page(root: Path) -> str:
    """The page."""
    text, files = INTRODUCTION, files_with_tests(root)
    for title, place in parts(root):
        entries = "".join(entry(file, root) for file in files if place == file or place in file.parents)
        whole = place / "main.rs"
        of_whole = f"\n{claim(whole.read_text(encoding='utf-8'))}\n" if whole.exists() else ""
        text += f"\n## {title}\n{of_whole}{entries}" if entries else ""
    return text


def main() -> None:
    """Writes the page to the file that is named."""
    if len(sys.argv) != 2:
        sys.exit("error: name the file to write, for example python scripts/index_of_tests.py docs/tests.md")
    Path(sys.argv[1]).write_text(page(ROOT), encoding="utf-8")


if __name__ == "__main__":
    main()
