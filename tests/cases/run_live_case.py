"""Changes the files of a running server, and checks that clients get pictures of the new times within a minute.

It uses the storms of case 70. One file is overwritten, and one folder is a link that is turned to another run. A third
storm is a link to a file that is replaced by a rename. The environment is that of run_cases.py, and so is exit code 77.
"""
import importlib.util
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

import run_cases

CASE = "70_data_changes_under_server"
WITHIN_S = 60  # the time in which clients must get pictures of new times
START_WITHIN_S = 120


class Server:
    """A server of the case's folders that draws in software."""

    def __init__(self, folder):
        self.folder = folder
        self.log = folder / "server.log"
        with open(self.log, "wb") as output:
            self.process = subprocess.Popen(
                [os.environ["THUNDERHEAD_BINARY"], "serve", "--data", "live", "latest", "linked", "--grpc", "127.0.0.1:0",
                 "--http", "127.0.0.1:0", "--state", "none", "--device", "software", "--allow-links-to", folder / "store"],
                cwd=folder, stdout=output, stderr=output)
        deadline = time.monotonic() + START_WITHIN_S
        while "is ready" not in self.log.read_text():
            if self.process.poll() is not None or time.monotonic() > deadline:
                self.process.kill()
                raise RuntimeError(f"the server did not start:\n{self.log.read_text()}")
            time.sleep(0.2)
        self.address = re.search(r"\(gRPC ([0-9.:]+)\)", self.log.read_text())[1]

    def valid_time(self, storm, index):
        """Returns the valid time of a picture, as HH:MM, or the exit code of a render that failed."""
        picture = self.folder / "picture.png"
        picture.unlink(missing_ok=True)
        run = subprocess.run(
            [os.environ["THUNDERHEAD_BINARY"], "render", "--server", self.address, storm, "--time", str(index), "--size",
             "160x90", "--error-seconds", "0", "-o", picture], capture_output=True, timeout=WITHIN_S, check=False)
        if run.returncode != 0:
            return run.returncode
        return re.search(rb"thunderhead\.valid\0+2013-05-20T([0-9]{2}:[0-9]{2}):00Z", picture.read_bytes())[1].decode()


def check(name, before, after, ask):
    """Asks until the answer is `after`. Returns whether it comes in time, and no answer but `before` comes first."""
    deadline = time.monotonic() + WITHIN_S
    answer = ask()
    while answer == before != after and time.monotonic() < deadline:
        time.sleep(1)
        answer = ask()
    good = answer == after
    print(f"{'ok    ' if good else 'FAILED'} {CASE}: {name}: {answer}" + ("" if good else f", not {after}"))
    return good


def run(folder):
    """Runs the case and returns whether every check passed."""
    (folder / "store").mkdir()
    (folder / "linked").mkdir()
    shutil.copy(folder / "run1/wrfout_a.nc", folder / "store/current.nc")
    shutil.copy(folder / "run2/wrfout_a.nc", folder / "store/new.nc")
    (folder / "latest").symlink_to("run1")
    (folder / "linked/replaced.nc").symlink_to("../store/current.nc")
    server = Server(folder)
    try:
        results = []

        def expect(storm, index, before, after, name):
            results.append(check(name, before, after, lambda: server.valid_time(storm, index)))

        expect("storm", 0, None, "20:00", "a file")
        expect("storm", 1, None, "20:20", "a file")
        expect("wrfout_a", 0, None, "19:00", "a folder behind a link")
        expect("replaced", 0, None, "19:00", "a link to a file")
        shutil.copy(folder / "next/storm.nc", folder / "live/storm.nc")
        (folder / "turned").symlink_to("run2")
        (folder / "turned").replace(folder / "latest")
        (folder / "store/new.nc").replace(folder / "store/current.nc")
        expect("storm", 0, "20:00", "20:20", "a file that was overwritten")
        expect("storm", 2, 64, "21:00", "a time that it did not have before")
        expect("wrfout_a", 0, "19:00", "22:00", "a link that was turned to another folder")
        expect("replaced", 0, "19:00", "22:00", "a file behind a link that was replaced")
        (folder / "live/storm.nc").unlink()
        expect("storm", 0, "20:20", 75, "a file that was removed")
        server.process.terminate()
        results.append(check("the end of the server", None, 0, server.process.wait))
        if not all(results):
            print(server.log.read_text())
        return all(results)
    finally:
        if server.process.poll() is None:
            server.process.kill()
            server.process.wait()


def main():
    if not pathlib.Path(os.environ["CASES"]).is_dir() or importlib.util.find_spec("netCDF4") is None:
        print("skipped: the cases or python3-netcdf4 are missing")
        return 77
    return 0 if run(run_cases.made(CASE)) else 1


if __name__ == "__main__":
    sys.exit(main())
