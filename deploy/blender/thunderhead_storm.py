"""Renders with Cycles a storm that `thunderhead export STORM -o storm.vdb --view storm.json` wrote.

    blender -b --factory-startup --python thunderhead_storm.py -- storm.vdb storm.json -o storm.exr

Camera, sun and picture size are those of the scene. Each grid scatters by Henyey and Greenstein with its own asymmetry
and albedo. There is no sky, no air and no ground. Without -o the script only builds the scene: start Blender without
-b, and continue there. The output is linear radiance in the unit of the sun's irradiance, as 32-bit OpenEXR. One
Blender unit is a kilometre. Needs Blender 3.4 or later.
"""

import argparse
import json
import math
import os
import sys

import bpy
from mathutils import Matrix, Vector

# Cycles ignores a medium that scatters less than 1e-5 per unit. With a unit of one metre this would be an optical depth
# of 1 in 100 km, which is too much to ignore. The unit is therefore a kilometre.
METRES_PER_UNIT = 1000.0


def in_units(metres):
    return Vector(metres) / METRES_PER_UNIT


def parse_arguments():
    parser = argparse.ArgumentParser(prog="thunderhead_storm.py", description=__doc__.splitlines()[0])
    parser.add_argument("vdb")
    parser.add_argument("view", help="the JSON of `thunderhead export --view`")
    parser.add_argument("-o", "--output", help="picture to render: .exr")
    parser.add_argument("--samples", type=int, default=64, help="samples a pixel (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--scatterings", type=int, default=1025,
                        help="light scattered more often is left out (1 to 1025, the default)")
    parser.add_argument("--step", type=float, default=0.25,
                        help="length of a ray's steps, in edges of the smallest voxel (default: %(default)s)")
    parser.add_argument("--sun-diameter-deg", type=float, default=0.53,
                        help="angular diameter of the sun (default: %(default)s)")
    arguments = parser.parse_args(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else [])
    if not 1 <= arguments.scatterings <= 1025:
        parser.error(f"--scatterings is {arguments.scatterings}; it must be from 1 to 1025")
    if arguments.step <= 0:
        parser.error(f"--step is {arguments.step}; it must be above 0")
    for path in (arguments.vdb, arguments.view):
        if not os.path.isfile(path):
            parser.error(f"there is no file {path}")
    return arguments


def add_medium(material, grids):
    """Adds one scattering node for all grids.

    If several nodes overlap, Cycles 3.4 scatters too much of a lamp's direct light: with two grids, 1.8 times as much
    was measured. It seems to add up the nodes' phase functions without weights. The albedo and the asymmetry of the one
    node are the means of the grids at each place, weighted by their extinction and by their scattering. This is exact
    for grids of equal asymmetry. Other grids keep their mean cosine.
    """
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()

    def calculate(operation, *operands):
        node = nodes.new("ShaderNodeMath")
        node.operation = operation
        for socket, operand in zip(node.inputs, operands):
            if isinstance(operand, (int, float)):
                socket.default_value = operand
            else:
                links.new(operand, socket)
        return node.outputs[0]

    def weighted_sum(values, weights):
        total = 0.0
        for value, weight in zip(values, weights):
            total = calculate("MULTIPLY_ADD", value, weight, total)
        return total

    def attribute(name):
        node = nodes.new("ShaderNodeAttribute")
        node.attribute_name = name
        return node.outputs["Fac"]

    extinctions = [attribute(grid["name"]) for grid in grids]
    scatterings = [calculate("MULTIPLY", extinction, METRES_PER_UNIT * grid["albedo"])
                   for extinction, grid in zip(extinctions, grids)]
    # Scattering and absorption have one node each. With these colours the density of a node is its coefficient.
    scatter = nodes.new("ShaderNodeVolumeScatter")
    scatter.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    scattering = weighted_sum(scatterings, [1.0] * len(grids))
    absorb = nodes.new("ShaderNodeVolumeAbsorption")
    absorb.inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    absorption = weighted_sum(extinctions, [METRES_PER_UNIT * (1.0 - grid["albedo"]) for grid in grids])
    both = nodes.new("ShaderNodeAddShader")
    output = nodes.new("ShaderNodeOutputMaterial")
    if grids:
        links.new(scattering, scatter.inputs["Density"])
        links.new(absorption, absorb.inputs["Density"])
        asymmetries = [grid["asymmetry"] for grid in grids]
        if len(set(asymmetries)) == 1:
            scatter.inputs["Anisotropy"].default_value = asymmetries[0]
        else:
            links.new(calculate("DIVIDE", weighted_sum(scatterings, asymmetries), scattering),
                      scatter.inputs["Anisotropy"])
        links.new(scatter.outputs[0], both.inputs[0])
        links.new(absorb.outputs[0], both.inputs[1])
        links.new(both.outputs[0], output.inputs["Volume"])
    material.cycles.volume_sampling = "DISTANCE"
    material.cycles.volume_interpolation = "LINEAR"
    material.cycles.volume_step_rate = 1.0


