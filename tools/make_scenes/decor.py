"""Small things: vases, bowls, pictures, plants, rugs, curtains."""

import math
import random

from geometry import Mesh, add, mul
from primitives import box, frame_ring, lathe, polygon, rod, rounded_box, sheet
from writer import Model


def clay_vase(name="clay-vase"):
    """A turned vase 0.34 m high, open, with a wall of 6 mm."""
    outer = [(0, 0), (0.055, 0), (0.06, 0.004), (0.085, 0.05), (0.105, 0.11), (0.10, 0.17),
             (0.07, 0.225), (0.042, 0.265), (0.038, 0.295), (0.056, 0.335)]
    inner = [(r - 0.006, max(y, 0.008)) for r, y in reversed(outer[2:])]
    profile = _curve(outer[:2]) + _curve(outer[2:]) + [(0.054, 0.34)]
    profile += _curve(inner) + [(0, 0.01)]
    return Model(name).part("clay", "glaze", lathe(profile, 40, 55))


def _curve(points, steps=3):
    """Catmull-Rom refinement of a lathe profile."""
    if len(points) < 3:
        return list(points)
    out = []
    for i in range(len(points) - 1):
        p0, p1 = points[max(i - 1, 0)], points[i]
        p2, p3 = points[i + 1], points[min(i + 2, len(points) - 1)]
        for k in range(steps):
            t = k / steps
            out.append(tuple(
                0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t * t
                       + (3 * b - a - 3 * c + d) * t * t * t)
                for a, b, c, d in zip(p0, p1, p2, p3)))
    return out + [points[-1]]


def glass_vase():
    """A small closed glass solid: outside, rim and inside, normals outward."""
    outer = [(0.032, 0.0), (0.040, 0.006), (0.047, 0.04), (0.044, 0.09), (0.034, 0.14),
             (0.036, 0.18), (0.045, 0.21)]
    inner = [(0.0415, 0.2095), (0.0325, 0.18), (0.0305, 0.14), (0.040, 0.09), (0.042, 0.045),
             (0.034, 0.022)]
    profile = [(0, 0)] + _curve(outer) + [(0.0435, 0.212)] + _curve(inner) + [(0, 0.016)]
    return Model("glass-vase").part("glass", "glass", lathe(profile, 40, 50))


def metal_bowl():
    """A wide shallow metal bowl, 0.30 m across."""
    outer = [(0.05, 0.0), (0.052, 0.008), (0.10, 0.028), (0.135, 0.06), (0.15, 0.092)]
    inner = [(0.146, 0.092), (0.131, 0.062), (0.097, 0.032), (0.05, 0.013)]
    profile = [(0, 0)] + _curve(outer) + _curve(inner) + [(0, 0.011)]
    return Model("metal-bowl").part("metal", "metal-bowl", lathe(profile, 48, 50))


def picture(name, width, height, seed, colours):
    """A framed picture of flat shapes, hung with its back on the plane z = 0."""
    bar = 0.03
    model = Model(name)
    model.part("frame", "wood-dark", frame_ring(width, height, bar, 0.028).moved(0, 0, 0.002))
    model.part("mount", "paper", box(-width / 2 + bar - 0.004, width / 2 - bar + 0.004,
                                     -height / 2 + bar - 0.004, height / 2 - bar + 0.004,
                                     -0.008, 0.002))
    rng = random.Random(seed)
    room_x, room_y = width / 2 - bar - 0.05, height / 2 - bar - 0.05
    for i, colour in enumerate(colours):
        size = (0.45 - 0.05 * i) * min(room_x, room_y) * 1.3
        x = (2 * rng.random() - 1) * max(room_x - size, 0.0)
        y = (2 * rng.random() - 1) * max(room_y - size, 0.0)
        shape = polygon((40, 4, 3, 40, 6)[(seed + i) % 5], size, 90 * rng.random())
        model.part("shape%d" % i, colour, shape.moved(x, y, -0.0095 - 0.0015 * i))
    return model


def _leaf(base, azimuth, rise, length, width):
    """An arching leaf as a two-sided sheet with a fold along the middle."""
    c, s = math.cos(azimuth), math.sin(azimuth)

    def point(u, v):
        across = 1 - 2 * v
        half = width * math.sin(math.pi * min(u * 0.94 + 0.06, 1.0)) ** 0.8
        out = length * (0.15 * u + 0.62 * u * u)
        up = rise * (1.9 * u - 1.15 * u * u) + 0.3 * half * abs(across)
        side = half * across
        return add(base, (c * out - s * side, up, s * out + c * side))

    return sheet(point, 10, 4, 45)


