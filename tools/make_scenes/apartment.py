"""Six rooms around a hall, each with its own lamp.

Plan (x right, z up the page, walls 0.12 m, ceiling at 2.6 m):

    9.40 +--------+-------------+-------+
         | study  |   bedroom   | store |
    5.82 +--[  ]--+--[  ]-------+-[  ]--+
         |            hall              |
    4.32 +---------[   ]------+--[  ]---+
         |     living         |         |
         |   camera           = kitchen |
    0.00 +--------------------+---------+
         0        2.9        5.0  6.6  8.8
"""

import casework
import decor
import lamps
import seating
from geometry import Mesh
from primitives import moulding
from room import spheres, write_shell
from writer import SceneText, emission, group, named, translation

CAMERA = ((0.95, 1.5, 0.4), (2.85, 1.08, 4.2), 54)
HEIGHT, DOOR = 2.6, 2.05
LIVING_PANEL = (2.5, HEIGHT, 1.7)

# (x0, x1, z0, z1) of the openings in the walls
DOORS = {
    "living-hall": (2.50, 3.70, 4.20, 4.32),
    "kitchen-hall": (6.20, 7.10, 4.20, 4.32),
    "study-hall": (1.30, 2.20, 5.70, 5.82),
    "bedroom-hall": (3.55, 4.45, 5.70, 5.82),
    "store-hall": (7.30, 8.20, 5.70, 5.82),
    "living-kitchen": (5.00, 5.12, 2.90, 3.90),
}
ROOMS = {
    "living": (0, 5.0, 0, 4.2, "wall"),
    "kitchen": (5.12, 8.8, 0, 4.2, "wall-sand"),
    "hall": (0, 8.8, 4.32, 5.7, "wall"),
    "study": (0, 2.9, 5.82, 9.4, "wall-sage"),
    "bedroom": (3.02, 6.6, 5.82, 9.4, "wall-blue"),
    "store": (6.72, 8.8, 5.82, 9.4, "wall-blush"),
}
# walked with the room on the left, from one doorway to the next
SKIRTINGS = (
    ((2.42, 4.2), (0, 4.2), (0, 0), (5, 0), (5, 2.82)),
    ((5, 3.98), (5, 4.2), (3.78, 4.2)),
    ((5.12, 2.82), (5.12, 0), (8.8, 0), (8.8, 4.2), (7.18, 4.2)),
    ((6.12, 4.2), (5.12, 4.2), (5.12, 3.98)),
    ((3.78, 4.32), (6.12, 4.32)),
    ((7.18, 4.32), (8.8, 4.32), (8.8, 5.7), (8.28, 5.7)),
    ((7.22, 5.7), (4.53, 5.7)),
    ((3.47, 5.7), (2.28, 5.7)),
    ((1.22, 5.7), (0, 5.7), (0, 4.32), (2.42, 4.32)),
    ((2.28, 5.82), (2.9, 5.82), (2.9, 9.4), (0, 9.4), (0, 5.82), (1.22, 5.82)),
    ((4.53, 5.82), (6.6, 5.82), (6.6, 9.4), (3.02, 9.4), (3.02, 5.82), (3.47, 5.82)),
    ((8.28, 5.82), (8.8, 5.82), (8.8, 9.4), (6.72, 9.4), (6.72, 5.82), (7.22, 5.82)),
)


def _building(out):
    out.note("Walls, floors and ceilings: one closed surface facing in")
    air = [(name, x0, x1, 0, HEIGHT, z0, z1) for name, (x0, x1, z0, z1, _) in ROOMS.items()]
    air += [("door", x0, x1, 0, DOOR, z0, z1) for x0, x1, z0, z1 in DOORS.values()]
    finish = {("door", "wall"): "trim", ("door", "ceiling"): "trim", ("door", "floor"): "floor"}
    for name, room in ROOMS.items():
        finish[name, "wall"] = room[4]
        finish[name, "ceiling"] = "ceiling"
        finish[name, "floor"] = "floor-tile" if name == "kitchen" else "floor"
    write_shell(out, "apartment", air, finish)
    out.note("Skirtings and door casings")
    out.use("trim")
    out.big_mesh("apartment-skirting", Mesh().append(
        *[moulding(path, -0.001, 0.09, 0.014) for path in SKIRTINGS]))
    casings = Mesh()
    for x0, x1, z0, z1 in DOORS.values():
        across = x1 - x0 > z1 - z0
        width = x1 - x0 if across else z1 - z0
        frame = casework.casing(width, DOOR, 0.12)
        frame = frame if across else frame.turned("y", 90)
        casings.append(frame.moved((x0 + x1) / 2, 0, (z0 + z1) / 2))
    out.big_mesh("apartment-casings", casings)
    out.note("Door leaves, hinged at one jamb")
    leaf = casework.door()
    half = casework.door("half-door", 0.59)
    out.place(half, (2.45, 0, 4.37), -112)
    out.place(half, (3.75, 0, 4.37), -62)
    out.place(leaf, (3.50, 0, 5.87), -102)
    out.place(leaf, (2.25, 0, 5.87), -72)
    out.place(leaf, (6.22, 0, 4.27), 28)
    out.place(leaf, (8.18, 0, 5.76), -150)


