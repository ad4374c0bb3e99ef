"""Lamps that are pictures, skies alone, views from within glass, shapes of all kinds, leaves."""

import struct

from primitives import box, slab
from torture_base import GREY, diffuse, down, light, room, sphere, start, towards_camera, up
from torture_materials import BOX_CAMERA


def _pfm(project, name, size, texel):
    """A square picture of RGB radiance; row 0 is the top, as everywhere but in the file."""
    rows = [[texel(x, y) for x in range(size)] for y in range(size)]
    data = b"".join(struct.pack("<3f", *t) for row in reversed(rows) for t in row)
    project.write_bytes("torture/" + name, b"PF\n%d %d\n-1.0\n" % (size, size) + data)


def picture_lamp(project):
    _pfm(project, "lamp.pfm", 4, lambda x, y: (
        (12.0, 8.0, 4.0) if (x + y) % 2 == 0 else (0.0, 0.5 * y, 2.0 + x)))
    out = start(project, "picture-lamp", [
        "Lamps that are pictures.",
        "A disk that shines to both sides and a tube, both with the same few texels, some of",
        "them black in red."], BOX_CAMERA)
    diffuse(out, GREY)
    out.mesh(room(-2, 2, 0, 2.2, -2, 2))
    diffuse(out, (0.65, 0.3, 0.25))
    out.mesh(slab(-0.7, -0.001, 0.6, 0.6, 0.9, 0.6).turned("y", 20))
    picture = 'AreaLightSource "diffuse" "string filename" "lamp.pfm"'
    out.begin()
    out.line(picture + ' "bool twosided" true "float scale" 1.5')
    diffuse(out, (0, 0, 0))
    out.line("Translate 0.1 1.7 0.2")
    out.line("Rotate 70 1 0 0")
    out.line('Shape "disk" "float radius" 0.5 "float innerradius" 0.1')
    out.end()
    out.begin()
    out.line(picture)
    diffuse(out, (0.2, 0.2, 0.2))
    out.line("Translate 0.8 0.5 0.5")
    out.line("Scale 1 1 0.6")
    out.line('Shape "cylinder" "float radius" 0.2 "float zmin" -0.5 "float zmax" 0.5')
    out.end()
    out.finish()


def sky_alone(project):
    _pfm(project, "sky.pfm", 8, lambda x, y: (
        (30.0, 26.0, 20.0) if (x, y) == (5, 2) else (0.2 + 0.05 * x, 0.3, 0.3 + 0.05 * y)))
    out = start(project, "sky-alone", [
        "A picture of the sky is the only light.",
        "One of its texels is a hundred times as bright as the others; the ground is glossy."],
        ((0, 1.4, -3), (0, 0.5, 0), 40, ""))
    out.begin()
    out.line("Rotate -90 1 0 0")
    out.line('LightSource "infinite" "string filename" "sky.pfm"')
    out.end()
    out.line('Material "coateddiffuse" "rgb reflectance" [0.5 0.45 0.4] "float roughness" 0.2')
    out.mesh(up(-3, 3, 0, -2, 3))
    diffuse(out, (0.3, 0.45, 0.6))
    sphere(out, (-0.3, 0.4, 0.2), 0.4)
    diffuse(out, (0.65, 0.3, 0.25))
    out.mesh(slab(0.6, -0.001, 0.3, 0.4, 0.8, 0.4).turned("y", 25))
    out.finish()


def within_glass(project):
    out = start(project, "within-glass", [
        "A camera within a ball of glass.",
        "Radiance is larger within by the square of the index, and nothing but the camera's own",
        "walks reaches the lens."],
        ((0, 1.0, -0.9), (0, 0.8, 0.4), 70, ""), maxdepth=6)
    diffuse(out, GREY)
    out.mesh(room(-2, 2, 0, 2.2, -2, 2))
    light(out, down(-0.7, 0.7, 2.15, -0.6, 0.8), (5, 5, 5))
    diffuse(out, (0.65, 0.3, 0.25))
    out.mesh(slab(0.3, -0.001, 0.9, 0.6, 0.9, 0.6).turned("y", 20))
    out.line('Material "dielectric" "float eta" 1.5')
    sphere(out, (0, 1.0, -0.9), 0.3)
    out.finish()


