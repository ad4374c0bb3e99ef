"""Lamp bodies. The emitters are written by the scenes, since a lamp may be off."""

import math

from geometry import Mesh
from primitives import box, lathe, rod
from writer import Model

# the uplighter: height of its rim and of the emitting disk inside the bowl
UPLIGHT_RIM = 1.95
UPLIGHT_DISK = 1.74
UPLIGHT_RADIUS = 0.06


def uplighter():
    """A floor lamp whose deep opaque bowl is open only at the top."""
    rim = UPLIGHT_RIM
    outer = [(0.03, rim - 0.26), (0.07, rim - 0.245), (0.105, rim - 0.19), (0.13, rim - 0.10),
             (0.145, rim)]
    inner = [(0.139, rim), (0.124, rim - 0.10), (0.10, rim - 0.185), (0.075, rim - 0.22),
             (0.0, rim - 0.225)]
    foot = lathe([(0, -0.001), (0.14, -0.001), (0.14, 0.018), (0.12, 0.028), (0.02, 0.04),
                  (0, 0.04)], 36)
    pole = rod((0, 0.03, 0), (0, rim - 0.24, 0), 0.012)
    model = Model("uplighter").part("stand", "black", foot, pole)
    model.part("bowl", "brass-paint", lathe([(0, rim - 0.26)] + outer, 48, 50))
    return model.part("lining", "white", lathe([outer[-1]] + inner, 48, 50))


def ceiling_panel(size):
    """The tray of a square ceiling light; hangs from y = 0."""
    tray = box(-size / 2, size / 2, -0.05, 0.003, -size / 2, size / 2)
    return Model("ceiling panel").part("tray", "trim", tray)


def panel_emitter(size):
    """A square of light 4 mm under the tray of a ceiling panel, facing down."""
    h, y = size / 2, -0.054
    return Mesh().face((-h, y, -h), (h, y, -h), (h, y, h), (-h, y, h))


def pendant():
    """A conical lamp shade on a cord; hangs from y = 0, its rim at -0.95. The
    disk of light belongs at -0.86, facing down."""
    shade = [(0.02, -0.70), (0.05, -0.70), (0.06, -0.72), (0.20, -0.95), (0.196, -0.95),
             (0.055, -0.725), (0.02, -0.715)]
    outside = lathe(list(reversed(shade[:4])) + [(0, -0.70)], 40, 40)
    inside = lathe([(0, -0.715)] + list(reversed(shade[4:])) + [shade[3]], 40, 40)
    cord = rod((0, -0.71, 0), (0, 0.002, 0), 0.004, segments=8)
    rose = lathe([(0, -0.03), (0.05, -0.025), (0.055, 0.002), (0, 0.002)], 24)
    model = Model("pendant").part("shade", "black", outside, cord)
    return model.part("lining", "white", inside).part("rose", "white", rose)


def globe_mount():
    """A short rod and rose for a globe lamp; hangs from y = 0 to -0.22."""
    rose = lathe([(0, -0.03), (0.06, -0.025), (0.065, 0.002), (0, 0.002)], 24)
    return Model("globe-mount").part("mount", "brass-paint", rose,
                                     rod((0, -0.225, 0), (0, -0.02, 0), 0.008))


def table_lamp():
    """A lamp with an open tubular shade; a globe of radius 0.045 belongs at
    height 0.40. Stands on y = 0."""
    foot = [(0, -0.001), (0.07, -0.001), (0.075, 0.01), (0.05, 0.04), (0.065, 0.10),
            (0.05, 0.18), (0.02, 0.23), (0.012, 0.25), (0.012, 0.34), (0, 0.34)]
    shade = [(0.15, 0.29), (0.105, 0.51), (0.102, 0.51), (0.147, 0.29), (0.15, 0.29)]
    spokes = [rod((0, 0.33, 0), (0.14 * math.cos(a), 0.30, 0.14 * math.sin(a)), 0.003, segments=6)
              for a in (0.3, 2.394, 4.489)]
    model = Model("table-lamp").part("foot", "clay", lathe(foot, 32, 50))
    return model.part("shade", "linen", lathe(shade, 40, 40), *spokes)


def desk_lamp():
    """A jointed lamp; the disk of light belongs at DESK_DISK, facing down."""
    arm = [lathe([(0, -0.001), (0.08, -0.001), (0.08, 0.015), (0, 0.02)], 28),
           rod((0, 0.01, 0), (0.10, 0.30, 0), 0.007),
           rod((0.10, 0.30, 0), (-0.12, 0.44, 0), 0.007)]
    head = [(0.015, 0.46), (0.03, 0.455), (0.08, 0.37), (0.077, 0.37), (0.028, 0.445), (0, 0.446)]
    outside = lathe(list(reversed(head[:3])) + [(0, 0.46)], 32, 40)
    inside = lathe(list(reversed(head[3:])) + [head[2]], 32, 40)
    shade = Mesh().append(outside, inside).moved(-0.14, 0, 0)
    return Model("desk-lamp").part("arm", "black", *arm).part("shade", "fabric-rust", shade)


DESK_DISK = (-0.14, 0.41)
