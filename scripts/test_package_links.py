"""The Python package: its modules are the scripts, and its example is a case of the repository."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent.parent / "python"


def example(folder: str) -> subprocess.CompletedProcess[str]:
    """Calls `python -m talcum.example` in a folder."""
    command = [sys.executable, "-m", "talcum.example"]
    environment = {"PYTHONPATH": str(PACKAGE)}
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)


class Package(unittest.TestCase):
    def test_modules_are_the_scripts(self) -> None:
        links = [path for path in PACKAGE.rglob("*") if path.is_symlink()]
        self.assertGreater(len(links), 6)
        for link in links:
            self.assertTrue(link.is_file(), link)
            name = link.parent.name + ".py" if link.name == "__init__.py" else link.name
            self.assertEqual(name, link.resolve().name)

    def test_the_example_is_written_once(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            said = example(folder)
            self.assertEqual(said.returncode, 0, said.stderr)
            self.assertIn("talcum run first-bed.toml --threads 2", said.stdout)
            case = PACKAGE.parent / "cases/first-bed.toml"
            self.assertEqual((Path(folder) / case.name).read_text(), case.read_text())
            again = example(folder)
            self.assertEqual((again.returncode, again.stdout), (1, ""))
            self.assertIn("error: first-bed.toml: File exists", again.stderr)


if __name__ == "__main__":
    unittest.main()