def bulb(project):
    out = start(project, "bulb", [
        "A lamp within glass, seen in a mirror.",
        "All of its light leaves by refraction and much of it comes back by reflection: what lies",
        "between two smooth surfaces only hits upon the lamp can find."],
        BOX_CAMERA, maxdepth=7)
    diffuse(out, (0.5, 0.5, 0.5))
    out.mesh(room(-2, 2, 0, 2.2, -2, 2))
    out.line('Material "conductor" "rgb reflectance" [0.9 0.9 0.9] "float roughness" 0')
    out.mesh(towards_camera(-1.2, 1.2, 0.2, 1.6, 1.9))
    out.begin()
    out.emit((6, 5, 4))
    diffuse(out, (0, 0, 0))
    sphere(out, (0.1, 1.1, 0.5), 0.3)
    out.end()
    out.line('Material "dielectric" "float eta" 1.4')
    sphere(out, (0.1, 1.1, 0.5), 0.4)
    out.finish()


def narrow_spot(project):
    out = start(project, "narrow-spot", [
        "A spot of three degrees.",
        "Next to no direction of the lamp has light, and all that is seen is lit indirectly."],
        BOX_CAMERA)
    diffuse(out, (0.7, 0.7, 0.65))
    out.mesh(room(-2, 2, 0, 2.2, -2, 2))
    diffuse(out, (0.3, 0.45, 0.6))
    out.mesh(slab(-0.6, -0.001, 0.5, 0.6, 0.9, 0.6).turned("y", 20))
    out.line('LightSource "spot" "rgb I" [900 800 700] "point3 from" [-1.5 2 -0.5]')
    out.line('  "point3 to" [1.2 0 0.9] "float coneangle" 3 "float conedeltaangle" 1')
    out.finish()


def shapes(project):
    out = start(project, "shapes", [
        "Tubes, rings, parts of balls, patches and subdivided meshes.",
        "One of the tubes is a lamp, under a map that makes its section an ellipse."],
        BOX_CAMERA)
    diffuse(out, GREY)
    out.mesh(room(-2, 2, 0, 2.2, -2, 2))
    out.begin()
    out.emit((7, 6, 5))
    diffuse(out, (0, 0, 0))
    out.line("Translate -0.2 1.9 0.3")
    out.line("Scale 1 0.5 0.6")
    out.line('Shape "cylinder" "float radius" 0.25')
    out.end()
    diffuse(out, (0.65, 0.3, 0.25))
    out.begin()
    out.line("Translate -0.8 0.4 0.4")
    out.line("Rotate 60 1 0.3 0")
    out.line('Shape "cylinder" "float radius" 0.3 "float zmin" -0.4 "float zmax" 0.4'
             ' "float phimax" 250')
    out.end()
    diffuse(out, (0.3, 0.45, 0.6))
    out.line('Shape "bilinearmesh" "point3 P" [0.3 0.1 0.2 1.2 0.5 0.3 0.4 1.0 0.9 1.1 0.2 1.1]')
    diffuse(out, (0.3, 0.6, 0.3))
    out.begin()
    out.line("Translate 0.1 0.35 0.1")
    out.line("Scale 0.4 0.4 0.4")
    out.line('Shape "loopsubdiv" "integer levels" 2')
    out.line('  "point3 P" [1 1 1 -1 -1 1 -1 1 -1 1 -1 -1]')
    out.line('  "integer indices" [0 2 1 0 1 3 0 3 2 1 2 3]')
    out.end()
    diffuse(out, (0.6, 0.55, 0.2))
    out.begin()
    out.line("Translate 0.9 1.3 0.8")
    out.line('Shape "sphere" "float radius" 0.4 "float zmin" -0.2 "float zmax" 0.3'
             ' "float phimax" 300')
    out.end()
    out.finish()