def plant(name="plant", leaves=26, size=1.0, seed=3):
    """A leafy plant in a clay pot; size 1 is about 1.2 m high."""
    pot = [(0, -0.001), (0.115, -0.001), (0.12, 0.004), (0.15, 0.24), (0.168, 0.245),
           (0.172, 0.295), (0.155, 0.30), (0.148, 0.27), (0, 0.265)]
    soil = lathe([(0.1505, 0.272), (0, 0.274)], 32)
    rng = random.Random(seed)
    green, stems = Mesh(), Mesh()
    for i in range(leaves):
        share = (i + 0.5) / leaves
        azimuth = 2.399963 * i + 0.3 * rng.random()
        reach = size * (0.85 - 0.35 * share + 0.1 * rng.random())
        rise = size * (0.35 + 0.65 * share)
        root = (0.05 * math.cos(azimuth), 0.27, 0.05 * math.sin(azimuth))
        neck = add(root, (0.05 * math.cos(azimuth) * size, 0.16 * size * (0.5 + share),
                          0.05 * math.sin(azimuth) * size))
        stems.append(rod(root, add(neck, mul((0, 1, 0), 0.01)), 0.005, 0.004, 6))
        green.append(_leaf(neck, azimuth, rise * 0.8, reach, 0.055 * size))
    model = Model(name).part("pot", "clay", lathe(pot, 36, 40)).part("soil", "soil", soil)
    return model.part("stems", "leaf", stems).part("leaves", "leaf", green)


def rug(name, width, depth):
    """A flat rug in three steps of 1.5 mm."""
    def layer(inset, top):
        return box(-width / 2 + inset, width / 2 - inset, -0.001, top,
                   -depth / 2 + inset, depth / 2 - inset)
    model = Model(name).part("edge", "rug-dark", layer(0.0, 0.008))
    model.part("field", "rug-field", layer(0.10, 0.0095))
    return model.part("middle", "rug-pale", layer(0.28, 0.011))


def curtain(name, width, height, seed):
    """A pleated curtain hanging from y = 0 down, in front of the plane z = 0."""
    rng = random.Random(seed)
    phase = 6.28 * rng.random()

    def point(u, v):
        flare = 0.90 + 0.10 * v
        x = width * (u - 0.5) * flare
        fold = math.sin(2 * math.pi * 5 * u + phase + 0.4 * math.sin(3 * v))
        fold += 0.3 * math.sin(2 * math.pi * 11 * u + 1.3 * v)
        return (x, -height * v, -0.075 + 0.032 * fold * (0.6 + 0.4 * v))

    return Model(name).part("cloth", "linen", sheet(point, 80, 6, 80))


def curtain_rail(name, width):
    """A rail with ball ends, 7.5 cm before the plane z = 0."""
    bar = rod((-width / 2, 0, -0.075), (width / 2, 0, -0.075), 0.012)
    ball = [(0.024 * math.sin(math.pi * i / 10), -0.024 * math.cos(math.pi * i / 10))
            for i in range(11)]
    ball[0], ball[10] = (0, -0.024), (0, 0.024)
    ends = [lathe(ball, 16).moved(s * (width / 2 + 0.015), 0, -0.075) for s in (-1, 1)]
    hooks = [box(s * width * 0.44 - 0.008, s * width * 0.44 + 0.008, -0.008, 0.008, -0.07, 0.004)
             for s in (-1, 1)]
    return Model(name).part("rail", "wood-dark", bar, *ends, *hooks)


def window(name, width, height):
    """Frame and glazing bars that fill an opening, standing 3 cm before the
    plane z = 0; the dark pane is the wall behind it."""
    bars = [frame_ring(width + 0.004, height + 0.004, 0.055, 0.035).moved(0, 0, 0.002)]
    bars.append(box(-0.025, 0.025, -height / 2 + 0.01, height / 2 - 0.01, -0.034, 0.002))
    half = width / 2 - 0.01
    bars.append(box(-half, half, height * 0.12 - 0.018, height * 0.12 + 0.018,
                    -0.032, 0.001))
    return Model(name).part("bars", "trim", *bars)


def tray():
    """A low tray with two books and a candle, for a side table."""
    model = Model("tray")
    model.part("tray", "wood-pale", rounded_box(0.36, 0.02, 0.24, 0.008).moved(0, 0.009, 0))
    model.part("book", "book-plum", box(-0.15, 0.03, 0.018, 0.046, -0.09, 0.05).turned("y", 9))
    return model.part("candle", "paper", lathe(
        [(0, 0.018), (0.025, 0.018), (0.025, 0.11), (0.02, 0.112), (0, 0.108)], 24).moved(
            0.11, 0, 0.02))
