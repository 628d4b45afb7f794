"""Tests the recipes of README.md and docs/pipelines.md: runs them as a new user would, on copies of the files that they
name.

Also checks that every file of this repository that a page about pipelines names exists.
"""

import os
import pathlib
import re
import unittest

from product_test import PROGRAM, ROOT, ProductTest, run

PAGES = [ROOT / "docs/pipelines.md", *sorted((ROOT / "docs/pipelines").glob("*.md"))]


def blocks(page: pathlib.Path) -> list[str]:
    """Returns the page's blocks of shell commands."""
    return re.findall(r"^```sh\n(.*?)^```$", page.read_text(), re.M | re.S)


class RecipesTest(ProductTest):
    def follow(self, commands: str) -> list[str]:
        """Runs the commands and returns the names of all products.

        Leaves out the build, which is already done, and draws small pictures to save time.
        """
        (self.folder / "build/release").mkdir(parents=True, exist_ok=True)
        (self.folder / "build/release/bin").symlink_to(pathlib.Path(PROGRAM).parent)
        for name in ("samples", "deploy"):
            (self.folder / name).symlink_to(ROOT / name)
        commands = re.sub(r"(?m)^\./dev build.*$", "", commands)
        commands, sizes = re.subn(r"--size \d+x\d+", "--size 64x36 --quality fast --device software", commands)
        self.assertGreater(sizes, 0)
        run("bash", "-euo", "pipefail", "-c", commands, cwd=self.folder, env={**os.environ, "HOME": str(self.folder)})
        return sorted(file.name for file in (self.folder / "products").iterdir())

    def expect_a_run(self, products: list[str]) -> None:
        self.assertEqual(sum(name.endswith("_west.png") for name in products), 4, products)
        self.assertEqual(sum(name.endswith("_above.png") for name in products), 4, products)
        self.assertEqual([name for name in products if not name.endswith(".png")],
                         ["manifest.jsonl", *(name for name in products if name.endswith(".webm"))])
        self.assertEqual(sum(name.endswith(".webm") for name in products), 2, products)

    def test_the_pages_recipe(self) -> None:
        watch, sequence = blocks(ROOT / "docs/pipelines.md")[:2]
        self.assertIn("thunderhead watch", watch)
        self.assertIn("thunderhead sequence", sequence)
        products = self.follow(watch)
        self.expect_a_run(products)
        for file in (self.folder / "products").iterdir():
            file.unlink()
        sequence = sequence.replace("1280x720", "64x36 --quality fast --device software")
        run("bash", "-euo", "pipefail", "-c", 'PATH="$PWD/build/release/bin:$PATH"\n' + sequence, cwd=self.folder)
        self.expect_a_run(sorted(file.name for file in (self.folder / "products").iterdir()))

    def test_the_readmes_recipe(self) -> None:
        (recipe,) = [block for block in blocks(ROOT / "README.md") if "thunderhead watch" in block]
        self.expect_a_run(self.follow(recipe))

    def test_every_file_that_a_page_names_is_there(self) -> None:
        engines = {page.stem for page in PAGES}
        self.assertLessEqual({"slurm", "ecflow", "kubernetes", "systemd"}, engines)
        for page in PAGES:
            text = page.read_text()
            self.assertTrue(blocks(page), f"{page} has no recipe")
            if page.parent.name == "pipelines":
                before = text[: text.index("```sh")]
                self.assertLess(before.count("\n"), 6, f"{page} does not begin with its recipe")
            for name in re.findall(r"(?<![\w/.])deploy/[\w./@-]*\w", " ".join(blocks(page))):
                self.assertTrue((ROOT / name).exists(), f"{page} names {name}")
            for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", text):
                self.assertTrue((page.parent / link).exists(), f"{page} links to {link}")


if __name__ == "__main__":
    unittest.main()