def leaves(project):
    out = start(project, "leaves", [
        "Leaves that are cut out of squares, placed many times.",
        "Half of each is not there, some of the rest is half there; light comes through them."],
        ((0, 1.0, -1.8), (0, 0.7, 0.4), 55, ""))
    out.line('Texture "cells" "float" "checkerboard" "float uscale" 4 "float vscale" 4')
    out.line('  "float tex1" 0.5 "float tex2" 0')
    out.line('Texture "cut" "float" "checkerboard" "float uscale" 2 "float vscale" 2')
    out.line('  "float tex1" 1 "texture tex2" "cells"')
    diffuse(out, GREY)
    out.mesh(room(-2, 2, 0, 2.2, -2, 2))
    light(out, down(-0.5, 0.5, 2.15, -0.2, 0.8), (12, 12, 11))
    out.line('ObjectBegin "leaf"')
    out.line('  Material "diffusetransmission" "rgb reflectance" [0.3 0.5 0.2]'
             ' "rgb transmittance" [0.2 0.3 0.1]')
    out.line('  Shape "bilinearmesh" "point3 P" [-1 0 -1 1 0 -1 -1 0 1 1 0 1] "texture alpha" "cut"')
    out.line("ObjectEnd")
    for i in range(9):
        out.begin()
        out.line("Translate %g %g %g" % (0.6 * (i % 3) - 0.6, 0.5 + 0.12 * i, 0.2 * (i // 3) + 0.1))
        out.line("Rotate %d 1 0.5 0" % (25 * i))
        out.line("Scale 0.35 0.35 %g" % (-0.35 if i % 2 else 0.35))
        out.line('ObjectInstance "leaf"')
        out.end()
    out.finish()


def lamps(project):
    out = start(project, "lamps", [
        "Many lamps of every kind.",
        "Small ones in rows, some of which shine to both sides, a mesh of many triangles, pictures, a",
        "spot and a point, the sun and the sky; each is near to some of what it lights."],
        ((0, 1.3, -2.6), (0, 0.45, 0.2), 50, ""))
    out.line('LightSource "infinite" "rgb L" [0.03 0.04 0.06]')
    out.line('LightSource "distant" "rgb L" [0.2 0.18 0.15]')
    out.line('  "point3 from" [2 3 -1] "point3 to" [0 0 0]')
    out.line('LightSource "point" "rgb I" [0.05 0.02 0.02] "point3 from" [-1.1 0.25 -0.4]')
    out.line('LightSource "spot" "rgb I" [0.5 0.8 0.5] "point3 from" [1.3 1.5 -0.5]')
    out.line('  "point3 to" [0.8 0 0.1] "float coneangle" 20 "float conedeltaangle" 8')
    diffuse(out, GREY)
    out.mesh(up(-3, 3, 0, -2, 3))
    for i in range(12):
        x, z = 0.45 * (i % 6) - 1.1, 0.8 * (i // 6) - 0.5
        lamp = down(x, x + 0.08, 0.2 + 0.03 * i, z, z + 0.1 + 0.02 * i)
        color = [(3, 1, 1), (1, 3, 1), (1, 1, 4)][i % 3]
        light(out, lamp, color, ' "bool twosided" true' if i % 4 == 0 else "")
    out.begin()
    out.emit((0.8, 1.2, 0.5))
    diffuse(out, (0.2, 0.2, 0.2))
    out.line("Translate -0.7 0.5 0.5")
    out.line("Scale 0.25 0.25 0.25")
    out.line('Shape "loopsubdiv" "integer levels" 2')
    out.line('  "point3 P" [1 1 1 -1 -1 1 -1 1 -1 1 -1 -1]')
    out.line('  "integer indices" [0 2 1 0 1 3 0 3 2 1 2 3]')
    out.end()
    out.begin()
    out.line('AreaLightSource "diffuse" "string filename" "lamp.pfm" "bool twosided" true'
             ' "float scale" 0.2')
    diffuse(out, (0, 0, 0))
    out.line("Translate 1.1 0.6 0.9")
    out.line("Rotate 60 1 0.4 0")
    out.line('Shape "disk" "float radius" 0.2')
    out.end()
    diffuse(out, (0.65, 0.3, 0.25))
    out.mesh(slab(-0.1, -0.001, 0.7, 0.4, 0.7, 0.4).turned("y", 20))
    out.line('Material "coateddiffuse" "rgb reflectance" [0.3 0.4 0.6] "float roughness" 0.3')
    sphere(out, (0.5, 0.3, 0.0), 0.3)
    out.line('Material "diffusetransmission" "rgb reflectance" [0.3 0.5 0.2]'
             ' "rgb transmittance" [0.2 0.3 0.1]')
    out.mesh(towards_camera(-1.5, -0.9, 0, 0.7, 0.1))
    out.finish()


def empty(project):
    out = start(project, "empty", [
        "Nothing at all.", "Neither surfaces nor lights: the picture is black."],
        BOX_CAMERA)
    out.finish()
    out = start(project, "empty-sky", [
        "A sky over nothing.", "Every pixel has the radiance of the sky, whoever looks."],
        BOX_CAMERA)
    out.line('LightSource "infinite" "rgb L" [0.2 0.3 0.4]')
    out.finish()


def write_all(project):
    for make in (picture_lamp, sky_alone, within_glass, bulb, narrow_spot, shapes, leaves, lamps,
                 empty):
        make(project)
