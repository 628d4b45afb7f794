"""Moves a storm to a coast for the gallery.

    storm_at_coast.py IN.nc OUT.nc

OUT.nc has one time of an idealised WRF file, with a map projection, latitudes and longitudes around Galveston Bay, and
land and water by GSHHG's coast.
"""

import sys

import netCDF4
import numpy

COASTS = "/usr/share/gmt-gshhg/binned_GSHHS_h.nc"
MIDDLE_DEG = (29.4, -94.9)
INLAND_DEG = 30.6  # farther north there is only land
PARALLELS_DEG = (25.0, 35.0)
RADIUS_M = 6_370_000.0
WATER, GRASSLAND = 16, 7  # USGS classes


class Lambert:
    """The Lambert conformal conic projection around the meridian of the domain's middle (Snyder 1987, 15-1 to 15-11)."""

    def __init__(self) -> None:
        first, second = numpy.radians(PARALLELS_DEG)
        self.cone = numpy.log(numpy.cos(first) / numpy.cos(second)) / numpy.log(self.stretched(second) / self.stretched(first))
        self.scale_m = RADIUS_M * numpy.cos(first) * self.stretched(first) ** self.cone / self.cone
        self.middle_m = self.scale_m / self.stretched(numpy.radians(MIDDLE_DEG[0])) ** self.cone

    @staticmethod
    def stretched(latitude: float) -> float:
        return numpy.tan(numpy.pi / 4 + latitude / 2)

    def place_of(self, east_m: numpy.ndarray, north_m: numpy.ndarray) -> tuple[numpy.ndarray, numpy.ndarray]:
        """Returns latitudes and longitudes in degrees."""
        down_m = self.middle_m - north_m
        latitude = 2 * numpy.arctan((self.scale_m / numpy.hypot(east_m, down_m)) ** (1 / self.cone)) - numpy.pi / 2
        return numpy.degrees(latitude), MIDDLE_DEG[1] + numpy.degrees(numpy.arctan2(east_m, down_m) / self.cone)


def coast_near(latitudes: numpy.ndarray, longitudes: numpy.ndarray) -> numpy.ndarray:
    """Returns the pieces of coast near these places, each as two longitudes and two latitudes in degrees."""
    pieces = []
    with netCDF4.Dataset(COASTS) as file:
        file.set_auto_maskandscale(False)
        value = {name: variable[:] for name, variable in file.variables.items()}
        side = value["Bin_size_in_minutes"][0] / 60
        columns = value["N_bins_in_360_longitude_range"][0]
        for bin_index, first in enumerate(value["Id_of_first_segment_in_a_bin"]):
            west = bin_index % columns * side - 360
            south = 90 - side * (bin_index // columns + 1)
            if west > longitudes.max() or west + side < longitudes.min() or south > INLAND_DEG or south + side < latitudes.min():
                continue
            for segment in range(first, first + value["N_segments_in_a_bin"][bin_index]):
                start = value["Id_of_first_point_in_a_segment"][segment]
                points = slice(start, start + (value["Embedded_npts_levels_exit_entry_for_a_segment"][segment] >> 9))
                parts = side / 65535
                x = west + parts * value["Relative_longitude_from_SW_corner_of_bin"][points].astype(numpy.uint16)
                y = south + parts * value["Relative_latitude_from_SW_corner_of_bin"][points].astype(numpy.uint16)
                pieces.append(numpy.stack([x[:-1], x[1:], y[:-1], y[1:]], 1))
    return numpy.concatenate(pieces)


def is_land(latitudes: numpy.ndarray, longitudes: numpy.ndarray) -> numpy.ndarray:
    """Returns which places are land.

    A place is land if a line to the north, up to a latitude that is land, crosses the coast an even number of times.
    """
    coast = coast_near(latitudes, longitudes)
    land = numpy.empty(latitudes.shape, bool)
    for at, longitude in numpy.ndenumerate(longitudes):
        crossed = coast[(coast[:, 0] <= longitude) != (coast[:, 1] <= longitude)]
        there = crossed[:, 2] + (longitude - crossed[:, 0]) / (crossed[:, 1] - crossed[:, 0]) * (crossed[:, 3] - crossed[:, 2])
        land[at] = ((there > latitudes[at]) & (there < INLAND_DEG)).sum() % 2 == 0
    return land


def main(source: str, output: str) -> None:
    with netCDF4.Dataset(source) as before, netCDF4.Dataset(output, "w") as after:
        for name, dimension in before.dimensions.items():
            after.createDimension(name, None if dimension.isunlimited() else len(dimension))
        after.setncatts({name: before.getncattr(name) for name in before.ncattrs()})
        after.setncatts({"MAP_PROJ": numpy.int32(1), "TRUELAT1": PARALLELS_DEG[0], "TRUELAT2": PARALLELS_DEG[1], "MOAD_CEN_LAT": MIDDLE_DEG[0],
                         "STAND_LON": MIDDLE_DEG[1], "MMINLU": "USGS"})
        for name, variable in before.variables.items():
            copy = after.createVariable(name, variable.dtype, variable.dimensions, zlib=variable.dtype.kind != "S")
            copy.setncatts({each: variable.getncattr(each) for each in variable.ncattrs()})
            variable.set_auto_maskandscale(False)
            copy.set_auto_maskandscale(False)
            copy[0] = variable[-1]
        columns = ("Time", "south_north", "west_east")
        rows, cells = (len(before.dimensions[name]) for name in columns[1:])
        north_m, east_m = (before.DX * (numpy.arange(count) - (count - 1) / 2) for count in (rows, cells))
        latitudes, longitudes = Lambert().place_of(*numpy.meshgrid(east_m, north_m))
        land = is_land(latitudes, longitudes)
        fields = {"XLAT": latitudes, "XLONG": longitudes, "LU_INDEX": numpy.where(land, GRASSLAND, WATER), "XLAND": numpy.where(land, 1, 2)}
        for name, values in fields.items():
            variable = after.variables[name] if name in after.variables else after.createVariable(name, "f4", columns)
            variable[0] = values


if __name__ == "__main__":
    main(*sys.argv[1:])
