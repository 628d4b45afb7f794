"""What whoever owns a forecast suite asks for: `watch` on an empty folder, the twelve files of a run copied in as files come in life, killed
on the way, and at the end twelve stills of each of two views, one movie, a manifest whose hashes check, and no leftovers."""

import collections
import hashlib
import json
import pathlib
import shutil
import subprocess
import threading
import time
import unittest

from product_test import PROGRAM, ROOT, ProductTest, run

# Twelve files of one run, beside the repository.
SERIES = ROOT.parent / "shared/data/supercell-series"
# So many products are there when it is killed.
KILLED_AT = (1, 8, 17)
PIECES = 5


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
        self.command = [
            PROGRAM, "watch", self.inbox, "--until", "12", "files", "--size", "160x90", "--quality", "fast", "--device", "software",
            "--views", self.scene("west.json", '{"camera": {"orbit": {"azimuthDeg": 270}}}'),
            self.scene("above.json", '{"camera": {"topDown": {}}}'),
            "--product", self.products / "{storm}_{valid:%H%M}_{view}.png", "--movie", self.products / "{storm}.webm", "--progress", "json",
        ]

    def copy(self, file: pathlib.Path, share: float = 1.0) -> None:
        """In pieces, as over a slow link; in place of what is there."""
        data = file.read_bytes()
        data = data[: int(share * len(data))]
        step = len(data) // PIECES + 1
        with open(self.inbox / file.name, "wb") as to:
            for at in range(0, len(data), step):
                to.write(data[at : at + step])
                to.flush()
                time.sleep(0.2)

    def model(self) -> None:
        """What comes into the folder, and when."""
        for number, file in enumerate(self.files):
            # The fifth comes cut short; whole only after the last.
            self.copy(file, 0.6 if number == 4 else 1.0)
            if number == 6:
                self.copy(self.files[2])
        time.sleep(5)
        self.copy(self.files[4])

    def pictures(self) -> int:
        return len(list(self.products.glob("*.png")))

    def watch(self) -> subprocess.Popen:
        with open(self.log, "ab") as log, open(self.folder / "errors", "ab") as errors:
            return subprocess.Popen([str(part) for part in self.command], stdout=log, stderr=errors)

    def test_files_as_they_come_in_life(self) -> None:
        model = threading.Thread(target=self.model)
        model.start()
        self.addCleanup(model.join)
        for count in KILLED_AT:
            program = self.watch()
            while self.pictures() < count:
                self.assertIsNone(program.poll(), (self.folder / "errors").read_text())
                time.sleep(0.02)
            program.kill()
            program.wait()
        program = self.watch()
        self.assertEqual(program.wait(500), 0, (self.folder / "errors").read_text())
        self.check()
        # The same again draws nothing.
        before = self.log.read_text().count('"event":"drawn"')
        program = self.watch()
        self.assertEqual(program.wait(300), 0)
        self.assertEqual(self.log.read_text().count('"event":"drawn"'), before)
        self.check()

    def check(self) -> None:
        stills = [f"run42_{minutes // 60:02d}{minutes % 60:02d}_{view}.png" for minutes in range(10, 130, 10) for view in ("west", "above")]
        there = sorted(file.name for file in self.products.iterdir())
        self.assertEqual(there, sorted([*stills, "manifest.jsonl", "run42.webm"]))
        entries = [json.loads(line) for line in (self.products / "manifest.jsonl").read_text().splitlines()]
        self.assertEqual(sorted(entry["file"] for entry in entries), sorted([*stills, "run42.webm"]))
        # As docs/pipelines.md tells an auditor to.
        sums = "".join(f'{entry["sha256"]}  {entry["file"]}\n' for entry in entries)
        run("sha256sum", "--check", "--quiet", text=sums, cwd=self.products)
        made_of = {file.name: sha256(file) for file in self.files}
        for entry in entries:
            if entry["file"].endswith(".png"):
                self.assertEqual(entry["input"]["sha256"], made_of[pathlib.Path(entry["input"]["file"]).name], entry["file"])
        events = [json.loads(line) for line in self.log.read_text().splitlines() if line.endswith("}")]
        drawn = collections.Counter(pathlib.Path(event["file"]).name for event in events if event["event"] == "drawn")
        # Whoever is killed after a product and before its line says nothing of it; nothing else is drawn twice.
        self.assertEqual({name: drawn[name] for name in stills if drawn[name] > 1}, {})
        self.assertGreaterEqual(sum(drawn[name] for name in stills), len(stills) - len(KILLED_AT) * 2)
        if shutil.which("ffprobe") is not None:
            movie = json.loads(run("ffprobe", "-v", "error", "-count_frames", "-show_streams", "-of", "json", self.products / "run42.webm").stdout)
            self.assertEqual(movie["streams"][0]["nb_read_frames"], "12")


if __name__ == "__main__":
    unittest.main()
