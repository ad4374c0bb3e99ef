"""Neutral scenes: Cornell boxes that renderers can describe exactly.

A is lit by a lamp under the ceiling. B is lit by a lamp that faces up within an open cup, so that
all but a patch of the ceiling is lit indirectly. C is A in fog, with the camera in it: connections
cross no boundary, since even an empty cube of null surfaces makes images of Mitsuba 3.9.1 darker.
Right-handed, y is up; the camera stands at +z and looks along -z. All surfaces are two-sided
Lambertian quads; lamps shine from their front alone and reflect nothing. Standard library only: each
renderer's script reads its scene from here.
"""

import math
import os
from pathlib import Path
from typing import NamedTuple, Optional

SIDE = 256         # pixels of the square image; one-pixel box filter, linear Rec. 709
MAX_DEPTH = 32     # segments of a path, as Mitsuba counts; what is longer is below every noise
EYE = (0.0, 0.0, 3.9)
TARGET = (0.0, 0.0, 0.0)
UP = (0.0, 1.0, 0.0)
FIELD_OF_VIEW = 39.0  # degrees, across the whole image

WHITE = (0.73, 0.73, 0.73)
RED = (0.65, 0.05, 0.05)
GREEN = (0.12, 0.45, 0.15)
GREY = (0.5, 0.5, 0.5)
BLACK = (0.0, 0.0, 0.0)


class Quad(NamedTuple):
    """A surface: four corners, counterclockwise as seen from the front."""

    name: str
    corners: list
    albedo: tuple
    radiance: Optional[tuple] = None  # of the front; None: no lamp


class Fog(NamedTuple):
    """A medium that fills a cube around the origin."""

    half: float        # of a side
    absorption: tuple  # per unit of length
    scattering: tuple
    mean_cosine: float # of Henyey and Greenstein's phase function

    def faces(self):
        """Returns the boundary, seen from outside."""
        side = (-self.half, self.half)
        return box("fog", [side, side], side, BLACK, "tufblr")


SCENES = "ABC"
FOG = {"C": Fog(5.0, (0.01, 0.02, 0.03), (0.06, 0.1, 0.16), 0.5)}


def quads(scene):
    """All surfaces of a scene."""
    block = [(-0.3, 0.3), (-0.3, 0.3)]
    shell = room()
    shell += box("tall", block, (-1.0, 0.2), WHITE, "tfblr", turn=18.0, at=(-0.35, -0.3))
    shell += box("short", block, (-1.0, -0.4), WHITE, "tfblr", turn=-17.0, at=(0.35, 0.35))
    return shell + {"A": ceiling_lamp, "B": lamp_in_cup, "C": ceiling_lamp}[scene]()


def room():
    """Floor, ceiling, back and sides of a cube from -1 to 1; the front is open."""
    return [
        Quad("floor", [(-1, -1, 1), (1, -1, 1), (1, -1, -1), (-1, -1, -1)], WHITE),
        Quad("ceiling", [(-1, 1, -1), (1, 1, -1), (1, 1, 1), (-1, 1, 1)], WHITE),
        Quad("back", [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1)], WHITE),
        Quad("left", [(-1, -1, 1), (-1, -1, -1), (-1, 1, -1), (-1, 1, 1)], RED),
        Quad("right", [(1, -1, -1), (1, -1, 1), (1, 1, 1), (1, 1, -1)], GREEN),
    ]


def box(name, plan, heights, albedo, faces, turn=0.0, at=(0.0, 0.0)):
    """Faces (of t, u, f, b, l, r) of an upright box, turned by degrees about its axis."""
    (x0, x1), (z0, z1) = plan
    y0, y1 = heights
    cos, sin = math.cos(math.radians(turn)), math.sin(math.radians(turn))

    def place(x, y, z):
        return (at[0] + cos * x + sin * z, y, at[1] - sin * x + cos * z)

    corners = {
        "t": [(x0, y1, z1), (x1, y1, z1), (x1, y1, z0), (x0, y1, z0)],
        "u": [(x0, y0, z0), (x1, y0, z0), (x1, y0, z1), (x0, y0, z1)],
        "f": [(x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1)],
        "b": [(x1, y0, z0), (x0, y0, z0), (x0, y1, z0), (x1, y1, z0)],
        "l": [(x0, y0, z0), (x0, y0, z1), (x0, y1, z1), (x0, y1, z0)],
        "r": [(x1, y0, z1), (x1, y0, z0), (x1, y1, z0), (x1, y1, z1)],
    }
    return [Quad("%s-%s" % (name, face), [place(*p) for p in corners[face]], albedo)
            for face in faces]


