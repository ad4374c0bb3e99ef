"""Scenes of any size: a closed box with a terrain, instances of terrains, or many lamps, and a hall
with lamps all over.

Each is the same to look at, so that paths are about as long whatever the number of things: only the
work of finding, choosing and keeping them grows.
"""

import math
import os
import struct
from pathlib import Path

FILM = (80, 60)
BOX = ((-1.5, 1.5), (0.0, 2.0), (-1.5, 2.5))
HALL = ((-20.0, 20.0), (0.0, 3.0), (-37.0, 3.0))
FACES = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]
HEAD = """\
LookAt 0 1.1 2.3  0 0.5 0  0 1 0
Camera "perspective" "float fov" 60
Film "rgb" "integer xresolution" %d "integer yresolution" %d
PixelFilter "box"
Sampler "sobol"
Integrator "bdpt" "integer maxdepth" 6
WorldBegin
Material "diffuse" "rgb reflectance" [0.6 0.6 0.6]
"""


class Folder:
    """The folder of generated scenes."""

    def __init__(self, path):
        self.path = path

    def _mesh(self, name, points, triangles):
        """Writes a mesh as binary PLY from numbers and iterables of points and triangles. These are not
        stored, since a child process counts at least the memory of its parent."""
        head = ("ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\n"
                "property float y\nproperty float z\nelement face %d\n"
                "property list uchar int vertex_indices\nend_header\n")
        with open(os.path.join(self.path, name), "wb") as file:
            file.write((head % (points[0], triangles[0])).encode())
            file.writelines(struct.pack("<3f", *point) for point in points[1])
            file.writelines(struct.pack("<B3i", 3, *triangle) for triangle in triangles[1])
        return 'Shape "plymesh" "string filename" "%s"\n' % name

    def _scene(self, name, body, box=BOX):
        path = Path(self.path, name + ".pbrt")
        path.write_text(HEAD % FILM + _walls(box) + body, encoding="utf-8")
        return path

    def triangles(self, count):
        """Makes a terrain with about this number of triangles in one mesh: (scene, triangles)."""
        side = max(1, round(math.sqrt(count / 2)))
        body = self._mesh("terrain-%d.ply" % count, *_terrain(side)) + self._lamps(1)
        return self._scene("triangles-%d" % count, body), 2 * side * side

    def instances(self, places, side=22):
        """Makes instances of a terrain of 2 · side² triangles: (scene, triangles)."""
        across = max(1, round(math.sqrt(places)))
        body = 'ObjectBegin "patch"\n%sObjectEnd\n' % self._mesh("patch.ply", *_terrain(side))
        body += "".join(
            "AttributeBegin\nTranslate %g 0 %g\nScale %g 1 %g\nObjectInstance \"patch\"\n"
            "AttributeEnd\n" % ((2 * i + 1) / across - 1, (2 * j + 1) / across - 1,
                                1 / across, 1 / across)
            for i in range(across) for j in range(across))
        body += self._lamps(1)
        return self._scene("instances-%d" % places, body), 2 * side * side * across * across

    def lamps(self, count):
        """Makes small emissive triangles with a constant total power: (scene, lamps)."""
        across = max(1, round(math.sqrt(count)))
        return self._scene("lamps-%d" % count, self._lamps(across)), across * across

    def hall(self, count):
        """Makes such lamps all over a hall of 40 m with a terrain on its floor: (scene, lamps)."""
        across = max(1, round(math.sqrt(count)))
        body = ('AttributeBegin\nTranslate 0 0 -17\nScale 20 2 20\n%sAttributeEnd\n'
                % self._mesh("terrain.ply", *_terrain(60)))
        body += self._lamps(across, side=40.0, part=0.3, height=2.98, centre=-17.0)
        return self._scene("hall-%d" % count, body, HALL), across * across

    def _lamps(self, across, side=1.0, part=1.0, height=1.98, centre=0.0):
        """Makes downward lamps over a square around (0, height, centre), each of which covers a part of its
        own square."""
        # A lamp is half a square, so that the total area does not depend on the number.
        spacing = side / across
        count = across * across
        points = ((x, height, z) for i in range(count)
                  for x, z in _corners(i // across * spacing - side / 2,
                                       i % across * spacing - side / 2 + centre, part * spacing))
        triangles = ((3 * i, 3 * i + 1, 3 * i + 2) for i in range(count))
        mesh = self._mesh("lamps-%d.ply" % across, (3 * count, points), (count, triangles))
        return ('AttributeBegin\nAreaLightSource "diffuse" "rgb L" [8 8 8]\n%sAttributeEnd\n'
                % mesh)


def _corners(x, z, width):
    return (x, z), (x + width, z), (x, z + width)


def _walls(box):
    corners = [(x, y, z) for x in box[0] for y in box[1] for z in box[2]]
    points = " ".join("%g %g %g" % point for point in corners)
    indices = " ".join("%d %d %d %d %d %d" % (a, b, c, a, c, d) for a, b, c, d in FACES)
    return ('Shape "trianglemesh" "point3 P" [%s] "integer indices" [%s]\n' % (points, indices))


def _terrain(side):
    """Hills over [-1, 1]², 2 · side² triangles: points and triangles, each with their number."""
    def point(i, j):
        x, z = 2 * i / side - 1, 2 * j / side - 1
        fine = 0.3 / side * ((i * 7919 + j * 104729) % 97 / 97)
        return x, 0.2 + 0.15 * math.sin(5 * x) * math.cos(4 * z) + fine, z
    row = side + 1
    points = (point(i, j) for i in range(row) for j in range(row))
    triangles = (triangle for i in range(side) for a in range(i * row, i * row + side)
                 for triangle in ((a, a + 1, a + row), (a + 1, a + row + 1, a + row)))
    return (row * row, points), (2 * side * side, triangles)
