"""Sofas, armchairs, chairs, stools and beds."""

from primitives import box, cushion, rod, rounded_box
from writer import Model


def _feet(width, depth, height, radius):
    x, z = width / 2 - 0.08, depth / 2 - 0.08
    return [rod((sx * x, -0.001, sz * z), (sx * x, height, sz * z), radius * 0.6, radius)
            for sx in (-1, 1) for sz in (-1, 1)]


def sofa(name, width, seats):
    """A sofa, or an armchair with one seat: 0.9 m deep, 0.84 m high."""
    arm = 0.17
    inner = (width - 2 * arm) / seats
    middles = [-(width / 2 - arm) + inner * (i + 0.5) for i in range(seats)]
    frame = [rounded_box(width - 0.03, 0.22, 0.80, 0.03).moved(0, 0.215, 0.02),
             rounded_box(width - 0.05, 0.62, 0.18, 0.07).turned("x", 9).moved(0, 0.52, 0.37)]
    frame += [rounded_box(arm, 0.50, 0.86, 0.065).moved(side * (width - arm) / 2, 0.36, 0.0) for side in (-1, 1)]
    seat = [cushion(inner - 0.01, 0.13, 0.66, 0.03).moved(x, 0.395, -0.09) for x in middles]
    back = [cushion(inner - 0.03, 0.13, 0.44, 0.035).turned("x", 104).moved(x, 0.67, 0.22)
            for x in middles]
    model = Model(name)
    model.part("feet", "wood-dark", *_feet(width, 0.8, 0.14, 0.025))
    model.part("frame", "fabric-teal", *frame)
    model.part("seat", "fabric-teal", *seat, *back)
    return model


def throw_pillow(name, size):
    """A square pillow leaning back a little, standing on its edge."""
    pillow = cushion(size, 0.04, size, 0.045).turned("x", 112)
    return Model(name).part("cover", "fabric-mustard", pillow.moved(0, size * 0.47, 0))


def chair():
    """A dining chair with a slatted back, seat at 0.46 m."""
    wood = [rounded_box(0.43, 0.035, 0.42, 0.012).moved(0, 0.455, 0)]
    for side in (-1, 1):
        wood.append(rod((side * 0.19, -0.001, -0.185), (side * 0.185, 0.45, -0.17), 0.014, 0.02))
        wood.append(rod((side * 0.19, -0.001, 0.22), (side * 0.185, 0.46, 0.18), 0.014, 0.02))
        wood.append(rod((side * 0.185, 0.44, 0.18), (side * 0.18, 0.92, 0.245), 0.019, 0.013))
    wood += [rounded_box(0.36, 0.055, 0.014, 0.006).turned("x", 8).moved(0, y, z)
             for y, z in ((0.89, 0.241), (0.78, 0.226), (0.67, 0.211))]
    pad = rounded_box(0.39, 0.03, 0.37, 0.014).moved(0, 0.481, -0.005)
    return Model("chair").part("frame", "wood", *wood).part("pad", "fabric-cream", pad)


def stool():
    """A round-legged bar stool, seat at 0.66 m."""
    legs = [rod((sx * 0.17, -0.001, sz * 0.17), (sx * 0.11, 0.64, sz * 0.11), 0.012, 0.017)
            for sx in (-1, 1) for sz in (-1, 1)]
    legs += [rod((-0.145, 0.25, s * 0.146), (0.145, 0.25, s * 0.146), 0.009) for s in (-1, 1)]
    seat = rounded_box(0.34, 0.05, 0.34, 0.022).moved(0, 0.655, 0)
    return Model("stool").part("legs", "wood-pale", *legs).part("seat", "fabric-rust", seat)


def bed():
    """A double bed, 1.6 x 2.05 m, its head at +z."""
    frame = [rounded_box(1.62, 0.16, 2.02, 0.02).moved(0, 0.24, 0),
             rounded_box(1.66, 0.75, 0.07, 0.03).moved(0, 0.54, 1.01)]
    frame += _feet(1.6, 2.0, 0.2, 0.03)
    mattress = rounded_box(1.56, 0.20, 1.94, 0.06).moved(0, 0.40, -0.02)
    blanket = rounded_box(1.65, 0.22, 1.25, 0.05).moved(0, 0.42, -0.39)
    fold = rounded_box(1.655, 0.05, 0.26, 0.022).moved(0, 0.512, 0.18)
    pillows = [cushion(0.62, 0.07, 0.40, 0.05).turned("x", -18).moved(s * 0.38, 0.58, 0.72)
               for s in (-1, 1)]
    model = Model("bed")
    model.part("frame", "wood", *frame).part("mattress", "white", mattress)
    model.part("blanket", "fabric-blue", blanket).part("fold", "linen", fold)
    return model.part("pillows", "white", *pillows)


def bench():
    """A low hall bench with a cushion."""
    wood = [box(-0.5, 0.5, 0.40, 0.44, -0.17, 0.17)]
    wood += [box(side * 0.44 - 0.02, side * 0.44 + 0.02, -0.001, 0.405, -0.15, 0.15) for side in (-1, 1)]
    pad = rounded_box(0.96, 0.05, 0.32, 0.02).moved(0, 0.464, 0)
    return Model("bench").part("frame", "wood-pale", *wood).part("pad", "fabric-rust", pad)
