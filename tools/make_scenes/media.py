"""Scenes with participating media: a caustic in fog, a cloud, juice and milk, candles."""

import math

from primitives import slab
from torture_base import GREY, diffuse, down, light, room, sphere, towards_camera, up
from writer import SceneText, nums


def medium(out, name, absorption, scattering, extra=""):
    out.line('MakeNamedMedium "%s" "string type" "homogeneous"' % name)
    out.line('  "rgb sigma_a" [%s] "rgb sigma_s" [%s]%s'
             % (nums(absorption), nums(scattering), extra))


def write_all(project):
    fog(project)
    cloud(project)
    liquids(project)
    candles(project)


def fog(project):
    out = SceneText(project, "fog.pbrt", [
        "A spot light shines through a glass ball in fog.",
        "The ball gathers the beam behind it: a caustic in the fog, which no camera walk finds",
        "and no connection through smooth glass."])
    medium(out, "fog", (0.01, 0.01, 0.01), (0.09, 0.09, 0.09), ' "float g" 0.3')
    out.line('MediumInterface "fog"')
    out.header((400, 300), ((0, 1.2, -4.2), (0.15, 0.95, 0), 40, ""))
    out.line('LightSource "spot" "point3 from" [-1.9 2.6 0] "point3 to" [0 1.1 0]')
    out.line('  "float coneangle" 14 "float conedeltaangle" 3 "rgb I" [180 168 144]')
    diffuse(out, (0.5, 0.5, 0.5))
    out.mesh(up(-4, 4, 0, -5, 4))
    diffuse(out, (0.35, 0.42, 0.5))
    out.mesh(towards_camera(-4, 4, 0, 4, 2.5))
    out.begin()
    out.line('Material "dielectric" "float eta" 1.5')
    sphere(out, (0, 1.1, 0), 0.45)
    out.end()
    out.finish()


def cloud(project):
    out = SceneText(project, "cloud.pbrt", [
        "A cloud over a field, in the light of a low sun and a sky.",
        "Its density is noise in a box, which an ellipsoid cuts."])
    out.line("Translate 0 0.3 0")
    out.line('MakeNamedMedium "cloud" "string type" "cloud"')
    out.line('  "rgb sigma_a" [0 0 0] "rgb sigma_s" [28 28 28] "float g" 0.6')
    out.line('  "float density" 1.5 "float frequency" 2.5')
    out.line('  "point3 p0" [-1.6 0.45 -1] "point3 p1" [1.6 1 1]')
    out.line("Identity")
    out.header((400, 300), ((0, 0.5, -4.2), (0, 0.85, 0), 42, ""), maxdepth=60)
    out.line('LightSource "infinite" "rgb L" [0.25 0.42 0.8]')
    out.line('LightSource "distant" "point3 from" [-2 2.2 -1.4] "point3 to" [0 0 0]')
    out.line('  "rgb L" [3.2 2.9 2.4]')
    diffuse(out, (0.18, 0.22, 0.12))
    out.mesh(up(-40, 40, 0, -40, 40))
    out.begin()
    out.line("Translate 0 0.75 0")
    out.line("Scale 1.6 0.55 1")
    out.line('MediumInterface "cloud" ""')
    out.line('Material "interface"')
    out.line('Shape "sphere"')
    out.end()
    out.finish()


def liquids(project):
    out = SceneText(project, "liquids.pbrt", [
        "Balls of juice, milk and green glass in a box.",
        "Juice and glass absorb what passes through them, milk scatters it many times: media",
        "within smooth glass, under a wide lamp."])
    medium(out, "juice", (0.4, 3.5, 6), (0.02, 0.02, 0.02))
    medium(out, "milk", (0.02, 0.03, 0.08), (14, 17, 20))
    medium(out, "green", (3, 0.4, 2), (0, 0, 0))
    out.header((400, 300), ((0, 1.15, -3.1), (0, 0.62, 0), 42, ""), maxdepth=60)
    diffuse(out, GREY)
    out.mesh(room(-2, 2, 0, 2.4, -3.2, 2))
    light(out, down(-0.8, 0.8, 2.35, -0.9, 0.7), (9, 8.6, 8))
    diffuse(out, (0.62, 0.35, 0.22))
    out.mesh(slab(0, -0.001, 0.9, 2.4, 0.3, 0.5))
    for name, x in (("juice", -0.85), ("milk", 0), ("green", 0.85)):
        out.begin()
        out.line('MediumInterface "%s" ""' % name)
        out.line('Material "dielectric" "float eta" 1.33')
        sphere(out, (x, 0.381, 0), 0.38)
        out.end()
    out.finish()


