#!/usr/bin/python3
"""One storm as WRF output, as CF netCDF and as GRIB2 makes the same picture.

Columns of the sample storm are placed on a Lambert map and written in each format. The netCDF library writes the netCDF
files. GRIB2 is written octet by octet, with 24 bits a value. Each picture's radiance is compared with that of the WRF file.

What a format cannot say is excluded:

- The scene takes the particle sizes of the papers, because only WRF names a microphysics scheme, and HRRR implies another.
- Two files have the heights of the layers' faces, as ICON has. The other two have those of the layers' middles, as HRRR
  and many CF files have. Faces half-way between middles are up to 5 m off. The storm's cells are as high as the thinnest layer,
  so they become 300.3 m high instead of 300.0 m. The turbulent detail follows the cells, so these files are
  compared without it.
- No file has winds or turbulent energy, so that the detail of all comes from contrasts of the fields.

    formats_test.py --keep FOLDER     also keeps the storms and the pictures there
"""

import json
import pathlib
import struct
import sys
import unittest
import zlib

from product_test import DEGREES, SAMPLE, ProductTest, netCDF4, numpy, transform

RECORD = 1
WEST, SOUTH, COLUMNS, ROWS = 80, 56, 84, 56  # the columns of the sample storm with condensate, and some around them
EARTH_M = 6_370_000.0
PARALLELS_DEG = (30.0, 60.0)
ORIGIN_DEG = (40.0, -97.0)  # latitude and longitude
MAP = f"+proj=lcc +lat_1=30 +lat_2=60 +lat_0=40 +lon_0=-97 +x_0=0 +y_0=0 +R={EARTH_M:.0f} +units=m +no_defs"
FIRST_M = (150_000.0, 550_000.0)  # the south-western column on the map
STEP_M = 1000.0  # between columns on the map; their true distance is 3 % larger
TIME = "2013-05-20T21:00:00Z"
GRAVITY = 9.81  # in WRF
NAMES = {"QCLOUD": "cloud", "QRAIN": "rain", "QICE": "ice", "QSNOW": "snow", "QGRAUP": "graupel"}
# The largest relative RMSE that is allowed.
LARGEST = 0.02
TARGET = {"xM": -5000, "yM": 0, "zM": 6500}
VIEWS = {
    "orbit": {"orbit": {"target": TARGET, "azimuthDeg": 200, "elevationDeg": 6, "distanceM": 60000}},
    "above": {"orbit": {"target": TARGET, "azimuthDeg": 60, "elevationDeg": 60, "distanceM": 80000}},
}


class Source:
    """The sample storm's columns: mixing ratios per kg of dry air, and the state of the air. In the arrays, x runs
    fastest, and levels run upwards.
    """

    def __init__(self) -> None:
        with netCDF4.Dataset(SAMPLE) as file:
            file.set_auto_mask(False)
            part = (RECORD, ..., slice(SOUTH, SOUTH + ROWS), slice(WEST, WEST + COLUMNS))
            self.values = {
                name: numpy.asarray(file[name][part], "f4")
                for name in ("PH", "PHB", "P", "PB", "T", "QVAPOR", "HGT", *NAMES)
            }
        value = self.values
        self.faces_m = (value["PH"].astype("f8") + value["PHB"]) / GRAVITY
        self.pressure_pa = value["P"].astype("f8") + value["PB"]
        self.temperature_k = (value["T"].astype("f8") + 300.0) * (self.pressure_pa / 1e5) ** (287.0 / 1004.5)
        self.vapour = numpy.maximum(value["QVAPOR"], 0.0).astype("f8")
        self.dry = {name: numpy.maximum(value[name], 0.0).astype("f8") for name in NAMES}
        # The mass of all air for 1 kg of dry air.
        self.whole_kg = 1.0 + self.vapour + sum(self.dry.values())
        points = [(FIRST_M[0] + STEP_M * x, FIRST_M[1] + STEP_M * y) for y in range(ROWS) for x in range(COLUMNS)]
        degrees = numpy.array(transform(points, "-s_srs", MAP, "-t_srs", DEGREES)).reshape(ROWS, COLUMNS, 2)
        self.longitude_deg, self.latitude_deg = degrees[:, :, 0], degrees[:, :, 1]

    @property
    def middles_m(self) -> numpy.ndarray:
        return 0.5 * (self.faces_m[1:] + self.faces_m[:-1])

    @property
    def layers(self) -> int:
        return len(self.pressure_pa)


