"""scripts/report moon2006: builds the page, or keeps its data of runs."""

from paper_report.command import run

from .paper import PAPER

run(PAPER)
