"""Plots how time and memory grow with the size of the problem: docs/growth.csv and docs/growth.svg.

    growth_plot.py BENCHMARK.json [LOAD.json ...] -o PREFIX

`thunderhead_bench --benchmark_filter=growth --benchmark_out=BENCHMARK.json` writes BENCHMARK.json. `thunderhead load
--json` prints a LOAD.json for one number of viewers; without LOAD.json, viewers are not plotted. `./dev bench growth`
writes all of these files and runs this script.
"""

import argparse
import csv
import json
import re

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams["svg.fonttype"] = "none"  # words stay words
matplotlib.rcParams["svg.hashsalt"] = "thunderhead"  # the same figures give the same file
from matplotlib import pyplot, ticker  # noqa: E402

ROW = re.compile(r"growth/(?P<technique>\w+)/(?P<axis>[a-z]+)_(?P<value>\d+)(?P<light>/light)?(/|_median|$)")
# Each technique's name on the plot and its colour. Colour-blind people can tell the colours apart.
SERIES = {
    "default": ("default look", "#0072b2"),
    "light_volume": ("light volume, as the papers", "#e69f00"),
    "half_angle": ("slicing, as the papers", "#009e73"),
}
AXES = {"cells": "cells", "pixels": "pixels", "slices": "samples along a ray, or slices", "fields": "fields"}


def rows_of(benchmark):
    """Returns rows of (technique, axis, value, moving, milliseconds, fields in MB, textures in MB), only medians, in order."""
    rows = []
    for run in benchmark["benchmarks"]:
        found = ROW.match(run["run_name"])
        if found is None or run.get("aggregate_name") != "median":
            continue
        moving = "sun" if found["light"] else "camera"
        memory = (run["fields_MB"], run["device_MB"])
        rows.append((found["technique"], found["axis"], int(found["value"]), moving, run["real_time"], *memory))
    return sorted(rows)


def curve(axes, rows, column, **style):
    if rows:
        axes.plot([row[2] for row in rows], [row[column] for row in rows], marker="o", markersize=3, linewidth=1.2, **style)


def label(axes, across, up):
    axes.set(xscale="linear" if across == AXES["fields"] else "log", yscale="log", xlabel=across, ylabel=up)
    for scaled in (axes.xaxis, axes.yaxis):
        if scaled.get_scale() == "log":
            scaled.set_major_locator(ticker.LogLocator(subs=(1, 2, 5)))
            scaled.set_minor_locator(ticker.NullLocator())
        scaled.set_major_formatter(ticker.EngFormatter(sep=""))
    axes.grid(True, which="major", color="#cccccc", linewidth=0.5)
    axes.legend(fontsize=7, frameon=False)


def plot_times(axes, rows, axis):
    for technique, (name, color) in SERIES.items():
        for moving, dashes in (("camera", "-"), ("sun", "--")):
            here = [row for row in rows if (row[0], row[1], row[3]) == (technique, axis, moving)]
            curve(axes, here, 4, color=color, linestyle=dashes, label=f"{name}, {moving} moves")
    label(axes, AXES[axis], "ms a frame")


def plot_memory(axes, rows):
    here = [row for row in rows if row[0] == "default" and row[1] == "cells" and row[3] == "camera"]
    curve(axes, here, 5, color="#d55e00", label="fields, in main memory")
    curve(axes, here, 6, color="#cc79a7", label="textures, on the device")
    label(axes, AXES["cells"], "MB")


def plot_viewers(axes, loads):
    viewers = [load["viewers"] for load in loads]
    axes.plot(viewers, [load["fps_min"] for load in loads], marker="o", markersize=3, color="#0072b2", label="frames/s of the slowest viewer")
    axes.plot(viewers, [load["latency_ms"]["p95"] for load in loads], marker="o", markersize=3, color="#d55e00", label="latency, p95, ms")
    label(axes, "viewers", "frames/s, ms")


def write_csv(path, rows, loads):
    with open(path, "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["technique", "axis", "value", "moving", "milliseconds", "fields_mb", "device_mb", "fps_min", "latency_p95_ms"])
        for *key, milliseconds, fields, device in rows:
            table.writerow([*key, f"{milliseconds:.3g}", f"{fields:.4g}", f"{device:.4g}", "", ""])
        for load in loads:
            figures = [f"{load['fps_min']:.3g}", f"{load['latency_ms']['p95']:.3g}"]
            table.writerow(["server", "viewers", load["viewers"], "camera", "", "", "", *figures])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("benchmark")
    parser.add_argument("loads", nargs="*")
    parser.add_argument("-o", "--output", required=True, help="prefix of the files to write: .csv and .svg")
    arguments = parser.parse_args()
    with open(arguments.benchmark, encoding="utf-8") as file:
        benchmark = json.load(file)
    loads = []
    for path in arguments.loads:
        with open(path, encoding="utf-8") as file:
            loads.append(json.load(file))
    loads.sort(key=lambda load: load["viewers"])
    rows = rows_of(benchmark)
    if not rows:
        parser.error(f"{arguments.benchmark} has no medians of growth; make it with --benchmark_filter=growth --benchmark_out=FILE")
    figure, grid = pyplot.subplots(2, 3, figsize=(13, 8))
    for axes, axis in zip(grid.flat, AXES):
        plot_times(axes, rows, axis)
    plot_memory(grid[1, 1], rows)
    if loads:
        plot_viewers(grid[1, 2], loads)
    else:
        grid[1, 2].set_axis_off()
    figure.suptitle(f"300 x 300 pixels, 128 samples, five fields, 2.2 million cells where not said; {benchmark['context']['gl_renderer']}", fontsize=9)
    figure.tight_layout()
    figure.savefig(f"{arguments.output}.svg", metadata={"Date": None})
    write_csv(f"{arguments.output}.csv", rows, loads)


if __name__ == "__main__":
    main()
