"""Tests of the documents: their links, and the checker that looks at them; the cases that they show."""

from __future__ import annotations

import re
import subprocess
import tempfile
import unittest
from pathlib import Path

import command_line
from check_links import DOCUMENTS, ROOT, anchor_of, broken, html_page, markdown_page, not_in_summary
from talcum_results import program


class Links(unittest.TestCase):
    """The checker on made-up pages."""

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name).resolve()
        (self.root / "docs" / "deep").mkdir(parents=True)
        (self.root / "README.md").write_text("# Whole\n[a](docs/one.md#first-part) <img src=\"docs/x.png\">\n")
        (self.root / "docs" / "x.png").write_bytes(b"")
        (self.root / "docs" / "one.md").write_text("## First part\n[up](deep/two.md) `[code](nowhere.md)`\n")
        (self.root / "docs" / "deep" / "two.md").write_text("[back](../one.md#first-part) [far](https://example.org)\n")
        (self.root / "docs" / "SUMMARY.md").write_text("[One](one.md)\n[Two](deep/two.md)\n")

    def wrong(self) -> list[str]:
        return broken(sorted(self.root.rglob("*.md")), self.root, self.root / "docs")

    def test_good_links_pass(self) -> None:
        self.assertEqual(self.wrong(), [])
        self.assertEqual(not_in_summary(self.root / "docs"), [])

    def test_each_fault_is_found(self) -> None:
        page = self.root / "docs" / "deep" / "two.md"
        faults = {
            "[x](three.md)": "no such file",
            "[x](../one.md#second-part)": "no such heading",
            "[x](#nowhere)": "no such heading",
            "[x](../../README.md)": "leads out of the book",
            "![x](lost.png)": "no such file",
        }
        for text, said in faults.items():
            page.write_text(text)
            wrong = self.wrong()
            self.assertEqual(len(wrong), 1, text)
            self.assertIn(said, wrong[0])

    def test_a_page_without_a_place_is_found(self) -> None:
        (self.root / "docs" / "lost.md").write_text("# Lost\n")
        self.assertEqual(not_in_summary(self.root / "docs"), ["lost.md: is not in SUMMARY.md"])

    def test_anchors_are_those_of_forges(self) -> None:
        self.assertEqual(anchor_of("Drag laws: `gas.drag`"), "drag-laws-gasdrag")
        self.assertEqual(anchor_of("measure-NAME.h5, measure-NAME.vtkhdf"), "measure-nameh5-measure-namevtkhdf")
        self.assertEqual(markdown_page("# A\n# A\n```\n# no\n```\n").anchors, {"a", "a-1"})

    def test_pages_of_html_are_read(self) -> None:
        page = html_page('<h1 id="top">x</h1><a href="one.html#a">y</a><img src="p.png"><link href="s.css">')
        self.assertEqual((page.links, page.anchors), (["one.html#a", "p.png"], {"top"}))


class Documents(unittest.TestCase):
    """The documents of the repository."""

    def test_links_lead_somewhere(self) -> None:
        paths = sorted(path for pattern in DOCUMENTS for path in ROOT.glob(pattern))
        self.assertGreater(len(paths), 15)
        self.assertEqual(broken(paths, ROOT, ROOT / "docs"), [])

    def test_every_page_of_the_book_has_its_place(self) -> None:
        self.assertEqual(not_in_summary(ROOT / "docs"), [])


BLOCK = re.compile(r"^```toml\n(.*?)^```", re.MULTILINE | re.DOTALL)


def blocks_of(name: str) -> list[str]:
    """The blocks of TOML of a page of the book."""
    return BLOCK.findall((ROOT / "docs" / name).read_text(encoding="utf-8"))


