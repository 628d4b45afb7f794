"""Tests that top-down products are where the model says. GDAL's programs locate clouds of known cells in the picture."""

import json
import os
import pathlib
import unittest

from product_test import CELLS, CLOUDS, DEGREES, PROGRAM, SAMPLE, SPACING_M, ProductTest, run, transform, write_wrf

import netCDF4
import numpy
from PIL import Image

# For each WRF MAP_PROJ: the attributes, the same projection in PROJ's notation, the domain's middle, and the name in
# CF. The scale is true at the middle, so the product's projection is that of the model.
PROJECTIONS = {
    "lambert": (
        {"MAP_PROJ": 1, "TRUELAT1": 41.0, "TRUELAT2": 60.0, "MOAD_CEN_LAT": 38.5, "STAND_LON": -97.0},
        "+proj=lcc +lat_1=41 +lat_2=60 +lat_0=38.5 +lon_0=-97 +R=6370000 +no_defs", (-90.0, 41.0), "lambert_conformal_conic"),
    "polar": (
        {"MAP_PROJ": 2, "TRUELAT1": -70.0, "STAND_LON": 20.0},
        "+proj=stere +lat_0=-90 +lat_ts=-70 +lon_0=20 +R=6370000 +no_defs", (35.0, -70.0), "polar_stereographic"),
    "mercator": (
        {"MAP_PROJ": 3, "TRUELAT1": 14.0, "STAND_LON": 120.0},
        "+proj=merc +lat_ts=14 +lon_0=120 +R=6370000 +no_defs", (122.0, 14.0), "mercator"),
}
# The view is neither centred on the domain, nor as wide, nor square, so that no two mistakes cancel. It is lit from
# above and has no turbulent detail, so that clouds are brightest in their middles.
VIEW = """{"camera": {"topDown": {"xM": 3000, "yM": -2000, "widthM": 150000}}, "sun": {"elevationDeg": 90},
           "ground": {"cover": "COVER_PLAIN"}, "rendering": {"lightVolume": {"detail": false}}}"""
SIZE_PX = (300, 260)
PIXEL_M = 150000 / 300


def blobs(values: numpy.ndarray) -> list[tuple[float, float]]:
    """Returns the centres of the bright spots, one for each cloud, from left to right.

    A centre is (column, row) in pixels from the upper left corner.
    """
    bright = numpy.argwhere(values > 0.5 * values.max())
    groups: list[list[numpy.ndarray]] = []
    for at in bright:
        near = next((group for group in groups if numpy.abs(group[0] - at).max() < 30), None)
        near.append(at) if near is not None else groups.append([at])
    return sorted((float(numpy.mean(group, 0)[1]) + 0.5, float(numpy.mean(group, 0)[0]) + 0.5) for group in groups)


def brightness(file: pathlib.Path) -> numpy.ndarray:
    with Image.open(file) as picture:
        return numpy.asarray(picture.convert("L"), float)


def between(values: numpy.ndarray, column: float, row: float) -> float:
    """Returns the value at a place in pixels, interpolated linearly in both directions between the middles of pixels."""
    x, y = int(column - 0.5), int(row - 0.5)
    a, b = column - 0.5 - x, row - 0.5 - y
    return float((1 - b) * ((1 - a) * values[y, x] + a * values[y, x + 1]) + b * ((1 - a) * values[y + 1, x] + a * values[y + 1, x + 1]))


