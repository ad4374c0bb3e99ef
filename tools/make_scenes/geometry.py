"""Triangle meshes: storage, rigid motion, smooth normals.

Every solid is built with outward normals, that is (p1 - p0) x (p2 - p0) points
away from the solid.
"""

import math


def add(a, b):
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def mul(a, s):
    return (a[0] * s, a[1] * s, a[2] * s)


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0])


def unit(a):
    length = math.sqrt(dot(a, a))
    return mul(a, 1.0 / length) if length > 0.0 else a


def rotation(axis, degrees):
    """Row-major 3x3 matrix of the rotation that pbrt's `Rotate` describes."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return {
        "x": ((1, 0, 0), (0, c, -s), (0, s, c)),
        "y": ((c, 0, s), (0, 1, 0), (-s, 0, c)),
        "z": ((c, -s, 0), (s, c, 0), (0, 0, 1)),
    }[axis]


class Mesh:
    """Points, optional per-vertex normals (same length) and triangles."""

    def __init__(self, points=(), normals=(), triangles=()):
        self.points = list(points)
        self.normals = list(normals)
        self.triangles = list(triangles)

    def face(self, *corners):
        """A flat convex polygon with its own vertices and its own flat normal."""
        normal = unit(cross(sub(corners[1], corners[0]), sub(corners[2], corners[0])))
        base = len(self.points)
        self.points.extend(corners)
        self.normals.extend([normal] * len(corners))
        for i in range(1, len(corners) - 1):
            self.triangles.append((base, base + i, base + i + 1))
        return self

    def append(self, *others):
        for other in others:
            base = len(self.points)
            self.points.extend(other.points)
            self.normals.extend(other.normals)
            self.triangles.extend((a + base, b + base, c + base)
                                  for a, b, c in other.triangles)
        return self

    def moved(self, x, y, z):
        return Mesh([add(p, (x, y, z)) for p in self.points], self.normals, self.triangles)

    def turned(self, axis, degrees):
        rows = rotation(axis, degrees)
        points, normals = ([tuple(dot(r, v) for r in rows) for v in vectors]
                           for vectors in (self.points, self.normals))
        return Mesh(points, normals, self.triangles)

    def flipped(self):
        """The same surface facing the other way."""
        return Mesh(self.points, [mul(n, -1.0) for n in self.normals], [(a, c, b) for a, b, c in self.triangles])

    def is_flat_shaded(self):
        """True where the vertex normals say nothing that the winding does not."""
        for tri in self.triangles:
            a, b, c = (self.points[i] for i in tri)
            normal = unit(cross(sub(b, a), sub(c, a)))
            if any(dot(normal, self.normals[i]) < 0.99999 for i in tri):
                return False
        return True


def _key(point):
    return tuple(round(v * 1e6) for v in point)


def smoothed(mesh, crease):
    """Vertices welded by position, normals averaged over the faces around a
    vertex that turn less than `crease` degrees; sliver triangles dropped."""
    limit = math.cos(math.radians(crease))
    around = {}
    faces = []
    for tri in mesh.triangles:
        corners = [mesh.points[i] for i in tri]
        keys = [_key(p) for p in corners]
        if len(set(keys)) < 3:
            continue
        normal = unit(cross(sub(corners[1], corners[0]), sub(corners[2], corners[0])))
        faces.append((corners, keys, normal))
        for i in range(3):
            to_next = unit(sub(corners[(i + 1) % 3], corners[i]))
            to_last = unit(sub(corners[(i + 2) % 3], corners[i]))
            angle = math.acos(max(-1.0, min(1.0, dot(to_next, to_last))))
            around.setdefault(keys[i], []).append((normal, angle))
    out, seen = Mesh(), {}
    for corners, keys, normal in faces:
        indices = []
        for corner, key in zip(corners, keys):
            total = (0.0, 0.0, 0.0)
            for other, angle in around[key]:
                if dot(other, normal) > limit:
                    total = add(total, mul(other, angle))
            total = unit(total)
            name = (key, _key(mul(total, 1e-2)))
            if name not in seen:
                seen[name] = len(out.points)
                out.points.append(corner)
                out.normals.append(total)
            indices.append(seen[name])
        out.triangles.append(tuple(indices))
    return out
