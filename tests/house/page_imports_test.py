"""Checks that no modules of the page import each other in a circle."""

import os
import pathlib
import re
import sys
import tempfile
import unittest

SOURCES = pathlib.Path(__file__).resolve().parents[2] / "client-web" / "src"
IMPORT = re.compile(r'(?:import|export)\s[^;]*?from\s+"(\.[^"]+)"|import\("(\.[^"]+)"\)')


def imports_of(sources: pathlib.Path) -> dict[str, list[str]]:
    """Returns the modules that each module imports, by their paths."""
    modules = {str(path.relative_to(sources)) for path in sources.rglob("*.ts*")}
    imports: dict[str, list[str]] = {}
    for module in sorted(modules):
        imports[module] = []
        for match in IMPORT.finditer((sources / module).read_text()):
            target = os.path.normpath(os.path.join(os.path.dirname(module), match[1] or match[2]))
            imports[module] += [target + end for end in (".ts", ".tsx") if target + end in modules]
    return imports


def find_circle(imports: dict[str, list[str]]) -> list[str]:
    """Returns the modules of one circle in its order, or none."""
    done: set[str] = set()

    def search(module: str, path: list[str]) -> list[str]:
        if module in path:
            return path[path.index(module) :]
        if module in done:
            return []
        for other in imports[module]:
            if circle := search(other, [*path, module]):
                return circle
        done.add(module)
        return []

    for module in imports:
        if circle := search(module, []):
            return circle
    return []


class PageImportsTest(unittest.TestCase):
    def test_no_modules_import_each_other(self) -> None:
        imports = imports_of(SOURCES)
        self.assertGreater(sum(map(len, imports.values())), 100)
        self.assertEqual(find_circle(imports), [])

    def test_a_circle_is_found(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            sources = pathlib.Path(folder)
            (sources / "a.ts").write_text('import type { B } from "./b";\n')
            (sources / "b.tsx").write_text('export { c } from "./c";\n')
            (sources / "c.ts").write_text('const a = () => import("./a");\n')
            self.assertEqual(find_circle(imports_of(sources)), ["a.ts", "b.tsx", "c.ts"])


if __name__ == "__main__":
    sys.exit(unittest.main())
