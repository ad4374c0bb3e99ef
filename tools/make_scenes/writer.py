"""Writes pbrt-v4 text and the binary PLY meshes it refers to."""

import contextlib
import os
import struct

from geometry import Mesh

INLINE_LIMIT = 64  # triangles; larger meshes go to meshes/*.ply


def num(value):
    """Formats a number: seven digits, no negative zero."""
    return format(round(value, 12) + 0.0, ".7g")


def nums(values):
    return " ".join(num(v) for v in values)


def _wrapped(values, per_line, indent):
    lines = [values[i:i + per_line] for i in range(0, len(values), per_line)]
    return ("\n" + indent).join(" ".join(line) for line in lines)


def named(material):
    return 'NamedMaterial "%s"' % material


def group(name):
    """Names the group of the lights of a block; others than bidir ignore it."""
    return 'Attribute "light" "string lightgroup" "%s"' % name


def emission(rgb):
    return 'AreaLightSource "diffuse" "rgb L" [%s]' % nums(rgb)


def translation(at):
    return "Translate %g %g %g" % at


class Project:
    """The output folder: remembers the meshes written."""

    def __init__(self, root):
        self.root = root
        self.meshes = {}    # name -> bytes
        for folder in ("meshes", "parts"):
            os.makedirs(os.path.join(root, folder), exist_ok=True)

    def write(self, path, data):
        with open(os.path.join(self.root, path), "wb") as out:
            out.write(data)

    def write_ply(self, name, mesh):
        has_normals = not mesh.is_flat_shaded()
        properties = ["x", "y", "z", *(["nx", "ny", "nz"] if has_normals else [])]
        head = ["ply", "format binary_little_endian 1.0", "element vertex %d" % len(mesh.points),
                *("property float " + name for name in properties), "element face %d" % len(mesh.triangles),
                "property list uchar int vertex_indices", "end_header", ""]
        # rounded first, so that the last bits of a sine do not show
        points = [[round(v, 5) + 0.0 for v in point] for point in mesh.points]
        normals = [[round(v, 4) + 0.0 for v in normal] if has_normals else [] for normal in mesh.normals]
        data = "\n".join(head).encode()
        data += b"".join(struct.pack("<%df" % len(properties), *p, *n) for p, n in zip(points, normals))
        data += b"".join(struct.pack("<B3i", 3, *triangle) for triangle in mesh.triangles)
        if self.meshes.setdefault(name, data) != data:
            raise ValueError("two different meshes named " + name)
        self.write("meshes/" + name + ".ply", data)


class SceneText:
    """One .pbrt file being written."""

    def __init__(self, project, path, comment):
        self.project = project
        self.path = path
        self.lines = ["# " + line if line else "#" for line in comment] + [""]
        self.indent = ""

    def line(self, text=""):
        self.lines.append((self.indent + text) if text else "")

    def note(self, text):
        self.lines += ["", self.indent + "# " + text]

    def header(self, eye, target, angle):
        name = os.path.basename(self.path)[:-5] + ".exr"
        self.lines += [
            "LookAt %s  %s  0 1 0" % (nums(eye), nums(target)),
            'Camera "perspective" "float fov" ' + num(angle),
            'Film "rgb" "integer xresolution" 640 "integer yresolution" 480',
            '  "string filename" "%s"' % name,
            'PixelFilter "gaussian"',
            'Sampler "sobol" "integer pixelsamples" 64',
            'Integrator "bdpt" "integer maxdepth" 8',
            "",
            "WorldBegin",
        ]

    @contextlib.contextmanager
    def block(self, *head):
        """A block of attributes, with its first lines: what is None is left out."""
        self.line("AttributeBegin")
        self.indent += "  "
        for line in filter(None, head):
            self.line(line)
        yield
        self.indent = self.indent[:-2]
        self.line("AttributeEnd")

    def use(self, material):
        self.line(named(material))

    def include(self, path):
        self.line('Include "%s"' % path)

    def mesh(self, mesh):
        """Writes an inline trianglemesh, with normals if shading needs them."""
        indent = self.indent + "    "
        self.line('Shape "trianglemesh"')
        self.line('  "integer indices" [%s]' % _wrapped(["%d %d %d" % t for t in mesh.triangles], 12, indent))
        self.line('  "point3 P" [%s]' % _wrapped([nums(p) for p in mesh.points], 6, indent))
        if not mesh.is_flat_shaded():
            self.line('  "normal N" [%s]' % _wrapped(
                [nums(round(v, 5) for v in n) for n in mesh.normals], 6, indent))

    def big_mesh(self, name, mesh):
        """Writes a PLY file next to the scene, or an inline mesh if it is small."""
        if len(mesh.triangles) <= INLINE_LIMIT:
            self.mesh(mesh)
            return
        self.project.write_ply(name, mesh)
        self.line('Shape "plymesh" "string filename" "meshes/%s.ply"' % name)

    def place(self, model, at, angle=0.0, swap=None):
        """A model of the furniture at a point of the plan, turned about the
        vertical. swap: {material of the model: material to use instead}."""
        turn = "Rotate %s 0 1 0" % num(angle) if angle else None
        with self.block("# " + model.name, "Translate " + nums(at), turn):
            for part, material, mesh in model.parts:
                self.use((swap or {}).get(material, material))
                self.big_mesh(model.name + "-" + part, mesh)

    def finish(self):
        self.project.write(self.path, ("\n".join(self.lines) + "\n").encode())


class Model:
    """A piece of furniture: parts of one material each, standing on y = 0 and
    facing -z."""

    def __init__(self, name):
        self.name = name
        self.parts = []

    def part(self, name, material, *meshes):
        self.parts.append((name, material, Mesh().append(*meshes)))
        return self