def write_wrf(source: Source, path: pathlib.Path) -> None:
    with netCDF4.Dataset(path, "w") as file:
        for name, length in {
            "Time": None, "DateStrLen": 19, "south_north": ROWS, "west_east": COLUMNS,
            "bottom_top": source.layers, "bottom_top_stag": source.layers + 1,
        }.items():
            file.createDimension(name, length)
        file.setncatts({"TITLE": " OUTPUT FROM WRF V4.7.1 MODEL", "SIMULATION_START_DATE": "2013-05-20_20:00:00"})
        whole = {"GRID_ID": 1, "MAP_PROJ": 1, "MP_PHYSICS": 6}
        file.setncatts({name: numpy.int32(value) for name, value in whole.items()})
        real = {
            "DX": STEP_M, "DY": STEP_M, "TRUELAT1": PARALLELS_DEG[0], "TRUELAT2": PARALLELS_DEG[1],
            "MOAD_CEN_LAT": ORIGIN_DEG[0], "STAND_LON": ORIGIN_DEG[1],
        }
        file.setncatts({name: numpy.float32(value) for name, value in real.items()})
        file.createVariable("Times", "S1", ("Time", "DateStrLen"))[:] = numpy.array([list("2013-05-20_21:00:00")], "S1")
        units = {"PH": "m2 s-2", "PHB": "m2 s-2", "P": "Pa", "PB": "Pa", "T": "K", "HGT": "m", "XLAT": "degree_north", "XLONG": "degree_east"}
        for name, values in {**source.values, "XLAT": source.latitude_deg, "XLONG": source.longitude_deg}.items():
            layers = {2: (), 3: ("bottom_top_stag" if len(values) > source.layers else "bottom_top",)}[values.ndim]
            variable = file.createVariable(name, "f4", ("Time", *layers, "south_north", "west_east"))
            variable.units = units.get(name, "kg kg-1")
            variable[0] = values


def write_cf(source: Source, path: pathlib.Path, faces: bool) -> None:
    """Writes mass fractions of the whole air. An array has the heights of the layers' faces, or of their middles."""
    with netCDF4.Dataset(path, "w") as file:
        file.setncatts({"Conventions": "CF-1.8", "title": "sample storm"})
        for name, length in {"time": 1, "z": source.layers, "z_2": source.layers + 1, "y": ROWS, "x": COLUMNS}.items():
            file.createDimension(name, length)

        def variable(name: str, on: tuple[str, ...], values: object, **attributes: object) -> None:
            created = file.createVariable(name, "f4" if len(on) > 1 else "f8", on)
            created.setncatts(attributes)
            created[:] = values

        variable("time", ("time",), [21.0], units="hours since 2013-05-20 00:00:00", standard_name="time")
        for axis, (length, first) in {"x": (COLUMNS, FIRST_M[0]), "y": (ROWS, FIRST_M[1])}.items():
            variable(axis, (axis,), first + STEP_M * numpy.arange(length), units="m", standard_name=f"projection_{axis}_coordinate")
        for axis, length in {"z": source.layers, "z_2": source.layers + 1}.items():
            variable(axis, (axis,), numpy.arange(1.0, length + 1.0), axis="Z", positive="up", long_name="number of the level")
        crs = file.createVariable("crs", "i4", ())
        crs.setncatts({
            "grid_mapping_name": "lambert_conformal_conic", "standard_parallel": numpy.array(PARALLELS_DEG),
            "longitude_of_central_meridian": ORIGIN_DEG[1], "latitude_of_projection_origin": ORIGIN_DEG[0],
            "earth_radius": EARTH_M,
        })  # fmt: skip
        if faces:
            variable("HHL", ("z_2", "y", "x"), source.faces_m, units="m", standard_name="altitude")
        else:
            variable("z_mc", ("z", "y", "x"), source.middles_m, units="m", standard_name="altitude")
        variable("orog", ("y", "x"), source.values["HGT"], units="m", standard_name="surface_altitude")
        substances = {"cloud": "cloud_liquid_water", "rain": "rain", "ice": "cloud_ice", "snow": "snow", "graupel": "graupel"}
        on = ("time", "z", "y", "x")
        for name, word in NAMES.items():
            variable(f"q_{word}", on, source.dry[name] / source.whole_kg, units="kg kg-1",
                     standard_name=f"mass_fraction_of_{substances[word]}_in_air", grid_mapping="crs")  # fmt: skip
        variable("hus", on, source.vapour / (1.0 + source.vapour), units="1", standard_name="specific_humidity")
        variable("p", on, source.pressure_pa, units="Pa", standard_name="air_pressure")
        variable("ta", on, source.temperature_k, units="K", standard_name="air_temperature")


def octets(number: int, count: int) -> bytes:
    """Returns a number as GRIB2 stores it: big-endian, with a sign bit."""
    return (abs(number) | ((1 << (8 * count - 1)) if number < 0 else 0)).to_bytes(count, "big")


