"""Tests of the notebooks, each of which is executed again and gives its stored text; and tests of the comparison."""

from __future__ import annotations

import base64
import copy
import io
import re
import socket
import subprocess
import sys
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import nbformat
from nbformat import NotebookNode
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook, new_output
from PIL import Image

from notebooks import ROOT, blocks_of, cells_that_write, compare, differences, execute, fill_in, notebooks, read, tidied

LARGEST = 250_000  # bytes: GitHub shows a notebook of this size at once
# The start of an absolute path, at which no word, `/` of a unit, or address ends.
ABSOLUTE = re.compile(r"(?<![\w.:/*\])])/(?:[A-Za-z][\w.-]*/)+")
TIMES = re.compile(r"\b\d{4}-\d\d-\d\d \d\d:\d\d|\d (?:ms|seconds|minutes)\b|\bpid\b", re.IGNORECASE)


def filled(notebook: NotebookNode) -> NotebookNode:
    """A copy with the text of the book."""
    anew = copy.deepcopy(notebook)
    fill_in(anew)
    return anew


def retired_words() -> list[str]:
    """The phrases that docs/glossary.md refuses, as the Rust test of all other documents reads them."""
    table = (ROOT / "docs/glossary.md").read_text(encoding="utf-8").split("| not | but |")[1]
    cells = re.findall(r"^\| ([^|]*) \|", table, re.MULTILINE)
    return [phrase.strip() for cell in cells if not cell.startswith("-") for phrase in cell.split(",")]


class TestStored(unittest.TestCase):
    """The notebooks as they are stored."""

    def setUp(self) -> None:
        self.stored = {path.name: read(path) for path in notebooks()}
        self.assertEqual(len(self.stored), 6)

    def test_they_are_small_valid_and_executed_in_order(self) -> None:
        for path in notebooks():
            self.assertLess(path.stat().st_size, LARGEST, path.name)
            notebook = self.stored[path.name]
            nbformat.validate(notebook)
            code = [cell for cell in notebook.cells if cell.cell_type == "code"]
            self.assertEqual([cell.execution_count for cell in code], list(range(1, len(code) + 1)), path.name)
            self.assertEqual(notebook, tidied_but_for_figures(notebook), path.name)

    def test_cases_are_those_of_the_book(self) -> None:
        for name, notebook in self.stored.items():
            self.assertIn("bed.toml", cells_that_write(notebook), name)
            wanted, found = ([cell.source for cell in each.cells] for each in (filled(notebook), notebook))
            self.assertEqual(found, wanted, f"{name}: .venv/bin/python scripts/notebooks.py --write puts the book's text there")

    def test_nothing_of_a_machine_is_stored(self) -> None:
        for name, notebook in self.stored.items():
            for cell in notebook.cells:
                self.assertEqual(marks_of_a_machine(cell), [], name)

    def test_files_they_name_are_there(self) -> None:
        count = 0
        for name, notebook in self.stored.items():
            for cell in notebook.cells:
                prose = cell.source if cell.cell_type == "markdown" else ""
                for path in re.findall(r"`(docs/[\w/.-]+)`", prose):
                    self.assertTrue((ROOT / path).is_file(), f"{name}: {path}")
                    count += 1
                for link in re.findall(r"\]\(([^)]+)\)", prose):
                    self.assertTrue((ROOT / "docs/notebooks" / link).is_file(), f"{name}: {link}")
                    count += 1
        self.assertGreater(count, 20)

    def test_they_use_the_words_of_the_field(self) -> None:
        retired = retired_words()
        self.assertIn("picture", retired)
        for name, notebook in self.stored.items():
            text = "\n".join(cell.source for cell in notebook.cells)
            used = [phrase for phrase in retired if re.search(rf"\b{re.escape(phrase)}\b", text, re.IGNORECASE)]
            self.assertEqual(used, [], name)

    def test_the_page_of_the_book_lists_them(self) -> None:
        page = (ROOT / "docs/notebooks.md").read_text(encoding="utf-8")
        self.assertEqual(re.findall(r"\]\(notebooks/([^)]+)\)", page), list(self.stored))


