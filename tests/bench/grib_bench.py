"""Time and memory of a GRIB2 file of the size of HRRR's native files, by stage: ./dev bench grib.

Makes the file from a small one in the same layout (3 minutes, 0.65 GB), unless --large names one that exists. Then prints the stages of reading within
one process, and the seconds and the peak memory of `thunderhead inspect` and `thunderhead render` with their readers."""

import argparse
import pathlib
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
SMALL = ROOT.parent / "shared/data/grib/hrrr-native/hrrr.t21z.wrfnatf01.grib2"
GIB_KB = 1 << 20


def peaks_kb(process: int, known: dict[str, int]) -> None:
    """Updates the peak memory of the process and of its readers, by the program's name."""
    try:
        children = pathlib.Path(f"/proc/{process}/task/{process}/children").read_text().split()
        for each in [str(process), *children]:
            status = pathlib.Path(f"/proc/{each}/status").read_text()
            fields = dict(line.split(":", 1) for line in status.splitlines())
            if "VmHWM" in fields:
                name = fields["Name"].strip()
                known[name] = max(known.get(name, 0), int(fields["VmHWM"].split()[0]))
    except (FileNotFoundError, ProcessLookupError):
        pass  # it has just ended


def run(name: str, command: list[str]) -> None:
    """Runs the command, and prints its seconds and the peaks."""
    begun = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    peaks: dict[str, int] = {}
    while process.poll() is None:
        for thread in pathlib.Path(f"/proc/{process.pid}/task").glob("*"):
            try:
                for child in (thread / "children").read_text().split():
                    peaks_kb(int(child), peaks)
            except (FileNotFoundError, ProcessLookupError):
                pass
        peaks_kb(process.pid, peaks)
        time.sleep(0.02)
    if process.returncode != 0:
        sys.exit(f"{name} failed")
    memory = ", ".join(f"{program} {kb / GIB_KB:.2f} GiB" for program, kb in sorted(peaks.items()))
    print(f"{name}: {time.monotonic() - begun:.1f} s; at most {memory}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--small", type=pathlib.Path, default=SMALL)
    parser.add_argument("--large", type=pathlib.Path, help="an existing large file, or where to keep it")
    parser.add_argument("--programs", type=pathlib.Path, default=ROOT / "build/release/bin")
    parser.add_argument("--size", default="1280x720")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="thunderhead-bench-") as folder:
        large = options.large or pathlib.Path(folder) / "hrrr.grib2"
        bench, thunderhead = options.programs / "thunderhead_grib_bench", options.programs / "thunderhead"
        if not large.exists():
            subprocess.run([bench, "make", options.small, large], check=True)
        subprocess.run(["cat", large], stdout=subprocess.DEVNULL, check=True)  # so that the file is in memory
        subprocess.run([bench, "stages", large], check=True)
        run("inspect", [str(thunderhead), "inspect", str(large)])
        run("render", [str(thunderhead), "render", str(large), "--size", options.size, "--device", "software", "-o", f"{folder}/storm.png"])


if __name__ == "__main__":
    main()
