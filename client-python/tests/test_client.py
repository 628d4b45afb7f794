"""Tests of the client against the real server: $THUNDERHEAD_BINARY serves the repository's sample, and renders in software."""

import importlib.util
import io
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import types
import unittest
import unittest.mock
from collections.abc import Callable

import grpc
import numpy
from PIL import Image

from thunderhead import Client, ThunderheadError, scene_of
from thunderhead.client import product_path
from thunderhead.scenes import limits_of
from thunderhead.v1 import scene_pb2

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
PROGRAM = os.environ["THUNDERHEAD_BINARY"]
SIZE = (160, 90)
FAST = {"rendering": {"preset": "PRESET_FAST"}}


# Longest wait before a test counts as hung. It is not a performance requirement.
HANG_LIMIT_S = 600.0


def wait_for(what: str, condition: Callable[[], object]) -> None:
    """Waits until the condition is true. Fails the test if it does not become true."""
    end = time.monotonic() + HANG_LIMIT_S
    while not condition():
        if time.monotonic() > end:
            raise AssertionError(f"{what} did not come within {HANG_LIMIT_S:.0f} s")
        time.sleep(0.02)


class Server:
    """A running server. It ends with `stop`."""

    def __init__(self, *flags: str) -> None:
        self.folder = tempfile.mkdtemp(prefix="thunderhead-python-")
        self.log = open(f"{self.folder}/log", "w+b")
        self.process = subprocess.Popen(
            [PROGRAM, "serve", "--grpc", "127.0.0.1:0", "--http", "127.0.0.1:0", "--device", "software", *flags],
            stdout=self.log, stderr=self.log, env={**os.environ, "STATE_DIRECTORY": self.folder})
        ready = re.compile(r"is ready at .*\(gRPC 127\.0\.0\.1:(\d+)\)")
        wait_for("the server", lambda: ready.search(self.output()) or self.process.poll() is not None)
        found = ready.search(self.output())
        if found is None:
            raise AssertionError("the server did not start:\n" + self.output())
        self.port = int(found[1])

    def output(self) -> str:
        return pathlib.Path(self.log.name).read_text(errors="replace")

    @property
    def address(self) -> str:
        return f"127.0.0.1:{self.port}"

    def stop(self) -> None:
        self.process.terminate()
        try:
            self.process.wait(HANG_LIMIT_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.log.close()
        shutil.rmtree(self.folder, ignore_errors=True)


class ClientTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.server = Server("--data", str(ROOT / "samples/supercell.nc"))
        cls.addClassCleanup(cls.server.stop)

    def setUp(self) -> None:
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="thunderhead-python-"))
        self.addCleanup(shutil.rmtree, self.folder)
        self.client = Client(self.server.address, timeout_s=HANG_LIMIT_S)
        self.addCleanup(self.client.close)

    def test_storms(self) -> None:
        (storm,) = self.client.storms()
        self.assertEqual(storm.id, "supercell")
        self.assertRegex(storm.valid_times[0], r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$")
        self.assertEqual(self.client.describe("supercell", 1).time_index, 1)
        self.assertEqual(self.client.server().device, "software")

    def test_a_picture_for_pillow_and_for_numpy(self) -> None:
        image = self.client.render("supercell", FAST, SIZE)
        self.assertEqual((image.mode, image.size), ("RGB", SIZE))
        array = self.client.render_array("supercell", FAST, SIZE)
        self.assertEqual((array.dtype, array.shape), (numpy.uint8, (90, 160, 3)))
        numpy.testing.assert_array_equal(numpy.asarray(image), array)
        self.assertGreater(int(array.max()) - int(array.min()), 50, "a picture of one colour")
        # A different scene must give a different picture.
        evening = self.client.render_array("supercell", {**FAST, "sun": {"elevationDeg": 3}}, SIZE)
        self.assertGreater(float(numpy.abs(evening.astype(float) - array).mean()), 2.0)

    def test_what_is_known_of_a_picture(self) -> None:
        picture = self.client.picture("supercell", FAST, SIZE, time_index=1)
        self.assertEqual(picture.scene.time_index, 1)
        self.assertGreater(picture.estimated_error or 0.0, 0.0)
        self.assertEqual((picture.measured, picture.error_interval), (False, None))
        measured = self.client.picture("supercell", FAST, SIZE, time_index=1, error_seconds=1.0)
        self.assertTrue(measured.measured)
        low, high = measured.error_interval or (1.0, 0.0)
        self.assertLessEqual(low, measured.estimated_error or 0.0)
        self.assertGreater(high, measured.estimated_error or 0.0)
        self.assertGreater(picture.milliseconds["view"], 0.0)
        self.assertEqual(picture._repr_png_(), picture.data)
        saved = picture.save(self.folder / "new/storm.png")
        self.assertEqual([file.name for file in saved.parent.iterdir()], ["storm.png"])
        self.assertEqual(scene_of(saved).time_index, 1)
        again = self.client.picture("supercell", saved)
        self.assertEqual(numpy.asarray(again).tolist(), picture.array.tolist())
        jpeg = self.client.picture("supercell", FAST, SIZE, format="jpeg")
        self.assertEqual(jpeg._repr_jpeg_(), jpeg.data)
        self.assertEqual(Image.open(io.BytesIO(jpeg.data)).format, "JPEG")

    def test_scenes_of_all_kinds(self) -> None:
        file = self.folder / "scene.json"
        file.write_text(json.dumps({"sun": {"elevationDeg": 7}}))
        for scene in (file, str(file), {"sun": {"elevation_deg": 7}}, scene_pb2.Scene(sun={"elevation_deg": 7})):
            message = scene_of(scene, "storm", 2, (10, 20))
            self.assertEqual(message.sun.elevation_deg, 7)
            self.assertEqual((message.storm_id, message.time_index, message.output.height_px), ("storm", 2, 20))
        with self.assertRaisesRegex(ValueError, "is not a scene"):
            scene_of({"son": {}})
        plain = self.folder / "plain.png"
        Image.new("RGB", (2, 2)).save(plain)
        with self.assertRaisesRegex(ValueError, "without a scene in it"):
            scene_of(plain)
        self.assertEqual(limits_of("sun.elevation_deg").maximum, 90)
        with self.assertRaisesRegex(KeyError, "no part 'azimut'"):
            limits_of("sun.azimut")

    def test_refusals_name_the_field(self) -> None:
        with self.assertRaises(ThunderheadError) as refused:
            self.client.render("supercell", {"sun": {"elevationDeg": 91}})
        self.assertEqual(refused.exception.code, "INVALID_ARGUMENT")
        self.assertEqual(refused.exception.reason, "VALUE_OUT_OF_RANGE")
        self.assertEqual(refused.exception.field, "scene.sun.elevation_deg")
        self.assertIn("91", str(refused.exception))
        with self.assertRaises(ThunderheadError) as refused:
            self.client.describe("none")
        self.assertEqual((refused.exception.code, refused.exception.reason), ("NOT_FOUND", "STORM_NOT_FOUND"))
        with Client("127.0.0.1:1", timeout_s=HANG_LIMIT_S) as nobody, self.assertRaises(ThunderheadError) as refused:
            nobody.storms()
        self.assertEqual(refused.exception.code, "UNAVAILABLE")

    def test_a_sequence_has_every_time_in_order(self) -> None:
        times = len(self.client.storms()[0].valid_times)
        product = str(self.folder / "{storm}_{valid:%Y%m%d_%H%M}_{time:02d}.png")
        pictures = list(self.client.sequence("supercell", FAST, SIZE, product=product))
        self.assertEqual([picture.scene.time_index for picture in pictures], list(range(times)))
        files = sorted(self.folder.iterdir())
        self.assertEqual([file.read_bytes() for file in files], [picture.data for picture in pictures])
        (last,) = self.client.sequence("supercell", FAST, SIZE, times=[times - 1])
        self.assertEqual(last.scene.time_index, times - 1)
        with self.assertRaisesRegex(ValueError, "the same name"):
            next(self.client.sequence("supercell", FAST, SIZE, product="{storm}.png"))
        self.assertEqual(str(product_path("{valid:%j_%y}", "s", "2012-12-31T01:02:03Z", 0)), "366_12")
        with self.assertRaisesRegex(ValueError, "its fields can be"):
            product_path("{view}", "s", "2012-12-31T01:02:03Z", 0)

    def test_a_session_shows_what_is_set(self) -> None:
        with self.client.session("supercell", {**FAST, "camera": {"orbit": {}}}, SIZE) as session:
            self.assertIs(session.durable, True)
            first = session.wait(timeout_s=HANG_LIMIT_S)
            before = numpy.asarray(Image.open(io.BytesIO(session._repr_jpeg_())), dtype=float)
            session.set("camera.orbit.azimuth_deg", session.get("camera.orbit.azimuth_deg") + 120)
            frame = session.wait(refined=True, timeout_s=HANG_LIMIT_S)
            self.assertGreater(frame.scene_revision, first.scene_revision)
            after = numpy.asarray(Image.open(io.BytesIO(session.jpeg)), dtype=float)
            self.assertGreater(numpy.abs(before - after).mean(), 2.0)
            self.assertEqual(session.picture().scene.camera, session.scene.camera)
            with self.assertRaises(KeyError):
                session.set("camera.azimuth", 3)
            with self.assertRaises(ThunderheadError) as refused:
                session.set("sun.elevation_deg", 100)
            self.assertEqual(refused.exception.code, "INVALID_ARGUMENT")
        with self.assertRaises(ThunderheadError):
            session.set("sun.elevation_deg", 10)

    def test_sliders_move_the_scene(self) -> None:
        try:
            import ipywidgets
        except ImportError:
            self.skipTest("ipywidgets is not installed (Debian's python3-ipywidgets)")
        with self.client.session("supercell", {**FAST, "camera": {"orbit": {}}}, SIZE) as session:
            widget = session.widget(["sun.elevation_deg", "time_index"])
            picture, elevation, time_index = widget.children
            self.assertIsInstance(picture, ipywidgets.Image)
            self.assertEqual((elevation.min, elevation.max), (-90, 90))
            before = picture.value
            elevation.value = 5.0
            time_index.value = 0
            wait_for("another picture", lambda: picture.value != before)
            self.assertEqual((session.get("sun.elevation_deg"), session.get("time_index")), (5.0, 0))

    def test_a_notebook_shows_sliders_or_the_picture(self) -> None:
        shown = []
        notebook = types.ModuleType("IPython.display")
        notebook.display = shown.append
        modules = {"IPython": types.ModuleType("IPython"), "IPython.display": notebook}
        with self.client.session("supercell", {**FAST, "camera": {"orbit": {}}}, SIZE) as session:
            # None in sys.modules makes Python treat the module as missing.
            with unittest.mock.patch.dict(sys.modules, {**modules, "ipywidgets": None}):
                session.display()
                with self.assertRaisesRegex(RuntimeError, "sliders need ipywidgets"):
                    session.widget()
            self.assertEqual(shown, [session])
            # A notebook calls this method to show the picture.
            with Image.open(io.BytesIO(shown[0]._repr_jpeg_())) as picture:
                self.assertEqual(picture.size, SIZE)
            if importlib.util.find_spec("ipywidgets") is None:
                self.skipTest("ipywidgets is not installed (Debian's python3-ipywidgets)")
            import ipywidgets
            with unittest.mock.patch.dict(sys.modules, modules):
                session.display()
            self.assertIsInstance(shown[1], ipywidgets.VBox)
            self.assertIsInstance(shown[1].children[0], ipywidgets.Image)
            self.assertEqual(len(shown[1].children), 5, "the picture and four sliders")

    def test_the_examples_run(self) -> None:
        for example in sorted((HERE.parent / "examples").glob("*.py")):
            done = subprocess.run([sys.executable, str(example), self.server.address, str(self.folder)], capture_output=True,
                                  text=True, timeout=HANG_LIMIT_S)
            self.assertEqual(done.returncode, 0, f"{example}: {done.stdout}{done.stderr}")
        with Image.open(self.folder / "film.gif") as film:
            self.assertEqual(film.n_frames, len(self.client.storms()[0].valid_times))
        self.assertEqual(scene_of(self.folder / "notebook.png").camera.orbit.azimuth_deg, 270)
        self.assertTrue((self.folder / "storm.png").exists())


class WatchTest(unittest.TestCase):
    def test_times_are_drawn_as_they_come(self) -> None:
        series = sorted((ROOT.parent / "shared/data/supercell-series").glob("wrfout*"))
        self.assertGreater(len(series), 3, "shared/data/supercell-series lies beside the repository")
        with tempfile.TemporaryDirectory() as folder:
            run = pathlib.Path(folder) / "run42"
            run.mkdir()
            # The test needs two files, because a single file in a folder is a storm with its own name.
            for file in series[:2]:
                shutil.copy(file, run)
            server = Server("--data", folder, "--settle-seconds", "1", "--rescan-seconds", "1")
            self.addCleanup(server.stop)

            out = pathlib.Path(folder) / "out"

            def copy_others() -> None:
                wait_for("a picture of the first times", out.exists)
                for file in series[2:4]:
                    shutil.copy(file, run)

            copying = threading.Thread(target=copy_others)
            copying.start()
            with Client(server.address, timeout_s=HANG_LIMIT_S) as client:
                # Until the second file has been unchanged for long enough, the first may appear as a separate storm.
                wait_for("the run", lambda: [storm.id for storm in client.storms()] == ["run42"])
                pictures = list(client.watch("run42", FAST, SIZE, until=4, timeout_s=HANG_LIMIT_S, poll_s=0.2,
                                             product=f"{out}/{{valid:%H%M}}.png"))
                copying.join()
                self.assertEqual(len({picture.data for picture in pictures}), 4)
                names = sorted(file.name for file in out.iterdir())
                self.assertEqual(names, ["0010.png", "0020.png", "0030.png", "0040.png"])
                with self.assertRaisesRegex(TimeoutError, "4 times are drawn"):
                    list(client.watch("run42", FAST, SIZE, until=5, timeout_s=0.5, poll_s=0.1))


class AccessTest(unittest.TestCase):
    def test_token_and_tls(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            key, cert, tokens = (f"{folder}/{name}" for name in ("key.pem", "cert.pem", "tokens"))
            subprocess.run(["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-keyout", key, "-out", cert, "-days", "2",
                            "-subj", "/CN=localhost", "-addext", "subjectAltName=DNS:localhost"], check=True, capture_output=True)
            digest = subprocess.run(["sha256sum"], input=b"a" * 64, capture_output=True, check=True).stdout.split()[0].decode()
            pathlib.Path(tokens).write_text(f"suite pipeline {digest}\n")
            for file in (key, tokens):
                os.chmod(file, 0o600)
            server = Server("--data", str(ROOT / "samples/supercell.nc"), "--auth", "tokens", tokens, "--tls-cert", cert,
                            "--tls-key", key)
            self.addCleanup(server.stop)
            address = f"localhost:{server.port}"
            with Client(address, token="a" * 64, tls_ca=cert, timeout_s=HANG_LIMIT_S) as client:
                self.assertEqual(client.storms()[0].id, "supercell")
                self.assertEqual(client.render("", FAST, SIZE).size, SIZE)
                # A pipeline's token may draw single pictures, but may not open sessions.
                with self.assertRaises(ThunderheadError) as refused:
                    client.session()
                self.assertEqual(refused.exception.reason, "ROLE_MAY_NOT")
            with Client(address, token="wrong", tls_ca=cert, timeout_s=HANG_LIMIT_S) as client, self.assertRaises(ThunderheadError) as refused:
                client.storms()
            self.assertEqual(refused.exception.code, "UNAUTHENTICATED")
            with Client(address, token="a" * 64) as client, self.assertRaises(ThunderheadError):
                client.storms()

    def test_a_token_is_not_sent_in_the_clear_to_another_machine(self) -> None:
        for address in ("storms.example.org:50051", "192.0.2.7:50051", "[2001:db8::1]:50051", "localhost.example.org:50051"):
            with self.assertRaisesRegex(ThunderheadError, "without encryption"):
                Client(address, token="secret")
            Client(address, token="secret", allow_plaintext_token=True).close()
            Client(address, token="secret", tls_ca=True).close()
            Client(address, token="").close()
        for address in ("localhost:50051", "127.0.0.1:50051", "127.1.2.3:50051", "[::1]:50051", "unix:/run/thunderhead"):
            Client(address, token="secret").close()


if __name__ == "__main__":
    unittest.main()