def tidied_but_for_figures(notebook: NotebookNode) -> NotebookNode:
    """What storing would make of a notebook, but that figures stay as they are."""
    tidy = tidied(notebook)
    for cell, before in zip(tidy.cells, notebook.cells):
        for output, other in zip(cell.get("outputs", []), before.get("outputs", [])):
            if "image/png" in output.get("data", {}):
                output.data = other.data
    return tidy


def marks_of_a_machine(cell: NotebookNode) -> list[str]:
    """What in a cell's outputs belongs to the machine that executed it: paths, its name, times, complaints."""
    found = []
    for output in cell.get("outputs", []):
        texts = [output.get("text", ""), *(text for kind, text in output.get("data", {}).items() if kind != "image/png")]
        text = "\n".join(texts)
        found += ABSOLUTE.findall(re.sub(r"</\w+>", "", text)) + TIMES.findall(text)
        found += [socket.gethostname()] if re.search(rf"\b{re.escape(socket.gethostname())}\b", text) else []
        found += [output.output_type] if output.output_type == "error" else []
        found += [output.text] if output.get("name") == "stderr" else []
    return found


class TestExecuted(unittest.TestCase):
    """Each notebook is executed from its beginning in an empty folder, two at a time."""

    def test_they_give_what_is_stored(self) -> None:
        with ThreadPoolExecutor(2) as pool:
            done = pool.map(compared, notebooks())
        for path, ended in zip(notebooks(), done):
            with self.subTest(path.name):
                advice = "if this is meant: .venv/bin/python scripts/notebooks.py --write"
                self.assertEqual(ended.returncode, 0, f"{ended.stdout}\n{ended.stderr}\n{advice}")
                self.assertIn(path.name, ended.stdout)

    def test_a_notebook_that_is_not_there(self) -> None:
        ended = compared(Path("7-nothing.ipynb"))
        self.assertEqual(ended.returncode, 2)
        self.assertIn("no such notebook: 7-nothing.ipynb; there are 1-case, 2-run,", ended.stderr)


def compared(path: Path) -> subprocess.CompletedProcess[str]:
    """Executes a notebook by the script, in a process of its own."""
    command = [sys.executable, str(ROOT / "scripts/notebooks.py"), path.stem]
    return subprocess.run(command, capture_output=True, text=True, check=False)