def changed(case: str, block: str) -> tuple[str, list[str]]:
    """A case with the stages and walls of a block, and a `--set` for each other key of the block.

    A stage takes the place of that of the same name; other members of lists go to the end.
    """
    before, mark, members = block.partition("[[")
    for name in re.findall(r'stage]]\nname = ("\w+")', members):
        case = re.sub(rf"^\[\[stage]]\nname = {name}\n.*?(?=^\[\[|^\[(?!stage))", "", case, flags=re.MULTILINE | re.DOTALL)
    options, section = [], ""
    for line in before.splitlines():
        if line.startswith("["):
            section = line.strip("[]") + "."
        elif " = " in line:
            key, value = line.split(" #")[0].split(" = ", 1)
            options += ["--set", f"{section}{key.strip()}={value.strip()}"]
    return f"{case}\n{mark}{members}", options


class Cases(unittest.TestCase):
    """What the tutorial and the how-to pages show is accepted by `talcum check`.

    A block that begins with `# NAME` is a case, one that begins with `# in NAME` changes keys of that case.
    """

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def check(self, case: str, options: list[str]) -> subprocess.CompletedProcess[str]:
        path = self.folder / "case.toml"
        path.write_text(case, encoding="utf-8")
        return subprocess.run([program(), "check", path, *options], capture_output=True, text=True)

    def test_every_case_and_change_is_accepted(self) -> None:
        pages = sorted(page.relative_to(ROOT / "docs") for page in (ROOT / "docs" / "how-to").glob("*.md"))
        blocks = [(str(page), block) for page in pages for block in blocks_of(str(page))]
        cases = {"bed.toml": "".join(blocks_of("tutorial.md")[:4])}
        cases |= {found[1]: block for _, block in blocks if (found := re.match(r"# (\S+\.toml)\n", block))}
        self.assertEqual(sorted(cases), ["beads.toml", "bed.toml", "drum.toml", "hopper.toml", "shear.toml"])
        tried = 0
        for page, block in [*blocks, ("tutorial.md", "# in bed.toml\n"), ("running.md", "# in running.toml\n")]:
            cases["running.toml"] = blocks_of("running.md")[0]
            if found := re.match(r"# (?:in )?(\S+\.toml)\n", block):
                case, options = changed(cases[found[1]], block if block.startswith("# in ") else "")
                done = self.check(case, options)
                self.assertEqual(done.returncode, 0, f"{page}:\n{block}\n{done.stderr}")
                lines = (line for line in done.stdout.splitlines() if "  warning  " in line)
                # The bed of these pages is small, which they say.
                warnings = [line for line in lines if "cells of the gas high" not in line]
                self.assertEqual(warnings if page == "how-to/sizes.md" else [], [], block)
                tried += 1
        self.assertGreater(tried, 12)

    def test_a_wrong_change_is_seen(self) -> None:
        case, options = changed("".join(blocks_of("tutorial.md")[:4]), "[gas]\ndrag = \"wen\" # which\n")
        self.assertEqual(options, ["--set", 'gas.drag="wen"'])
        self.assertIn("gas.drag", self.check(case, options).stderr)
        stages = '[[stage]]\nname = "a"\nx = 1\n[stage.gas]\ny = 2\n[[stage]]\nname = "b"\n[output]\nz = 3\n'
        other = '[[stage]]\nname = "a"\nx = 4\n'
        self.assertEqual(changed(stages, other), (f'[[stage]]\nname = "b"\n[output]\nz = 3\n\n{other}', []))
        case, options = changed("units = 1\n", "[box]\nx = 2\n[[wall]]\nname = 3\n")
        self.assertEqual((case, options), ("units = 1\n\n[[wall]]\nname = 3\n", ["--set", "box.x=2"]))


class CommandLine(unittest.TestCase):
    """docs/command-line.md."""

    def test_the_page_is_what_the_program_says(self) -> None:
        kept = command_line.PAGE.read_text(encoding="utf-8")
        self.assertEqual(kept, command_line.page(), "python scripts/command_line.py writes docs/command-line.md again")

    def test_commands_are_those_of_the_help(self) -> None:
        text = "What\n\nCommands:\n  check  Reads\n           more\n  run-on  x\n  help   Print\n\nOptions:\n  -h\n"
        self.assertEqual(command_line.commands(text), ["check", "run-on"])


if __name__ == "__main__":
    unittest.main()
