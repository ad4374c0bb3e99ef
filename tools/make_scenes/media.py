"""Scenes with participating media: a caustic in fog, a cloud, juice and milk."""

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
