"""Runs the cases that all clients share: tests/clients/README.md."""

import json
import math
import pathlib
import unittest
from collections.abc import Callable
from typing import Any

from google.protobuf import json_format

from thunderhead.scenes import limits_of
from thunderhead.v1 import scene_pb2

CASES = pathlib.Path(__file__).resolve().parents[2] / "tests/clients/cases"
# The tolerated difference of two numbers, relative or absolute. Messages store 32-bit floats, so results are not exact.
TOLERANCE = 1e-5


class CaseError(Exception):
    """A case that the runner does not understand, or whose result differs."""


class Arguments:
    """The arguments of one step, or the values of `given`, the state before the first step. Records which were read."""

    def __init__(self, values: "dict[str, Any]") -> None:
        self._values = values
        self._read: "set[str]" = set()

    def get(self, name: str) -> Any:
        self._read.add(name)
        if name not in self._values:
            raise CaseError(f"the argument '{name}' is missing")
        return self._values[name]

    def expect_all_read(self) -> None:
        """Raises CaseError if an argument was not read."""
        unread = set(self._values) - self._read
        if unread:
            raise CaseError(f"the runner does not know: {', '.join(sorted(unread))}")


# An Action runs a step and returns its results by name. A Runner makes a module in the given state, and returns its
# actions by name.
Action = Callable[[Arguments], "dict[str, Any]"]
Runner = Callable[[Arguments], "dict[str, Action]"]


def run_limits(given: Arguments) -> "dict[str, Action]":
    # The limits do not depend on the scene, but the scene must be valid.
    json_format.ParseDict(given.get("scene"), scene_pb2.Scene())

    def limits(step: Arguments) -> "dict[str, Any]":
        found = limits_of(step.get("path"))
        default = found.default_value if found.HasField("default_value") else None
        return {"minimum": found.minimum, "maximum": found.maximum, "default": default, "unit": found.unit,
                "logarithmic": found.logarithmic}

    return {"limits": limits}


RUNNERS: "dict[str, Runner]" = {"limits": run_limits}


def is_equal(expected: Any, found: Any) -> bool:
    number = isinstance(expected, (int, float)) and not isinstance(expected, bool)
    if number and isinstance(found, (int, float)) and not isinstance(found, bool):
        return math.isclose(expected, found, rel_tol=TOLERANCE, abs_tol=TOLERANCE)
    return type(expected) is type(found) and bool(expected == found)


def run_step(actions: "dict[str, Action]", step: "dict[str, Any]") -> None:
    values = {key: value for key, value in step.items() if key not in ("do", "times", "expect")}
    action = actions.get(step["do"])
    if action is None:
        raise CaseError(f"the runner does not know the action '{step['do']}'")
    results: "dict[str, Any]" = {}
    for _ in range(step.get("times", 1)):
        arguments = Arguments(values)
        results = action(arguments)
        arguments.expect_all_read()
    for key, expected in step.get("expect", {}).items():
        if key not in results:
            raise CaseError(f"the runner does not know the result '{key}'")
        if not is_equal(expected, results[key]):
            raise CaseError(f"{key} is {results[key]} in place of {expected}")


def run_case(runner: Runner, case: "dict[str, Any]") -> None:
    """Raises CaseError if the module does not do what the case expects."""
    given = Arguments(case.get("given", {}))
    actions = runner(given)
    given.expect_all_read()
    if not any("expect" in step for step in case["steps"]):
        raise CaseError("the case expects nothing")
    for step in case["steps"]:
        run_step(actions, step)


class CasesTest(unittest.TestCase):
    def test_every_case_of_the_files_that_name_this_client(self) -> None:
        files = {path.stem: json.loads(path.read_text()) for path in CASES.glob("*.json")}
        named = {name for name, file in files.items() if "python" in file["modules"]}
        self.assertEqual(named, set(RUNNERS), "the files that name python in place of the runners")
        for name in sorted(named):
            for case in files[name]["cases"]:
                with self.subTest(name, case=case["name"]):
                    run_case(RUNNERS[name], case)

    def test_a_case_that_the_runner_does_not_understand_fails(self) -> None:
        def runner(_: Arguments) -> "dict[str, Action]":
            return {"add": lambda step: {"sum": step.get("by")}}

        run_case(runner, {"steps": [{"do": "add", "by": 1, "expect": {"sum": 1}}]})
        for message, case in {
            "does not know the action": {"steps": [{"do": "divide", "expect": {}}]},
            "does not know: slow": {"steps": [{"do": "add", "by": 1, "slow": True, "expect": {}}]},
            "does not know the result": {"steps": [{"do": "add", "by": 1, "expect": {"rest": 0}}]},
            "is 1 in place of 2": {"steps": [{"do": "add", "by": 1, "expect": {"sum": 2}}]},
            "is True in place of 1": {"steps": [{"do": "add", "by": True, "expect": {"sum": 1}}]},
            "is missing": {"steps": [{"do": "add", "expect": {}}]},
            "does not know: from": {"given": {"from": 1}, "steps": [{"do": "add", "by": 1, "expect": {}}]},
            "expects nothing": {"steps": [{"do": "add", "by": 1}]},
        }.items():
            with self.assertRaisesRegex(CaseError, message):
                run_case(runner, case)


if __name__ == "__main__":
    unittest.main()
