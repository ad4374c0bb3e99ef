"""Common parts of the small test scenes: film, camera, quads, a closed room."""

from geometry import Mesh
from primitives import box
from writer import SceneText, nums

GREY = (0.6, 0.6, 0.6)


def start(project, name, comment, camera, film=(32, 32), maxdepth=5,
          filter_text='"box"', film_extra="", samples=256):
    """camera: (eye, target, fov, extra parameters)."""
    out = SceneText(project, "torture/%s.pbrt" % name, comment)
    out.header(film, camera, maxdepth=maxdepth, filter_text=filter_text,
               sampler='"independent" "integer pixelsamples" %d' % samples,
               film_extra=film_extra)
    return out


def diffuse(out, rgb):
    out.line('Material "diffuse" "rgb reflectance" [%s]' % nums(rgb))


def quad(*corners):
    return Mesh().face(*corners)


def up(x0, x1, y, z0, z1):
    """A horizontal rectangle facing up."""
    return quad((x0, y, z0), (x0, y, z1), (x1, y, z1), (x1, y, z0))


def down(x0, x1, y, z0, z1):
    """A horizontal rectangle facing down."""
    return up(x0, x1, y, z0, z1).flipped()


def towards_camera(x0, x1, y0, y1, z):
    """An upright rectangle facing -z."""
    return quad((x0, y0, z), (x0, y1, z), (x1, y1, z), (x1, y0, z))


def room(x0, x1, y0, y1, z0, z1):
    """The inside of a box."""
    return box(x0, x1, y0, y1, z0, z1).flipped()


def light(out, mesh, rgb, extra="", normals=None):
    out.begin()
    out.emit(rgb, extra)
    diffuse(out, (0, 0, 0))
    out.mesh(mesh, normals)
    out.end()


def sphere(out, centre, radius):
    out.begin()
    out.line("Translate " + nums(centre))
    out.line('Shape "sphere" "float radius" %s' % nums([radius]))
    out.end()
