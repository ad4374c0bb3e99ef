"""Six scenes of daylight, glass and fog, of the kinds that people bring.

The model of `auto` may be mended by looking at `house`, `bathroom` and `floor_object`; the others judge
whether that helped. `path` finds all of their light.
"""

import math
import struct

SKY_SIZE = 128
SKY_ZENITH = (0.25, 0.45, 0.95)
SKY_HORIZON = (0.85, 0.9, 1.0)
SUN = 'LightSource "distant" "rgb L" [%g %g %g] "point3 from" [%g %g %g] "point3 to" [0 0 0]\n'
SKY = (
    "AttributeBegin\nRotate -90 1 0 0\n"
    'LightSource "infinite" "string filename" "sky.pfm" "float scale" %g\nAttributeEnd\n'
)
HEAD = """\
%sLookAt %s  %s  0 1 0
Camera "perspective" "float fov" %g
Film "rgb" "integer xresolution" 192 "integer yresolution" 108
PixelFilter "gaussian"
Sampler "sobol" "integer pixelsamples" 16
Integrator "bdpt" "integer maxdepth" 10
WorldBegin
%s"""


def write(folder):
    """Writes the sky and the scenes into a folder; returns the paths of the scenes."""
    _write_sky(folder / "sky.pfm")
    paths = []
    for make in (house, bathroom, floor_object, class_room, fog_lantern, water_glass):
        paths.append(folder / f"{make.__name__.replace('_', '-')}.pbrt")
        paths[-1].write_text(make(), encoding="utf-8")
    return paths


def _write_sky(path):
    """Writes a clear sky in pbrt's equal-area octahedral map, whose z axis points up."""
    rows = [
        [_radiance(_octahedral_height((x + 0.5) / SKY_SIZE, (y + 0.5) / SKY_SIZE)) for x in range(SKY_SIZE)]
        for y in range(SKY_SIZE)
    ]
    data = b"".join(struct.pack("<3f", *pixel) for row in reversed(rows) for pixel in row)
    path.write_bytes(b"PF\n%d %d\n-1.0\n" % (SKY_SIZE, SKY_SIZE) + data)


def _radiance(height):
    """Returns the radiance of the sky at this sine of the elevation; below the horizon it is haze."""
    part = math.sqrt(max(height, 0.0))
    return tuple(low + (high - low) * part for low, high in zip(SKY_HORIZON, SKY_ZENITH, strict=True))


def _octahedral_height(u, v):
    """Returns the sine of the elevation of a point of the unit square [Clarberg08]."""
    distance = 1.0 - abs(2.0 * u - 1.0) - abs(2.0 * v - 1.0)
    radius = 1.0 - abs(distance)
    return math.copysign(1.0 - radius * radius, distance)


def _head(eye, target, fov, lights, before=""):
    return HEAD % (before, _numbers(eye), _numbers(target), fov, lights)


def _numbers(values):
    return " ".join(f"{value:.6g}" for value in values)


def _matt(red, green, blue):
    return f'Material "diffuse" "rgb reflectance" [{red} {green} {blue}]\n'


def _glazed(red, green, blue, roughness=0.05):
    return (
        f'Material "coateddiffuse" "rgb reflectance" [{red} {green} {blue}] "float roughness" {roughness}\n'
    )


def _mesh(points, triangles):
    return (
        f'Shape "trianglemesh" "point3 P" [{"  ".join(map(_numbers, points))}] '
        f'"integer indices" [{"  ".join(map(_numbers, triangles))}]\n'
    )


def _quad(a, b, c, d):
    """Makes a quadrilateral whose normal is that of a, b, c against the clock."""
    return _mesh([a, b, c, d], [(0, 1, 2), (0, 2, 3)])


def _box(low, high):
    """Makes a box with outward normals."""
    points = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return _mesh(points, [triangle for a, b, c, d in faces for triangle in ((a, b, c), (a, c, d))])


def _ground(half, height=0.0):
    return _quad((-half, height, -half), (-half, height, half), (half, height, half), (half, height, -half))


def _at(place, *shapes):
    return f"AttributeBegin\nTranslate {_numbers(place)}\n{''.join(shapes)}AttributeEnd\n"


