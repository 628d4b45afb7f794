"""Tests the metadata of PNG, OpenEXR and movies: scene, storm, times, version and the camera's pose.

The same picture can be drawn again from this metadata.
"""

import json
import math
import pathlib
import shutil
import struct
import unittest

from product_test import PROGRAM, ProductTest, run, write_wrf

import numpy
from PIL import Image

ATTRIBUTES = {"MAP_PROJ": 1, "TRUELAT1": 41.0, "TRUELAT2": 60.0, "MOAD_CEN_LAT": 38.5, "STAND_LON": -97.0}
LAMBERT = "+proj=lcc +lat_1=41 +lat_2=60 +lat_0=38.5 +lon_0=-97 +R=6370000 +no_defs"
# Lambert's cone constant of the two standard parallels (Snyder 1987, equation 15-3).
CONE = math.log(math.cos(math.radians(41)) / math.cos(math.radians(60))) / math.log(math.tan(math.radians(75)) / math.tan(math.radians(65.5)))
SCENE = """{"camera": {"orbit": {"target": {"xM": 1000, "yM": 2000, "zM": 4000}, "azimuthDeg": 270, "elevationDeg": 10,
            "distanceM": 90000, "fieldOfViewDeg": 40}}, "sun": {"azimuthDeg": 120, "elevationDeg": 35}}"""
SIZE = ("--size", "160x100", "--quality", "fast")


def exr_attributes(file: pathlib.Path) -> dict[str, object]:
    """Returns texts and numbers in the header of an OpenEXR file. Each attribute has a name, type, size and value."""
    data = file.read_bytes()
    assert data[:4] == b"\x76\x2f\x31\x01", "no OpenEXR"
    at, attributes = 8, {}
    while data[at]:
        name, kind, rest = data[at:].split(b"\0", 2)
        at += len(name) + len(kind) + 2
        (size,) = struct.unpack_from("<i", data, at)
        value = data[at + 4 : at + 4 + size]
        at += 4 + size
        if kind == b"string":
            attributes[name.decode()] = value.decode()
        elif kind == b"float":
            (attributes[name.decode()],) = struct.unpack("<f", value)
    return attributes


