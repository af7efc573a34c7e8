"""Writes docs/command-line.md: the text of `talcum --help` for each command.

    python scripts/command_line.py        after `cargo build`, if options have changed

scripts/test_book.py checks that the page is up to date.
"""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

from talcum_results import program

PAGE = Path(__file__).resolve().parent.parent / "docs" / "command-line.md"

HEAD = """\
# The command line

<!-- Written by scripts/command_line.py from the program's own --help: change that. -->

This page has the program's own help. [Running a case](running.md) explains the commands that run cases. For `analyse` see
[Analyses of results](analyse.md), for `study` and `summary` see [Studies](study.md), and for `contact` see
[Contacts](theory/contacts.md).
"""


def help_of(*words: str) -> str:
    """The output of `talcum WORDS --help`, on lines of up to 100 characters."""
    command = [program(), *words, "--help"]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env={**os.environ, "COLUMNS": "100"})
    return "\n".join(line.rstrip() for line in done.stdout.strip().splitlines()) + "\n"


def commands(text: str) -> list[str]:
    """The commands that the program's help lists, except `help` itself."""
    listed = text.split("\nCommands:\n")[1].split("\n\n")[0]
    return [name for name in re.findall(r"^  ([\w-]+) ", listed, re.MULTILINE) if name != "help"]


def page() -> str:
    """The page."""
    whole = help_of()
    parts = [HEAD, f"\n## talcum\n\n```text\n{whole}```\n"]
    parts += [f"\n## talcum {name}\n\n```text\n{help_of(name)}```\n" for name in commands(whole)]
    return "".join(parts)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