def add_storm(scene, path, grids, step_voxels):
    volume = bpy.data.volumes.new("storm")
    volume.filepath = os.path.abspath(path)
    # These settings keep the optical depths of the file: no compression to half floats, and no thin parts left out.
    volume.render.precision = "FULL"
    volume.render.space = "WORLD"
    volume.render.clipping = 0.0
    if grids:
        volume.render.step_size = step_voxels * min(min(grid["voxelM"]) for grid in grids) / METRES_PER_UNIT
    storm = bpy.data.objects.new("storm", volume)
    storm.scale = (1.0 / METRES_PER_UNIT,) * 3
    if grids:
        # Cycles 3.4 shows a voxel's value half a voxel east, north and above the position in the file.
        storm.location = -0.5 * in_units(grids[0]["voxelM"])
    material = bpy.data.materials.new("storm")
    add_medium(material, grids)
    volume.materials.append(material)
    scene.collection.objects.link(storm)


def add_sun(scene, sun, diameter_deg):
    light = bpy.data.lights.new("sun", "SUN")
    # The energy is the irradiance on a plane that faces the sun.
    light.energy = sun["irradiance"]
    light.angle = math.radians(diameter_deg)
    light.cycles.max_bounces = 1024
    lamp = bpy.data.objects.new("sun", light)
    lamp.rotation_mode = "QUATERNION"
    lamp.rotation_quaternion = Vector(sun["towards"]).to_track_quat("Z", "Y")
    scene.collection.objects.link(lamp)


def add_camera(scene, view):
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit = "HORIZONTAL"
    if view["halfWidthM"] > 0:
        camera.type = "ORTHO"
        camera.ortho_scale = 2 * view["halfWidthM"] / METRES_PER_UNIT
    else:
        camera.angle = 2 * math.atan(view["tanHalfWidth"])
    camera.clip_start, camera.clip_end = 0.001, 1e5
    eye = bpy.data.objects.new("camera", camera)
    right, up, forward = (Vector(view[axis]) for axis in ("right", "up", "forward"))
    axes = Matrix((right, up, -forward)).transposed().to_4x4()
    eye.matrix_world = Matrix.Translation(in_units(view["eyeM"])) @ axes
    scene.collection.objects.link(eye)
    scene.camera = eye


def set_up_cycles(scene, arguments):
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = arguments.samples
    cycles.seed = arguments.seed
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    # These settings keep the radiance unchanged: no clamping, no blur, and no scattering order left out before the
    # last.
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
    cycles.max_bounces = cycles.volume_bounces = arguments.scatterings - 1
    cycles.transparent_max_bounces = 1024
    cycles.volume_step_rate = cycles.volume_preview_step_rate = 1.0
    cycles.volume_max_steps = 65536
    cycles.pixel_filter_type = "BOX"
    cycles.filter_width = 1.0
    scene.world = None


def set_up_picture(scene, image):
    render = scene.render
    render.resolution_x, render.resolution_y = image["widthPx"], image["heightPx"]
    render.resolution_percentage = 100
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_mode = "RGB"
    render.image_settings.color_depth = "32"
    render.image_settings.exr_codec = "ZIP"


def main():
    arguments = parse_arguments()
    with open(arguments.view, encoding="utf-8") as file:
        view = json.load(file)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    set_up_cycles(scene, arguments)
    set_up_picture(scene, view["image"])
    add_storm(scene, arguments.vdb, view["grids"], arguments.step)
    add_sun(scene, view["sun"], arguments.sun_diameter_deg)
    add_camera(scene, view["camera"])
    if arguments.output:
        scene.render.filepath = os.path.abspath(arguments.output)
        bpy.ops.render.render(write_still=True)


main()
