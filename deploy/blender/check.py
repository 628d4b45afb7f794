"""Compares the Monte Carlo reference with Cycles on the same storms: Henyey and Greenstein, no air, a black ground.
`./dev blender` runs it; docs/accuracy/blender.md explains the figures.

    python3 check.py --program build/release/bin/thunderhead --work /tmp/check --output docs/accuracy
"""

import argparse
import json
import os
import subprocess
import sys
import time
from dataclasses import dataclass

import numpy as np
from PIL import Image

import exr

HERE = os.path.dirname(os.path.abspath(__file__))
SAMPLES = os.path.join(HERE, "..", "..", "samples")
BLOCK = 8  # edge length in pixels of the blocks whose means are also compared
MARKS = ("<!-- ./dev blender writes from here -->", "<!-- to here -->")
WITHOUT_LIMIT = 1025  # largest number of scatterings that Cycles traces


@dataclass
class Case:
    name: str
    storm: str  # a file in samples/, or a preset of `thunderhead generate`
    camera: str
    scatterings: int
    asymmetry: float = 0.85
    only: str = ""  # the only visible field; if empty, all fields are visible
    step: float = 0.125  # step of Cycles along a ray, in edge lengths of the smallest voxel
    picture: bool = False


CASES = [
    # Single scattering tests extinction, place, phase function and shadow.
    Case("1-km storm, ice alone", "supercell.nc", "orbit", 1, 0.7, only="ice"),
    Case("1-km storm, graupel alone", "supercell.nc", "orbit", 1, 0.3, only="graupel"),
    Case("1-km storm", "supercell.nc", "orbit", 1),
    Case("1-km storm", "supercell.nc", "top-down", 1),
    # Multiple scattering tests the transport of light.
    Case("1-km storm", "supercell.nc", "orbit", 64, 0.0),
    Case("1-km storm", "supercell.nc", "orbit", 64, 0.5, step=1.0),
    Case("1-km storm", "supercell.nc", "orbit", 64, 0.5, step=0.5),
    Case("1-km storm", "supercell.nc", "orbit", 64, 0.5, step=0.25),
    Case("1-km storm", "supercell.nc", "orbit", 64, 0.5),
    Case("1-km storm", "supercell.nc", "orbit", WITHOUT_LIMIT, step=0.25, picture=True),
    Case("1-km storm", "supercell.nc", "spotter", WITHOUT_LIMIT, step=0.25, picture=True),
    Case("congestus", "congestus", "orbit", WITHOUT_LIMIT, step=0.25, picture=True),
    Case("congestus", "congestus", "spotter", WITHOUT_LIMIT, step=0.25, picture=True),
]


def run(*command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}\n{done.stdout[-2000:]}\nfailed with status {done.returncode}")


def scene_of(case, path):
    with open(os.path.join(HERE, "scene.json"), encoding="utf-8") as file:
        scene = json.load(file)
    for field in scene["fields"]:
        field["phase"]["asymmetry"] = case.asymmetry
        field["visible"] = not case.only or field["hydrometeor"].lower().endswith(case.only)
    with open(path, "w", encoding="utf-8") as file:
        json.dump(scene, file)


def storm_of(case, arguments):
    if case.storm.endswith(".nc"):
        return os.path.join(SAMPLES, case.storm)
    path = os.path.join(arguments.work, case.storm + ".nc")
    if not os.path.exists(path):
        run(arguments.program, "generate", "--preset", case.storm, "-o", path)
    return path


