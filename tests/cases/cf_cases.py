"""The expected results for the CF files that people report trouble with.

Each row has the members of run_cases.Check: the folder of the case, the program's arguments, and the exit code. Then
follow the words that the output must contain, and those that it must not contain.
"""

NOT_CUT_SHORT = ("cut short", "still be writing", "still being written")

CHECKS = (
    ("31_calendar", "inspect noleap.nc", 0, ("2013-05-20T20:00:00Z", "2013-05-20T21:00:00Z", "calendar noleap")),
    ("31_calendar", "inspect d360.nc", 0, ("2013-05-20T20:00:00Z", "2013-05-20T21:00:00Z", "calendar 360_day")),
    ("33_time_zone", "inspect plus9.nc", 0, ("2013-05-20T20:00:00Z",)),
    ("33_time_zone", "inspect iso_minus6.nc", 0, ("2013-05-20T20:00:00Z",)),
    ("33_time_zone", "inspect zulu.nc", 0, ("2013-05-20T20:00:00Z",)),
    # unsigned.nc stores the same cells as control.nc in another way, so both have the same largest rain water path.
    ("39_unsigned_and_valid_range", "inspect control.nc", 0, ("34.72",)),
    ("39_unsigned_and_valid_range", "inspect unsigned.nc", 0, ("34.72", "0.00258"), ("0.032",)),
    ("44_filters", "inspect f_zstd.nc", 65, ("Zstandard (HDF5 filter 32015", "hdf5plugin"), NOT_CUT_SHORT),
    ("45_rotated_pole", "inspect rotated.nc", 0, ("middle  47.000 N 8.000 E",)),
    ("46_greenwich_0_360", "inspect wrap.nc", 0, ("middle  51.000 N 0.000 E",)),
    ("46_greenwich_0_360", "inspect east.nc", 0, ("middle  35.200 N -97.400 E",)),
    ("49_level_numbers", "inspect levels.nc", 65, ("lev has no units", "numbers of levels", "HHL"), NOT_CUT_SHORT),
    ("50_scalar_time", "inspect scalar.nc", 0, ("2013-05-20T20:00:00Z",)),
    ("50_scalar_time", "inspect run", 0, ("2013-05-20T20:00:00Z", "2013-05-20T20:30:00Z")),
    ("57_bounds_and_corners", "inspect middles.nc", 0, ("middle  35.200 N -97.400 E",)),
    ("57_bounds_and_corners", "inspect corners.nc", 0, ("middle  35.200 N -97.400 E",)),
    ("57_bounds_and_corners", "inspect layers.nc", 0, ("0.5844",)),
    ("62_lambert_cf", "inspect lambert.nc", 0, ("middle  35.200 N -97.400 E",)),
    # The layers below the hill are empty. Without a hill the mean rain water path would be 1.422 kg/m2.
    ("66_terrain_layout", "inspect control.nc", 0, ("1.308", "34.52"), ("1.422",)),
    ("66_terrain_layout", "inspect xy.nc", 0, ("1.308", "34.52"), ("1.422",)),
    ("66_terrain_layout", "inspect tyx.nc", 0, ("1.308", "34.52"), ("1.422",)),
    ("66_terrain_layout", "inspect km.nc", 0, ("1.308", "34.52"), ("1.422",)),
    ("67_height_above_ground", "inspect height.nc --json", 0, ('"zM": 1500', "above the surface")),
    ("67_height_above_ground", "inspect altitude.nc --json", 0, ('"zM": 1500',)),
    ("69_times_not_rising", "inspect falling.nc", 0, ("2013-05-20T20:00:00Z", "2013-05-20T20:30:00Z", "do not rise")),
    ("69_times_not_rising", "inspect falling.nc --time 0", 0, ("0.0056",)),
    ("69_times_not_rising", "inspect double.nc", 0, ("2013-05-20T20:00:00Z", "twice")),
)
