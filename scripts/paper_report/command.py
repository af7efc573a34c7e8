"""Builds one self-contained page of Talcum's versions of a paper's figures, compared with the paper's statements.

    scripts/report moon2006                    into results/moon2006.html
    scripts/report moon2006 --keep FOLDER      keeps the page's data of the runs themselves in this folder, and builds no page

Tables of studies are read from results/STUDY if the study was run, otherwise from those kept with the cases. Figures
over height and time are drawn from the runs, or are the kept figures of earlier runs.
"""

from __future__ import annotations

import argparse
from pathlib import Path

# First, because it says what to do if numpy is missing.
from talcum_results import run_script

from .page import Paper, page, write


def main(paper: Paper, command_line: list[str] | None = None) -> None:
    """Builds the page of a paper, or keeps its data of runs."""
    parser = argparse.ArgumentParser(
        prog=f"scripts/report {paper.name}", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--results", type=Path, default=Path("results"), metavar="FOLDER", help="the folder in which studies were run")
    parser.add_argument("--output", type=Path, metavar="FILE", help=f"the page (default: RESULTS/{paper.name}.html)")
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="keep the page's data of the runs themselves in this folder")
    arguments = parser.parse_args(command_line)
    if arguments.keep:
        paper.keep(arguments.results, arguments.keep)
    else:
        write(arguments.output or arguments.results / f"{paper.name}.html", page(paper, arguments.results))


def run(paper: Paper) -> None:
    """The program of a paper."""
    run_script(lambda command_line: main(paper, command_line))
