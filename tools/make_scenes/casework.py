"""Tables, shelves with books, cupboards and doors."""

import random

from geometry import Mesh
from primitives import box, lathe, rod, rounded_box, slab
from writer import Model

BOOKS = ("book-red", "book-green", "book-blue", "book-ochre", "book-cream", "book-plum")


def round_table(name="round-table", radius=0.55):
    """A round pedestal table, top at 0.74 m."""
    top = lathe([(0, 0.705), (radius - 0.02, 0.705), (radius, 0.715), (radius, 0.732),
                 (radius - 0.006, 0.74), (0, 0.74)], 48)
    foot = lathe([(0, -0.001), (0.30, -0.001), (0.30, 0.02), (0.22, 0.035), (0.09, 0.06),
                  (0.05, 0.12), (0.04, 0.30), (0.055, 0.42), (0.045, 0.56), (0.07, 0.66),
                  (0.16, 0.71), (0, 0.71)], 32, 50)
    return Model(name).part("top", "wood", top).part("foot", "wood", foot)


def table(name, width, depth, height):
    """A rectangular table with tapered legs."""
    parts = [rounded_box(width, 0.03, depth, 0.01).moved(0, height - 0.015, 0)]
    x, z = width / 2 - 0.05, depth / 2 - 0.05
    parts += [rod((sx * x, -0.001, sz * z), (sx * x, height - 0.02, sz * z), 0.014, 0.026)
              for sx in (-1, 1) for sz in (-1, 1)]
    for s in (-1, 1):
        parts.append(box(-x, x, height - 0.09, height - 0.024, s * z - 0.01, s * z + 0.01))
        parts.append(box(s * x - 0.01, s * x + 0.01, height - 0.088, height - 0.025, -z, z))
    return Model(name).part("wood", "wood", *parts)


def _book_row(rng, books, x0, x1, y, depth, height):
    """Books on one shelf: mostly upright, with a gap and a lying pile."""
    x = x0
    end = x1 - (x1 - x0) * (0.05 + 0.35 * rng.random())
    while True:
        width = 0.018 + 0.035 * rng.random()
        if x + width > end:
            break
        tall = height * (0.62 + 0.33 * rng.random())
        deep = depth * (0.68 + 0.24 * rng.random())
        colour = BOOKS[int(rng.random() * len(BOOKS))]
        books[colour].append(box(x, x + width, y - 0.001, y + tall,
                                 depth / 2 - deep, depth / 2 - 0.012))
        x += width + 0.0015
    if x1 - x > 0.27:
        level = y
        for _ in range(2 + int(3 * rng.random())):
            thick = 0.02 + 0.025 * rng.random()
            lying = slab(0, 0, 0, 0.19 + 0.03 * rng.random(), thick, depth * 0.6)
            lying = lying.turned("y", 14 * rng.random() - 7)
            colour = BOOKS[int(rng.random() * len(BOOKS))]
            books[colour].append(lying.moved((x + x1) / 2, level - 0.001, 0))
            level += thick + 0.0005
    return x


def bookshelf(name, width, height, shelves, seed):
    """A bookcase 0.3 m deep, filled with books."""
    depth, t = 0.30, 0.022
    case = [box(s * (width / 2 - t / 2) - t / 2, s * (width / 2 - t / 2) + t / 2,
                -0.001, height, -depth / 2, depth / 2) for s in (-1, 1)]
    inner = width / 2 - t
    case.append(box(-inner - 0.003, inner + 0.003, 0.072, height - 0.022,
                    depth / 2 - 0.010, depth / 2 - 0.002))
    rng = random.Random(seed)
    books = {colour: Mesh() for colour in BOOKS}
    step = (height - 0.09 - t) / shelves
    for i in range(shelves + 1):
        y = 0.07 + i * step
        case.append(box(-inner - 0.004, inner + 0.004, y, y + t,
                        -depth / 2 + 0.004, depth / 2 - 0.004))
        if i < shelves:
            _book_row(rng, books, -inner + 0.004, inner - 0.004, y + t, depth, step - t)
    model = Model(name).part("case", "wood", *case)
    for colour in BOOKS:
        if books[colour].triangles:
            model.part(colour, colour, books[colour])
    return model


def cupboard(name, width, height, depth, doors, knob="metal-brass"):
    """A plain cupboard with panelled doors on the front (-z)."""
    body = [box(-width / 2, width / 2, -0.001, height, -depth / 2, depth / 2)]
    front, knobs = [], []
    step = width / doors
    for i in range(doors):
        x = -width / 2 + step * (i + 0.5)
        front.append(box(x - step / 2 + 0.006, x + step / 2 - 0.006, 0.07, height - 0.03,
                         -depth / 2 - 0.018, -depth / 2 + 0.002))
        front.append(box(x - step / 2 + 0.07, x + step / 2 - 0.07, 0.14, height - 0.10,
                         -depth / 2 - 0.024, -depth / 2 - 0.010))
        side = 1 if i % 2 == 0 else -1
        kx, ky, kz = x + side * (step / 2 - 0.038), height * 0.55, -depth / 2 - 0.018
        knobs.append(rod((kx, ky, kz + 0.004), (kx, ky, kz - 0.022), 0.007, 0.012))
    model = Model(name).part("body", "white", *body).part("doors", "trim", *front)
    return model.part("knobs", knob, *knobs)


def worktop(name, width):
    """A kitchen counter top with a splash strip, for cupboards 0.86 m high."""
    top = [rounded_box(width + 0.02, 0.04, 0.64, 0.008).moved(0, 0.875, -0.02),
           box(-width / 2, width / 2, 0.89, 0.99, 0.27, 0.300)]
    return Model(name).part("slab", "wood-pale", *top)


def door(name="door", width=0.86, height=2.04):
    """A door leaf hinged at the origin, reaching to +x when closed."""
    leaf = [box(0, width, 0.006, height, -0.02, 0.02)]
    for y0, y1 in ((0.18, 0.88), (1.04, height - 0.16)):
        for s in (-1, 1):
            leaf.append(box(0.13, width - 0.13, y0, y1, s * 0.022 - 0.005, s * 0.022 + 0.005))
    handle = []
    x = width - 0.07
    for s in (-1, 1):
        handle.append(rod((x, 1.0, s * 0.015), (x, 1.0, s * 0.065), 0.01))
        handle.append(rod((x + 0.01, 1.0, s * 0.062), (x - 0.11, 1.0, s * 0.062), 0.009))
    return Model(name).part("leaf", "trim", *leaf).part("handle", "metal-brass", *handle)


def casing(width, height, depth):
    """The frame of a doorway of the given opening, centred on x = 0 and on the
    middle of a wall of the given thickness; 8 mm lip into the opening."""
    mesh = Mesh()
    for s in (-1, 1):
        z0, z1 = sorted((s * (depth / 2 - 0.005), s * (depth / 2 + 0.018)))
        for side in (-1, 1):
            x0, x1 = sorted((side * (width / 2 - 0.008), side * (width / 2 + 0.07)))
            mesh.append(box(x0, x1, -0.001, height + 0.02, z0, z1))
        mesh.append(box(-width / 2 - 0.075, width / 2 + 0.075, height - 0.008, height + 0.075,
                        z0 - 0.002, z1 + 0.002))
    return mesh
