"""The inside surface of rooms, carved out of solid as boxes of air.

All boxes are cut along one common grid and only the faces between air and solid
are kept, so the result is closed, never doubled and free of T-junctions.
"""

import itertools

from geometry import Mesh

# (axis, direction to the neighbour, corner order with the normal into the cell)
_SIDES = (
    ("wall", (-1, 0, 0), ((0, 0, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1))),
    ("wall", (1, 0, 0), ((1, 0, 0), (1, 0, 1), (1, 1, 1), (1, 1, 0))),
    ("floor", (0, -1, 0), ((0, 0, 0), (0, 0, 1), (1, 0, 1), (1, 0, 0))),
    ("ceiling", (0, 1, 0), ((0, 1, 0), (1, 1, 0), (1, 1, 1), (0, 1, 1))),
    ("wall", (0, 0, -1), ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0))),
    ("wall", (0, 0, 1), ((0, 0, 1), (0, 1, 1), (1, 1, 1), (1, 0, 1))),
)


def carve(air_boxes):
    """air_boxes: (tag, x0, x1, y0, y1, z0, z1). Returns {(tag, side): Mesh} with
    side one of wall, floor, ceiling; the first box that holds a cell names it."""
    cuts = []
    for axis in range(3):
        values = {box[1 + 2 * axis] for box in air_boxes}
        values |= {box[2 + 2 * axis] for box in air_boxes}
        cuts.append(sorted(values))

    def tag_of(cell):
        middle = []
        for axis in range(3):
            if not 0 <= cell[axis] < len(cuts[axis]) - 1:
                return None
            middle.append((cuts[axis][cell[axis]] + cuts[axis][cell[axis] + 1]) / 2)
        for box in air_boxes:
            if all(box[1 + 2 * a] < middle[a] < box[2 + 2 * a] for a in range(3)):
                return box[0]
        return None

    meshes = {}
    for cell in itertools.product(*(range(len(values) - 1) for values in cuts)):
        tag = tag_of(cell)
        for side, step, order in _SIDES if tag else ():
            if tag_of([c + s for c, s in zip(cell, step)]) is None:
                corners = [tuple(values[c + o] for values, c, o in zip(cuts, cell, offset)) for offset in order]
                meshes.setdefault((tag, side), Mesh()).face(*corners)
    return meshes
