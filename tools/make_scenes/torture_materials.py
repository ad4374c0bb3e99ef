"""Glass, metal, shading normals, mirrored transforms, a white furnace."""

import math

from geometry import Mesh, unit
from primitives import slab
from torture_base import (GREY, diffuse, down, light, quad, room, sphere, start,
                          towards_camera, up)

BOX_CAMERA = ((0, 1.0, -1.8), (0, 0.75, 0.4), 55, "")


def glass(project):
    out = start(project, "glass", [
        "Smooth and rough glass.",
        "A smooth glass sphere over a floor: a caustic, which only light paths find well.",
        "Beside it a sphere of rough glass. A closed room, so nothing is lost outside."],
        BOX_CAMERA, film=(48, 48), maxdepth=6)
    diffuse(out, GREY)
    out.mesh(room(-2, 2, 0, 2.2, -2, 2))
    light(out, down(-0.35, 0.35, 2.15, -0.2, 0.5), (20, 20, 20))
    out.line('Material "dielectric" "float eta" 1.5')
    sphere(out, (-0.55, 0.65, 0.35), 0.45)
    out.line('Material "dielectric" "float eta" 1.5 "float roughness" 0.09')
    sphere(out, (0.6, 0.55, 0.2), 0.4)
    out.finish()


def conductor(project):
    out = start(project, "conductor", [
        "Smooth, rough and anisotropic metal.",
        "A mirror sphere, a rough gold sphere and an anisotropic plate."],
        BOX_CAMERA, film=(48, 48), maxdepth=6)
    diffuse(out, GREY)
    out.mesh(room(-2, 2, 0, 2.2, -2, 2))
    light(out, down(-0.4, 0.4, 2.15, -0.4, 0.4), (12, 12, 12))
    out.line('Material "conductor" "rgb reflectance" [0.9 0.9 0.9] "float roughness" 0')
    sphere(out, (-0.6, 0.5, 0.4), 0.42)
    out.line('Material "conductor" "rgb eta" [0.168 0.35 1.508] "rgb k" [3.138 2.714 1.879]')
    out.line('  "float roughness" 0.04')
    sphere(out, (0.6, 0.5, 0.2), 0.42)
    out.line('Material "conductor" "rgb eta" [1.475 0.959 0.618] "rgb k" [7.794 6.687 5.469]')
    out.line('  "float uroughness" 0.01 "float vroughness" 0.25')
    out.mesh(quad((-0.9, 0.9, 1.4), (-0.9, 1.9, 1.9), (0.9, 1.9, 1.9), (0.9, 0.9, 1.4)))
    out.finish()


def _coarse_sphere(rings, sectors, radius):
    """Few flat triangles that pretend to be a sphere."""
    mesh = Mesh()
    rows = []
    for i in range(rings + 1):
        a = math.pi * (i / rings - 0.5)
        rows.append([(math.cos(a) * math.cos(2 * math.pi * j / sectors), math.sin(a),
                      math.cos(a) * math.sin(2 * math.pi * j / sectors)) for j in range(sectors)])
    for i in range(rings):
        for j in range(sectors):
            k = (j + 1) % sectors
            if i == 0:
                corners = [rows[0][0], rows[1][j], rows[1][k]]
            elif i == rings - 1:
                corners = [rows[i][j], rows[rings][0], rows[i][k]]
            else:
                corners = [rows[i][j], rows[i + 1][j], rows[i + 1][k], rows[i][k]]
            base = len(mesh.points)
            mesh.points += [tuple(radius * v for v in c) for c in corners]
            mesh.normals += [unit(c) for c in corners]
            for t in range(1, len(corners) - 1):
                mesh.triangles.append((base, base + t, base + t + 1))
    return mesh


def shading_normal(project):
    out = start(project, "shading-normal", [
        "Shading normals that disagree with the geometry.",
        "Vertex normals far from the geometric ones: a sphere of a few triangles, and a floor",
        "whose normals lean by up to 40 degrees, lit at a grazing angle in a closed room.",
        "Camera paths and light paths must apply the same correction to agree."],
        BOX_CAMERA, film=(48, 48))
    diffuse(out, GREY)
    shell = room(-2, 2, -0.01, 2.2, -2, 2)
    out.mesh(shell)
    floor = Mesh()
    steps = 4
    for i in range(steps + 1):
        for j in range(steps + 1):
            lean = math.radians(40) * (1 if (i + j) % 2 else -1)
            floor.points.append((-2 + 4 * i / steps, 0.0, -2 + 4 * j / steps))
            floor.normals.append((math.sin(lean), math.cos(lean), 0.0))
    for i in range(steps):
        for j in range(steps):
            a, b = i * (steps + 1) + j, (i + 1) * (steps + 1) + j
            floor.triangles += [(a, a + 1, b + 1), (a, b + 1, b)]
    out.mesh(floor, normals=True)
    diffuse(out, (0.7, 0.4, 0.3))
    out.mesh(_coarse_sphere(4, 5, 0.5).moved(0.1, 0.62, 0.2), normals=True)
    # a low panel on the left wall, facing +x
    light(out, quad((-1.95, 0.15, -0.8), (-1.95, 0.75, -0.8), (-1.95, 0.75, 0.8),
                    (-1.95, 0.15, 0.8)), (12, 11, 10))
    out.finish()


