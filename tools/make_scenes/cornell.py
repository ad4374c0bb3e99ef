"""A Cornell box of the project's own numbers."""

from primitives import slab
from torture_base import diffuse, down, light, quad
from writer import SceneText


def write_all(project):
    out = SceneText(project, "cornell.pbrt", [
        "A Cornell box, 2 m wide, with two diffuse blocks and a small ceiling light.",
        "Direct light, soft shadows and colour bleeding in a few dozen triangles; the numbers",
        "are the project's own. Nothing stands before the open front."])
    out.header((512, 512), ((0, 1, -3.7), (0, 1, 0), 31, ""), filter_text='"box"')
    white = (0.72, 0.71, 0.68)
    diffuse(out, white)
    out.note("floor, ceiling, back")
    out.mesh(quad((-1, 0, 0), (-1, 0, 2), (1, 0, 2), (1, 0, 0)))
    out.mesh(quad((-1, 2, 0), (1, 2, 0), (1, 2, 2), (-1, 2, 2)))
    out.mesh(quad((-1, 0, 2), (-1, 2, 2), (1, 2, 2), (1, 0, 2)))
    out.note("left, red; right, green")
    diffuse(out, (0.61, 0.08, 0.06))
    out.mesh(quad((-1, 0, 0), (-1, 2, 0), (-1, 2, 2), (-1, 0, 2)))
    diffuse(out, (0.13, 0.44, 0.10))
    out.mesh(quad((1, 0, 0), (1, 0, 2), (1, 2, 2), (1, 2, 0)))
    out.note("tall and short block")
    diffuse(out, white)
    out.mesh(slab(0, -0.001, 0, 0.58, 1.2, 0.58).turned("y", 18).moved(-0.36, 0, 1.28))
    out.mesh(slab(0, -0.001, 0, 0.58, 0.6, 0.58).turned("y", -17).moved(0.38, 0, 0.68))
    out.note("the light, 4 mm under the ceiling, facing down")
    light(out, down(-0.25, 0.25, 1.996, 0.8, 1.2), (30, 26, 20))
    out.finish()
