"""Executes the notebooks of docs/notebooks, and compares what they print with what is stored in them.

    .venv/bin/python scripts/notebooks.py [NAME ...]            compares, and prints the differences
    .venv/bin/python scripts/notebooks.py --write [NAME ...]    executes and stores: also after a change in the notebook

Each notebook is executed from its beginning in an empty folder. The text that a cell prints or shows must equal the stored text;
figures are not compared. Files that a notebook writes by `%%writefile` have the text of the book; --write puts it there.
"""

from __future__ import annotations

import argparse
import base64
import copy
import difflib
import io
import os
import re
import sys
import tempfile
import time
from pathlib import Path
from unittest import mock

import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError
from nbformat import NotebookNode
from PIL import Image
from traitlets.config import Config

import stored_figures
from talcum_results import program

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "docs" / "notebooks"
BLOCK = re.compile(r"^```toml\n(.*?)^```", re.MULTILINE | re.DOTALL)
WRITEFILE = re.compile(r"%%writefile (?:-a )?\S*?([\w-]+\.toml)$", re.MULTILINE)
# Files of cases: the page of the book that shows them, and which of its blocks they are.
CASES = {
    "bed.toml": ("tutorial.md", slice(0, 4)),
    "cohesive.toml": ("tutorial.md", slice(4, 5)),
    "study.toml": ("tutorial.md", slice(5, 6)),
    "beads.toml": ("how-to/gas-in-three-dimensions.md", slice(0, 1)),
}
LONGEST_CELL = 600  # seconds; a cell takes some 10
WIDEST, COLOURS = 800, 128  # of stored figures: pixels, colours


def notebooks() -> list[Path]:
    """The notebooks, in their order."""
    return sorted(FOLDER.glob("*.ipynb"))


def blocks_of(file: str) -> list[str]:
    """The blocks of the book that make a file of a case."""
    page, which = CASES[file]
    return BLOCK.findall((ROOT / "docs" / page).read_text(encoding="utf-8"))[which]


def cells_that_write(notebook: NotebookNode) -> dict[str, list[NotebookNode]]:
    """The cells that write each file of a case, in their order."""
    found: dict[str, list[NotebookNode]] = {}
    for cell in notebook.cells:
        if cell.cell_type == "code" and (writes := WRITEFILE.match(cell.source)):
            found.setdefault(writes[1], []).append(cell)
    return found


def fill_in(notebook: NotebookNode) -> None:
    """Puts the text of the book into the cells that write files: the whole into one cell, or a block into each."""
    for file, cells in cells_that_write(notebook).items():
        blocks = blocks_of(file)
        if len(cells) == 1:
            blocks = ["\n".join(blocks)]
        if len(cells) != len(blocks):
            raise ValueError(f"{file} is written by {len(cells)} cells, but has {len(blocks)} blocks in the book")
        for number, (cell, block) in enumerate(zip(cells, blocks)):
            head = cell.source.splitlines()[0]
            cell.source = "\n".join([head, *([""] if number else []), block.rstrip("\n")])


def execute(notebook: NotebookNode, folder: Path) -> NotebookNode:
    """A copy of the notebook with the outputs of its cells in an empty folder; a cell that raises is an error."""
    anew = copy.deepcopy(notebook)
    settings = {name: str(folder / "jupyter") for name in ("IPYTHONDIR", "JUPYTER_RUNTIME_DIR", "JUPYTER_CONFIG_DIR")}
    settings |= {"PYTHONPATH": str(ROOT / "python"), "TALCUM": program(), "PYDEVD_DISABLE_FILE_VALIDATION": "1"}
    work = folder / "work"
    work.mkdir()
    # Sockets are files: no port is opened.
    sockets = Config(KernelManager={"transport": "ipc", "ip": str(folder / "kernel")})
    place = {"metadata": {"path": str(work)}}
    client = NotebookClient(anew, timeout=LONGEST_CELL, resources=place, record_timing=False, config=sockets)
    with mock.patch.dict(os.environ, settings):
        client.execute()
    return anew


