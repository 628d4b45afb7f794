"""Tests --annotate: a picture with texts in its corners is the same from this process and from a server."""

import json
import os
import pathlib
import re
import subprocess
import unittest

from product_test import PROGRAM, SAMPLE, ProductTest, run, wait_for, write_wrf

import numpy
from PIL import Image

SIZE = ("--size", "480x270")
# No error is measured, because within a time limit it would differ from run to run.
FAST = ("--quality", "fast", "--error-seconds", "0")
LAMBERT = ({"MAP_PROJ": 1, "TRUELAT1": 41.0, "TRUELAT2": 60.0, "MOAD_CEN_LAT": 38.5, "STAND_LON": -97.0},
           "+proj=lcc +lat_1=41 +lat_2=60 +lat_0=38.5 +lon_0=-97 +R=6370000 +no_defs", (-90.0, 41.0))


def pixels(file: pathlib.Path) -> numpy.ndarray:
    with Image.open(file) as picture:
        return numpy.asarray(picture.convert("RGB"), int)


def changed(a: numpy.ndarray, b: numpy.ndarray) -> numpy.ndarray:
    """Returns where two pictures differ."""
    return (numpy.abs(a - b) > 2).any(axis=2)


class AnnotationTest(ProductTest):
    def test_the_picture_is_the_same_but_for_its_corners(self) -> None:
        plain, annotated = self.folder / "plain.png", self.folder / "annotated.png"
        self.render(SAMPLE, plain, *SIZE, *FAST)
        self.render(SAMPLE, annotated, *SIZE, *FAST, "--annotate")
        differs = changed(pixels(plain), pixels(annotated))
        self.assertGreater(differs[:45, :240].sum(), 800)
        self.assertGreater(differs[240:, :160].sum(), 200)
        self.assertEqual(differs[45:235].sum(), 0)
        self.assertEqual(differs[:, 300:].sum(), 0)
        # The PNG text contains the same scene.
        with Image.open(annotated) as a, Image.open(plain) as b:
            self.assertEqual(a.text, b.text)
        titled = self.folder / "titled.png"
        self.render(SAMPLE, titled, *SIZE, *FAST, "--annotate", "--title", "Für Zürich")
        differs = changed(pixels(titled), pixels(annotated))
        self.assertGreater(differs[:22].sum(), 200)
        self.assertEqual(differs[240:].sum(), 0, "the valid time is the same")

    def test_false_colours_have_a_legend(self) -> None:
        """Every technique that shows false colours has a legend, because the legend belongs to the setting."""
        output = self.folder / "out.png"
        for technique in ({"halfAngle": {"slices": 16}}, {"lightVolume": {"slices": 16, "tracedLight": "TRACED_LIGHT_OFF"}},
                          {"metaball": {"count": 50}}):
            (name, settings), = technique.items()
            with self.subTest(name):
                corner = {}
                for colours in (True, False):
                    scene = json.dumps({"rendering": {name: {**settings, "falseColors": colours}}})
                    self.render(SAMPLE, output, *SIZE, "--annotate", "--scene", self.scene("scene.json", scene))
                    corner[colours] = pixels(output)[150:, 380:]
                # The colours are those of cloud, rain and ice.
                for colour in ((0xE6, 0x9F, 0x00), (0x56, 0xB4, 0xE9), (0xCC, 0x79, 0xA7)):
                    self.assertGreater((numpy.abs(corner[True] - colour) < 10).all(axis=2).sum(), 15, colour)
                    self.assertEqual((numpy.abs(corner[False] - colour) < 10).all(axis=2).sum(), 0, colour)

    def test_logos(self) -> None:
        logo = self.folder / "logo.png"
        Image.new("RGBA", (30, 20), (255, 0, 255, 255)).save(logo)
        output = self.folder / "out.jpg"
        self.render(SAMPLE, output, *SIZE, *FAST, "--annotate", "--logo", logo)
        with Image.open(output) as picture:
            self.assertEqual(picture.format, "JPEG")
        # JPEG blurs colours across edges.
        purple = (numpy.abs(pixels(output) - (255, 0, 255)) < 40).all(axis=2)
        self.assertGreater(purple[:40, 420:].sum(), 300)
        self.assertEqual(purple[:, :400].sum() + purple[60:].sum(), 0)
        tiny = ("--size", "64x36", *FAST)
        self.assertIn("--logo cannot be read", self.render(SAMPLE, output, *tiny, "--annotate", "--logo", "/none.png", code=64))
        logo.write_bytes(logo.read_bytes()[:60])
        said = self.render(SAMPLE, output, *tiny, "--annotate", "--logo", logo, code=65)
        self.assertIn(f"--logo {logo}: is a damaged PNG", said)
        self.assertIn("add it", self.render(SAMPLE, output, *tiny, "--logo", logo, code=64))

    def sequence(self, storm: object, products: pathlib.Path, *more: object) -> tuple[int, list[pathlib.Path]]:
        """Renders a sequence. Returns the number of pictures drawn, and the names of all files."""
        done = run(PROGRAM, "sequence", storm, "--product", products / "{valid:%H%M}.png", "--size", "240x135", *FAST, "--annotate",
                   "--progress", "json", *more)
        drawn = [line for line in done.stdout.splitlines() if json.loads(line)["event"] == "drawn"]
        return len(drawn), sorted(products.glob("*.png"))

    def test_a_server_and_this_process_make_the_same_products(self) -> None:
        storm = self.folder / "storms" / "run.nc"
        storm.parent.mkdir()
        write_wrf(storm, LAMBERT[1], LAMBERT[0], LAMBERT[2])
        here, there = self.folder / "here", self.folder / "there"
        flags = ("--camera", "top-down", "--world-file")
        count, products = self.sequence(storm, here, *flags, "--device", "software")
        self.assertEqual(count, 2)
        self.assertEqual([product.name for product in products], ["2000.png", "2010.png"])
        first, second = (pixels(product) for product in products)
        self.assertGreater(changed(first, second)[115:, :90].sum(), 10, "the valid times")
        self.assertEqual(self.sequence(storm, here, *flags, "--device", "software")[0], 0)
        self.assertEqual(self.sequence(storm, here, *flags, "--device", "software", "--title", "another")[0], 2)
        address = self.serve(storm.parent)
        count, drawn = self.sequence("run", there, *flags, "--title", "another", "--server", address)
        self.assertEqual(count, 2)
        for product, other in zip(products, drawn):
            self.assertEqual(changed(pixels(product), pixels(other)).sum(), 0)
            self.assertEqual(product.with_suffix(".pgw").read_text(), other.with_suffix(".pgw").read_text())

    def serve(self, storms: pathlib.Path) -> str:
        log = self.folder / "server.log"
        with open(log, "wb") as output:
            server = subprocess.Popen(
                [PROGRAM, "serve", "--data", str(storms), "--grpc", "127.0.0.1:0", "--http", "127.0.0.1:0", "--device", "software"],
                stdout=output, stderr=output, env={**os.environ, "STATE_DIRECTORY": str(self.folder / "state")})
        self.addCleanup(server.wait)
        self.addCleanup(server.terminate)
        wait_for("the server", lambda: "is ready" in log.read_text() or server.poll() is not None)
        ready = re.search(r"\(gRPC ([0-9.:]+)\)", log.read_text())
        self.assertIsNotNone(ready, log.read_text())
        return ready[1]


if __name__ == "__main__":
    unittest.main()