class MapTest(ProductTest):
    def storm(self, name: str) -> tuple[pathlib.Path, dict[str, numpy.ndarray]]:
        attributes, projection, middle, _ = PROJECTIONS[name]
        file = self.folder / f"{name}.nc"
        return file, write_wrf(file, projection, attributes, middle)

    def draw(self, storm: pathlib.Path, ending: str, *more: object) -> pathlib.Path:
        output = self.folder / f"{storm.stem}.product.{ending}"
        view = self.scene("view.json", VIEW)
        self.render(storm, output, "--scene", view, "--size", "x".join(map(str, SIZE_PX)), *more)
        return output

    def expect_clouds(self, found: list[tuple[float, float]], coordinates: dict[str, numpy.ndarray]) -> None:
        """Checks that the places `found`, in degrees east and north, are those of the clouds."""
        self.assertEqual(len(found), len(CLOUDS))
        for x, y in CLOUDS:
            lon, lat = coordinates["lon"][y, x], coordinates["lat"][y, x]
            nearest_m = min(numpy.hypot((a - lon) * numpy.cos(numpy.radians(lat)), b - lat) for a, b in found) * 111_177.0
            # A cloud of one 3 km cell has soft edges, so its middle is known to half a pixel.
            self.assertLess(nearest_m, 0.5 * PIXEL_M, f"cell {x}, {y}")

    def test_clouds_are_at_their_places(self) -> None:
        for name, (_, projection, middle, cf_name) in PROJECTIONS.items():
            with self.subTest(name):
                storm, coordinates = self.storm(name)
                tiff = self.draw(storm, "tif", "--world-file")
                light = self.draw(storm, "nc")
                self.check_tiff(tiff, coordinates, projection, middle)
                self.check_netcdf(light, coordinates, cf_name, tiff)

    def check_tiff(self, tiff: pathlib.Path, coordinates: dict[str, numpy.ndarray], projection: str, middle: tuple[float, float]) -> None:
        info = json.loads(run("gdalinfo", "-json", tiff).stdout)
        self.assertEqual(info["driverShortName"], "GTiff")
        self.assertEqual(info["size"], list(SIZE_PX))
        self.assertEqual([band["colorInterpretation"] for band in info["bands"]], ["Red", "Green", "Blue"])
        self.assertIn("6370000", info["coordinateSystem"]["wkt"])
        scene = json.loads(info["metadata"][""]["thunderhead.scene"])
        self.assertEqual(scene["camera"]["topDown"]["widthM"], 150000)
        # Computes the corner independently: the domain's middle projected, plus the view.
        x_m, y_m = transform([middle], "-s_srs", DEGREES, "-t_srs", projection)[0]
        expected = [x_m + 3000 - 75000, PIXEL_M, 0.0, y_m - 2000 + 0.5 * 260 * PIXEL_M, 0.0, -PIXEL_M]
        for found, wanted in zip(info["geoTransform"], expected):
            # XLAT and XLONG are floats, accurate to a metre.
            self.assertAlmostEqual(found, wanted, delta=2.0)
        pixels = brightness(tiff)
        self.expect_clouds(transform(blobs(pixels - numpy.median(pixels)), tiff, "-t_srs", DEGREES), coordinates)
        world = [float(line) for line in tiff.with_suffix(".tfw").read_text().split()]
        origin_x, width, _, origin_y, _, height = info["geoTransform"]
        for found, wanted in zip(world, [width, 0.0, 0.0, height, origin_x + width / 2, origin_y + height / 2]):
            self.assertAlmostEqual(found, wanted, places=3)

    def check_netcdf(self, light: pathlib.Path, coordinates: dict[str, numpy.ndarray], cf_name: str, tiff: pathlib.Path) -> None:
        with netCDF4.Dataset(light) as file:
            self.assertEqual(file.Conventions, "CF-1.8")
            depth = file["storm_optical_depth"]
            self.assertEqual(depth.shape, SIZE_PX[::-1])
            self.assertEqual(file[depth.grid_mapping].grid_mapping_name, cf_name)
            self.assertEqual(file[depth.grid_mapping].earth_radius, 6370000.0)
            self.assertEqual(depth.coordinates, "lat lon time forecast_reference_time")
            self.assertEqual(str(netCDF4.num2date(file["time"][...], file["time"].units)), "2013-05-20 20:10:00")
            self.assertEqual(str(netCDF4.num2date(file["forecast_reference_time"][...], file["time"].units)), "2013-05-20 12:00:00")
            values = depth[:].filled(numpy.nan)
            middles = blobs(values)
            self.expect_clouds([tuple(between(file[axis][:], *at) for axis in ("lon", "lat")) for at in middles], coordinates)
            # The clouds' middles are at 4.5 km. Their tops are at 6 km and, softened, reach 7 km. In clear columns the
            # optical depth never reaches one, so they have no height.
            heights = file["depth_one_height"][:]
            at = [(int(column), int(row)) for column, row in middles]
            for column, row in at:
                self.assertGreater(heights[row, column], 4500.0)
                self.assertLess(heights[row, column], 7000.0)
            self.assertTrue(numpy.array_equal(heights.mask, values < 1.0))
            self.assertTrue(numpy.array_equal(file["depth_one_distance"][:].mask, heights.mask))
            opacity = file["storm_opacity"][:].filled(numpy.nan)
            self.assertGreater(min(opacity[row, column] for column, row in at), 0.99)
            self.assertLess(numpy.abs(opacity[values == 0.0]).max(), 1e-3)
            self.assertGreater(file["radiance_green"][:].min(), 0.0)
            self.assertGreater(file["estimated_error"][...], 0.0)
            self.assertLess(file["estimated_error"][...], 1.0)
            self.assertIn("Thunderhead", file.source)
        # GDAL reads the same map from the file.
        geotransform = json.loads(run("gdalinfo", "-json", f'NETCDF:"{light}":storm_optical_depth').stdout)["geoTransform"]
        for found, wanted in zip(geotransform, json.loads(run("gdalinfo", "-json", tiff).stdout)["geoTransform"]):
            self.assertAlmostEqual(found, wanted, places=2)

    def test_a_grid_of_degrees_stays_one(self) -> None:
        """Near the equator a degree of longitude has the same length in the whole domain, so nothing is resampled."""
        storm = self.folder / "degrees.nc"
        lat = 8.0 + 0.02 * numpy.arange(CELLS)
        lon = 7.0 + 0.03 * numpy.arange(CELLS)
        with netCDF4.Dataset(storm, "w") as file:
            file.Conventions = "CF-1.8"
            axes = {
                "time": ([0.0], "seconds since 2013-05-20 20:00:00", "time"), "z": (numpy.arange(500.0, 10000.0, 1000.0), "m", "altitude"),
                "lat": (lat, "degrees_north", "latitude"), "lon": (lon, "degrees_east", "longitude"),
            }
            for name, (values, units, standard_name) in axes.items():
                file.createDimension(name, len(values))
                variable = file.createVariable(name, "f8", (name,))
                variable.setncatts({"units": units, "standard_name": standard_name})
                variable[:] = values
            file["z"].positive = "up"
            water = file.createVariable("clw", "f4", ("time", "z", "lat", "lon"))
            water.setncatts({"units": "kg m-3", "standard_name": "mass_concentration_of_cloud_liquid_water_in_air"})
            water[:] = 0.0
            for x, y in CLOUDS:
                water[0, 3:6, y, x] = 2e-3
        grid_lon, grid_lat = numpy.meshgrid(lon, lat)
        coordinates = {"lon": grid_lon, "lat": grid_lat}
        tiff = self.draw(storm, "tif")
        pixels = brightness(tiff)
        self.expect_clouds(transform(blobs(pixels - numpy.median(pixels)), tiff, "-t_srs", "+proj=longlat +R=6371229 +no_defs"), coordinates)
        with netCDF4.Dataset(self.draw(storm, "nc")) as file:
            depth = file["storm_optical_depth"]
            self.assertEqual(depth.dimensions, ("lat", "lon"))
            self.assertEqual(file[depth.grid_mapping].grid_mapping_name, "latitude_longitude")
            grid = dict(zip(("lon", "lat"), numpy.meshgrid(file["lon"][:], file["lat"][:])))
            middles = blobs(depth[:].filled(0.0))
            self.expect_clouds([tuple(between(grid[axis], *at) for axis in ("lon", "lat")) for at in middles], coordinates)

    def test_an_idealised_run_has_metres_and_no_place(self) -> None:
        tiny = ("--size", "64x36", "--quality", "fast", "--camera", "top-down")
        said = self.render(SAMPLE, self.folder / "ideal.tif", *tiny, code=64)
        self.assertIn("needs the storm's place on Earth", said)
        self.assertFalse((self.folder / "ideal.tif").exists())
        self.render(SAMPLE, self.folder / "ideal.png", *tiny, "--world-file")
        width, _, _, height, _, _ = (float(line) for line in (self.folder / "ideal.pgw").read_text().split())
        self.assertAlmostEqual(width, -height, places=3)
        self.render(SAMPLE, self.folder / "ideal.nc", *tiny)
        with netCDF4.Dataset(self.folder / "ideal.nc") as file:
            self.assertNotIn("grid_mapping", file["storm_optical_depth"].ncattrs())
            self.assertEqual(file["x"].long_name, "metres east of the middle of the domain")
            self.assertAlmostEqual(file["x"][1] - file["x"][0], width, places=3)

    def test_what_is_no_map_is_refused_before_anything_is_drawn(self) -> None:
        for ending in ("tif", "nc"):
            said = self.render(SAMPLE, self.folder / f"view.{ending}", code=64)
            self.assertIn("camera is not: use --camera top-down", said)
        said = self.render(SAMPLE, self.folder / "view.png", "--world-file", code=64)
        self.assertIn("camera is not: use --camera top-down", said)
        said = self.render(SAMPLE, self.folder / "view.nc", "--camera", "top-down", "--annotate", code=64)
        self.assertIn("contains radiance and no pixels", said)
        said = self.render(SAMPLE, self.folder / "view.tif", "--camera", "top-down", "--technique", "reference", code=64)
        self.assertIn("--technique reference writes only .png, .jpg and .exr", said)
        self.assertEqual([file.name for file in self.folder.iterdir()], [])

    def test_without_gdal_it_names_the_package(self) -> None:
        storm, _ = self.storm("lambert")
        libraries = self.folder / "libraries"
        libraries.mkdir()
        for name in ("libgdal.so.32", "libgdal.so"):
            (libraries / name).write_text("no library")
        done = run(PROGRAM, "render", storm, "-o", self.folder / "a.tif", "--camera", "top-down", "--size", "64x36", "--quality", "fast",
                   "--device", "software", code=78, env={**os.environ, "LD_LIBRARY_PATH": str(libraries)})
        self.assertIn("install Debian's package libgdal32", done.stderr)
        self.assertFalse((self.folder / "a.tif").exists())

    def test_a_real_place_has_its_borders_or_says_that_it_has_not(self) -> None:
        storm, _ = self.storm("lambert")
        command = (PROGRAM, "render", storm, "-o", self.folder / "a.png", "--camera", "top-down", "--size", "64x36", "--quality", "fast",
                   "--device", "software", "--json")
        modelled = json.loads(run(*command).stdout)["modelled"]
        there = pathlib.Path("/usr/share/gmt-gshhg").exists()
        self.assertEqual(modelled["ground"].get("borders", False), there)
        self.assertEqual("CODE_BORDERS" in [each["code"] for each in modelled.get("notShown", [])], not there)

    def test_a_run_of_maps_is_resumed_with_their_world_files(self) -> None:
        storm, _ = self.storm("lambert")
        view = self.scene("above.json", VIEW)
        products = self.folder / "products"
        command = (PROGRAM, "sequence", storm, "--views", view, "--product", products / "{valid:%H%M}_{view}.tif", "--size", "64x48",
                   "--world-file", "--device", "software")
        self.assertEqual(run(*command).stdout.count(" ms)"), 2)
        names = ["2000_above.tfw", "2000_above.tif", "2010_above.tfw", "2010_above.tif"]
        self.assertEqual(sorted(file.name for file in products.iterdir()), [*names, "manifest.jsonl"])
        entries = [json.loads(line) for line in (products / "manifest.jsonl").read_text().splitlines()]
        self.assertEqual(sorted(entry["file"] for entry in entries), names)
        run("sha256sum", "--check", text="".join(f'{entry["sha256"]}  {products / entry["file"]}\n' for entry in entries))
        self.assertEqual(run(*command).stdout.count(" ms)"), 0)
        (products / names[2]).unlink()
        self.assertEqual(run(*command).stdout.count(" ms)"), 1)
        self.assertTrue((products / names[2]).exists())
        said = run(*command, "--movie", self.folder / "movie.webm", code=64).stderr
        self.assertIn("--movie needs pictures of .png or .jpg", said)


if __name__ == "__main__":
    unittest.main()
