"""Runs the cases of cases/gallery, draws them, and writes docs/gallery.md with their run times.

    scripts/gallery.py                 all cases, each on one core: some minutes
    scripts/gallery.py spout heap      these cases; the page keeps the entries of the others
"""

from __future__ import annotations

# First, because it says what to do if numpy is missing.
from talcum_results import ResultsError, program, run_script

import argparse
import re
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

import fluidised_bed
import particles
import spacetime
from stored_figures import store

ROOT = Path(__file__).resolve().parent.parent
CASES = ROOT / "cases/gallery"
PAGE = ROOT / "docs/gallery.md"
HEAD = """# Gallery

These are complete cases that run in minutes. Each is a file of `cases/gallery`; `talcum new NAME` writes it into your folder. Times were
measured on one core of the machine that made this page with `scripts/gallery.py`.
"""


@dataclass
class Entry:
    """A case of the gallery, and how it is drawn: a script with its options."""

    name: str
    script: object
    options: tuple[str, ...] = ()


ENTRIES = [
    Entry("travelling-waves", spacetime, ("--from", "20")),
    Entry("cohesive-plug", spacetime, ("--from", "20")),
    Entry("vibrated-bed", spacetime, ("--from", "125")),
    Entry("bubbling-bed", fluidised_bed),
    Entry("spout", fluidised_bed),
    Entry("round-column", fluidised_bed),
    Entry("pulsed-bed", particles, ("--colour", "rise", "--panels", "4", "--from", "0.8")),
    Entry("segregation", particles, ("--colour", "size", "--panels", "3")),
    Entry("moving-wall", particles, ("--colour", "rise", "--panels", "2", "--from", "0.5")),
    Entry("agglomerates", fluidised_bed, ("--colour", "members")),
    Entry("two-species", particles, ("--colour", "species", "--panels", "3")),
    Entry("heap", particles, ("--panels", "3", "--to", "1.2")),
]


def run(case: Path, results: Path) -> float:
    """Runs a case again, and returns the seconds that it took."""
    begin = time.monotonic()
    command = [program(), "run", str(case), "--output", str(results), "--force"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise ResultsError(f"{case}: {done.stderr.strip().splitlines()[-1] if done.stderr.strip() else 'failed'}")
    return time.monotonic() - begin


def seconds_in(page: str) -> dict[str, float]:
    """The run times given on a page."""
    found = re.findall(r"^`talcum new ([\w-]+)`; \d+ particles, (\d+) s", page, re.MULTILINE)
    return {name: float(seconds) for name, seconds in found}


def part(name: str, seconds: float) -> str:
    """The part of the page about a case, from the comments at its head."""
    lines = (CASES / f"{name}.toml").read_text().splitlines()
    what, look = lines[0].removeprefix("# "), lines[1].removeprefix("# Look at: ")
    title, rest = what.split(": ", 1)
    count = next(line.split("=")[1].split("#")[0].strip() for line in lines if line.startswith("count ="))
    look = re.sub(r"(python -m talcum\.\w+ results/[\w-]+(?: --\w+ \w+)?|talcum analyse results/[\w-]+ --analysis \w+)", r"`\1`", look)
    return (
        f"## {title}\n\n{rest[0].upper()}{rest[1:]}\n\n`talcum new {name}`; {count} particles, {seconds:.0f} s. Look at: {look}\n\n"
        f"![{title}](gallery-{name}.png)\n"
    )


def main(words: list[str] | None = None) -> None:
    """Runs, draws, and writes the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", help="which cases (default: all)")
    parser.add_argument("--results", type=Path, default=ROOT / "results/gallery", metavar="FOLDER", help="the folder in which they are run")
    parser.add_argument("--draw-only", action="store_true", help="draw the results of earlier runs")
    arguments = parser.parse_args(words)
    known = [entry.name for entry in ENTRIES]
    for name in arguments.names:
        if name not in known:
            raise ResultsError(f"{name}: there is no such case: {', '.join(known)}")
    seconds = seconds_in(PAGE.read_text()) if PAGE.exists() else {}
    for entry in ENTRIES:
        if arguments.names and entry.name not in arguments.names:
            continue
        results = arguments.results / entry.name
        if not arguments.draw_only:
            print(f"== {entry.name}")
            seconds[entry.name] = run(CASES / f"{entry.name}.toml", results)
        picture = PAGE.parent / f"gallery-{entry.name}.png"
        entry.script.main([str(results), *entry.options, "--output", str(picture)])
        store(picture)
    parts = [part(name, seconds[name]) for name in known if name in seconds]
    PAGE.write_text("\n".join([HEAD, *parts]))
    print(f"page: {PAGE}")


if __name__ == "__main__":
    run_script(main)
