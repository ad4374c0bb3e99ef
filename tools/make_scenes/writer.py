"""Writes pbrt-v4 text and the binary PLY meshes it refers to."""

import os
import struct

from geometry import Mesh
from palette import MATERIALS

INLINE_LIMIT = 64  # triangles; larger meshes go to meshes/*.ply


def num(value):
    """Formats a number: seven digits, no negative zero."""
    return format(round(value, 12) + 0.0, ".7g")


def nums(values):
    return " ".join(num(v) for v in values)


def _wrapped(values, per_line, indent):
    lines = [values[i:i + per_line] for i in range(0, len(values), per_line)]
    return ("\n" + indent).join(" ".join(line) for line in lines)


class Project:
    """The output folder: remembers the meshes written and the scenes made."""

    def __init__(self, root):
        self.root = root
        self.meshes = {}    # name -> (triangles, bytes)
        self.scenes = []    # (path, triangles, title) for the README
        self.broken = []    # (path, what is wrong)
        self.parts = {}     # include file -> triangles
        for folder in ("meshes", "parts", "torture", "broken"):
            os.makedirs(os.path.join(root, folder), exist_ok=True)

    def write(self, path, text):
        with open(os.path.join(self.root, path), "w", encoding="utf-8", newline="\n") as out:
            out.write(text)

    def write_bytes(self, path, data):
        with open(os.path.join(self.root, path), "wb") as out:
            out.write(data)

    def write_ply(self, name, mesh):
        normals = not mesh.is_flat_shaded()
        head = ["ply", "format binary_little_endian 1.0",
                "element vertex %d" % len(mesh.points)]
        head += ["property float " + axis for axis in "xyz"]
        if normals:
            head += ["property float n" + axis for axis in "xyz"]
        head += ["element face %d" % len(mesh.triangles),
                 "property list uchar int vertex_indices", "end_header", ""]
        data = bytearray("\n".join(head).encode("ascii"))
        # rounded first, so that the last bits of a sine do not show
        for point, normal in zip(mesh.points, mesh.normals):
            data += struct.pack("<3f", *(round(v, 5) + 0.0 for v in point))
            if normals:
                data += struct.pack("<3f", *(round(v, 4) + 0.0 for v in normal))
        for triangle in mesh.triangles:
            data += struct.pack("<B3i", 3, *triangle)
        data = bytes(data)
        if self.meshes.setdefault(name, (len(mesh.triangles), data))[1] != data:
            raise ValueError("two different meshes named " + name)
        with open(os.path.join(self.root, "meshes", name + ".ply"), "wb") as out:
            out.write(data)


class SceneText:
    """One .pbrt file being written."""

    def __init__(self, project, path, comment):
        self.project = project
        self.path = path
        self.title = comment[0]
        self.triangles = 0
        self.lines = ["# " + line if line else "#" for line in comment] + [""]
        self.indent = ""

    def line(self, text=""):
        self.lines.append((self.indent + text) if text else "")

    def note(self, text):
        self.lines += ["", self.indent + "# " + text]

    def header(self, film, camera, integrator="bdpt", maxdepth=8, filter_text='"gaussian"',
               sampler='"sobol" "integer pixelsamples" 64', film_extra=""):
        """film: (width, height); camera: (eye, target, fov, extra parameters), or a text in
        place of the angle where it is another camera than `perspective`."""
        name = os.path.basename(self.path)[:-5] + ".exr"
        eye, target, fov, extra = camera
        self.line("LookAt %s  %s  0 1 0" % (nums(eye), nums(target)))
        kind = fov if isinstance(fov, str) else '"perspective" "float fov" ' + num(fov)
        self.line("Camera %s%s" % (kind, extra))
        self.line('Film "rgb" "integer xresolution" %d "integer yresolution" %d%s'
                  % (film[0], film[1], film_extra))
        self.line('  "string filename" "%s"' % name)
        self.line("PixelFilter " + filter_text)
        self.line("Sampler " + sampler)
        self.line('Integrator "%s" "integer maxdepth" %d' % (integrator, maxdepth))
        self.line()
        self.line("WorldBegin")

    def values(self, parameter, values):
        """A parameter of many numbers."""
        text = _wrapped([num(value) for value in values], 18, self.indent + "    ")
        self.line('  "%s" [%s]' % (parameter, text))

    def begin(self):
        self.line("AttributeBegin")
        self.indent += "  "

    def end(self):
        self.indent = self.indent[:-2]
        self.line("AttributeEnd")

    def materials(self, names):
        for name in sorted(names):
            self.line('MakeNamedMaterial "%s" %s' % (name, MATERIALS[name]))

    def use(self, material):
        self.line('NamedMaterial "%s"' % material)

    def group(self, name):
        """Names the group of the lights of this block; others than bidir ignore it."""
        self.line('Attribute "light" "string lightgroup" "%s"' % name)

    def emit(self, rgb, extra=""):
        self.line('AreaLightSource "diffuse" "rgb L" [%s]%s' % (nums(rgb), extra))

    def include(self, path):
        self.line('Include "%s"' % path)
        self.triangles += self.project.parts[path]

    def mesh(self, mesh, normals=None):
        """Writes an inline trianglemesh, with normals if shading needs them or they are given."""
        self.triangles += len(mesh.triangles)
        if normals is None:
            normals = not mesh.is_flat_shaded()
        indent = self.indent + "    "
        self.line('Shape "trianglemesh"')
        self.line('  "integer indices" [%s]' % _wrapped(
            ["%d %d %d" % t for t in mesh.triangles], 12, indent))
        self.line('  "point3 P" [%s]' % _wrapped([nums(p) for p in mesh.points], 6, indent))
        if normals:
            self.line('  "normal N" [%s]' % _wrapped(
                [nums(round(v, 5) for v in n) for n in mesh.normals], 6, indent))

    def big_mesh(self, name, mesh):
        """Writes a PLY file next to the scene, or an inline mesh if it is small."""
        if len(mesh.triangles) <= INLINE_LIMIT:
            self.mesh(mesh)
            return
        self.project.write_ply(name, mesh)
        self.triangles += len(mesh.triangles)
        self.line('Shape "plymesh" "string filename" "meshes/%s.ply"' % name)

    def place(self, model, at, angle=0.0, swap=None, scale=1.0):
        """A model of the furniture at a point of the plan, turned about the
        vertical. swap: {material of the model: material to use instead}."""
        self.begin()
        self.line("# " + model.name)
        self.line("Translate " + nums(at))
        if angle:
            self.line("Rotate %s 0 1 0" % num(angle))
        if scale != 1.0:
            self.line("Scale %s %s %s" % ((num(scale),) * 3))
        for part, material, mesh in model.parts:
            self.use((swap or {}).get(material, material))
            self.big_mesh(model.name + "-" + part, mesh)
        self.end()

    def finish(self, listed=True):
        self.project.write(self.path, "\n".join(self.lines) + "\n")
        if listed:
            self.project.scenes.append((self.path, self.triangles, self.title))
        else:
            self.project.parts[self.path] = self.triangles


class Model:
    """A piece of furniture: parts of one material each, standing on y = 0 and
    facing -z."""

    def __init__(self, name):
        self.name = name
        self.parts = []

    def part(self, name, material, *meshes):
        self.parts.append((name, material, Mesh().append(*meshes)))
        return self
