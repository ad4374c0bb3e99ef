"""Commands with the files they read and write, for parts that disturb them."""

import json
import os
from pathlib import Path

import exr
import harness
import part
import runs
from worlds import ROOM

LIMITS = runs.Limits(cpu=30, wall=300)
INFO = """Camera "perspective" WorldBegin LightSource "infinite"
Texture "t" "spectrum" "imagemap" "string filename" "picture.png"
Material "diffuse" "texture reflectance" "t"
Include "more.pbrt"
"""
MORE = """Shape "plymesh" "string filename" "mesh.ply"
LightSource "point" "spectrum I" "lamp.spd"
"""
EXPERIMENT = """title = "t"
size = "8x6"
seeds = 2
[[scene]]
file = "room.pbrt"
reference-spp = 32
[[method]]
name = "a"
integrator = "bdpt"
max-depth = 3
[[method]]
name = "b"
integrator = "path"
max-depth = 3
[[budget]]
samples = 2
"""
RENDER = ("render", "room.pbrt", "-q", "--threads", "1", "--size", "24x16")
# By name: arguments, and the outputs with reproducible contents.
COMMANDS = {
    "render": ((*RENDER, "--spp", "8", "-o", "out.exr", "--checkpoint", "a.film", "--resume"),
               ("out.exr", "out.png")),
    "share": ((*RENDER, "--passes", "4..6", "--checkpoint", "new.film", "--checkpoint-every", "0.001s",
               "--resume"), ()),
    "merge": (("merge", "a.film", "b.film", "-o", "out.film", "--image", "out.exr"), ("out.exr", "out.png")),
    "develop": (("film", "develop", "a.film", "-o", "out.exr"), ("out.exr", "out.png")),
    "verify": (("film", "verify", "a.film", "b.film"), ()),
    "missing": (("missing", "a.film", "b.film", "--spp", "4"), ()),
    "compare": (("compare", "a.exr", "b.exr", "--error-map", "out.png"), ("out.png",)),
    "tonemap": (("tonemap", "a.exr", "-o", "out.png"), ("out.png",)),
    "info": (("info", "info.pbrt"), ()),
    "gltf": (("info", "all.glb"), ()),
    "reference": (("reference", "room.pbrt", "-q", "--size", "8x6", "--spp", "32", "--threads", "1",
                   "-o", "out-reference"), ()),
    "experiment": (("experiment", "small.toml", "-q", "-o", "out-results", "--threads", "1"), ()),
}


def prepare(work, folder):
    """The files that the commands read, in an empty folder."""
    seeds = harness.ROOT / "fuzz" / "seeds"
    for name, data in (("room.pbrt", ROOM), ("info.pbrt", INFO), ("more.pbrt", MORE), ("small.toml", EXPERIMENT)):
        part.write(folder, name, data)
    for name, seed in (("picture.png", "image/rgb8.png"), ("mesh.ply", "ply/little.ply"),
                       ("lamp.spd", "spectrum/lamp.spd"), ("all.glb", "gltf/triangle.glb")):
        data = part.read(seeds, seed)
        # The first byte of the seed of an image is the format.
        part.write(folder, name, data[1:] if seed.startswith("image/") else data)
    for name, passes in (("a", "0..2"), ("b", "2..4")):
        must(work, folder, *RENDER, "--passes", passes, "--checkpoint", name + ".film", "-o", name + ".exr")


def must(work, folder, *arguments):
    """Runs what the cases need; raises RuntimeError if it fails."""
    ended = runs.run(work.bidir(*arguments), folder, LIMITS)
    if ended.wrong(0):
        raise RuntimeError("%s: %s\n%s" % (" ".join(ended.command), ended.wrong(0), ended.said))


def render(work, text, folder, flags, limits):
    """Renders a scene to the file a.exr. Returns how that ended."""
    part.write(folder, "scene.pbrt", text)
    command = work.bidir("render", "scene.pbrt", "-q", *flags, "-o", "a.exr")
    return runs.run(command, folder, limits)


def figures(path):
    """The results of an experiment without times, which differ from run to run."""
    records = json.loads(Path(path).read_text())["records"]
    return [{key: value for key, value in record.items() if "seconds" not in key} for record in records]


def content(path):
    """Returns all of an output that has to be the same in every run: pixels of an EXR, whose attributes have times,
    the figures of an experiment, or the bytes of a PNG."""
    if not os.path.exists(path):
        return "nothing"
    if path.endswith(".exr"):
        return {channel: values.tobytes() for channel, values in exr.read(path).items()}
    if path.endswith("results.json"):
        return figures(path)
    return part.read("", path) if path.endswith(".png") else "a file"


def contents(folder, outputs):
    """Returns the contents of outputs by name."""
    return {name: content(os.path.join(folder, name)) for name in outputs}