class MetadataTest(ProductTest):
    def setUp(self) -> None:
        super().setUp()
        self.storm = self.folder / "run42.nc"
        self.places = write_wrf(self.storm, LAMBERT, ATTRIBUTES, (-90.0, 41.0))

    def check(self, texts: dict[str, object], version: str) -> None:
        self.assertEqual(texts["Software"], f"Thunderhead {version}")
        self.assertEqual(texts["Title"], "run42 (WRF V4.5)")
        self.assertEqual(texts["thunderhead.storm"], "run42")
        self.assertEqual(texts["thunderhead.valid"], "2013-05-20T20:10:00Z")
        self.assertEqual(texts["thunderhead.run"], "2013-05-20T12:00:00Z")
        scene = json.loads(texts["thunderhead.scene"])
        self.assertEqual(scene["timeIndex"], 1)
        self.assertEqual(scene["sun"]["azimuthDeg"], 120)
        self.assertEqual(scene["camera"]["orbit"]["distanceM"], 90000)
        self.assertGreater(float(texts["thunderhead.estimated_error"]), 0.0)
        # The pose follows from the orbit: west of the target, 10 degrees above it, looking back at it.
        view = json.loads(texts["thunderhead.view"])
        distance_m, up = 90000 * math.cos(math.radians(10)), 90000 * math.sin(math.radians(10))
        for axis, expected in {"xM": 1000 - distance_m, "yM": 2000, "zM": 4000 + up}.items():
            # The Earth's curvature tilts the pose by the angle 90 km / 7433 km. These are the camera's distance and the
            # Earth's effective radius (server/physics/atmosphere.h).
            self.assertAlmostEqual(view["eye"][axis], expected, delta=1000)
        forward = [view["forward"].get(axis, 0.0) for axis in "xyz"]
        self.assertAlmostEqual(math.dist(forward, [math.cos(math.radians(10)), 0, -math.sin(math.radians(10))]), 0.0, delta=0.02)
        # The view is 40 degrees and 100 pixels high.
        self.assertAlmostEqual(float(texts["thunderhead.focal_length_px"]), 50 / math.tan(math.radians(20)), delta=0.1)
        latitude, longitude = (float(part) for part in str(texts["thunderhead.middle_deg"]).split())
        self.assertAlmostEqual(latitude, self.places["lat"][19:21, 19:21].mean(), places=3)
        self.assertAlmostEqual(longitude, self.places["lon"][19:21, 19:21].mean(), places=3)
        self.assertIn("+proj=lcc", texts["thunderhead.projection"])
        # The middle is 7 degrees east of the grid's central meridian, and true north is therefore to the left.
        self.assertAlmostEqual(float(texts["thunderhead.true_north_deg"]), CONE * (-97.0 - longitude), places=2)

    def test_a_png_tells_what_it_shows_and_can_be_drawn_again(self) -> None:
        version = run(PROGRAM, "--version").stdout.split()[-1]
        scene, first, again = self.scene("scene.json", SCENE), self.folder / "first.png", self.folder / "again.png"
        self.render(self.storm, first, "--scene", scene, *SIZE)
        with Image.open(first) as picture:
            self.check(picture.text, version)
        self.render(self.storm, again, "--scene", first)
        with Image.open(first) as a, Image.open(again) as b:
            self.assertTrue(numpy.array_equal(numpy.asarray(a), numpy.asarray(b)))

    def test_an_openexr_file_tells_the_same(self) -> None:
        version = run(PROGRAM, "--version").stdout.split()[-1]
        scene, light = self.scene("scene.json", SCENE), self.folder / "light.exr"
        self.render(self.storm, light, "--scene", scene, *SIZE)
        self.check(exr_attributes(light), version)

    def test_movies_tell_their_times_scene_and_pose(self) -> None:
        if shutil.which("ffprobe") is None:
            self.skipTest("Debian's package ffmpeg is not installed; ./dev install test does that")
        scene = self.scene("west.json", SCENE)
        for kind in ("webm", "mp4"):
            movie = self.folder / f"movie.{kind}"
            run(PROGRAM, "sequence", self.storm, "--views", scene, "--product", self.folder / "{valid:%H%M}.png", *SIZE, "--movie", movie,
                "--device", "software")
            probed = json.loads(run("ffprobe", "-v", "error", "-show_format", "-of", "json", movie).stdout)
            tags = {name.lower(): value for name, value in probed["format"]["tags"].items()}
            self.assertEqual(tags["title"], "run42")
            self.assertRegex(tags["comment"], "^made by Thunderhead [0-9.]+ of scene [0-9a-f]{64}$")
            told = json.loads(tags["description"])
            self.assertEqual(told["storm"], "run42")
            self.assertEqual(told["run"], "2013-05-20T12:00:00Z")
            self.assertEqual(told["valid"], ["2013-05-20T20:00:00Z", "2013-05-20T20:10:00Z"])
            self.assertEqual(told["view"], "west")
            self.assertEqual(told["scene"]["sun"]["azimuthDeg"], 120)
            self.assertLess(told["pose"]["eye"]["xM"], -80000)
            # The movie's error is the largest error of its pictures, as in the manifest.
            lines = [json.loads(line) for line in (self.folder / "manifest.jsonl").read_text().splitlines()]
            errors = [line["estimated_error"] for line in lines if line["file"].endswith(".png")]
            self.assertGreater(min(errors), 0.0)
            self.assertEqual(told["estimated_error"], max(errors))
            self.assertEqual([line["estimated_error"] for line in lines if line["file"] == movie.name], [max(errors)])


if __name__ == "__main__":
    unittest.main()
