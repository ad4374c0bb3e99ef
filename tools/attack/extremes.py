"""Scenes at the ends of what a renderer accepts, by all integrators: each ends within its time and
memory, and no pixel is infinite or not a number."""

import math
import os

import commands
import exr
import runs
from worlds import INTEGRATORS, LAMP, ROOM, WALLS

# The memory of eight by eight pixels, plus that of threads and of the program itself.
LIMITS = runs.Limits(cpu=10, wall=300, memory=runs.GIB // 2)
HEAD = 'LookAt 0 0 -4 0 0 0 0 1 0\nCamera "perspective"\nWorldBegin\n'
INSIDE = 'LookAt 0 0 -0.5 0 0 0 0 1 0\nCamera "perspective"\nWorldBegin\n'
POINT = 'LightSource "point"\n'
SKY = 'LightSource "infinite"\n'
SPHERE = 'Shape "sphere"\n'
LAMP_OF = 'AttributeBegin AreaLightSource "diffuse" "rgb L" [%s]\nShape %s\nAttributeEnd\n'
DIFFUSE = 'Material "diffuse" "rgb reflectance" [%s]\n'
MESH = '"trianglemesh" "integer indices" [%s] "point3 P" [%s]\n'
MIRRORS = """Material "conductor" "spectrum eta" "metal-Ag-eta" "spectrum k" "metal-Ag-k"
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-9 -9 1 9 -9 1 9 9 1 -9 9 1]
Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-9 -9 -5 9 -9 -5 9 9 -5 -9 9 -5]
"""
GLASS = 'Material "dielectric" "float eta" %s\n'


def lit(material, light=POINT, head=HEAD):
    return head + light + material + SPHERE


# Texts by name.
SCENES = {
    "white closed sphere": lit(DIFFUSE % "1 1 1", head=INSIDE),
    "white sphere from outside": lit(DIFFUSE % "1 1 1"),
    "nearly white closed sphere": lit(DIFFUSE % "0.999 0.999 0.999", head=INSIDE),
    "white sphere around a lamp": INSIDE + LAMP_OF % ("1 1 1", '"sphere" "float radius" 0.1') + DIFFUSE % "1 1 1"
        + SPHERE,
    "black sphere": lit(DIFFUSE % "0 0 0", head=INSIDE),
    "mirrors facing each other": HEAD + POINT + MIRRORS,
    "glass in glass": lit(GLASS % "1.5" + SPHERE + 'Shape "sphere" "float radius" 0.999\n', SKY),
    "glass without a boundary": lit(GLASS % "1", SKY),
    "dense glass": lit(GLASS % "1000", SKY),
    "rough glass, closed": lit('Material "dielectric" "float roughness" 0.0001\n', head=INSIDE),
    "coats of many layers": lit('Material "coateddiffuse" "integer maxdepth" 1000 "integer nsamples" 64 '
                                '"rgb reflectance" [1 1 1]\n', SKY),
    "tiny lamp": HEAD + LAMP_OF % ("1e12 1e12 1e12", '"sphere" "float radius" 1e-15') + DIFFUSE % "0.5 0.5 0.5"
        + SPHERE,
    "huge lamp": INSIDE + LAMP_OF % ("1 1 1", '"sphere" "float radius" 9e11') + DIFFUSE % "0.5 0.5 0.5" + SPHERE,
    "huge radiance": lit(DIFFUSE % "1 1 1", 'LightSource "point" "rgb I" [1e12 1e12 1e12]\n'),
    "huge radiance seen": HEAD + LAMP_OF % ("1e12 1e12 1e12", '"sphere"'),
    "huge sky": lit(DIFFUSE % "1 1 1", 'LightSource "infinite" "rgb L" [1e12 1e12 1e12]\n'),
    "tiny radiance": lit(DIFFUSE % "0.5 0.5 0.5", 'LightSource "point" "rgb I" [1e-42 1e-42 1e-42]\n'),
    "black light": lit(DIFFUSE % "0.5 0.5 0.5", 'LightSource "point" "rgb I" [0 0 0]\n'),
    "black lamp": HEAD + LAMP_OF % ("0 0 0", '"sphere" "float radius" 0.1') + SPHERE,
    "black sky": lit(DIFFUSE % "0.5 0.5 0.5", 'LightSource "infinite" "rgb L" [0 0 0]\n'),
    "narrow spot": lit(DIFFUSE % "0.5 0.5 0.5", 'LightSource "spot" "float coneangle" 0.002 '
                                 '"float conedeltaangle" 0\n'),
    "light beyond the limit": lit(DIFFUSE % "1 1 1", 'LightSource "point" "rgb I" [1e38 1e38 1e38]\n'),
    "place beyond the limit": HEAD + SKY + "Translate 1e30 0 0\n" + SPHERE,
    "no light": HEAD + DIFFUSE % "0.5 0.5 0.5" + SPHERE,
    "nothing": HEAD,
    "lamp of no area": HEAD + LAMP_OF % ("1 1 1", MESH % ("0 1 2", "0 0 0 1 1 1 2 2 2")) + SPHERE,
    "triangles of no area": HEAD + SKY + "Shape " + MESH % ("0 0 0 0 1 1 0 1 2", "0 0 0 0 0 0 1 0 0"),
    "needle triangles": HEAD + SKY + "Shape " + MESH % ("0 1 2", "-1e6 0 0 1e6 1e-6 0 0 0 1e-6"),
    "one triangle many times": HEAD + SKY + "Shape " + MESH % (" ".join(["0 1 2"] * 4000), "-1 -1 0 1 -1 0 0 1 0"),
    "tiny sphere": HEAD + SKY + 'Shape "sphere" "float radius" 1e-30\n',
    "flat instance": HEAD + SKY + 'ObjectBegin "o"\n' + SPHERE + 'ObjectEnd\nScale 1 1e-9 1\nObjectInstance "o"\n',
    "camera on a surface": 'LookAt 0 0 -1 0 0 0 0 1 0\nCamera "perspective"\nWorldBegin\n' + SKY + SPHERE,
    "narrow view": 'LookAt 0 0 -4 0 0 0 0 1 0\nCamera "perspective" "float fov" 0.002\nWorldBegin\n' + SKY + SPHERE,
    "wide view": 'LookAt 0 0 -4 0 0 0 0 1 0\nCamera "perspective" "float fov" 179.99\nWorldBegin\n' + SKY + SPHERE,
    "huge lens": 'LookAt 0 0 -4 0 0 0 0 1 0\nCamera "perspective" "float lensradius" 1e10 "float focaldistance" 1e-3\n'
        "WorldBegin\n" + SKY + SPHERE,
    "thousand lamps": HEAD + "".join(
        LAMP_OF % ("1 1 1", '"sphere" "float radius" %r' % (1e-3 * (i + 1))) for i in range(1000)) + SPHERE,
    "nested transforms": HEAD + SKY + "Scale 1.01 1.01 1.01\n" * 2000 + SPHERE,
    "room": ROOM,
    "closed white room": INSIDE.replace("-0.5", "-0.9") + LAMP + WALLS.replace("0.7 0.7 0.7", "1 1 1"),
}
# Settings of a render.
FLAGS = {
    "": (),
    "without a limit of depth": ("--max-depth", "0"),
    "without roulette": ("--max-depth", "100", "--path-roulette", "off"),
    "within two seconds": ("--max-depth", "0", "--spp", "100000000", "--time", "2"),
    "one pixel": ("--size", "1x1"),
    "crop": ("--size", "65536x65536", "--crop", "40000,40000,40003,40002"),
    "wide": ("--size", "4096x1"),
    "many threads": ("--threads", "64"),
    "uniform weights": ("--mis", "uniform"),
    "layers": ("--strategy-layers", "16", "--light-groups", "--aov", "albedo,normal,depth,variance"),
}


def not_finite(path):
    """Returns the number of values of the image that are infinite or NaN; depth may be infinite."""
    pixels = exr.read(path)
    return sum(not math.isfinite(value) for name in pixels if name[-1] in "RGB" for value in pixels[name])


def render(work, text, integrator, flags, folder):
    """Returns the fault and the command."""
    defaults = (("--size", "8x8"), ("--spp", "4"), ("--threads", "2"))
    flags = [*flags, "--integrator", integrator, *(word for pair in defaults if pair[0] not in flags for word in pair)]
    ended = commands.render(work, text, folder, flags, LIMITS)
    fault = ended.fault()
    if not fault and ended.code == 0:
        count = not_finite(os.path.join(folder, "a.exr"))
        fault = "%d values are not finite" % count if count else None
    return fault, ended.command


def run(work):
    cases = [(scene, integrator, name) for scene in SCENES for integrator in INTEGRATORS for name in FLAGS]
    cases = work.random.sample(cases, min(work.count(), len(cases)))
    for scene, integrator, name in cases:
        with work.folder() as folder:
            fault, command = render(work, SCENES[scene], integrator, FLAGS[name], folder)
            work.case("%s, %s %s" % (scene, integrator, name), fault, folder, command)
