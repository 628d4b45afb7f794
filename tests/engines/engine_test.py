"""What the tests of batch systems share: the program, the storms, daemons in a temporary folder, and the checks of products."""

import hashlib
import json
import os
import pathlib
import random
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("THUNDERHEAD_BINARY", str(ROOT / "build/release/bin/thunderhead"))
# Twelve files of one model run, next to the repository.
SERIES = ROOT.parent / "shared/data/supercell-series"

# The exit code that ctest counts as skipped.
SKIPPED = 77


def need(programs: dict[str, str]) -> None:
    """Ends the test as skipped if a program is missing. The keys of `programs` are programs, the values their Debian
    packages.
    """
    path = os.pathsep.join([os.environ.get("PATH", ""), "/usr/sbin", "/sbin"])
    missing = [package for name, package in programs.items() if shutil.which(name, path=path) is None]
    if missing:
        print(f"SKIPPED: Debian's packages {', '.join(missing)} are not installed; ./dev install engines does that")
        sys.exit(SKIPPED)
    os.environ["PATH"] = path


HELD_PORTS: list[socket.socket] = []


def free_port() -> int:
    """Returns a port of 127.0.0.1 that belongs to this process until it ends.

    It lies between 26000 and 32000, because ecFlow accepts only registered ports, and because the kernel does not
    assign these ports to programs that ask for any free port. While this process runs, it holds an abstract Unix socket
    named after the port, which keeps other tests of this folder from taking it. The range below belongs to
    tests/e2e/server_process.mjs.
    """
    while True:
        port = random.randrange(26000, 32000)
        held = socket.socket(socket.AF_UNIX)
        with socket.socket() as probe:
            try:
                held.bind(f"\0thunderhead-test-port-{port}")
                probe.bind(("", port))
            except OSError:
                held.close()
                continue
        HELD_PORTS.append(held)
        return port


def run(*command: object, check: bool = True, **more: object) -> str:
    """Runs the command and returns its standard output. If it fails, the test fails with all of its output."""
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=600, **more)
    if check and done.returncode != 0:
        raise AssertionError(f"{command} ended with {done.returncode}:\n{done.stdout}\n{done.stderr}")
    return done.stdout


def kill_those_of(folder: pathlib.Path) -> None:
    """Kills the processes whose command line names the folder, because jobs can outlive the daemon that started them."""
    for process in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            if str(folder).encode() in (process / "cmdline").read_bytes() and int(process.name) != os.getpid():
                os.kill(int(process.name), signal.SIGKILL)
        except OSError:
            pass  # The job has ended.


class EngineTest(unittest.TestCase):
    """A test with a temporary folder, a run of twelve files, and daemons that end with the test."""

    def setUp(self) -> None:
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="thunderhead-engine-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.addCleanup(kill_those_of, self.folder)
        self.storm = self.folder / "run42"
        self.storm.mkdir()
        self.assertTrue(SERIES.is_dir(), f"{SERIES} is missing: it lies in the folder shared beside the repository")
        for file in sorted(SERIES.iterdir()):
            (self.storm / file.name).symlink_to(file)
        self.times = len(list(self.storm.iterdir()))
        self.assertEqual(self.times, 12)
        self.products = self.folder / "products"

    def start(self, name: str, *command: object, **more: object) -> subprocess.Popen:
        """Starts a daemon in the foreground, which ends with the test. Its output is written to NAME.log."""
        with open(self.folder / f"{name}.log", "ab") as log:
            process = subprocess.Popen([str(part) for part in command], stdout=log, stderr=log, **more)

        def end() -> None:
            process.terminate()
            try:
                process.wait(60)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

        self.addCleanup(end)
        return process

    def logs(self) -> str:
        """Returns the last part of the output of each daemon and job."""
        texts = []
        for file in sorted(self.folder.rglob("*")):
            if file.suffix in {".log", ".out"} or ".job" in file.name and file.is_file():
                text = file.read_text(errors="replace")
                texts.append(f"--- {file}\n{text[-3000:]}")
        return "\n".join(texts)

    def wait_for(self, what: str, condition, seconds: float = 600.0):
        """Waits until `condition` returns a true value, and returns it. Otherwise the test fails with all logs."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            result = condition()
            if result:
                return result
            time.sleep(0.2)
        self.fail(f"{what} did not come within {seconds:.0f} s\n{self.logs()}")

    def entries(self) -> list[dict]:
        """Returns the entries of all manifests."""
        lines = []
        for manifest in sorted(self.products.glob("manifest*.jsonl")):
            lines += [json.loads(line) for line in manifest.read_text().splitlines()]
        return lines

    def expect_each_product_once(self, products: int, others: int = 0) -> None:
        """Checks that every product exists, is complete and is recorded once, and that exactly `others` other files are
        recorded.
        """
        entries = self.entries()
        files = [entry["file"] for entry in entries]
        self.assertEqual(len(files), len(set(files)), f"recorded twice: {sorted(files)}")
        pictures = [file for file in files if file.endswith(".png")]
        self.assertEqual(len(pictures), products, sorted(files))
        self.assertEqual(len(files), products + others, sorted(files))
        self.assertEqual(len({entry["input"]["file"] for entry in entries if entry["file"] in pictures}), self.times)
        for entry in entries:
            data = (self.products / entry["file"]).read_bytes()
            self.assertEqual(hashlib.sha256(data).hexdigest(), entry["sha256"], entry["file"])
        there = {file.name for file in self.products.iterdir() if not file.name.startswith("manifest")}
        self.assertEqual(there, set(files), "files that no manifest has")
