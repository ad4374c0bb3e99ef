"""The furnished room of 4 x 3 x 5 m, lit directly (A) and indirectly (B)."""

import casework
import decor
import lamps
import seating
from palette import MATERIALS
from primitives import box, moulding
from shell import carve
from writer import SceneText, emission, named, translation

CAMERA = ((3.6, 1.5, 0.3), (1.62, 0.86, 4.0), 56)
LAMP = (0.48, 0.0, 4.55)          # where the uplighter stands
PANEL = (2.2, 3.0, 2.6)           # where the ceiling light hangs


def write_palette(project):
    out = SceneText(project, "parts/materials.pbrt",
                    ["The named materials of the room and of the apartment.",
                     "To be included after WorldBegin."])
    for name in sorted(MATERIALS):
        out.line('MakeNamedMaterial "%s" %s' % (name, MATERIALS[name]))
    out.finish()


def spheres(out, places):
    """Sphere shapes: (material, centre, radius)."""
    for material, centre, radius in places:
        with out.block(named(material), translation(centre)):
            out.line('Shape "sphere" "float radius" %g' % radius)


def write_shell(out, name, air, materials):
    for key, mesh in sorted(carve(air).items()):
        out.use(materials[key])
        out.big_mesh(name + "-" + "-".join(key), mesh)


def _building(out):
    out.note("Walls, floor, ceiling and the window niche: one closed surface facing in")
    air = [("room", 0, 4, 0, 3, 0, 5), ("niche", 1.2, 2.6, 0.95, 2.35, 5, 5.2)]
    write_shell(out, "room", air, {
        ("room", "wall"): "wall", ("room", "floor"): "floor", ("room", "ceiling"): "ceiling",
        ("niche", "wall"): "trim", ("niche", "floor"): "trim", ("niche", "ceiling"): "trim"})
    out.note("The dark pane, before the back of the niche; skirting, cornice and sill")
    out.use("night")
    out.mesh(box(1.199, 2.601, 0.949, 2.351, 5.195, 5.21))
    ring = [(0, 0), (4, 0), (4, 5), (0, 5)]
    out.use("trim")
    out.mesh(moulding(ring, -0.001, 0.10, 0.014, closed=True))
    out.mesh(moulding(ring, 2.94, 3.001, 0.05, closed=True))
    out.mesh(box(1.14, 2.66, 0.92, 0.962, 4.94, 5.19))
    out.place(decor.window("room-window", 1.4, 1.4), (1.9, 1.65, 5.196))
    out.place(decor.curtain_rail("room-rail", 2.5), (1.9, 2.52, 5))
    out.place(decor.curtain("curtain-left", 0.55, 2.42, 1), (0.98, 2.5, 5))
    out.place(decor.curtain("curtain-right", 0.55, 2.42, 2), (2.82, 2.5, 5))


def _sofa_corner(out):
    out.note("Sofa under the window, low table, armchair, rug")
    out.place(seating.sofa("sofa", 1.95, 2), (1.9, 0, 4.36))
    out.place(seating.throw_pillow("pillow", 0.40), (1.32, 0.44, 4.32), 18)
    out.place(seating.throw_pillow("pillow", 0.40), (2.46, 0.44, 4.34), -14,
              {"fabric-mustard": "fabric-rust"})
    out.place(decor.rug("rug", 2.3, 1.7), (1.75, 0, 3.05))
    out.place(casework.table("low-table", 0.95, 0.50, 0.40), (1.95, 0.01, 3.35),
              0, {"wood": "wood-pale"})
    out.place(decor.tray(), (1.85, 0.4095, 3.36), 8)
    spheres(out, [("fabric-rust", (2.22, 0.454, 3.27), 0.045)])
    out.place(seating.sofa("armchair", 0.86, 1), (0.98, 0.008, 2.42), -118,
              {"fabric-teal": "fabric-rust"})


