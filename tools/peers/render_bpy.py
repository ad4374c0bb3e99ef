"""Renders a neutral scene with Cycles: render_bpy.py JOB, a `Job` as JSON. Runs in the peers'
environment, where Blender is the module `bpy`."""

import json
import math
import sys
import time

import bpy

import images
import neutral


def build(job):
    """An empty file, and the scene in it."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    for quad in neutral.quads(job["scene"]):
        mesh = bpy.data.meshes.new(quad.name)
        mesh.from_pydata([tuple(map(float, p)) for p in quad.corners], [], [(0, 1, 2, 3)])
        mesh.materials.append(lamp(quad) if quad.radiance else matte(quad))
        scene.collection.objects.link(bpy.data.objects.new(quad.name, mesh))
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit = "HORIZONTAL"
    camera.angle = math.radians(neutral.FIELD_OF_VIEW)
    camera.clip_start = 0.001
    scene.camera = bpy.data.objects.new("camera", camera)
    scene.camera.location = neutral.EYE  # unturned it looks along -z, and up is +y
    scene.collection.objects.link(scene.camera)
    scene.world = bpy.data.worlds.new("nothing")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.0
    return scene


def material(quad):
    """An empty material: (material, its nodes, its links, the input of its surface)."""
    found = bpy.data.materials.new(quad.name)
    found.use_nodes = True
    tree = found.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    return found, tree.nodes, tree.links, output.inputs["Surface"]


def matte(quad):
    found, nodes, links, surface = material(quad)
    diffuse = nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Color"].default_value = (*quad.albedo, 1.0)
    diffuse.inputs["Roughness"].default_value = 0.0
    links.new(diffuse.outputs[0], surface)
    return found


def lamp(quad):
    """Emission of the front: its strength is multiplied by 1 - `Backfacing`."""
    found, nodes, links, surface = material(quad)
    strength = float(max(quad.radiance))
    emission = nodes.new("ShaderNodeEmission")
    colour = [value / strength for value in quad.radiance]
    emission.inputs["Color"].default_value = (*colour, 1.0)
    geometry, front = nodes.new("ShaderNodeNewGeometry"), nodes.new("ShaderNodeMath")
    front.operation = "MULTIPLY_ADD"
    front.inputs[1].default_value, front.inputs[2].default_value = -strength, strength
    links.new(geometry.outputs["Backfacing"], front.inputs[0])
    links.new(front.outputs[0], emission.inputs["Strength"])
    links.new(emission.outputs[0], surface)
    found.cycles.emission_sampling = "FRONT"
    return found


def configure(scene, job):
    """The estimator without clamps, filters, adaptivity and guesses; linear output."""
    render, cycles = scene.render, scene.cycles
    render.engine, cycles.device = "CYCLES", "CPU"
    render.resolution_x = render.resolution_y = neutral.SIDE
    render.threads_mode, render.threads = "FIXED", job["threads"]
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.use_light_tree = cycles.use_guiding = False
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = 0.0
    cycles.max_bounces = cycles.diffuse_bounces = neutral.MAX_DEPTH
    cycles.seed = job["seed"]
    settings = render.image_settings
    settings.file_format, settings.color_depth = "OPEN_EXR", "32"
    settings.color_mode = "RGB"
    scene.view_settings.view_transform = "Raw"
    render.filepath = job["image"]


def render(scene, samples):
    """(CPU seconds, seconds) of a render."""
    scene.cycles.samples = samples
    wall, cpu = time.monotonic(), time.process_time()
    bpy.ops.render.render(write_still=True)
    return time.process_time() - cpu, time.monotonic() - wall


def main():
    job = json.loads(sys.argv[1])
    scene = build(job)
    configure(scene, job)
    # It takes no CPU time as a limit: what a sample costs is learnt by short renders.
    samples, cpu = 4, 0.0
    while True:
        cpu, _ = render(scene, samples)
        if cpu > 0.15 * job["seconds"]:
            break
        samples *= 2
    samples = max(1, round(samples * job["seconds"] / cpu))
    cpu, wall = render(scene, samples)
    images.finish(job["image"], images.read(job["image"]), samples, cpu, wall)


if __name__ == "__main__":
    main()
