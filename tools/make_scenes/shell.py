"""The inside surface of rooms, carved out of solid as boxes of air.

All boxes are cut along one common grid and only the faces between air and solid
are kept, so the result is closed, never doubled and free of T-junctions.
"""

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
    for i in range(len(cuts[0]) - 1):
        for j in range(len(cuts[1]) - 1):
            for k in range(len(cuts[2]) - 1):
                tag = tag_of((i, j, k))
                if tag is None:
                    continue
                for side, step, order in _SIDES:
                    if tag_of((i + step[0], j + step[1], k + step[2])) is None:
                        corners = [(cuts[0][i + a], cuts[1][j + b], cuts[2][k + c])
                                   for a, b, c in order]
                        meshes.setdefault((tag, side), Mesh()).face(*corners)
    return meshes