def texts_of(cell: NotebookNode) -> list[str]:
    """The text that a cell prints and shows. Text printed in several pieces is joined; a figure has no text."""
    texts: list[tuple[str, str]] = []
    for output in cell.get("outputs", []):
        if output.output_type == "stream":
            if texts and texts[-1][0] == output.name:
                texts[-1] = (output.name, texts[-1][1] + output.text)
            else:
                texts.append((output.name, output.text))
        elif output.output_type == "error":
            texts.append(("error", f"{output.ename}: {output.evalue}"))
        elif "image/png" not in output.data:
            texts.append(("shown", output.data.get("text/plain", "")))
    return [text for _, text in texts]


def differences(stored: NotebookNode, anew: NotebookNode) -> list[str]:
    """The differences between the texts of two notebooks with the same cells."""
    found = []
    if [cell.source for cell in stored.cells] != [cell.source for cell in anew.cells]:
        return ["the cells are not the same"]
    for number, (before, after) in enumerate(zip(stored.cells, anew.cells), start=1):
        lines = [[line for text in texts_of(cell) for line in text.splitlines()] for cell in (before, after)]
        if lines[0] != lines[1]:
            found += [f"cell {number}:", *difflib.unified_diff(*lines, "stored", "executed", lineterm="")]
    return found


def smaller(figure: str, widest: int = WIDEST) -> str:
    """A figure, PNG in base64, with fewer pixels and colours."""
    written = io.BytesIO()
    with Image.open(io.BytesIO(base64.b64decode(figure))) as drawn:
        stored_figures.smaller(drawn, widest, COLOURS).save(written, "PNG", optimize=True)
    return base64.b64encode(written.getvalue()).decode()


def tidied(notebook: NotebookNode) -> NotebookNode:
    """An executed notebook as it is stored: without anything of this machine, with small figures."""
    tidy = copy.deepcopy(notebook)
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    tidy.metadata = NotebookNode(kernelspec=kernel, language_info={"name": "python"})
    for number, cell in enumerate(tidy.cells, start=1):
        cell.id, cell.metadata = f"cell-{number}", NotebookNode()
        for output in cell.get("outputs", []):
            if "image/png" in output.get("data", {}):
                shown = output.metadata.get("image/png", {}).get("width", WIDEST)
                output.data = NotebookNode({"image/png": smaller(output.data["image/png"], min(WIDEST, 3 * shown // 2))})
        if cell.cell_type == "code":
            cell.outputs = joined(cell.outputs)
    return tidy


def joined(outputs: list[NotebookNode]) -> list[NotebookNode]:
    """Outputs in which text printed in several pieces is joined."""
    kept: list[NotebookNode] = []
    for output in outputs:
        if kept and output.output_type == "stream" and kept[-1].get("name") == output.name:
            kept[-1].text += output.text
        else:
            kept.append(output)
    return kept


def read(path: Path) -> NotebookNode:
    """A notebook as it is stored."""
    return nbformat.read(path, as_version=4)


def store(path: Path, folder: Path) -> None:
    """Executes a notebook with the text of the book, and stores it."""
    notebook = read(path)
    fill_in(notebook)
    nbformat.write(tidied(execute(notebook, folder)), path)


def compare(path: Path, folder: Path) -> list[str]:
    """The differences when a notebook is executed again; a cell that raises counts as one."""
    stored = read(path)
    try:
        return differences(stored, execute(stored, folder))
    except CellExecutionError as error:
        return [f"a cell raises:\n{error}"]


def main() -> int:
    """Compares or stores; returns 1 if anything differs."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help="notebooks, such as 1-case (default: all)")
    parser.add_argument("--write", action="store_true", help="store what the notebooks print and draw")
    arguments = parser.parse_args()
    paths = [FOLDER / f"{name}.ipynb" for name in arguments.names] or notebooks()
    if absent := [path.name for path in paths if not path.is_file()]:
        parser.error(f"no such notebook: {', '.join(absent)}; there are {', '.join(path.stem for path in notebooks())}")
    wrong = 0
    for path in paths:
        began = time.monotonic()
        with tempfile.TemporaryDirectory(prefix="talcum-notebook-") as folder:
            found = store(path, Path(folder)) if arguments.write else compare(path, Path(folder))
        print("\n".join([f"{path.name}: {time.monotonic() - began:.0f} s, {path.stat().st_size / 1e3:.0f} kB", *(found or [])]))
        wrong += bool(found)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
