"""Scale and place: the same room from 1e-9 to 1e9 units, and far from the origin, has the same light.

Scales and offsets come from transforms or are written into the points. The mean of the image by every
estimator agrees within 1 % with that of the room of two units by path tracing.
"""

import os

import commands
import exr
import runs
from worlds import LAMP, WALLS

LIMITS = runs.Limits(cpu=120, wall=600)
ESTIMATORS = ("path", "light", "bdpt", "lvc", "auto")
DECADES = [10.0 ** decade for decade in range(-9, 10)]
OFFSETS = [10.0 ** decade for decade in range(0, 8)]
DIRECTIONS = ((1, 0, 0), (0, 1, 0), (-1, 2, 3))
TOLERANCE = 0.01
# Samples of a pixel: the means of 24 × 24 pixels then have standard errors of about two thousandths.
SPP = {"path": 512, "light": 1024, "bdpt": 256, "lvc": 256, "auto": 256}
SCENE = """%sCamera "perspective" "float fov" 45
Film "rgb" "integer xresolution" 24 "integer yresolution" 24
WorldBegin
%s%s
"""


def scaled_by_transform(scale):
    view = "LookAt 0 %r %r 0 %r 0 0 1 0\n" % (scale, -3.7 * scale, scale)
    return SCENE % (view, "Scale %r %r %r\n" % (scale, scale, scale), LAMP + WALLS)


def scaled_points(scale):
    """Every number of the points is multiplied."""
    view = "LookAt 0 %r %r 0 %r 0 0 1 0\n" % (scale, -3.7 * scale, scale)
    return SCENE % (view, "", points(LAMP + WALLS, scale))


def points(text, scale):
    pieces = text.split('"point3 P" [')
    for i, piece in enumerate(pieces[1:], 1):
        numbers, rest = piece.split("]", 1)
        pieces[i] = " ".join("%r" % (scale * float(number)) for number in numbers.split()) + "]" + rest
    return '"point3 P" ['.join(pieces)


def moved(offset):
    """Camera and room are both moved by transforms, whose numbers are exact."""
    back = "Translate %r %r %r\n" % tuple(-value for value in offset)
    return SCENE % ("LookAt 0 1 -3.7 0 1 0 0 1 0\n" + back, "Translate %r %r %r\n" % tuple(offset), LAMP + WALLS)


def scenes():
    """Titles and texts of all cases."""
    found = []
    for scale in DECADES:
        found.append(("scaled by %g by a transform" % scale, scaled_by_transform(scale)))
        found.append(("scaled by %g in its points" % scale, scaled_points(scale)))
    for offset in OFFSETS:
        for direction in DIRECTIONS:
            vector = [offset * value for value in direction]
            found.append(("moved by %g, %g, %g" % tuple(vector), moved(vector)))
    return found


def render(work, text, estimator, folder):
    """Returns the mean of the image, the fault and the command."""
    flags = ("--integrator", estimator, "--spp", SPP[estimator], "--seed", work.options.seed % 1000)
    ended = commands.render(work, text, folder, flags, LIMITS)
    if ended.wrong(0):
        return None, "%s: %s" % (ended.wrong(0), ended.said.strip()), ended.command
    return exr.mean(os.path.join(folder, "a.exr")), None, ended.command


def run(work):
    with work.folder() as folder:
        right, fault, command = render(work, scaled_points(1.0), "path", folder)
        work.case("the room of two units", fault, folder, command)
    if fault:
        return
    cases = [(title, text, estimator) for title, text in scenes() for estimator in ESTIMATORS]
    if work.count() < len(cases):
        cases = work.random.sample(cases, work.count())
    for title, text, estimator in cases:
        with work.folder() as folder:
            mean, fault, command = render(work, text, estimator, folder)
            if not fault and not abs(mean / right - 1) <= TOLERANCE:
                fault = "the mean is %.4f of that of the room of two units" % (mean / right)
            work.case("%s, %s" % (title, estimator), fault, folder, command)
