"""Tests of the page that says what the tests show: every file of tests has a comment at its head."""

from __future__ import annotations

import tempfile
import unittest
from pathlib import Path

from index_of_tests import ROOT, claim, files_with_tests, page, tests_in, without_claim

ONE = "//! Head\n//! of it.\n//!\n//! More.\n#[test]\n/// Why.\n#[ignore]\nfn one_is_one() {}\nfn no_test() {}\n"


class TestIndex(unittest.TestCase):
    """The files of the repository, and made-up ones."""

    def test_every_file_of_tests_says_what_it_shows(self) -> None:
        self.assertGreater(len(files_with_tests(ROOT)), 200)
        self.assertEqual(without_claim(ROOT), [])

    def test_a_test_is_found_behind_attributes_and_comments(self) -> None:
        self.assertEqual((claim(ONE), tests_in(ONE)), ("Head of it.", ["one_is_one"]))

    def test_the_page_has_programs_files_and_tests(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            for name, text in {"tests/physics/main.rs": "//! Physics.\nmod one;\n", "tests/physics/one.rs": ONE, "src/two.rs": ONE[18:]}.items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(text)
            parts = page(root).split("\n## ")
            self.assertEqual(len(parts), 3)
            self.assertEqual(parts[1], "`cargo test --test physics`\n\nPhysics.\n\n**`tests/physics/one.rs`**: Head of it.\n\n* one is one\n")
            self.assertEqual(without_claim(root), ["src/two.rs"])  # it begins with an empty line of its comment


if __name__ == "__main__":
    unittest.main()
