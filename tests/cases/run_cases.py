"""Runs the program on the files that people report trouble with, and checks its exit code and its output.

Usage: run_cases.py GROUP. The environment has THUNDERHEAD_BINARY, CASES (the folder with a make.py for each case) and
WORK (a folder for the files that these write). Exit code 77 means that the cases or their Python packages are missing.
"""
import importlib.util
import os
import pathlib
import shutil
import subprocess
import sys
import time
from typing import NamedTuple

import cf_cases


class Check(NamedTuple):
    case: str  # the folder of the case; empty for files that are there already
    command: str  # the program's arguments, run where make.py has written its files; {data} is ../data of the cases
    code: int  # the exit code
    says: tuple = ()  # words of the output or of the error
    never: tuple = ()  # words that are neither in the output nor in the error
    aged: tuple = ()  # files whose last change is set to an hour ago; all others have just changed


KATRINA = "{data}/real/wrf-python_ci_test_file.nc"  # WRF 3.8.1 with WSM3, a moving nest
STILL_WRITTEN = ("still be writing", "still being written")

CHECKS = {
    "wrf": (
        Check("01_xlat_without_time", "inspect wrfout_d01_2013-05-20_20:00:00", 0, ("middle  35.000 N -97.000 E",)),
        Check("01_xlat_without_time", "inspect xlat_only.nc", 0, ("middle  35.000 N -97.000 E",)),
        Check("01_xlat_without_time", "inspect control.nc", 0, ("middle  35.000 N -97.000 E",)),
        Check("06_xtime_reencoded", "inspect xtime_hours.nc", 0, ("2013-05-20T20:00:00Z", "2013-05-20T21:00:00Z")),
        Check("06_xtime_reencoded", "inspect xtime_minutes.nc", 0, ("2013-05-20T20:00:00Z", "2013-05-20T21:00:00Z")),
        Check("07_after_cdo", "inspect cdo_levels.nc", 0, ("middle  35.000 N -97.000 E", "2013-05-20T20:20:00Z"),
              STILL_WRITTEN),
        Check("07_after_cdo", "inspect cdo_time_only.nc", 0, ("middle  35.000 N -97.000 E", "2013-05-20T20:20:00Z"),
              STILL_WRITTEN),
        Check("13_moving_nest", "inspect moving.nc --time 0", 0, ("middle  35.000 N -97.000 E", "domain moves")),
        Check("13_moving_nest", "inspect moving.nc --time 1", 0, ("middle  35.200 N -96.500 E", "domain moves")),
        Check("13_moving_nest", "inspect folder --time 0", 0, ("middle  35.000 N -97.000 E",)),
        Check("13_moving_nest", "inspect folder --time 1", 0, ("middle  35.200 N -96.500 E",)),
        Check("27_no_records", "inspect empty.nc", 65, ("holds no times",), STILL_WRITTEN, aged=("empty.nc",)),
        Check("27_no_records", "inspect empty.nc", 75, ("holds no times", "it changed just now")),
        Check("27_no_records", "inspect run", 0, ("2013-05-20T20:00:00Z", "2013-05-20T20:40:00Z",
                                                  "wrfout_d01_2013-05-20_20_20_00: holds no times")),
        Check("49_level_numbers", "inspect xwrf.nc", 65, ("vertical coordinate z counts eta", "heights are needed"),
              STILL_WRITTEN, aged=("xwrf.nc",)),
        Check("", f"inspect {KATRINA} --time 0", 0, ("middle  23.753 N -89.540 E", "0.00181", "0.00528", "scheme WSM3")),
        Check("", f"inspect {KATRINA} --time 3", 0, ("middle  24.737 N -90.889 E", "domain moves")),
    ),
    "cf": tuple(Check(*row) for row in cf_cases.CHECKS),
    "series": (
        Check("24_restart_overlap", "inspect run", 0,
              ("2013-05-20T20:00:00Z", "2013-05-20T20:40:00Z", "because it was written later")),
        Check("26_field_in_some_files", "inspect run", 0,
              ("2013-05-20T20:00:00Z", "2013-05-20T20:40:00Z", "has no graupel", "have no hail")),
        Check("68_longer_overlap", "inspect run", 0, ("2013-05-20T21:00:00Z", "because it was written later")),
        Check("69_times_not_rising", "inspect falling.nc", 0, ("2013-05-20T20:00:00Z", "2013-05-20T20:30:00Z")),
        Check("69_times_not_rising", "inspect double.nc", 0, ("in records 0 and 1; the later record is used",)),
    ),
}


def made(case):
    """Writes the files of the case and returns their folder."""
    folder = pathlib.Path(os.environ["WORK"]) / (case or "no_case")
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    if not case:
        return folder
    script = pathlib.Path(os.environ["CASES"]) / case / "make.py"
    subprocess.run([sys.executable, "-B", script], cwd=folder, check=True)
    return folder


def failures(check, folder):
    """Runs the command and returns a line for each thing that is wrong."""
    now = time.time()
    for path in folder.glob("*"):
        age_s = 3600 if path.name in check.aged else 0
        os.utime(path, (now - age_s, now - age_s))
    command = check.command.format(data=pathlib.Path(os.environ["CASES"]).parent / "data")
    run = subprocess.run([os.environ["THUNDERHEAD_BINARY"], *command.split()], cwd=folder, capture_output=True, text=True)
    output = run.stdout + run.stderr
    wrong = [] if run.returncode == check.code else [f"exit code {run.returncode}, not {check.code}"]
    wrong += [f"does not say '{words}'" for words in check.says if words not in output]
    wrong += [f"says '{words}'" for words in check.never if words in output]
    return wrong + [output] if wrong else []


def main():
    group = sys.argv[1]
    if not pathlib.Path(os.environ["CASES"]).is_dir() or importlib.util.find_spec("netCDF4") is None:
        print("skipped: the cases or python3-netcdf4 are missing")
        return 77
    folders = {}
    failed = 0
    for check in CHECKS[group]:
        if check.case not in folders:
            folders[check.case] = made(check.case)
        wrong = failures(check, folders[check.case])
        failed += bool(wrong)
        print(f"{'FAILED' if wrong else 'ok    '} {check.case}: {check.command.format(data='data')}")
        for line in wrong:
            print(f"       {line}")
    print(f"{len(CHECKS[group]) - failed} of {len(CHECKS[group])} checks passed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