def _sphere(radius):
    return f'Shape "sphere" "float radius" {radius}\n'


def _wall_with_windows(plane, span, height, windows):
    """Makes a wall at x = plane, 0.2 thick, with openings (from, to) along z between two heights."""
    low, high = height[1], height[2]
    edges = [span[0], *(edge for window in windows for edge in window), span[1]]
    parts = [
        _box((plane, 0, span[0]), (plane + 0.2, low, span[1])),
        _box((plane, high, span[0]), (plane + 0.2, height[0], span[1])),
    ]
    parts += [
        _box((plane, low, a), (plane + 0.2, high, b)) for a, b in zip(edges[::2], edges[1::2], strict=True)
    ]
    return "".join(parts)


def house():
    """A house on a lawn under sun and sky, seen from the garden."""
    text = _head((9, 1.7, 11), (0, 1.8, 0), 45, SUN % (2.6, 2.4, 2.0, 4, 6, 3) + SKY % 0.6)
    text += _matt(0.2, 0.3, 0.1) + _ground(60)
    text += _matt(0.7, 0.66, 0.58) + _box((-4, 0, -3), (4, 3, 3))
    text += _matt(0.45, 0.2, 0.14)
    text += _quad((-4.5, 2.8, 3.5), (4.5, 2.8, 3.5), (4.5, 5.2, 0), (-4.5, 5.2, 0))
    text += _quad((-4.5, 5.2, 0), (4.5, 5.2, 0), (4.5, 2.8, -3.5), (-4.5, 2.8, -3.5))
    text += _matt(0.7, 0.66, 0.58) + _mesh([(4, 3, 3), (4, 3, -3), (4, 5.05, 0)], [(0, 1, 2)])
    text += _glazed(0.05, 0.06, 0.08, 0.01)
    text += "".join(_box((x, 1, 2.95), (x + 1.2, 2.2, 3.03)) for x in (-3.2, -1.2, 2))
    text += _glazed(0.3, 0.15, 0.08, 0.1) + _box((0.6, 0, 2.95), (1.6, 2.1, 3.05))
    text += _matt(0.6, 0.6, 0.6) + _box((0.2, -0.1, 3), (2, 0.1, 6))
    text += _matt(0.15, 0.3, 0.08)
    text += "".join(_at((x, 2.4, z), _sphere(1.3)) for x, z in ((-6, 4), (6.5, 1), (-7, -2)))
    text += _matt(0.3, 0.22, 0.15)
    text += "".join(
        _box((x - 0.12, 0, z - 0.12), (x + 0.12, 1.6, z + 0.12)) for x, z in ((-6, 4), (6.5, 1), (-7, -2))
    )
    return text + "".join(_box((-9 + 0.5 * i, 0, 6), (-8.65 + 0.5 * i, 0.9, 6.05)) for i in range(22))


