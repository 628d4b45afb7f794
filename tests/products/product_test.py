"""What the tests of products share: the program, and storms with a place on Earth, written with netCDF's own library."""

import importlib.util
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
from collections.abc import Callable

# The exit code that ctest counts as skipped.
SKIPPED = 77
ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.environ.get("THUNDERHEAD_BINARY", str(ROOT / "build/release/bin/thunderhead"))
SAMPLE = ROOT / "samples/supercell.nc"

for _module, _package in {"netCDF4": "python3-netcdf4", "PIL": "python3-pil", "numpy": "python3-numpy"}.items():
    if importlib.util.find_spec(_module) is None:
        print(f"SKIPPED: Debian's package {_package} is not installed; ./dev install test python does that")
        sys.exit(SKIPPED)
if shutil.which("gdaltransform") is None:
    print("SKIPPED: Debian's package gdal-bin is not installed; ./dev install test does that")
    sys.exit(SKIPPED)

import netCDF4  # noqa: E402
import numpy  # noqa: E402

# Longitude and latitude in degrees on WRF's sphere, in PROJ's notation.
DEGREES = "+proj=longlat +R=6370000 +no_defs"
# The longest wait before a test counts as hung. It is not a requirement on speed.
HANG_LIMIT_S = 600.0
CELLS = 40
SPACING_M = 3000.0
LEVELS = 10
TOP_M = 10000.0
# Columns of thick cloud: (west-east, south-north), counted from 0. They are far from the middle and from each other's
# mirror image.
CLOUDS = [(31, 9), (8, 13), (12, 33)]
TIMES = ["2013-05-20_20:00:00", "2013-05-20_20:10:00"]


def run(*command: object, code: int = 0, text: str | None = None, **more: object) -> subprocess.CompletedProcess:
    """Runs a command. The test fails with all of its output if its exit code is not `code`."""
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, input=text, timeout=HANG_LIMIT_S, **more)
    if done.returncode != code:
        raise AssertionError(f"{command} ended with {done.returncode}, not {code}:\n{done.stdout}\n{done.stderr}")
    return done


def wait_for(what: str, condition: Callable[[], object]) -> None:
    """Waits until the condition is true. Fails the test if it does not become true."""
    end = time.monotonic() + HANG_LIMIT_S
    while not condition():
        if time.monotonic() > end:
            raise AssertionError(f"{what} did not come within {HANG_LIMIT_S:.0f} s")
        time.sleep(0.02)


def transform(points: list[tuple[float, float]], *options: object) -> list[tuple[float, float]]:
    """Converts points with one call of gdaltransform."""
    lines = "".join(f"{x:.12f} {y:.12f}\n" for x, y in points)
    out = run("gdaltransform", *options, text=lines).stdout
    return [tuple(float(number) for number in line.split()[:2]) for line in out.splitlines() if line.strip()]


def write_wrf(path: pathlib.Path, projection: str, attributes: dict[str, float], middle: tuple[float, float]) -> dict[str, numpy.ndarray]:
    """Writes a WRF file on a grid of this projection. Returns the coordinates of its columns in degrees.

    middle: the grid's middle in degrees east and north.
    """
    x_m, y_m = transform([middle], "-s_srs", DEGREES, "-t_srs", projection)[0]
    offsets = (numpy.arange(CELLS) - (CELLS - 1) / 2) * SPACING_M
    points = [(x_m + dx, y_m + dy) for dy in offsets for dx in offsets]
    degrees = numpy.array(transform(points, "-s_srs", projection, "-t_srs", DEGREES)).reshape(CELLS, CELLS, 2)
    with netCDF4.Dataset(path, "w") as file:
        for name, length in {
            "Time": None, "DateStrLen": 19, "south_north": CELLS, "west_east": CELLS, "bottom_top": LEVELS, "bottom_top_stag": LEVELS + 1,
        }.items():
            file.createDimension(name, length)
        file.setncatts({"TITLE": " OUTPUT FROM WRF V4.5 MODEL", "SIMULATION_START_DATE": "2013-05-20_12:00:00", "GRID_ID": numpy.int32(1)})
        file.setncatts({"DX": numpy.float32(SPACING_M), "DY": numpy.float32(SPACING_M)})
        file.setncatts({name: numpy.int32(value) if name == "MAP_PROJ" else numpy.float32(value) for name, value in attributes.items()})
        file.createVariable("Times", "S1", ("Time", "DateStrLen"))[:] = numpy.array([list(time) for time in TIMES], "S1")

        def field(name: str, dimensions: str, units: str, values: numpy.ndarray) -> None:
            names = {"z": "bottom_top", "w": "bottom_top_stag", "y": "south_north", "x": "west_east"}
            variable = file.createVariable(name, "f4", ("Time", *(names[letter] for letter in dimensions)))
            variable.units = units
            variable[:] = numpy.broadcast_to(values, (len(TIMES), *values.shape))

        levels = (LEVELS, CELLS, CELLS)
        heights_m = numpy.broadcast_to(numpy.linspace(0.0, TOP_M, LEVELS + 1)[:, None, None], (LEVELS + 1, CELLS, CELLS))
        field("PHB", "wyx", "m2 s-2", 9.81 * heights_m)
        field("PH", "wyx", "m2 s-2", numpy.zeros_like(heights_m))
        field("PB", "zyx", "Pa", numpy.full(levels, 8e4))
        field("P", "zyx", "Pa", numpy.zeros(levels))
        field("T", "zyx", "K", numpy.full(levels, 10.0))
        field("QVAPOR", "zyx", "kg kg-1", numpy.full(levels, 0.01))
        field("HGT", "yx", "m", numpy.zeros((CELLS, CELLS)))
        field("XLONG", "yx", "degree_east", degrees[:, :, 0])
        field("XLAT", "yx", "degree_north", degrees[:, :, 1])
        water = numpy.zeros(levels)
        for x, y in CLOUDS:
            water[3:6, y, x] = 2e-3
        field("QCLOUD", "zyx", "kg kg-1", water)
    return {"lon": degrees[:, :, 0], "lat": degrees[:, :, 1]}


class ProductTest(unittest.TestCase):
    def setUp(self) -> None:
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="thunderhead-products-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def render(self, storm: pathlib.Path, output: pathlib.Path, *more: object, code: int = 0) -> str:
        """Renders a picture. Returns the program's standard error."""
        return run(PROGRAM, "render", storm, "-o", output, "--device", "software", *more, code=code).stderr

    def scene(self, name: str, json: str) -> pathlib.Path:
        file = self.folder / name
        file.write_text(json)
        return file
