"""Checks that the cases of tests/clients/ are well formed, and that every module that two clients have in common has cases."""

import json
import pathlib
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
CASES = ROOT / "tests" / "clients" / "cases"
# The folder and the ending of each client's modules.
CLIENTS = {
    "page": ("client-web/src/core", ".ts"),
    "cpp": ("client-cpp/thunderhead_client", ".h"),
    "python": ("client-python/thunderhead", ".py"),
}


def modules_of(client: str) -> set[str]:
    """Returns the names of a client's modules, without endings."""
    folder, ending = CLIENTS[client]
    return {path.stem for path in (ROOT / folder).glob(f"*{ending}")}


def faults_of(document: dict) -> list[str]:
    """Returns what is wrong with the form of a case file, one text for each fault."""
    faults = []
    if set(document) != {"about", "modules", "cases"}:
        faults.append("a file has the keys about, modules and cases")
        return faults
    for client, path in document["modules"].items():
        if client not in CLIENTS:
            faults.append(f"there is no client '{client}'")
        elif not (ROOT / path).is_file() or not path.startswith(CLIENTS[client][0]):
            faults.append(f"{path} is no module of {client}")
    if len(document["modules"]) < 2:
        faults.append("cases are for modules of two clients at least")
    names = [case.get("name") for case in document["cases"]]
    if len(set(names)) != len(names) or not names:
        faults.append("there is no case, or two cases have the same name")
    for case in document["cases"]:
        if not set(case) <= {"name", "given", "steps"} or not case.get("name"):
            faults.append(f"the case {case.get('name')} has the keys name, given and steps only")
        steps = case.get("steps", [])
        if not any("expect" in step for step in steps):
            faults.append(f"the case '{case.get('name')}' expects nothing")
        if not all("do" in step for step in steps):
            faults.append(f"a step of '{case.get('name')}' has no action")
        if any("expect" in step and not step["expect"] for step in steps):
            faults.append(f"a step of '{case.get('name')}' has an empty expectation")
    return faults


class ClientCasesTest(unittest.TestCase):
    def test_every_file_is_well_formed(self) -> None:
        files = sorted(CASES.glob("*.json"))
        self.assertGreater(len(files), 0)
        for path in files:
            self.assertEqual(faults_of(json.loads(path.read_text())), [], path.name)

    def test_every_module_of_both_page_and_library_has_cases(self) -> None:
        both = modules_of("page") & modules_of("cpp")
        self.assertIn("back_off", both)
        for module in sorted(both):
            path = CASES / f"{module}.json"
            self.assertTrue(path.exists(), f"{module} exists in the page and in client-cpp; write tests/clients/cases/{path.name}")
            named = json.loads(path.read_text())["modules"]
            for client in ("page", "cpp"):
                folder, ending = CLIENTS[client]
                self.assertEqual(named.get(client), f"{folder}/{module}{ending}", path.name)

    def test_faults_are_found(self) -> None:
        steps = [{"do": "next", "expect": {"delay_ms": 1}}]
        modules = {"page": "client-web/src/core/back_off.ts", "cpp": "client-cpp/thunderhead_client/back_off.h"}
        good = {"about": "", "modules": modules, "cases": [{"name": "a", "steps": steps}]}
        self.assertEqual(faults_of(good), [])
        for change in (
            {"more": 1},
            {"modules": {"page": modules["page"]}},
            {"modules": {**modules, "cpp": "client-cpp/none.h"}},
            {"modules": {**modules, "java": "x"}},
            {"cases": []},
            {"cases": good["cases"] * 2},
            {"cases": [{"name": "a", "steps": [{"do": "next"}]}]},
            {"cases": [{"name": "a", "steps": [*steps, {"reset": 1}]}]},
            {"cases": [{"name": "a", "steps": [{"do": "next", "expect": {}}]}]},
            {"cases": [{"name": "a", "steps": steps, "skip": True}]},
        ):
            self.assertNotEqual(faults_of({**good, **change}), [], change)


if __name__ == "__main__":
    sys.exit(unittest.main())