def section(number: int, *parts: bytes) -> bytes:
    contents = b"".join(parts)
    return octets(len(contents) + 5, 4) + octets(number, 1) + contents


def packed(values: numpy.ndarray) -> tuple[bytes, bytes]:
    """Returns sections 5 and 7 by template 5.0 with 24 bits, which are exact to 6e-8 of the range of values."""
    bits = 24
    values = values.ravel()
    low = numpy.float32(values.min())
    low = numpy.nextafter(low, numpy.float32(-numpy.inf)) if low > values.min() else low
    span = float(values.max()) - float(low)
    exponent = int(numpy.ceil(numpy.log2(span / (2**bits - 1)))) if span > 0 else 0
    number = numpy.rint((values - float(low)) / 2.0**exponent).astype(">u4")
    used = bits if span > 0 else 0
    data = number.view("u1").reshape(-1, 4)[:, 1:].tobytes() if used else b""
    head = octets(values.size, 4) + octets(0, 2) + struct.pack(">f", low) + octets(exponent, 2) + octets(0, 2) + octets(used, 1) + octets(0, 1)
    return section(5, head), section(7, data)


def write_grib(source: Source, path: pathlib.Path, centre: int) -> None:
    """Writes the layout of ICON (centre 78: half levels, per kg of the whole air) or HRRR (7: levels, per kg of dry
    air).
    """
    icon = centre == 78
    micro = 1_000_000
    grid = section(
        3, octets(0, 1), octets(ROWS * COLUMNS, 4), octets(0, 2), octets(30, 2),
        octets(1, 1), octets(0, 1), octets(int(EARTH_M), 4), octets(0, 10), octets(COLUMNS, 4), octets(ROWS, 4),
        octets(round(source.latitude_deg[0, 0] * micro), 4), octets(round((source.longitude_deg[0, 0] % 360) * micro), 4),
        octets(8, 1), octets(round(PARALLELS_DEG[0] * micro), 4), octets(round((ORIGIN_DEG[1] % 360) * micro), 4),
        octets(round(STEP_M * 1000), 4), octets(round(STEP_M * 1000), 4), octets(0, 1), octets(0x40, 1),
        octets(round(PARALLELS_DEG[0] * micro), 4), octets(round(PARALLELS_DEG[1] * micro), 4), octets(-90 * micro, 4), octets(0, 4),
    )  # fmt: skip
    messages = []

    def add(category: int, number: int, values: numpy.ndarray, first: tuple[int, int], second: tuple[int, int] = (255, 0)) -> None:
        identification = section(
            1, octets(centre, 2), octets(0, 2), octets(2, 1), octets(0, 1), octets(1, 1), octets(2013, 2), octets(5, 1), octets(20, 1),
            octets(20, 1), octets(0, 2), octets(0, 1), octets(1, 1),
        )  # fmt: skip
        product = section(
            4, octets(0, 2), octets(0, 2), octets(category, 1), octets(number, 1), octets(2, 1), octets(0, 1), octets(1 if icon else 83, 1),
            octets(0, 3), octets(1, 1), octets(1, 4), octets(first[0], 1), octets(0, 1), octets(first[1], 4),
            octets(second[0], 1), octets(0, 1), octets(second[1], 4),
        )  # fmt: skip
        head, data = packed(values)
        body = identification + grid + product + head + section(6, octets(255, 1)) + data
        messages.append(b"GRIB" + octets(0, 2) + octets(0, 1) + octets(2, 1) + octets(len(body) + 20, 8) + body + b"7777")

    per = source.whole_kg if icon else 1.0
    numbers = {"QCLOUD": 22, "QRAIN": 24, "QICE": 82, "QSNOW": 25, "QGRAUP": 32}
    top = source.layers
    for layer in range(top):
        # ICON counts layers from the top, and HRRR from the ground.
        level = top - layer if icon else layer + 1
        first, second = ((150, level), (150, level + 1)) if icon else ((105, level), (255, 0))
        for name, number in numbers.items():
            add(1, number, (source.dry[name] / per)[layer], first, second)
        add(1, 0, (source.vapour / (1.0 + source.vapour))[layer], first, second)
        add(0, 0, source.temperature_k[layer], first, second)
        add(3, 0, source.pressure_pa[layer], first, second)
        if not icon:
            add(3, 5, source.middles_m[layer], first)
    if icon:
        for face in range(top + 1):
            add(3, 6, source.faces_m[face], (150, top + 1 - face), (101, 0))
    add(3, 5, source.values["HGT"], (1, 0))
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(b"".join(messages))


