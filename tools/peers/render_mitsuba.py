"""Renders a neutral scene with Mitsuba 3: render_mitsuba.py JOB, a `Job` as JSON with the keys
`variant` and `integrator` besides. Runs in the peers' environment."""

import json
import sys
import time

import drjit
import mitsuba
import numpy as np

import images
import neutral

# Samples per pixel of a pass: enough to keep vectors busy, few enough to stay in memory.
MOST = 64


def scene(job):
    side, transform = neutral.SIDE, mitsuba.ScalarTransform4f()
    film = {"type": "hdrfilm", "width": side, "height": side, "rfilter": {"type": "box"},
            "pixel_format": "rgb", "component_format": "float32"}
    sensor = {"type": "perspective", "fov": neutral.FIELD_OF_VIEW, "fov_axis": "x",
              "near_clip": 0.01, "far_clip": 100.0, "film": film,
              "sampler": {"type": "independent", "sample_count": 4},
              "to_world": transform.look_at(neutral.EYE, neutral.TARGET, neutral.UP)}
    integrator = {"type": job["integrator"], "max_depth": neutral.MAX_DEPTH}
    shapes = {quad.name: shape(job, quad) for quad in neutral.quads(job["scene"])}
    if job["scene"] in neutral.FOG:
        # References are to what was loaded before.
        shapes = {**fog(neutral.FOG[job["scene"]]), **shapes}
        sensor["medium"] = FOG
    return mitsuba.load_dict(
        {"type": "scene", **shapes, "sensor": sensor, "integrator": integrator})


def rgb(value):
    return {"type": "rgb", "value": [float(v) for v in value]}


FOG = {"type": "ref", "id": "fog"}


def fog(described):
    """The medium, and its boundary."""
    extinction = [a + s for a, s in zip(described.absorption, described.scattering)]
    medium = {"type": "homogeneous", "sigma_t": rgb(extinction),
              "albedo": rgb([s / t for s, t in zip(described.scattering, extinction)]),
              "phase": {"type": "hg", "g": described.mean_cosine}}
    cube = {"type": "cube", "to_world": mitsuba.ScalarTransform4f().scale(described.half),
            "bsdf": {"type": "null"}, "interior": FOG}
    return {"fog": medium, "fog-boundary": cube}


def shape(job, quad):
    path = neutral.mesh_path(job["scenes"], job["scene"], quad)
    matte = {"type": "diffuse", "reflectance": rgb(quad.albedo)}
    found = {"type": "ply", "filename": path, "face_normals": True,
             "bsdf": {"type": "twosided", "matte": matte}}
    if quad.radiance:
        found["emitter"] = {"type": "area", "radiance": rgb(quad.radiance)}
    return found


def render(world, seconds, seed):
    """Passes until the CPU seconds are spent, the last ones as large as what is left allows:
    (mean image, samples per pixel, CPU seconds, seconds)."""
    def image(samples, number):
        picture = mitsuba.render(world, spp=samples, seed=seed * 100003 + number)
        return np.array(picture, np.float64)

    # Kernels are compiled outside of the clock, and what a pass costs is learnt there.
    image(4, 99998)
    start = time.process_time()
    image(4, 99999)
    cost = (time.process_time() - start) / 4
    total, done, number = 0.0, 0, 0
    wall, start = time.monotonic(), time.process_time()
    while True:
        spent = time.process_time() - start
        cost = spent / done if done else cost
        samples = min(int((seconds - spent) / cost), MOST)
        if done and samples < 1:
            return total / done, done, spent, time.monotonic() - wall
        samples = max(samples, 1)
        total = total + samples * image(samples, number)
        done, number = done + samples, number + 1


def main():
    job = json.loads(sys.argv[1])
    mitsuba.set_variant(job["variant"])
    drjit.set_thread_count(job["threads"])
    images.finish(job["image"], *render(scene(job), job["seconds"], job["seed"]))


if __name__ == "__main__":
    main()
