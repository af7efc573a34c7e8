"""Writes an example case, first-bed.toml, into this folder: a bed in which waves rise (seconds on two threads)."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

NAME = "first-bed.toml"


def main(words: list[str] | None = None) -> None:
    """Writes the case, unless a file of its name exists, and prints how to run it."""
    argparse.ArgumentParser(prog="python -m talcum.example", description=__doc__).parse_args(words)
    case = Path(__file__).with_name(NAME).read_text(encoding="utf-8")
    try:
        with open(NAME, "x", encoding="utf-8") as file:
            file.write(case)
    except OSError as reason:
        sys.exit(f"error: {NAME}: {reason.strerror}")
    print(f"talcum run {NAME} --threads 2\npython -m talcum.spacetime results/{Path(NAME).stem} --from 25")


if __name__ == "__main__":
    main()
