"""Renders a neutral scene with LuxCore: render_pyluxcore.py JOB, a `Job` as JSON with the key
`engine` besides. Runs in the peers' environment.

Two settings keep its image the same as everyone's. Its default roulette is off: with it images are
6 to 7 % too bright. Its raster lies one pixel lower, so the screen window is moved up by one.
"""

import json
import os
import sys
import time

import numpy as np
import pyluxcore

import images
import neutral

NEVER = 1000  # a bounce that no path reaches


def scene(job):
    shift = -2.0 / neutral.SIDE
    found = properties({
        "scene.camera.type": "perspective",
        "scene.camera.lookat.orig": neutral.EYE,
        "scene.camera.lookat.target": neutral.TARGET,
        "scene.camera.up": neutral.UP,
        "scene.camera.fieldofview": neutral.FIELD_OF_VIEW,
        "scene.camera.screenwindow": (-1.0, 1.0, -1.0 + shift, 1.0 + shift),
        "scene.camera.lensradius": 0.0,
        "scene.camera.autofocus.enable": False,
        "scene.camera.cliphither": 0.001,
        "scene.camera.clipyon": 100.0,
    })
    for quad in neutral.quads(job["scene"]):
        found.Set(surface(job, quad))
    world = pyluxcore.Scene()
    world.Parse(found)
    return world


def surface(job, quad):
    material, shape = "scene.materials." + quad.name, "scene.objects." + quad.name
    found = {material + ".type": "matte", material + ".kd": quad.albedo}
    if quad.radiance:
        found[material + ".emission"] = quad.radiance
        found[material + ".emission.gain"] = (1.0, 1.0, 1.0)
        found[material + ".emission.power"] = 0.0
    found[shape + ".ply"] = neutral.mesh_path(job["scenes"], job["scene"], quad)
    found[shape + ".material"] = quad.name
    return properties(found)


def settings(job):
    found = {
        "renderengine.type": job["engine"],
        "renderengine.seed": job["seed"] + 1,
        "sampler.type": "SOBOL",
        "native.threads.count": job["threads"],
        "film.width": neutral.SIDE,
        "film.height": neutral.SIDE,
        "film.filter.type": "NONE",
        "film.imagepipelines.0.0.type": "NOP",
        "film.outputs.0.type": "RGB",
        "film.outputs.0.filename": job["image"],
        "path.clamping.variance.maxvalue": 0.0,
        "path.hybridbackforward.enable": False,
    }
    for depth in ("total", "diffuse", "glossy", "specular"):
        found["path.pathdepth." + depth] = neutral.MAX_DEPTH
    for walk in ("path", "light"):
        found[walk + ".maxdepth"] = neutral.MAX_DEPTH
        found[walk + ".russianroulette.depth"] = NEVER
    return properties(found)


def properties(values):
    found = pyluxcore.Properties()
    for key, value in values.items():
        if isinstance(value, tuple):
            value = [float(v) for v in value]
        found.Set(pyluxcore.Property(key, value))
    return found


def main():
    job = json.loads(sys.argv[1])
    pyluxcore.Init(lambda _message: None)
    session = pyluxcore.RenderSession(pyluxcore.RenderConfig(settings(job), scene(job)))
    wall, cpu = time.monotonic(), time.process_time()
    session.Start()
    while time.process_time() - cpu < job["seconds"]:
        time.sleep(0.02)
    session.UpdateStats()
    cpu, wall = time.process_time() - cpu, time.monotonic() - wall
    drawn = session.GetStats().Get("stats.renderengine.total.samplecount").GetFloat()
    session.Stop()
    picture = np.zeros((neutral.SIDE, neutral.SIDE, 3), np.float32)
    session.GetFilm().GetOutputFloat(pyluxcore.FilmOutputType.RGB, picture, 0)
    images.finish(job["image"], picture[::-1], drawn / neutral.SIDE**2, cpu, wall)
    # Its threads do not survive an orderly end of the interpreter.
    os._exit(0)


if __name__ == "__main__":
    main()