def _living(out):
    out.note("Living room")
    out.place(seating.sofa("sofa", 1.95, 2), (1.32, 0, 3.68), 0,
              {"fabric-teal": "fabric-blue"})
    out.place(seating.throw_pillow("pillow", 0.40), (0.82, 0.44, 3.64), 18)
    out.place(seating.throw_pillow("pillow", 0.40), (1.85, 0.44, 3.66), -12,
              {"fabric-mustard": "fabric-rust"})
    out.place(decor.rug("rug", 2.3, 1.7), (1.55, 0, 2.35), 0,
              {"rug-dark": "fabric-blue", "rug-field": "linen"})
    out.place(casework.table("low-table", 0.95, 0.50, 0.40), (1.45, 0.01, 2.55), 4)
    out.place(decor.tray(), (1.36, 0.4095, 2.56), 12)
    out.place(decor.picture("picture-c", 0.9, 0.66, 6, ("leaf", "fabric-teal", "book-ochre")),
              (1.32, 1.58, 4.2))
    out.place(casework.round_table(), (3.42, 0, 2.42))
    for dx, dz, angle in ((-0.30, 0.62, -25), (0.66, 0.10, 95), (-0.52, -0.42, 230)):
        out.place(seating.chair(), (3.42 + dx, 0, 2.42 + dz), angle)
    out.place(decor.metal_bowl(), (3.36, 0.7405, 2.40))
    spheres(out, [("fruit-orange", (3.34, 0.793, 2.43), 0.04),
                  ("fruit-green", (3.41, 0.796, 2.38), 0.038),
                  ("fruit-red", (3.325, 0.7955, 2.35), 0.038)])
    out.place(decor.plant(), (4.58, 0, 3.72))
    out.place(casework.bookshelf("bookcase", 1.15, 2.05, 6, 7), (4.832, 0, 1.25), 90)
    out.place(decor.picture("picture-b", 0.62, 0.46, 2, ("fabric-rust", "book-cream", "glaze")),
              (0, 1.6, 2.2), -90)


def _kitchen(out):
    out.note("Kitchen")
    for z in (0.72, 1.92, 3.12):
        out.place(casework.cupboard("cupboard-low", 1.19, 0.86, 0.58, 2), (8.505, 0, z), 90)
    for z in (0.72, 1.92):
        out.place(casework.cupboard("cupboard-high", 1.19, 0.70, 0.32, 2), (8.638, 1.50, z), 90)
    out.place(casework.worktop("worktop", 3.58), (8.505, 0, 1.92), 90)
    out.place(decor.clay_vase(), (8.5, 0.8945, 3.1))
    out.place(casework.table("kitchen-table", 1.30, 0.80, 0.74), (6.75, 0, 2.45), 90)
    for dx, dz, angle in ((-0.55, -0.3, -90), (-0.57, 0.33, -95), (0.56, 0.02, 84)):
        out.place(seating.chair(), (6.75 + dx, 0, 2.45 + dz), angle,
                  {"fabric-cream": "fabric-rust"})
    out.place(decor.glass_vase(), (6.72, 0.7405, 2.6))
    out.place(seating.stool(), (7.75, 0, 3.4), 20)
    out.place(lamps.pendant(), (6.75, HEIGHT, 2.45))


def _hall_and_bedroom(out):
    out.note("Hall")
    out.place(seating.bench(), (5.1, 0, 4.53), 180)
    out.place(decor.picture("picture-a", 0.50, 0.62, 4, ("fabric-blue", "fabric-mustard")),
              (2.85, 1.55, 5.7))
    out.place(decor.rug("runner", 4.2, 0.8), (4.2, 0, 5.0), 0, {"rug-field": "fabric-teal"})
    out.place(lamps.globe_mount(), (3.5, HEIGHT, 4.95))
    out.note("Bedroom")
    out.place(seating.bed(), (5.38, 0, 8.30))
    for x in (4.30, 6.40):
        out.place(casework.table("night-table", 0.36, 0.36, 0.5), (x, 0, 9.15))
        out.place(lamps.table_lamp(), (x, 0.4995, 9.15))
    out.place(decor.picture("picture-d", 1.1, 0.55, 9, ("fabric-mustard", "fabric-rust", "linen")),
              (5.38, 1.62, 9.4))
    out.place(casework.cupboard("wardrobe", 1.5, 2.1, 0.6, 3), (3.335, 0, 8.0), -90,
              {"white": "wood", "trim": "wood-pale"})
    out.place(decor.rug("rug", 2.3, 1.7), (5.38, 0, 6.75), 0)