def ceiling_lamp():
    """Scenes A and C: a square under the ceiling, facing down."""
    h, y = 0.25, 0.995
    return [Quad("lamp", [(-h, y, -h), (h, y, -h), (h, y, h), (-h, y, h)], BLACK, (17, 12, 4))]


def lamp_in_cup():
    """Scene B: a smaller and brighter square that faces up, in a cup 15 cm below the ceiling."""
    h, y = 0.15, 0.55
    lamp = Quad("lamp", [(-h, y, h), (h, y, h), (h, y, -h), (-h, y, -h)], BLACK, (170, 120, 40))
    return [lamp] + box("cup", [(-0.17, 0.17)] * 2, (0.53, 0.85), GREY, "ufblr")


def mesh_path(folder, scene, quad):
    """Returns the path of a surface's mesh, for renderers that read PLY."""
    return os.path.join(folder, "meshes-" + scene, quad.name + ".ply")


def ply_text(quad):
    """Two triangles as a PLY file in text."""
    head = ["ply", "format ascii 1.0", "element vertex 4"]
    head += ["property float " + axis for axis in "xyz"]
    head += ["element face 2", "property list uchar int vertex_indices", "end_header"]
    corners = ["%.9g %.9g %.9g" % point for point in quad.corners]
    return "\n".join(head + corners + ["3 0 1 2", "3 0 2 3"]) + "\n"


def pbrt_text(scene):
    """The scene for renderers that read pbrt-v4, whose space is left-handed: the camera is
    mirrored, the world is not. It names no sampler: each renderer has its own default."""
    lines = [
        *pbrt_fog(scene),
        "Scale -1 1 1",
        "LookAt %g %g %g  %g %g %g  %g %g %g" % (*EYE, *TARGET, *UP),
        'Camera "perspective" "float fov" %g' % FIELD_OF_VIEW,
        'Film "rgb" "integer xresolution" %d "integer yresolution" %d' % (SIDE, SIDE),
        '  "string filename" "%s.exr"' % scene,
        'PixelFilter "box" "float xradius" 0.5 "float yradius" 0.5',
        'Integrator "bdpt" "integer maxdepth" %d' % MAX_DEPTH,
        "",
        "WorldBegin",
    ]
    for quad in quads(scene):
        lines += ["AttributeBegin",
                  '  Material "diffuse" "rgb reflectance" [%g %g %g]' % quad.albedo]
        if quad.radiance:
            lines.append('  AreaLightSource "diffuse" "rgb L" [%g %g %g]' % quad.radiance)
        lines += [pbrt_shape(scene, quad), "AttributeEnd"]
    if scene in FOG:
        lines += ["AttributeBegin", '  MediumInterface "fog" ""', '  Material "interface"',
                  *(pbrt_shape(scene, face) for face in FOG[scene].faces()), "AttributeEnd"]
    return "\n".join(lines) + "\n"


def pbrt_shape(scene, quad):
    mesh = os.path.basename(os.path.dirname(mesh_path("", scene, quad)))
    return '  Shape "plymesh" "string filename" "%s/%s.ply"' % (mesh, quad.name)


def pbrt_fog(scene):
    """The medium, with the camera in it."""
    if scene not in FOG:
        return []
    fog = FOG[scene]
    return ['MakeNamedMedium "fog" "string type" "homogeneous" "float g" %g' % fog.mean_cosine,
            '  "rgb sigma_a" [%g %g %g]' % fog.absorption,
            '  "rgb sigma_s" [%g %g %g]' % fog.scattering,
            'MediumInterface "" "fog"']


def write(folder):
    """Writes the scenes into a folder: A.pbrt and so on, and the meshes of each."""
    for scene in SCENES:
        os.makedirs(os.path.join(folder, "meshes-" + scene), exist_ok=True)
        for quad in quads(scene) + (FOG[scene].faces() if scene in FOG else []):
            Path(mesh_path(folder, scene, quad)).write_text(ply_text(quad), encoding="ascii")
        Path(folder, scene + ".pbrt").write_text(pbrt_text(scene), encoding="ascii")
