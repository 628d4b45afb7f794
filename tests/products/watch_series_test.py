"""Tests what the owner of a forecast suite needs from `watch`.

It starts on an empty folder. The twelve files of a run are copied into the folder as a model would write them, and the
program is killed several times. At the end there must be twelve images of each of two views, one movie, a manifest
whose hashes match, and no leftover files.
"""

import collections
import hashlib
import json
import pathlib
import shutil
import subprocess
import threading
import unittest

from product_test import HANG_LIMIT_S, PROGRAM, ROOT, ProductTest, run, wait_for

# Twelve files of one model run, next to the repository.
SERIES = ROOT.parent / "shared/data/supercell-series"
# The program is killed when so many products exist.
KILLED_AT = (1, 8, 17)
PIECES = 5
# The index of the file that is first copied truncated.
CUT = 4
# After this file the third is copied once more.
AGAIN_AFTER = 6


def sha256(file: pathlib.Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()


class WatchSeriesTest(ProductTest):
    def setUp(self) -> None:
        super().setUp()
        self.assertTrue(SERIES.is_dir(), f"{SERIES} is missing: it lies in the folder shared beside the repository")
        self.files = sorted(SERIES.iterdir())
        self.assertEqual(len(self.files), 12)
        self.inbox, self.products = self.folder / "run42", self.folder / "products"
        self.inbox.mkdir()
        self.log = self.folder / "events"
        self.killed = threading.Event()
        self.command = [
            PROGRAM, "watch", self.inbox, "--until", "12", "files", "--size", "160x90", "--quality", "fast", "--device", "software",
            "--views", self.scene("west.json", '{"camera": {"orbit": {"azimuthDeg": 270}}}'),
            self.scene("above.json", '{"camera": {"topDown": {}}}'),
            "--product", self.products / "{storm}_{valid:%H%M}_{view}.png", "--movie", self.products / "{storm}.webm", "--progress", "json",
        ]

    def copy(self, file: pathlib.Path, share: float = 1.0) -> None:
        """Writes the file, or its first part, in pieces. Replaces a file that exists."""
        data = file.read_bytes()
        data = data[: int(share * len(data))]
        step = len(data) // PIECES + 1
        with open(self.inbox / file.name, "wb") as to:
            for at in range(0, len(data), step):
                to.write(data[at : at + step])
                to.flush()

    def is_found_cut(self, file: pathlib.Path) -> bool:
        return f"waits until it changes: {self.inbox / file.name}" in self.log.read_text()

    def model(self) -> None:
        """Writes the files into the folder one after another, as a model does."""
        cut = self.files[CUT]
        for number, file in enumerate(self.files):
            self.copy(file, 0.6 if file == cut else 1.0)
            if file == cut:
                wait_for("a look at the file that is cut short", lambda: self.is_found_cut(cut))
            if number == AGAIN_AFTER:
                wait_for("pictures of the third file", lambda: len(list(self.products.glob("run42_0030_*.png"))) == 2)
                self.copy(self.files[2])
        # The complete file comes only after all others are drawn and the program has been killed for the last time.
        wait_for("pictures of the other files", lambda: self.pictures() == 2 * len(self.files) - 2 and self.killed.is_set())
        self.copy(cut)

    def pictures(self) -> int:
        return len(list(self.products.glob("*.png")))

    def watch(self) -> subprocess.Popen:
        with open(self.log, "ab") as log, open(self.folder / "errors", "ab") as errors:
            return subprocess.Popen([str(part) for part in self.command], stdout=log, stderr=errors)

    def test_files_as_they_come_in_life(self) -> None:
        self.log.touch()
        model = threading.Thread(target=self.model)
        model.start()
        self.addCleanup(model.join)
        for count in KILLED_AT:
            program = self.watch()
            wait_for(f"{count} pictures", lambda: self.pictures() >= count or program.poll() is not None)
            self.assertIsNone(program.poll(), (self.folder / "errors").read_text())
            program.kill()
            program.wait()
        self.killed.set()
        program = self.watch()
        self.assertEqual(program.wait(HANG_LIMIT_S), 0, (self.folder / "errors").read_text())
        self.check()
        # Another run draws nothing.
        before = self.log.read_text().count('"event":"drawn"')
        program = self.watch()
        self.assertEqual(program.wait(HANG_LIMIT_S), 0)
        self.assertEqual(self.log.read_text().count('"event":"drawn"'), before)
        self.check()

    def check(self) -> None:
        stills = [f"run42_{minutes // 60:02d}{minutes % 60:02d}_{view}.png" for minutes in range(10, 130, 10) for view in ("west", "above")]
        there = sorted(file.name for file in self.products.iterdir())
        self.assertEqual(there, sorted([*stills, "manifest.jsonl", "run42.webm"]))
        entries = [json.loads(line) for line in (self.products / "manifest.jsonl").read_text().splitlines()]
        self.assertEqual(sorted(entry["file"] for entry in entries), sorted([*stills, "run42.webm"]))
        # Checks the hashes as docs/pipelines.md tells an auditor to.
        sums = "".join(f'{entry["sha256"]}  {entry["file"]}\n' for entry in entries)
        run("sha256sum", "--check", "--quiet", text=sums, cwd=self.products)
        made_of = {file.name: sha256(file) for file in self.files}
        for entry in entries:
            if entry["file"].endswith(".png"):
                self.assertEqual(entry["input"]["sha256"], made_of[pathlib.Path(entry["input"]["file"]).name], entry["file"])
        events = [json.loads(line) for line in self.log.read_text().splitlines() if line.endswith("}")]
        drawn = collections.Counter(pathlib.Path(event["file"]).name for event in events if event["event"] == "drawn")
        # A run that is killed between a product and its log line does not log the product. No other product is drawn
        # twice.
        self.assertEqual({name: drawn[name] for name in stills if drawn[name] > 1}, {})
        self.assertGreaterEqual(sum(drawn[name] for name in stills), len(stills) - len(KILLED_AT) * 2)
        if shutil.which("ffprobe") is not None:
            movie = json.loads(run("ffprobe", "-v", "error", "-count_frames", "-show_streams", "-of", "json", self.products / "run42.webm").stdout)
            self.assertEqual(movie["streams"][0]["nb_read_frames"], "12")


if __name__ == "__main__":
    unittest.main()
