"""Measures the pictures per minute of `thunderhead sequence` on a run of twelve files, and where the time is spent.

`./dev bench pipeline` runs it. It prints a table for docs/performance.md. If other programs use the machine, the load
is higher and the run's share of the processors is lower.
"""

import argparse
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]


def sequence(program: str, storm: pathlib.Path, size: str, device: str, processes: int) -> dict[str, float]:
    """Draws the whole run with this number of processes. Returns the seconds that each kind of work took."""
    folder = pathlib.Path(tempfile.mkdtemp(prefix="thunderhead-bench-"))
    try:
        begun, cpu_begun = time.monotonic(), os.times()
        running = [
            subprocess.Popen(
                [program, "sequence", str(storm), "--product", str(folder / "{valid:%H%M}.png"), "--size", size, "--device", device,
                 "--shard", f"{share}/{processes}", "--progress", "json"], stdout=subprocess.PIPE, text=True)
            for share in range(processes)
        ]
        events = [json.loads(line) for process in running for line in process.communicate()[0].splitlines()]
        if any(process.returncode != 0 for process in running):
            raise SystemExit("a run failed; see above")
        seconds = time.monotonic() - begun
        cpu = os.times()
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    drawn = [event for event in events if event["event"] == "drawn"]
    total = {part: sum(event[f"{part}_ms"] for event in drawn) / 1000.0 for part in ("read", "draw", "write")}
    return {"pictures": len(drawn), "seconds": seconds, "processes": processes,
            "cpu": cpu.children_user + cpu.children_system - cpu_begun.children_user - cpu_begun.children_system, **total}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("storm", nargs="?", type=pathlib.Path, default=ROOT.parent / "shared/data/supercell-series")
    parser.add_argument("--program", default=str(ROOT / "build/release/bin/thunderhead"))
    parser.add_argument("--size", default="1280x720")
    parser.add_argument("--device", default="auto")
    options = parser.parse_args()
    print(f"{options.storm.name}, {options.size}, default look, {os.cpu_count()} processors, device {options.device}\n")
    print("| processes | pictures a minute | reading | drawing | writing | drawing of the run | processors used | load before |")
    print("|---|---|---|---|---|---|---|---|")
    for processes in (1, 2):
        load = os.getloadavg()[0]
        took = sequence(options.program, options.storm, options.size, options.device, processes)
        work = took["read"] + took["draw"] + took["write"]
        shares = " | ".join(f'{100 * took[part] / work:.1f} %' for part in ("read", "draw", "write"))
        print(f'| {processes} | {60 * took["pictures"] / took["seconds"]:.1f} | {shares} '
              f'| {100 * took["draw"] / took["seconds"] / processes:.0f} % | {took["cpu"] / took["seconds"]:.2f} | {load:.1f} |', flush=True)


if __name__ == "__main__":
    main()