def bathroom():
    """A tiled bathroom with two windows, one with a pane, a mirror, chrome and a lamp at the mirror."""
    text = _head((1.25, 1.6, 2.3), (-0.5, 0.9, -0.6), 65, SKY % 4)
    text += _glazed(0.75, 0.76, 0.74)
    text += _ground(3) + _quad((-1.5, 2.5, -1.8), (1.5, 2.5, -1.8), (1.5, 2.5, 2.5), (-1.5, 2.5, 2.5))
    text += _wall_with_windows(-1.7, (-1.8, 2.5), (2.5, 1.3, 2.1), [(-1.2, -0.4), (0.4, 1.2)])
    text += _glazed(0.55, 0.68, 0.72)
    text += _quad((-1.5, 0, -1.8), (1.5, 0, -1.8), (1.5, 2.5, -1.8), (-1.5, 2.5, -1.8))
    text += _quad((1.5, 0, 2.5), (-1.5, 0, 2.5), (-1.5, 2.5, 2.5), (1.5, 2.5, 2.5))
    text += _quad((1.5, 0, -1.8), (1.5, 0, 2.5), (1.5, 2.5, 2.5), (1.5, 2.5, -1.8))
    text += 'Material "thindielectric" "float eta" 1.5\n'
    text += _quad((-1.6, 1.3, 0.4), (-1.6, 1.3, 1.2), (-1.6, 2.1, 1.2), (-1.6, 2.1, 0.4))
    text += (
        'Material "conductor" "spectrum eta" "metal-Ag-eta" "spectrum k" "metal-Ag-k" "float roughness" 0\n'
    )
    text += _quad((-0.4, 1.1, -1.79), (0.7, 1.1, -1.79), (0.7, 1.9, -1.79), (-0.4, 1.9, -1.79))
    text += _glazed(0.85, 0.85, 0.85, 0.02)
    text += _box((-1.5, 0.45, -1.7), (-0.7, 0.55, 0.2)) + _box((-0.8, 0, -1.7), (-0.7, 0.55, 0.2))
    text += _box((-1.5, 0, 0.1), (-0.7, 0.55, 0.2)) + _box((-0.2, 0.75, -1.75), (0.6, 0.9, -1.3))
    text += (
        'Material "conductor" "spectrum eta" "metal-Al-eta" "spectrum k" "metal-Al-k" "float roughness" 0.1\n'
    )
    text += _box((0.18, 0.9, -1.65), (0.22, 1.05, -1.6)) + _box((0.18, 1.03, -1.65), (0.22, 1.06, -1.45))
    text += _at((-0.75, 0.75, -1.6), _sphere(0.06))
    return text + (
        'AttributeBegin\nAreaLightSource "diffuse" "rgb L" [14 12 9]\n'
        + _matt(0, 0, 0)
        + _at((0.15, 2.05, -1.7), _sphere(0.05))
        + "AttributeEnd\n"
    )


def class_room():
    """A class room on a wide ground, lit by a sun through blinds and by the sky."""
    text = _head((4.3, 1.7, 3.1), (-2, 0.9, -1), 62, SUN % (9, 8.4, 7, -6, 4.5, 1.5) + SKY % 1)
    text += _matt(0.35, 0.33, 0.3) + _ground(111, -0.3)
    text += _matt(0.5, 0.42, 0.32) + _box((-5.2, -0.2, -3.7), (5.2, 0, 3.7))
    text += _matt(0.75, 0.74, 0.7) + _box((-5.2, 3.2, -3.7), (5.2, 3.4, 3.7))
    text += _box((-5.2, 0, -3.7), (5.2, 3.2, -3.5)) + _box((-5.2, 0, 3.5), (5.2, 3.2, 3.7))
    text += _box((5, 0, -3.5), (5.2, 3.2, 3.5))
    windows = [(-3.2, -1.3), (-0.9, 0.9), (1.3, 3.2)]
    text += _wall_with_windows(-5.2, (-3.5, 3.5), (3.2, 0.9, 2.7), windows)
    text += _matt(0.7, 0.7, 0.68)
    text += "".join(
        _box((-5.0, 0.95 + 0.06 * i, a), (-4.96, 0.98 + 0.06 * i, b)) for a, b in windows for i in range(28)
    )
    text += _matt(0.08, 0.16, 0.11) + _box((-2, 1, -3.52), (2, 2.2, -3.46))
    text += _glazed(0.5, 0.34, 0.18, 0.15)
    for x in (-3.2, -1.2, 0.8, 2.8):
        for z in (-1.6, 0.2, 2):
            text += _box((x, 0.7, z), (x + 1.2, 0.74, z + 0.6))
            text += _box((x + 0.05, 0, z + 0.05), (x + 0.1, 0.7, z + 0.55))
            text += _box((x + 1.1, 0, z + 0.05), (x + 1.15, 0.7, z + 0.55))
    return text