class TestComparing(unittest.TestCase):
    """Negative controls: what must be found, and what must not."""

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def notebook(self, *sources: str) -> NotebookNode:
        return new_notebook(cells=[new_markdown_cell("A heading"), *map(new_code_cell, sources)])

    def stored(self, notebook: NotebookNode) -> Path:
        path = self.folder / "made-up.ipynb"
        nbformat.write(notebook, path)
        return path

    def run_in(self, name: str) -> Path:
        (self.folder / name).mkdir()
        return self.folder / name

    def test_another_digit_is_found(self) -> None:
        source = "import os, sys\nprint('height 20.4')\nprint(os.listdir())\n20.5"
        path = self.stored(tidied(execute(self.notebook(source), self.run_in("first"))))
        self.assertEqual(compare(path, self.run_in("same")), [])
        printed, shown = read(path), read(path)
        printed.cells[1].outputs[0].text = "height 20.3\n[]\n"
        shown.cells[1].outputs[1].data["text/plain"] = "20.6"
        for name, other, lines in [("printed", printed, ("-height 20.3", "+height 20.4")), ("shown", shown, ("-20.6", "+20.5"))]:
            found = compare(self.stored(other), self.run_in(name))
            self.assertEqual(found[0], "cell 2:")
            self.assertEqual([line for line in found[3:] if line[0] in "+-"], list(lines))

    def test_a_cell_that_raises_is_found(self) -> None:
        path = self.stored(self.notebook("print(1)", "import talcum\ntalcum.open('nowhere')"))
        found = compare(path, self.run_in("run"))
        self.assertIn("a cell raises", found[0])
        self.assertIn("nowhere: is not a folder of results", found[0])

    def test_pieces_and_figures_make_no_difference(self) -> None:
        stored, anew = self.notebook("x"), self.notebook("x")
        stored.cells[1].outputs = [new_output("stream", name="stdout", text="one two\n")]
        anew.cells[1].outputs = [new_output("stream", name="stdout", text=text) for text in ("one ", "two\n")]
        for notebook, size in [(stored, 4), (anew, 5)]:
            data = {"image/png": figure(size), "text/plain": f"<Figure of {size}>"}
            notebook.cells[1].outputs.append(new_output("display_data", data))
        self.assertEqual(differences(stored, anew), [])
        self.assertEqual(len(tidied(anew).cells[1].outputs), 2)
        anew.cells[1].outputs.pop(0)
        self.assertEqual(differences(stored, anew)[0], "cell 2:")
        self.assertEqual(differences(stored, self.notebook("x", "y")), ["the cells are not the same"])

    def test_a_stored_figure_is_small_and_its_colours_stay(self) -> None:
        notebook = self.notebook("x")
        notebook.cells[1].outputs = [new_output("display_data", {"image/png": figure(2000)})]
        data = tidied(notebook).cells[1].outputs[0].data["image/png"]
        with Image.open(io.BytesIO(base64.b64decode(data))) as stored:
            self.assertLessEqual(stored.width, 800)
            self.assertEqual(stored.convert("RGB").getpixel((1, 1)), (255, 255, 255))
            red, green, blue = stored.convert("RGB").getpixel((stored.width - 2, stored.height // 2))
        self.assertTrue(abs(red - 200) < 6 and abs(green - 140) < 6 and blue < 6, (red, green, blue))

    def test_the_text_of_the_book_is_filled_in(self) -> None:
        blocks = blocks_of("bed.toml")
        whole, parts = self.notebook("%%writefile a/bed.toml"), self.notebook(*["%%writefile -a a/bed.toml\nold"] * len(blocks))
        fill_in(whole)
        fill_in(parts)
        self.assertEqual(whole.cells[1].source, "%%writefile a/bed.toml\n" + "\n".join(blocks).rstrip("\n"))
        self.assertEqual([cell.source.count("old") for cell in parts.cells], [0] * (len(blocks) + 1))
        with self.assertRaisesRegex(ValueError, "bed.toml is written by 2 cells, but has 4 blocks"):
            fill_in(self.notebook(*["%%writefile a/bed.toml"] * 2))

    def test_marks_of_a_machine_are_found(self) -> None:
        good = ["rho_s g d^3", "sqrt(d/g) 1/s", "results/bed/x.h5", "<td>1</td>\n<th>a/b</th>", "https://example.org/a/b/"]
        bad = ["in /tmp/x/y", "'/home/a/b'", "2026-01-02 03:04", "took 3 ms", f"on {socket.gethostname()} now"]
        for texts, count in [(good, 0), (bad, 1)]:
            for text in texts:
                cell = new_code_cell(outputs=[new_output("stream", name="stdout", text=text)])
                self.assertEqual(len(marks_of_a_machine(cell)), count, text)


def figure(width: int) -> str:
    """A made-up figure: white, a coloured strip on the right."""
    drawn = Image.new("RGB", (width, 20), "white")
    for row in range(20):
        for column in range(width - width // 10, width):
            drawn.putpixel((column, row), (200, 13 * row, 0))
    written = io.BytesIO()
    drawn.save(written, "PNG")
    return base64.b64encode(written.getvalue()).decode()


if __name__ == "__main__":
    unittest.main()