def _study_and_store(out):
    out.note("Study")
    out.place(casework.table("desk", 1.4, 0.65, 0.74), (1.3, 0, 9.02))
    out.place(seating.chair(), (1.25, 0, 8.45), 165)
    out.place(lamps.desk_lamp(), (1.72, 0.7395, 9.08), 20)
    out.place(decor.tray(), (0.9, 0.7395, 9.0), -6)
    out.place(casework.bookshelf("bookcase-2", 1.6, 2.2, 6, 11), (0.168, 0, 7.4), -90)
    out.place(seating.sofa("armchair", 0.86, 1), (2.3, 0, 7.2), 65,
              {"fabric-teal": "fabric-mustard"})
    out.note("Store room")
    out.place(casework.bookshelf("bookcase", 1.15, 2.05, 6, 7), (8.63, 0, 7.6), 90)
    out.place(casework.cupboard("cupboard-low", 1.19, 0.86, 0.58, 2), (7.76, 0, 9.09))
    out.place(lamps.ceiling_panel(0.5), (7.76, HEIGHT, 7.6))


def _disk_down(out, name, centre, radius, rgb):
    with out.block(group(name), emission(rgb), translation(centre)):
        out.line("Rotate 90 1 0 0  # the disk's normal, +z, now points down")
        out.line('Shape "disk" "float radius" %g' % radius)


def _lamps(out, strength):
    """strength: one factor on all of these lamps, for the exposure."""
    def times(rgb):
        return tuple(strength * v for v in rgb)

    out.note("The lamps of all rooms but the living room")
    _disk_down(out, "kitchen", (6.75, HEIGHT - 0.86, 2.45), 0.09, times((230, 205, 165)))
    x, dy = lamps.DESK_DISK
    # the lamp is turned by 20 degrees about its foot
    centre = (1.72 + 0.9397 * x, 0.7395 + dy, 9.08 - 0.3420 * x)
    _disk_down(out, "study", centre, 0.04, times((700, 640, 540)))
    globes = [("hall", (3.5, HEIGHT - 0.31, 4.95), 0.10, (42, 38, 32))]
    globes += [("bedroom", (bx, 0.4995 + 0.40, 9.15), 0.045, (190, 150, 100))
               for bx in (4.30, 6.40)]
    for name, centre, radius, rgb in globes:
        with out.block(group(name), emission(times(rgb)), translation(centre)):
            out.line('Shape "sphere" "float radius" %g' % radius)
    with out.block(group("store"), emission(times((30, 30, 30))), translation((7.76, HEIGHT, 7.6))):
        out.mesh(lamps.panel_emitter(0.44))


def write_rooms(project):
    out = SceneText(project, "parts/apartment-rooms.pbrt", [
        "Six furnished rooms, x 0..8.8, y 0..2.6 (up), z 0..9.4: everything but the",
        "emitters; included by apartment.pbrt and apartment-dark.pbrt."])
    _building(out)
    _living(out)
    _kitchen(out)
    _hall_and_bedroom(out)
    _study_and_store(out)
    out.note("The tray of the living room's light")
    out.place(lamps.ceiling_panel(0.8), LIVING_PANEL)
    out.finish()


def write_scene(project, path, comment, panel, strength):
    out = SceneText(project, path, comment)
    out.header(*CAMERA)
    out.include("parts/materials.pbrt")
    out.include("parts/apartment-rooms.pbrt")
    _lamps(out, strength)
    out.note("The living room's ceiling light: " + ("on" if panel else "off"))
    light = [group("living"), emission(panel)] if panel else []
    with out.block(*light, named("white"), translation(LIVING_PANEL)):
        out.mesh(lamps.panel_emitter(0.7))
    out.finish()


def write_all(project):
    write_rooms(project)
    write_scene(project, "apartment.pbrt", [
        "An apartment of six rooms, a lamp in each, seen from the living room.",
        "Through the open door one looks across the hall into the bedroom, at the right into",
        "the kitchen. Light paths that start in the other rooms seldom matter to a pixel:",
        "the case where choosing which shadow rays to trace pays most."], (56.0, 55.0, 54.0), 1.5)
    write_scene(project, "apartment-dark.pbrt", [
        "The same apartment with the lamp of the camera's own room off.",
        "What light there is comes through the doorways from the hall, bedroom and kitchen,",
        "whose lamps are brighter here so that the picture is well exposed."],
        None, 9.0)
