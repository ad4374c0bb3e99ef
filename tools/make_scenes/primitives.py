"""Building blocks of the furniture: boxes, lathes, rods, sheets, mouldings."""

import math

from geometry import Mesh, add, cross, mul, smoothed, sub, unit


def patch(rows, crease=60.0):
    """A grid of points; the normal is along d/d(row) x d/d(column)."""
    mesh = Mesh()
    columns = len(rows[0])
    for row in rows:
        mesh.points.extend(row)
    mesh.normals = [(0.0, 0.0, 0.0)] * len(mesh.points)
    for i in range(len(rows) - 1):
        for j in range(columns - 1):
            a, b = i * columns + j, (i + 1) * columns + j
            mesh.triangles += [(a, b, a + 1), (b, b + 1, a + 1)]
    return smoothed(mesh, crease)


def sheet(function, rows, columns, crease=60.0):
    """The patch of function(u, v), u and v from 0 to 1, u along the rows."""
    return patch([[function(i / rows, j / columns) for j in range(columns + 1)]
                  for i in range(rows + 1)], crease)


def box(x0, x1, y0, y1, z0, z1):
    """An axis-aligned box with sharp edges."""
    corner = [(x, y, z) for z in (z0, z1) for y in (y0, y1) for x in (x0, x1)]
    mesh = Mesh()
    for a, b, c, d in ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4),
                       (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)):
        mesh.face(corner[a], corner[b], corner[c], corner[d])
    return mesh


def slab(cx, y0, cz, width, height, depth):
    """A box standing on height y0, centred on (cx, cz)."""
    return box(cx - width / 2, cx + width / 2, y0, y0 + height,
               cz - depth / 2, cz + depth / 2)


def _axis_samples(half, radius, steps):
    """(offset of the inner box, slope) along one face of a rounded box."""
    angles = [-45.0 + 45.0 * i / steps for i in range(steps + 1)]
    low = [(-(half - radius), math.tan(math.radians(a))) for a in angles]
    return low + [(-offset, -slope) for offset, slope in reversed(low)]


def rounded_box(width, height, depth, radius, steps=2):
    """A box with round edges, centred on the origin."""
    half = (width / 2, height / 2, depth / 2)
    mesh = Mesh()
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for sign in (1.0, -1.0):
            rows = []
            for ou, su in _axis_samples(half[u], radius, steps):
                row = []
                for ov, sv in _axis_samples(half[v], radius, steps):
                    direction, centre = [0.0] * 3, [0.0] * 3
                    direction[axis], direction[u], direction[v] = sign, su, sv
                    centre[axis], centre[u], centre[v] = sign * (half[axis] - radius), ou, ov
                    row.append(add(tuple(centre), mul(unit(tuple(direction)), radius)))
                rows.append(row)
            side = patch(rows)
            mesh.append(side if sign > 0.0 else side.flipped())
    return smoothed(mesh, 50.0)


def cushion(width, height, depth, puff, steps=10):
    """A cushion: flat seam around the middle, swelling towards the middle of
    both faces; centred on the origin, thin along y."""
    def top(u, v):
        # finer near the seam
        a, b = -math.cos(math.pi * u), -math.cos(math.pi * v)
        swell = ((1.0 - a * a) * (1.0 - b * b)) ** 0.35
        pinch = 1.0 - 0.05 * (1.0 - swell)
        y = height / 2 * (1.0 - (a ** 8 + b ** 8) / 2.0) * swell + puff * swell
        return (width / 2 * a * pinch, y, depth / 2 * b * pinch)

    upper = sheet(lambda u, v: top(v, u), steps, steps)
    lower = sheet(lambda u, v: (lambda p: (p[0], -p[1], p[2]))(top(u, v)), steps, steps)
    both = Mesh().append(upper, lower)
    # at two corners the halves would lie on each other: cut these off
    both.triangles = [t for t in both.triangles
                      if any(abs(both.points[i][1]) > 1e-9 for i in t)]
    return smoothed(both, 75.0)


def lathe(profile, segments=32, crease=40.0):
    """Turns (radius, y) points about the y axis. Going up the outer side of a
    solid gives outward normals; a radius of 0 closes an end."""
    rows = []
    for radius, y in profile:
        row = [(radius * math.cos(2 * math.pi * j / segments), y,
                radius * math.sin(2 * math.pi * j / segments)) for j in range(segments)]
        rows.append(row + [row[0]])
    return patch(rows, crease)