def floor_object():
    """A glossy pot and a copper ball on a floor under a sun and a sky."""
    text = _head((0.6, 0.7, 1.5), (0, 0.16, 0), 34, SUN % (2.2, 2.1, 1.9, 1.2, 2, 0.6) + SKY % 0.9)
    text += _matt(0.55, 0.5, 0.45) + _ground(4)
    text += _glazed(0.55, 0.12, 0.08, 0.08) + _at((-0.12, 0.16, 0), _sphere(0.16))
    text += _at(
        (-0.12, 0.33, 0),
        'Rotate -90 1 0 0\nShape "cylinder" "float radius" 0.07 "float zmin" -0.05 "float zmax" 0.06\n',
    )
    text += (
        'Material "conductor" "spectrum eta" "metal-Cu-eta" "spectrum k" "metal-Cu-k" "float roughness" 0.2\n'
    )
    text += _at((0.2, 0.09, 0.15), _sphere(0.09))
    return text + _matt(0.2, 0.35, 0.6) + _box((0.1, 0, -0.35), (0.4, 0.25, -0.1))


def fog_lantern():
    """A lamp in a ball of glass, in a foggy yard."""
    fog = (
        'MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_a" [0.01 0.01 0.01] '
        '"rgb sigma_s" [0.12 0.12 0.12] "float g" 0.4\nMediumInterface "fog"\n'
    )
    text = _head((0.4, 1.5, -5), (0, 1.1, 0), 42, "", fog)
    text += _matt(0.4, 0.4, 0.4) + _ground(6)
    text += _matt(0.5, 0.35, 0.28) + _box((-6, 0, 3), (6, 4, 3.3)) + _box((-3.3, 0, -6), (-3, 4, 3))
    text += (
        _matt(0.2, 0.2, 0.22)
        + _box((0.35, 0, 0.35), (0.45, 1.2, 0.45))
        + _box((-1.7, 0, 0.6), (-0.9, 1.1, 1.2))
    )
    lamp = 'AttributeBegin\nMediumInterface "" ""\nAreaLightSource "diffuse" "rgb L" [60 50 36]\n' + _matt(
        0, 0, 0
    )
    lamp += _sphere(0.12) + "AttributeEnd\n"
    glass = 'MediumInterface "" "fog"\nMaterial "dielectric" "float eta" 1.5\n' + _sphere(0.3)
    return text + _at((0.4, 1.5, 0.4), lamp, glass)


def water_glass():
    """A glass of water on a table by a window."""
    text = _head((0.28, 0.3, 0.42), (0, 0.06, 0), 28, SKY % 0.15)
    text += _glazed(0.45, 0.3, 0.18, 0.2) + _ground(1)
    text += _matt(0.6, 0.58, 0.55) + _quad((-1, 0, -0.8), (1, 0, -0.8), (1, 1, -0.8), (-1, 1, -0.8))
    text += 'AttributeBegin\nAreaLightSource "diffuse" "rgb L" [8 8 7.5]\n' + _matt(0, 0, 0)
    text += _quad((-0.9, 0.5, 0.3), (-0.9, 0.5, -0.2), (-0.9, 0.9, -0.2), (-0.9, 0.9, 0.3)) + "AttributeEnd\n"
    wall, water, base, rim = 0.035, 0.08, 0.008, 0.11
    shell = [
        _cylinder(1.5, wall, 0, rim),
        _cylinder(1 / 1.5, wall - 0.003, water, rim),
        _cylinder(1.33 / 1.5, wall - 0.003, base, water),
        _disk(1.33, wall - 0.003, water),
        _disk(1.5 / 1.33, wall - 0.003, base),
        f'Material "dielectric" "float eta" 1.5\nShape "disk" "float radius" {wall} "float height" {rim} '
        f'"float innerradius" {wall - 0.003}\n',
        "ReverseOrientation\n",
        _disk(1.5, wall, 0),
    ]
    text += _at((0, 0.0005, 0), "Rotate -90 1 0 0\n", *shell)
    return text + _matt(0.7, 0.5, 0.1) + _at((0.1, 0.03, 0.02), _sphere(0.03))


def _cylinder(index, radius, low, high):
    """Makes a tube whose inside has this index relative to its outside."""
    return (
        f'Material "dielectric" "float eta" {index:.6g}\n'
        f'Shape "cylinder" "float radius" {radius} "float zmin" {low} "float zmax" {high}\n'
    )


def _disk(index, radius, height):
    """Makes a level surface; what is below has this index relative to what is above."""
    material = f'Material "dielectric" "float eta" {index:.6g}\n'
    return material + f'Shape "disk" "float radius" {radius} "float height" {height}\n'