def render_both(number, case, arguments):
    """Renders the case with Cycles and the reference.

    Returns two independent halves of Cycles' picture, the reference's picture and its standard error, and the seconds
    that each program took.
    """
    base = os.path.join(arguments.work, f"case{number}")
    scene_of(case, base + ".scene.json")
    common = [storm_of(case, arguments), "--scene", base + ".scene.json", "--camera", case.camera, "--size",
              arguments.size]
    run(arguments.program, "export", *common, "-o", base + ".vdb", "--view", base + ".json")
    began = time.monotonic()
    halves = []
    for seed in (1, 2):
        half = f"{base}.cycles{seed}.exr"
        run("blender", "-b", "--factory-startup", "--python-exit-code", "1", "--python",
            os.path.join(HERE, "thunderhead_storm.py"), "--", base + ".vdb", base + ".json", "-o", half, "--seed",
            str(seed), "--samples", str(arguments.cycles_samples // 2), "--scatterings", str(case.scatterings),
            "--step", str(case.step), "--sun-diameter-deg", "0")
        halves.append(exr.read_rgb(half).mean(axis=-1))
    middle = time.monotonic()
    reference = base + ".reference.exr"
    run(arguments.program, "render", *common, "--technique", "reference", "--no-air", "--peak-cut", "0",
        "--max-scatterings", str(case.scatterings), "--spp", str(arguments.reference_samples), "-o", reference)
    # The medium is grey, so the three colours of a path have the same value.
    error = exr.read_rgb(reference, "stderr.")[..., 0]
    return halves, exr.read_rgb(reference)[..., 0], error, middle - began, time.monotonic() - middle


def blocks(picture):
    height, width = (size // BLOCK * BLOCK for size in picture.shape)
    return picture[:height, :width].reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK).mean(axis=(1, 3))


def excess(halves, reference, variance):
    """Returns the relative RMSE of the difference, the part of it that noise explains, and the rest.

    The rest is negative if the difference is smaller than the noise explains.
    """
    cycles = 0.5 * (halves[0] + halves[1])
    of_cycles = np.mean((halves[0] - halves[1]) ** 2) / 4
    of_reference = np.mean(variance)
    squared = np.mean((cycles - reference) ** 2)
    left = squared - of_cycles - of_reference
    return [value / reference.mean() for value in (np.sqrt(squared), np.sqrt(of_cycles + of_reference),
                                               np.copysign(np.sqrt(abs(left)), left))]


def row_of(case, samples, halves, reference, error, seconds):
    mean = reference.mean()
    cycles = 0.5 * (halves[0] + halves[1])
    of_cycles = np.sqrt(np.sum((halves[0] - halves[1]) ** 2) / 4) / reference.size
    of_reference = np.sqrt(np.sum(error ** 2)) / reference.size
    bias = cycles.mean() / mean - 1
    of_bias = np.hypot(of_cycles, of_reference) / mean
    pixel = excess(halves, reference, error ** 2)
    block = excess([blocks(half) for half in halves], blocks(reference), blocks(error ** 2) / BLOCK ** 2)
    light = "all" if case.scatterings == WITHOUT_LIMIT else str(case.scatterings)
    return (f"| {case.name} | {case.camera} | {light} | {case.asymmetry:g} | {case.step:g} | "
            f"{samples[0]}, {samples[1]} | {100 * bias:+.2f} ± {100 * of_bias:.2f} % | {pixel[0]:.3f} | {pixel[1]:.3f} | {pixel[2]:+.3f} | "
            f"{block[0]:.3f} | {block[1]:.3f} | {block[2]:+.3f} | {seconds[0]:.0f}, {seconds[1]:.0f} s |")


HEADER = ("| case | camera | scatterings | g | step | samples | mean, Cycles over reference | RMSE | noise | without noise | "
          "RMSE of blocks | noise | without noise | Cycles, reference |\n"
          "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|")


def write_picture(path, halves, reference):
    """Writes three pictures side by side: Cycles, the reference, and their difference.

    In the difference, mid-grey means that both are equal. Where Cycles exceeds the reference by the reference's mean,
    the grey is brighter by a quarter of the full range.
    """
    cycles = 0.5 * (halves[0] + halves[1])
    white = np.percentile(reference, 99.5)
    panes = [np.clip(picture / white, 0, 1) ** (1 / 2.2) for picture in (cycles, reference)]
    panes.append(np.clip(0.5 + 0.25 * (cycles - reference) / reference.mean(), 0, 1))
    grey = (255 * np.concatenate(panes, axis=1) + 0.5).astype(np.uint8)
    Image.fromarray(grey).save(path, quality=82)


def write_table(path, table):
    """Replaces the text between the two marks in the page."""
    with open(path, encoding="utf-8") as file:
        page = file.read()
    before, rest = page.split(MARKS[0])
    after = rest.split(MARKS[1])[1]
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"{before}{MARKS[0]}\n{table}\n{MARKS[1]}{after}")


def main():
    parser = argparse.ArgumentParser(prog="check.py", description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--work", required=True, help="folder for what is rendered")
    parser.add_argument("--output", required=True, help="folder of blender.md, whose table it writes, and of the pictures")
    parser.add_argument("--size", default="160x100")
    parser.add_argument("--cycles-samples", type=int, default=64, help="a pixel; even")
    parser.add_argument("--reference-samples", type=int, default=512)
    parser.add_argument("--only", type=int, nargs="*", help="numbers of the cases to run, from 0")
    arguments = parser.parse_args()
    os.makedirs(arguments.work, exist_ok=True)
    rows = [HEADER]
    print(HEADER, flush=True)
    for number, case in enumerate(CASES):
        if arguments.only and number not in arguments.only:
            continue
        halves, reference, error, *seconds = render_both(number, case, arguments)
        rows.append(row_of(case, (arguments.cycles_samples, arguments.reference_samples), halves, reference, error, seconds))
        print(rows[-1], flush=True)
        if case.picture:
            storm = case.storm.removesuffix(".nc")
            write_picture(os.path.join(arguments.output, f"blender-{storm}-{case.camera}.jpg"), halves, reference)
    if not arguments.only:
        write_table(os.path.join(arguments.output, "blender.md"), "\n".join(rows))


main()