def mirror(project):
    out = start(project, "mirror", [
        "Mirrored transforms, one-sided and two-sided lights.",
        "A mirrored transform (Scale -1 1 1) around meshes with and without vertex normals,",
        "a one-sided light under the mirror that must still shine down into the room, and a",
        "two-sided light standing upright."],
        BOX_CAMERA, film=(48, 48))
    diffuse(out, GREY)
    out.mesh(room(-2, 2, 0, 2.2, -2, 2))
    out.begin()
    out.line("Scale -1 1 1")
    diffuse(out, (0.7, 0.35, 0.25))
    out.mesh(_coarse_sphere(6, 8, 0.4).moved(0.6, 0.45, 0.3), normals=True)
    diffuse(out, (0.25, 0.35, 0.7))
    out.mesh(slab(-0.7, -0.001, 0.6, 0.6, 0.8, 0.6), normals=False)
    light(out, down(0.5, 1.3, 2.15, -0.4, 0.4), (10, 9, 8), normals=False)
    light(out, down(-1.1, -0.7, 2.15, -0.2, 0.2), (10, 16, 16), normals=True)
    out.end()
    light(out, towards_camera(-0.25, 0.25, 0.3, 0.6, 0.9), (3, 4, 3),
          ' "bool twosided" true')
    out.finish()


def furnace(project):
    out = start(project, "furnace", [
        "White furnace, with a known answer.",
        "The inside of a unit sphere of albedo 0.5 that emits 0.5.",
        "At infinite depth every pixel is 0.5 / (1 - 0.5) = 1 exactly; with maxdepth d it is",
        "1 - 0.5^(d+1), here 1 - 1/64 = 0.984375."],
        ((0.3, 0.1, -0.4), (0, 0, 1), 60, ""), film=(16, 16), samples=64)
    diffuse(out, (0.5, 0.5, 0.5))
    out.begin()
    out.emit((0.5, 0.5, 0.5))
    out.line("ReverseOrientation  # normals, and so the emission, point inward")
    out.line('Shape "sphere" "float radius" 1')
    out.end()
    out.finish()


def red_light(project):
    out = start(project, "red-light-blue-surfaces", [
        "Red light on bluish surfaces.",
        "A nearly red light on bluish walls with a little grey: a choice among connections by",
        "one channel, or by luminance of the wrong thing, shows up as noise or bias here."],
        BOX_CAMERA)
    diffuse(out, (0.05, 0.15, 0.8))
    out.mesh(room(-2, 2, 0, 2.2, -2, 2))
    diffuse(out, (0.5, 0.5, 0.5))
    out.mesh(slab(-0.5, -0.001, 0.5, 0.6, 1.0, 0.6).turned("y", 20))
    diffuse(out, (0.02, 0.3, 0.7))
    out.mesh(slab(0.7, -0.001, 0.1, 0.5, 0.5, 0.5).turned("y", -15))
    light(out, down(-0.5, 0.5, 2.15, -0.5, 0.5), (60, 1.2, 1.2))
    out.finish()


def separated(project):
    def panel(x, mesh_rgb):
        diffuse(out, mesh_rgb)
        out.mesh(towards_camera(x - 1, x + 1, 0.5, 3, 4.0))
    out = start(project, "separated", [
        "Surfaces far apart, for testing single strategies.",
        "A wide light panel, a floor and upright walls, all far from each other: every distance in",
        "a path is bounded below, so each sampling strategy of each path length has a small",
        "variance by itself and can be tested on its own."],
        ((0, 2.0, -6), (0, 1.2, 2), 45, ""))
    diffuse(out, (0.7, 0.7, 0.7))
    out.mesh(up(-2.5, 2.5, 0, -2, 2.5))
    panel(-1.5, (0.7, 0.4, 0.3))
    panel(1.5, (0.3, 0.5, 0.7))
    diffuse(out, (0.6, 0.6, 0.6))
    out.mesh(quad((-4, 0.5, -1), (-4, 3, -1), (-4, 3, 2), (-4, 0.5, 2)))
    light(out, down(-2.5, 2.5, 5, -2.5, 2.5), (2, 2, 2))
    out.finish()


def write_all(project):
    for make in (glass, conductor, shading_normal, mirror, furnace, red_light, separated):
        make(project)