def _walls(out):
    out.note("Bookcase, pictures and the plant")
    out.place(casework.bookshelf("bookcase", 1.15, 2.05, 6, 7), (0.168, 0, 3.28), -90)
    out.place(decor.clay_vase(), (0.17, 2.049, 2.98))
    spheres(out, [("fabric-mustard", (0.17, 2.134, 3.42), 0.085),
                  ("fruit-green", (0.15, 2.099, 3.60), 0.05)])
    out.place(decor.picture("picture-a", 0.50, 0.62, 4, ("fabric-blue", "fabric-mustard")),
              (0, 1.60, 4.32), -90)
    out.place(decor.picture("picture-b", 0.62, 0.46, 2, ("fabric-rust", "book-cream", "glaze")),
              (3.33, 1.62, 5))
    out.place(decor.picture("picture-c", 0.9, 0.66, 6, ("leaf", "fabric-teal", "book-ochre")),
              (4, 1.62, 2.4), 90)
    out.place(decor.plant(), (3.48, 0, 4.50))


def _dining(out):
    out.note("Round table with chairs; the only glass and metal stand on it")
    x, z = 2.95, 2.72
    out.place(casework.round_table(), (x, 0, z))
    for dx, dz, angle in ((-0.66, 0.18, -105), (0.36, 0.62, 30), (-0.12, -0.68, 190)):
        out.place(seating.chair(), (x + dx, 0, z + dz), angle)
    out.place(decor.glass_vase(), (x + 0.18, 0.7405, z + 0.12))
    out.place(decor.metal_bowl(), (x - 0.14, 0.7405, z + 0.06))
    fruit = (("fruit-orange", -0.02, 0.0525, 0.03, 0.04),
             ("fruit-green", 0.05, 0.0555, -0.02, 0.038),
             ("fruit-red", -0.035, 0.055, -0.05, 0.038),
             ("fruit-orange", 0.045, 0.0585, 0.06, 0.037))
    spheres(out, [(m, (x - 0.14 + dx, 0.7405 + y, z + 0.06 + dz), r)
                  for m, dx, y, dz, r in fruit])


def write_furniture(project):
    out = SceneText(project, "parts/room-furniture.pbrt", [
        "A furnished room: x 0..4 (right), y 0..3 (up), z 0..5 (away from the camera).",
        "Everything but the emitters; included by room-direct.pbrt and room-indirect.pbrt."])
    _building(out)
    _sofa_corner(out)
    _walls(out)
    _dining(out)
    out.note("The lamps, unlit")
    out.place(lamps.uplighter(), LAMP)
    out.place(lamps.ceiling_panel(1.1), PANEL)
    out.finish()


def _emitter_disk(out, lit):
    at = (LAMP[0], lamps.UPLIGHT_DISK, LAMP[2])
    with out.block(lit and emission(lit), named("white"), translation(at)):
        out.line("Rotate -90 1 0 0  # the disk's normal, +z, now points up")
        out.line('Shape "disk" "float radius" %g' % lamps.UPLIGHT_RADIUS)


def _emitter_panel(out, lit):
    with out.block(lit and emission(lit), named("white"), translation(PANEL)):
        out.mesh(lamps.panel_emitter(1.0))


def write_room(project, path, comment, panel, lamp):
    out = SceneText(project, path, comment)
    out.header(*CAMERA)
    out.include("parts/materials.pbrt")
    out.include("parts/room-furniture.pbrt")
    out.note("Ceiling light: " + ("on" if panel else "off"))
    _emitter_panel(out, panel)
    out.note("Uplighter: " + ("on" if lamp else "off"))
    _emitter_disk(out, lamp)
    out.finish()


def write_all(project):
    write_palette(project)
    write_furniture(project)
    write_room(project, "room-direct.pbrt", [
        "Scene A: a furnished room lit directly by a ceiling light.",
        "The easy case of the 1995 paper: most points see the light, so most shadow rays",
        "succeed. Nearly everything is diffuse; one glass vase and one metal bowl."],
        (29.0, 28.5, 27.0), None)
    write_room(project, "room-indirect.pbrt", [
        "Scene B: the same room lit only by what leaves an opaque uplighter.",
        "The light itself cannot be seen by the camera, nor by almost any point in view:",
        "the pool on ceiling and walls lights the room, and most shadow rays are blocked."],
        None, (6500.0, 6100.0, 5500.0))