def radiance(path: pathlib.Path) -> numpy.ndarray:
    """Returns R, G and B of an OpenEXR file (32-bit floats in scan lines, ZIP compression) as rows, columns,
    colours.
    """
    data = path.read_bytes()
    at = 8
    header = {}
    while data[at]:
        name, kind, rest = data[at:].split(b"\0", 2)[0:3]
        at += len(name) + len(kind) + 2
        size = struct.unpack_from("<i", data, at)[0]
        header[name.decode()] = data[at + 4 : at + 4 + size]
        at += 4 + size
    at += 1
    assert header["compression"] == b"\x03", "another compression than ZIP"
    low_x, low_y, high_x, high_y = struct.unpack("<4i", header["dataWindow"])
    width, height = high_x - low_x + 1, high_y - low_y + 1
    channels = []
    text = header["channels"]
    while text[0]:
        name, text = text.split(b"\0", 1)
        assert struct.unpack_from("<i", text)[0] == 2, "another type than float"
        channels.append(name.decode())
        text = text[16:]
    lines = numpy.zeros((height, len(channels), width), "<f4")
    for offset in struct.unpack_from(f"<{-(-height // 16)}Q", data, at):
        y, size = struct.unpack_from("<2i", data, offset)
        count = min(16, height - (y - low_y))
        raw = data[offset + 8 : offset + 8 + size]
        if size < count * len(channels) * width * 4:
            # The data are differences of successive octets. The octets at even places are in the first half, those at
            # odd places in the second.
            sums = numpy.frombuffer(zlib.decompress(raw), "u1").astype("i8")
            sums[1:] -= 128
            sums = (numpy.cumsum(sums) & 255).astype("u1")
            mixed = numpy.empty_like(sums)
            half = (len(sums) + 1) // 2
            mixed[0::2], mixed[1::2] = sums[:half], sums[half:]
            raw = mixed.tobytes()
        lines[y - low_y : y - low_y + count] = numpy.frombuffer(raw, "<f4").reshape(count, len(channels), width)
    return numpy.stack([lines[:, channels.index(colour)] for colour in "RGB"], axis=2).astype("f8")


def relative_rmse(image: numpy.ndarray, reference: numpy.ndarray) -> float:
    """Returns the root mean square difference over pixels and colours, divided by the mean radiance, as in
    docs/accuracy.
    """
    return float(numpy.sqrt(numpy.mean((image - reference) ** 2)) / numpy.mean(reference))


class FormatsTest(ProductTest):
    keep: pathlib.Path | None = None

    def setUp(self) -> None:
        super().setUp()
        if self.keep is not None:
            self.folder = self.keep
            self.folder.mkdir(parents=True, exist_ok=True)

    def picture(self, storm: pathlib.Path, view: str, detail: bool) -> numpy.ndarray:
        kind = "detail" if detail else "smooth"
        scene = self.scene(f"{view}-{kind}.json", json.dumps({
            "camera": VIEWS[view], "output": {"widthPx": 320, "heightPx": 200}, "particleSizes": "PARTICLE_SIZES_PAPERS",
            "sun": {"source": "SOURCE_BY_HAND", "azimuthDeg": 275, "elevationDeg": 18}, "rendering": {"lightVolume": {"detail": detail}},
        }))  # fmt: skip
        output = self.folder / f"{view}-{kind}-{storm.stem}.exr"
        self.render(storm, output, "--scene", scene, "--error-seconds", "0")
        return radiance(output)

    def test_one_storm_is_one_picture_in_every_format(self) -> None:
        source = Source()
        wrf = self.folder / "wrfout_d01"
        cf_faces, cf_middles = self.folder / "cf_faces.nc", self.folder / "cf_middles.nc"
        grib_faces, grib_middles = self.folder / "grib_faces", self.folder / "grib_middles"
        write_wrf(source, wrf)
        write_cf(source, cf_faces, True)
        write_cf(source, cf_middles, False)
        write_grib(source, grib_faces / "storm.grib2", 78)
        write_grib(source, grib_middles / "storm.grib2", 7)
        for view in VIEWS:
            for detail, storms in ((True, (cf_faces, grib_faces)), (False, (cf_middles, grib_middles))):
                expected = self.picture(wrf, view, detail)
                for storm in storms:
                    error = relative_rmse(self.picture(storm, view, detail), expected)
                    print(f"{view}, {'with' if detail else 'without'} detail, {storm.stem}: relative RMSE {error:.4f}", flush=True)
                    with self.subTest(view=view, storm=storm.stem):
                        self.assertLess(error, LARGEST)


if __name__ == "__main__":
    if "--keep" in sys.argv:
        at = sys.argv.index("--keep")
        FormatsTest.keep = pathlib.Path(sys.argv[at + 1])
        del sys.argv[at : at + 2]
    unittest.main()
