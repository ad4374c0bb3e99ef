"""Checks this tool without any peer: writes all scenes, renders each, and measures the error."""

import os
import sys
import tempfile

import neutral
from bench import record
from renderers import Job, Ours

PASSES = 8
RATIO = 0.005  # more than four standard errors with this number of passes


def check(program):
    """Returns an exit code."""
    here = os.path.dirname(os.path.abspath(__file__))
    for name in sorted(os.listdir(here)):
        if name.endswith(".py"):
            with open(os.path.join(here, name), encoding="utf-8") as file:
                compile(file.read(), name, "exec")
    good = True
    with tempfile.TemporaryDirectory() as folder:
        neutral.write(folder)
        for scene in neutral.SCENES:
            good &= _check(program, folder, scene)
    return 0 if good else 1


def _check(program, folder, scene):
    ours, image = Ours(program, "bdpt"), os.path.join(folder, scene + ".exr")
    found = record(program, ours, scene, ours.passes(Job(folder, scene, 0.0, os.cpu_count(), 0, image), PASSES))
    good = abs(found.ratio - 1) <= RATIO and 0 < found.variance < 2
    print("scene %s: %d samples per pixel, mean / reference %.4f, relMSE × CPU seconds %.3g%s" % (
        scene, found.samples, found.ratio, found.merit, "" if good else ": WRONG"),
        file=sys.stdout if good else sys.stderr)
    return good
