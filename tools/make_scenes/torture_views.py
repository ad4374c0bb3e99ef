"""Cameras of parallel rays and of all directions, skies alone, lamps that are pictures."""

from primitives import box, slab
from torture_base import GREY, diffuse, down, light, room, sphere, start, up

PARALLEL = '"orthographic" "float screenwindow" [-1.3 1.3 -1.3 1.3]'


def _courtyard(out):
    """An open place under a sky with a sun, two lamps and a block."""
    out.line('LightSource "infinite" "rgb L" [0.3 0.4 0.5]')
    out.line('LightSource "distant" "rgb L" [0.9 0.8 0.6]')
    out.line('  "point3 from" [1 3 -2] "point3 to" [0 0 0]')
    diffuse(out, GREY)
    out.mesh(up(-3, 3, 0, -3, 3))
    light(out, down(-1.1, -0.3, 1.4, -0.2, 0.6), (4, 3, 2), ' "bool twosided" true')
    diffuse(out, (0.65, 0.3, 0.25))
    out.mesh(slab(0.6, -0.001, 0.3, 0.5, 0.9, 0.5).turned("y", 25))
    diffuse(out, (0.3, 0.45, 0.6))
    sphere(out, (-0.4, 0.4, 0.1), 0.35)


def parallel(project):
    out = start(project, "parallel", [
        "Parallel rays towards an open place under a sky.",
        "The camera is at infinity, and so is most light; a block stands behind the camera's",
        "plane, where it is in nobody's way. The sky itself only camera rays can see."],
        ((0, 1.4, -2.2), (0, 0.6, 0), PARALLEL, ""))
    _courtyard(out)
    diffuse(out, (0.5, 0.5, 0.2))
    out.mesh(box(-1.0, 1.0, 0.4, 2.6, -3.4, -3.2))
    out.finish()


def around(project):
    for name, mapping in (("longitude", "equirectangular"), ("octahedron", "equalarea")):
        out = start(project, "around-" + name, [
            "Everything around a point, mapped by %s." % mapping,
            "Some of it is close to the poles and to the edges of the film."],
            ((0, 0.8, -1.2), (0.2, 0.7, 0), '"spherical" "string mapping" "%s"' % mapping, ""))
        diffuse(out, GREY)
        out.mesh(room(-2, 2, 0, 2.2, -2.5, 2))
        light(out, down(-0.5, 0.5, 2.15, -0.9, -0.1), (8, 8, 7))
        diffuse(out, (0.65, 0.3, 0.25))
        out.mesh(slab(0.9, -0.001, -0.9, 0.5, 1.1, 0.5).turned("y", 25))
        diffuse(out, (0.3, 0.45, 0.6))
        sphere(out, (-0.6, 0.41, -0.2), 0.4)
        out.finish()


def write_all(project):
    for make in (parallel, around):
        make(project)
