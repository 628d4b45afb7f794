"""Checks that the tests that SECURITY.md names exist.

A name is a test program, such as `sandbox_test`, or a program and one of its suites, such as `unit_base.GuardedTest`. A
suite alone, such as `.CfReader`, belongs to the program that is named before it.
"""

import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SUITE = re.compile(r"^TEST(?:_F|_P)?\(\s*(\w+),", re.MULTILINE)


def lists() -> list[pathlib.Path]:
    """Returns the CMakeLists.txt files of tests."""
    return [path for folder in ("tests", "client-cpp/tests", "client-desktop/tests")
            for path in sorted((ROOT / folder).rglob("CMakeLists.txt")) if "node_modules" not in path.parts]


def suites_by_program() -> dict[str, set[str]]:
    """Returns the suites of each GoogleTest program."""
    suites: dict[str, set[str]] = {}
    for path in lists():
        for name, rest in re.findall(r"thunderhead_(?:test|register_suites)\((\w+)([^)]*)\)", path.read_text()):
            named = re.findall(r"\S+\.cc", rest.partition("SOURCES")[2].replace("${CMAKE_SOURCE_DIR}", str(ROOT)))
            sources = [path.parent / source for source in named] or sorted(path.parent.glob("*.cc"))
            suites[name] = {suite for source in sources for suite in SUITE.findall(source.read_text())}
    return suites


def other_tests() -> set[str]:
    """Returns the names of the tests that are not of a GoogleTest program."""
    names = {name for path in lists() for name in re.findall(r"add_test\(NAME ([a-z_.]+) ", path.read_text())}
    return names | {f"fuzz.{path.stem.removeprefix('fuzz_')}" for path in (ROOT / "tests/fuzz").glob("fuzz_*.cc")}


def named_tests(page: str) -> list[str]:
    """Returns the tests that the last column of the page's tables names, each with its program."""
    found = []
    for line in page.splitlines():
        if not line.startswith("|"):
            continue
        program = ""
        for name in re.findall(r"`([\w.]+)`", line.rstrip(" |").rpartition("|")[2]):
            if name.startswith("."):
                name = program + name
            program = name.partition(".")[0]
            found.append(name)
    return found


class SecurityTest(unittest.TestCase):
    def test_every_test_that_the_page_names_exists(self) -> None:
        named = named_tests((ROOT / "SECURITY.md").read_text())
        self.assertGreater(len(named), 50)
        suites, others = suites_by_program(), other_tests()
        for name in sorted(set(named)):
            program, _, suite = name.partition(".")
            exists = name in others or (program in suites and (not suite or suite in suites[program]))
            self.assertTrue(exists, f"SECURITY.md names the test {name}, which does not exist; name the test that replaces it")

    def test_a_suite_alone_belongs_to_the_program_before_it(self) -> None:
        page = "| `crash` | attack | `x_test.First`, `.Second` |\n| none | `--flag` | `y_test`; `./dev soak` |"
        self.assertEqual(named_tests(page), ["x_test.First", "x_test.Second", "y_test"])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
