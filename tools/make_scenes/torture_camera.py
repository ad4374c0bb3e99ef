"""Lens, crop, filters, light types, extreme scales, nearly touching surfaces."""

from primitives import box, slab
from torture_base import (GREY, diffuse, down, light, room, sphere, start, towards_camera, up)
from torture_materials import BOX_CAMERA


def lens(project):
    out = start(project, "lens", [
        "A thin lens with half of it covered.",
        "A large lens with a wall right before half of it: light paths that connect to the",
        "camera must be tested against the point on the lens that was sampled. Blocks before,",
        "in and behind the plane of focus, some at the edges of the image."],
        ((0, 1.0, -1.8), (0, 0.9, 0.4), 60,
         ' "float lensradius" 0.25 "float focaldistance" 2.2'), film=(48, 48))
    diffuse(out, GREY)
    out.mesh(room(-2, 2, 0, 2.2, -2.2, 2))
    light(out, down(-0.5, 0.5, 2.15, -0.5, 0.5), (16, 16, 16))
    diffuse(out, (0.3, 0.3, 0.35))
    out.mesh(box(0.01, 0.6, 0.4, 1.6, -1.69, -1.68))
    diffuse(out, (0.7, 0.3, 0.2))
    out.mesh(slab(-0.45, -0.001, -0.7, 0.2, 0.75, 0.2))
    diffuse(out, (0.3, 0.7, 0.3))
    out.mesh(slab(0.25, -0.001, 0.5, 0.3, 0.9, 0.3))
    diffuse(out, (0.2, 0.3, 0.7))
    out.mesh(slab(0.9, -0.001, 1.6, 0.4, 1.4, 0.3))
    diffuse(out, (0.7, 0.65, 0.2))
    out.mesh(slab(-1.22, -0.001, 0.35, 0.25, 1.9, 0.25))
    out.mesh(slab(1.25, -0.001, 0.35, 0.25, 1.9, 0.25))
    out.finish()


def _little_room(out, scale=1.0):
    """A closed room of 4 x 2.2 x 4 with two blocks and a ceiling light."""
    diffuse(out, (0.65, 0.63, 0.6))
    out.mesh(room(-2, 2, 0, 2.2, -2, 2).scaled(scale))
    diffuse(out, (0.65, 0.25, 0.2))
    out.mesh(slab(-0.6, -0.001, 0.6, 0.7, 1.2, 0.7).turned("y", 18).scaled(scale))
    diffuse(out, (0.25, 0.4, 0.65))
    out.mesh(slab(0.65, -0.001, 0.1, 0.6, 0.6, 0.6).turned("y", -20).scaled(scale))
    light(out, down(-0.5, 0.5, 2.15, -0.5, 0.5).scaled(scale), (9, 8.5, 8))


def crop(project):
    out = start(project, "crop", [
        "A crop window: 24 x 16 pixels out of 48 x 48.",
        "What the light paths splat outside of",
        "the window is dropped, and the rest must equal the same part of the full image."],
        BOX_CAMERA, film=(48, 48), filter_text='"gaussian"',
        film_extra=' "float cropwindow" [0.25 0.75 0.5 0.8333]')
    _little_room(out)
    out.finish()


def filters(project):
    for name, what in (("gaussian", '"gaussian"'), ("mitchell", '"mitchell"'),
                       ("sinc", '"sinc" "float xradius" 3 "float yradius" 3'),
                       ("triangle", '"triangle"')):
        out = start(project, "filter-" + name, [
            "The %s filter on bright edges against the dark." % name,
            "Negative lobes must stay (no clamping), and splats of light paths must go through",
            "the same filter as camera samples."],
            ((0, 1.0, -1.8), (0, 1.0, 1), 50, ""), filter_text=what)
        diffuse(out, (0.2, 0.2, 0.2))
        out.mesh(room(-2, 2, 0, 2, -2, 2))
        light(out, towards_camera(-0.33, 0.41, 0.62, 1.27, 1.2), (6, 6, 6))
        diffuse(out, (0.02, 0.02, 0.02))
        out.mesh(slab(0.55, -0.001, 0.4, 0.4, 1.5, 0.1).turned("y", 12))
        out.finish()


def lights(project):
    out = start(project, "lights", [
        "Point, spot, distant and infinite light together.",
        "A point light, a narrow spot, a distant and a constant infinite light at once, in an",
        "open scene: light leaves for infinity and arrives from it."],
        ((0, 1.6, -4), (0, 0.6, 0), 45, ""), film=(48, 48))
    out.line('LightSource "infinite" "rgb L" [0.12 0.16 0.22]')
    out.line('LightSource "distant" "rgb L" [0.8 0.75 0.6]')
    out.line('  "point3 from" [2 3 -1] "point3 to" [0 0 0]')
    out.line('LightSource "point" "rgb I" [0.8 0.3 0.2] "point3 from" [-1.1 0.9 0.2]')
    out.line('LightSource "spot" "rgb I" [6 9 6]')
    out.line('  "point3 from" [1 2.5 -0.5] "point3 to" [0.5 0 0.3]')
    out.line('  "float coneangle" 12 "float conedeltaangle" 4')
    diffuse(out, (0.65, 0.65, 0.65))
    out.mesh(up(-3, 3, 0, -2, 3))
    diffuse(out, (0.6, 0.5, 0.35))
    out.mesh(slab(-0.35, -0.001, 0.5, 0.5, 1.1, 0.5).turned("y", 30))
    diffuse(out, (0.35, 0.5, 0.65))
    sphere(out, (0.9, 0.41, 0.7), 0.4)
    out.finish()


def scales(project):
    for name, scale in (("unit", 1.0), ("tiny", 1e-4), ("huge", 1e4)):
        eye, target, fov, extra = BOX_CAMERA
        camera = (tuple(scale * v for v in eye), tuple(scale * v for v in target), fov, extra)
        out = start(project, "scale-" + name, [
            "A little room, all lengths times %g." % scale,
            "scale-unit, scale-tiny and scale-huge must give the same image: no fixed epsilon",
            "may show."], camera)
        _little_room(out, scale)
        out.finish()


def touching(project):
    out = start(project, "touching", [
        "Surfaces that almost touch.",
        "Surfaces 1e-4 apart: a block over the floor, a sphere over the floor, two plates, a",
        "light before a wall. Shadow rays must neither leak nor hit what they start from."],
        BOX_CAMERA)
    gap = 1e-4
    diffuse(out, (0.65, 0.63, 0.6))
    out.mesh(room(-2, 2, 0, 2.2, -2, 2))
    diffuse(out, (0.65, 0.25, 0.2))
    out.mesh(slab(-0.75, gap, 0.6, 0.6, 0.9, 0.6))
    out.mesh(slab(-0.75, 0.9 + 2 * gap, 0.6, 0.5, 0.3, 0.5))
    diffuse(out, (0.3, 0.6, 0.3))
    sphere(out, (0.25, 0.3 + gap, 0.2), 0.3)
    diffuse(out, (0.25, 0.4, 0.65))
    out.mesh(box(0.75, 0.85, 0.0 + gap, 1.2, -0.2, 0.9))
    out.mesh(box(0.85 + gap, 0.95, 0.0 + gap, 1.2, -0.2, 0.9))
    light(out, down(-0.5, 0.5, 2.2 - gap, -0.5, 0.5), (5, 5, 5))
    light(out, towards_camera(-0.3, 0.3, 1.0, 1.4, 2 - gap), (3, 3, 4))
    out.finish()


def write_all(project):
    for make in (lens, crop, filters, lights, scales, touching):
        make(project)
