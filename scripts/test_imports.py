"""Tests of who imports whom: no circle among the Python files of the repository, and nothing in scripts/ but a test knows a paper."""

from __future__ import annotations

import ast
import tempfile
import unittest
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PLACES = ("scripts", "python", "cases", "docs")
"""Folders with Python files."""
SEARCHED = ("scripts", "python", "")
"""Folders in which an import is looked for, in this order: those of PYTHONPATH, and the repository itself."""
PAPERS = "cases/"
"""Where the scripts of the papers are."""


def python_files(root: Path) -> list[Path]:
    """All Python files; those of the package that are links into scripts/ are that file."""
    return sorted({file.resolve() for place in PLACES for file in (root / place).rglob("*.py")})


def file_of(module: str, root: Path) -> Path | None:
    """The file of a module of the repository; None if it is of another package."""
    for folder in SEARCHED:
        place = root / folder / module.replace(".", "/")
        for file in (place.with_suffix(".py"), place / "__init__.py"):
            if file.exists():
                return file.resolve()
    return None


def package_of(file: Path, root: Path) -> str:
    """The package whose files `.` means in a file."""
    places = (root / folder for folder in SEARCHED)
    place = next(place for place in places if file.is_relative_to(place))
    return ".".join(file.relative_to(place).parent.parts)


def modules_in(file: Path, root: Path) -> Iterator[str]:
    """The modules that a file imports, anywhere in it. Of `from package import name` it is the module of that name if there is one."""
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names)
        elif isinstance(node, ast.ImportFrom):
            package = package_of(file, root).split(".")
            above = package[: len(package) + 1 - node.level] if node.level else []
            module = ".".join([*above, *([node.module] if node.module else [])])
            inside = [f"{module}.{name.name}" for name in node.names]
            yield from (name if file_of(name, root) else module for name in inside)


def imports(root: Path) -> dict[Path, set[Path]]:
    """The files of the repository that each of its files imports."""
    found = {}
    for file in python_files(root):
        known = (file_of(module, root) for module in modules_in(file, root))
        found[file] = {other for other in known if other}
    return found


def circle(graph: dict[Path, set[Path]]) -> list[Path]:
    """Files each of which imports the next, and the last the first; none if there is no such circle."""
    done: set[Path] = set()

    def walk(file: Path, path: list[Path]) -> list[Path]:
        if file in path:
            return path[path.index(file) :]
        if file not in done:
            for other in sorted(graph.get(file, ())):
                found = walk(other, [*path, file])
                if found:
                    return found
            done.add(file)
        return []

    return next((found for file in sorted(graph) if (found := walk(file, []))), [])


def of_papers(graph: dict[Path, set[Path]], root: Path) -> list[tuple[Path, Path]]:
    """Files of scripts/, but for tests, with what they import of a paper."""
    generic = [file for file in graph if file.is_relative_to(root / "scripts") and not file.name.startswith("test_")]
    return [(file, other) for file in generic for other in graph[file] if other.is_relative_to(root / PAPERS)]


class TestImports(unittest.TestCase):
    """The repository, and small ones that break its rules."""

    def names(self, files: list[Path], root: Path = ROOT) -> list[str]:
        """Their paths in the repository."""
        return [str(file.relative_to(root)) for file in files]

    def made(self, **files: str) -> Path:
        """A repository of these files; `__` in a name stands for a folder."""
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        root = Path(place.name).resolve()
        for name, text in files.items():
            file = root / f"{name.replace('__', '/')}.py"
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
        return root

    def test_no_circle_and_no_paper_in_scripts(self) -> None:
        graph = imports(ROOT)
        arrows = sum(map(len, graph.values()))
        self.assertGreater(len(graph), 90)
        self.assertGreater(arrows, 200)
        self.assertEqual(self.names(circle(graph)), [])
        self.assertEqual(of_papers(graph, ROOT), [])
        boxes = ROOT / "cases/moon2006/report/boxes.py"
        known = {file.name for file in graph[boxes]}
        self.assertEqual(known, {"tables.py", "page.py", "study_tables.py", "talcum_results.py"})

    def test_a_circle_is_found(self) -> None:
        root = self.made(scripts__a="import b", scripts__b="from cases.p.report import c", cases__p__report__c="def f():\n    from .d import g", cases__p__report__d="import a")
        found = self.names(circle(imports(root)), root)
        self.assertEqual(sorted(found), ["cases/p/report/c.py", "cases/p/report/d.py", "scripts/a.py", "scripts/b.py"])
        (root / "cases/p/report/d.py").write_text("import math")
        self.assertEqual(circle(imports(root)), [])

    def test_a_paper_in_scripts_is_found(self) -> None:
        root = self.made(scripts__a="import cases.p.report.c", scripts__test_a="from cases.p.report import c", cases__p__report__c="")
        found = of_papers(imports(root), root)
        self.assertEqual([self.names([*pair], root) for pair in found], [["scripts/a.py", "cases/p/report/c.py"]])


if __name__ == "__main__":
    unittest.main()