def rod(start, end, radius0, radius1=None, segments=12):
    """A closed round bar between two points, possibly tapered."""
    radius1 = radius0 if radius1 is None else radius1
    axis = unit(sub(end, start))
    helper = (1.0, 0.0, 0.0) if abs(axis[0]) < 0.9 else (0.0, 1.0, 0.0)
    side = unit(cross(helper, axis))
    # side, axis, other must be oriented as x, y, z for the lathe's winding
    other = cross(side, axis)
    length = math.sqrt(sum(v * v for v in sub(end, start)))
    mesh = lathe([(0.0, 0.0), (radius0, 0.0), (radius1, length), (0.0, length)], segments)

    def place(p):
        return add(mul(side, p[0]), add(mul(axis, p[1]), mul(other, p[2])))

    mesh.points = [add(start, place(p)) for p in mesh.points]
    mesh.normals = [place(n) for n in mesh.normals]
    return mesh


def polygon(sides, radius, turn=0.0):
    """A flat n-gon in the plane z = 0, facing -z."""
    corners = [(radius * math.cos(math.radians(turn) + 2 * math.pi * i / sides),
                radius * math.sin(math.radians(turn) + 2 * math.pi * i / sides), 0.0)
               for i in range(sides)]
    return Mesh().face(*reversed(corners))


def frame_ring(width, height, bar, depth):
    """A mitred rectangular frame in the plane z = 0, its back at z = 0 and its
    front at z = -depth; centred on the origin."""
    def corners(inset, z):
        w, h = width / 2 - inset, height / 2 - inset
        return [(-w, -h, z), (w, -h, z), (w, h, z), (-w, h, z)]

    outer_front, inner_front = corners(0.0, -depth), corners(bar, -depth)
    outer_back, inner_back = corners(0.0, 0.0), corners(bar, 0.0)
    mesh = Mesh()
    for i in range(4):
        j = (i + 1) % 4
        mesh.face(outer_front[i], inner_front[i], inner_front[j], outer_front[j])
        mesh.face(outer_back[i], outer_front[i], outer_front[j], outer_back[j])
        mesh.face(inner_front[i], inner_back[i], inner_back[j], inner_front[j])
    return mesh


def moulding(path, y0, y1, thickness, closed=False):
    """A strip of rectangular profile along a polyline of (x, z) on the wall,
    mitred at the corners. The room must lie to the left of the walk when x
    points right and z points up on the plan. The back is sunk 4 mm."""
    def offset(distance):
        out = []
        for i, (x, z) in enumerate(path):
            sides = []
            if i > 0 or closed:
                sides.append((path[i - 1], (x, z)))
            if i < len(path) - 1 or closed:
                sides.append(((x, z), path[(i + 1) % len(path)]))
            normals = []
            for (ax, az), (bx, bz) in sides:
                length = math.hypot(bx - ax, bz - az)
                normals.append((-(bz - az) / length, (bx - ax) / length))
            nx, nz = (sum(n[k] for n in normals) / len(normals) for k in (0, 1))
            scale = distance / (nx * nx + nz * nz)
            out.append((x + nx * scale, z + nz * scale))
        return out

    back, front = offset(-0.004), offset(thickness)
    mesh = Mesh()
    count = len(path)
    for i in range(count if closed else count - 1):
        j = (i + 1) % count
        (ax, az), (bx, bz) = back[i], back[j]
        (cx, cz), (dx, dz) = front[i], front[j]
        mesh.face((cx, y0, cz), (dx, y0, dz), (dx, y1, dz), (cx, y1, cz))
        mesh.face((cx, y1, cz), (dx, y1, dz), (bx, y1, bz), (ax, y1, az))
        mesh.face((ax, y0, az), (bx, y0, bz), (dx, y0, dz), (cx, y0, cz))
    if not closed:
        for i, order in ((0, 1), (count - 1, -1)):
            (ax, az), (cx, cz) = back[i], front[i]
            ring = [(ax, y0, az), (cx, y0, cz), (cx, y1, cz), (ax, y1, az)]
            mesh.face(*ring[::order])
    return mesh
