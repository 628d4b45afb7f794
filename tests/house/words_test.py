"""Tests that deploy/lint/words.py reads the prose of each kind of file."""

import importlib.util
import pathlib
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SPECIFICATION = importlib.util.spec_from_file_location("words", ROOT / "deploy/lint/words.py")
words = importlib.util.module_from_spec(SPECIFICATION)
SPECIFICATION.loader.exec_module(words)

FAULT = "It goes on."  # words: keep
LONG = "It " + "is so " * 16 + "long."


def kinds(path: str, text: str) -> list[tuple[int, str]]:
    """Returns line and kind of each fault of a file."""
    return [(line, kind) for line, kind, _ in words.faults_in(path, text, words.phrases())]


class WordsTest(unittest.TestCase):
    def test_every_kind_of_file_is_read(self) -> None:
        texts = {
            "a.cc": f"\n// {FAULT}\n",
            "a.tsx": f"\nconst a = 1;  // {FAULT}\n",
            "a.frag": f"\n// {FAULT}\n",
            "a.css": f"\n/* Some\n   words. {FAULT} */\n",
            "a.md": f"\n{FAULT}\n",
            "a.yaml": f"\na: 1  # {FAULT}\n",
            "a.cfg": f"\n# {FAULT}\n",
            "a@.service": f"\n# {FAULT}\n",
            "folder/CMakeLists.txt": f"\n# {FAULT}\n",
            "a.cmake": f"\n# {FAULT}\n",
            "dev": f"#!/usr/bin/env bash\n# {FAULT}\n",
            "a.py": f'\n"""{FAULT}"""\n',
        }
        for path, text in texts.items():
            self.assertEqual(kinds(path, text), [(2, "phrase")], path)
        self.assertEqual(kinds("folder/notes.txt", texts["a.cc"]), [], "a text that is no source")

    def test_docstrings_of_classes_and_functions_are_read(self) -> None:
        source = f'class A:\n    """First.\n\n    {FAULT}\n    """\n\n    def f(self):\n        """{LONG}"""\n'
        self.assertEqual(kinds("a.py", source), [(4, "phrase"), (8, "length")])

    def test_items_are_separate_sentences(self) -> None:
        half = "is so " * 8
        self.assertEqual(kinds("a.py", f'"""First.\n\nname: {half}\n    {half}\nother: {half}\n"""\n'), [(3, "length")])
        self.assertEqual(kinds("dev", f"# First.\n#   one {half}\n#   two {half}\n"), [])
        self.assertEqual(kinds("dev", f"# First.\n#   one {half}\n#       {half}\n"), [(2, "length")])

    def test_addresses_of_links_are_no_prose(self) -> None:
        self.assertEqual(kinds("a.md", "See [it](goes-on-besides.md).\n"), [])

    def test_decisions_and_measurements_are_read_but_no_records(self) -> None:
        left_out = [folder for folder in ("decisions", "accuracy", "lab") if words.LEFT_OUT.match(f"docs/{folder}/a.md")]
        self.assertEqual(left_out, ["lab"])


if __name__ == "__main__":
    unittest.main()