# The cells of a flame, across, up and across.
FLAME = (8, 18, 8)
# Half of its width, and its height.
FLAME_SIZE = (0.075, 0.36)


def flame(out, name, x, y, z):
    """The medium of a flame that stands on a point: soot, hotter and thinner towards the top."""
    soot, heat = [], []
    for k in range(FLAME[2]):
        for j in range(FLAME[1]):
            for i in range(FLAME[0]):
                h = (j + 0.5) / FLAME[1]
                across = math.hypot((i + 0.5) / FLAME[0] - 0.5, (k + 0.5) / FLAME[2] - 0.5) / 0.5
                edge = 1.5 * h ** 0.5 * (1 - h) ** 0.7
                soot.append(round(max(0, 1 - (across / edge) ** 2), 2))
                heat.append(round(1300 + 950 * min(1, 2.4 * h) - 250 * h * across))
    half, height = FLAME_SIZE
    out.line('MakeNamedMedium "%s" "string type" "uniformgrid"' % name)
    out.line('  "rgb sigma_a" [24 24 24] "rgb sigma_s" [0.5 0.5 0.5]')
    out.line('  "integer nx" %d "integer ny" %d "integer nz" %d' % FLAME)
    out.line('  "point3 p0" [%s] "point3 p1" [%s]'
             % (nums((x - half, y, z - half)), nums((x + half, y + height, z + half))))
    out.values('float density', soot)
    out.values('float temperature', heat)


def candle(out, name, x, z, height):
    """A candle of wax on the table, with a wick and its flame."""
    radius, wick = 0.19, 0.07
    out.begin()
    out.line('Material "subsurface" "rgb reflectance" [0.97 0.91 0.78] "rgb mfp" [0.04 0.03 0.02]')
    out.line('  "float eta" 1.3 "float roughness" 0.4')
    out.line("Translate %s" % nums((x, 0.001, z)))
    out.line("Rotate -90 1 0 0")
    out.line('Shape "cylinder" "float radius" %g "float zmin" 0 "float zmax" %g' % (radius, height))
    out.line('Shape "disk" "float radius" %g "float height" %g' % (radius, height))
    out.line("ReverseOrientation")
    out.line('Shape "disk" "float radius" %g' % radius)
    out.end()
    out.begin()
    diffuse(out, (0.03, 0.025, 0.02))
    out.line("Translate %s" % nums((x, height + 0.001, z)))
    out.line("Rotate -90 1 0 0")
    out.line('Shape "cylinder" "float radius" 0.012 "float zmin" 0 "float zmax" %g' % wick)
    out.end()
    half, tall = FLAME_SIZE
    out.begin()
    out.line('MediumInterface "%s" ""' % name)
    out.line('Material "interface"')
    out.line("Translate %s" % nums((x, height + wick + tall / 2, z)))
    out.line("Scale %s" % nums((half, tall / 2, half)))
    out.line('Shape "sphere"')
    out.end()


def candles(project):
    out = SceneText(project, "candles.pbrt", [
        "Two candles of wax and a glass ball on a table, with no light but their flames.",
        "A flame is soot that glows by its temperature: a light without a surface, from whose",
        "points light subpaths begin. Light walks through the wax."])
    places = (("left", -0.42, 0.15, 0.95), ("right", 0.12, -0.2, 0.5))
    for name, x, z, height in places:
        flame(out, name, x, height + 0.07, z)
    out.header((400, 300), ((0, 1.25, -3.4), (0.05, 0.72, 0), 36, ""), maxdepth=100,
               film_extra=' "float iso" 600')
    diffuse(out, (0.45, 0.3, 0.2))
    out.mesh(up(-3, 3, 0, -4, 1.6))
    diffuse(out, (0.55, 0.52, 0.48))
    out.mesh(towards_camera(-3, 3, 0, 3, 1.6))
    for name, x, z, height in places:
        candle(out, name, x, z, height)
    out.begin()
    out.line('Material "dielectric" "float eta" 1.5')
    sphere(out, (0.62, 0.241, 0.1), 0.24)
    out.end()
    out.finish()
