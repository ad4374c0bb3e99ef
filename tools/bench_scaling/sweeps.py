"""The varied quantities, and their tables."""

import os
from typing import NamedTuple

import harness
from runs import Case

METHODS = ("path", "bdpt")
ONE_THREAD = ("--threads", "1")


class Sweep(NamedTuple):
    """Cases by size, and the columns beside the speeds: functions of the size and of the costs by method."""

    title: str
    size: str
    cases: list
    columns: dict

    def table(self, costs):
        """Formats the costs as Markdown."""
        methods = list(dict.fromkeys(case.method for case in self.cases))
        speeds = [name for method in methods for name in ("`%s`, samples per second" % method, "of the first")]
        sizes = list(dict.fromkeys(case.size for case in self.cases))
        first = {method: costs[sizes[0], method] for method in methods}
        rows = []
        for size in sizes:
            at = {method: costs[size, method] for method in methods}
            rows.append([amount(size), *_speeds(at, first),
                         *(value(size, at) for value in self.columns.values())])
        return harness.table([self.size, *speeds, *self.columns], rows)


def _speeds(at, first):
    cells = []
    for method in at:
        speed = at[method].samples_per_second
        cells += [amount(speed), "%.2f" % (speed / first[method].samples_per_second)]
    return cells


def amount(number):
    """Formats a number with three digits, and with k or M."""
    for unit, letter in ((1e6, " M"), (1e3, " k")):
        # Numbers that round to 1000 get the next unit.
        if number >= 0.9995 * unit:
            return "%.3g%s" % (number / unit, letter)
    return "%.3g" % number


LOAD = {"load (s)": lambda _, at: "%.2f" % at["path"].load_seconds}
PEAK = {"peak of memory (MB)": lambda _, at: "%.0f" % (at["path"].peak_bytes / 1e6)}


def _cases(size, scene, *flags):
    return [Case(size, method, scene, flags) for method in METHODS]


def _own(name):
    return harness.ROOT / "scenes" / (name + ".pbrt")


def _growing(title, size, built, columns):
    """A sweep over generated scenes with their sizes, on one thread."""
    return Sweep(title, size, [case for scene, count in built for case in _cases(count, scene, *ONE_THREAD)],
                 columns)


def threads(_worlds):
    """Powers of two up to the number of processors."""
    counts = [1 << i for i in range(os.cpu_count().bit_length()) if 1 << i <= os.cpu_count()]
    cases = [case for count in counts for case in _cases(
        count, _own("room-indirect"), "--threads", str(count), "--size", "160x120")]
    return Sweep("Threads: `room-indirect`, 160 x 120", "threads", cases, {})


def triangles(worlds):
    """One mesh of more and more triangles."""
    per_triangle = {"tree (bytes per triangle)": lambda size, at: "%.0f" % (at["path"].bvh_bytes / size)}
    return _growing("Triangles: a terrain in a box", "triangles",
                    [worlds.triangles(10 ** i) for i in range(2, 7)], LOAD | per_triangle | PEAK)


def instances(worlds):
    """One mesh at more and more places."""
    tree = {"tree (MB)": lambda _, at: "%.2f" % (at["path"].bvh_bytes / 1e6)}
    return _growing("Instances: a terrain of 968 triangles, at 1 to 10 000 places", "triangles placed",
                    [worlds.instances(10 ** i) for i in range(5)], LOAD | tree | PEAK)


def resolution(_worlds):
    """More and more pixels, one sample of each."""
    flags = (*ONE_THREAD, "--max-depth", "1", "--spp", "1", "--size")
    cases = [Case(side * side, "path", _own("cornell"), (*flags, "%dx%d" % (side, side)))
             for side in (128, 256, 512, 1024)]
    film = {"film (bytes per pixel)": lambda size, at: "%.0f" % (at["path"].film_bytes / size)}
    peak = {"peak (bytes per pixel)": lambda size, at: "%.0f" % (at["path"].peak_bytes / size)}
    return Sweep("Resolution: `cornell`, one pass of one bounce", "pixels", cases, film | PEAK | peak)


def lamps(worlds):
    """More and more lamps of the same power together."""
    return _growing("Lights: triangles that emit, of the same power together", "lights",
                    [worlds.lamps(10 ** i) for i in range(6)], LOAD | PEAK)


def hall(worlds):
    """More and more lamps, each of which lights what is near."""
    return _growing("Lights all over a hall, of the same power together", "lights",
                    [worlds.hall(10 ** i) for i in range(6)], LOAD | PEAK)


def length(worlds):
    """Longer and longer paths; none ends by chance."""
    scene, _ = worlds.lamps(1)
    cases = [case for depth in (1, 2, 4, 8, 16) for case in _cases(
        depth, scene, *ONE_THREAD, "--max-depth", str(depth), "--path-roulette", "off")]
    rays = {"rays per sample, of both": lambda _, at: ", ".join(
        "%.1f" % cost.rays_per_sample for cost in at.values())}
    times = {"ns per ray, of both": lambda _, at: ", ".join(
        "%.0f" % (1e9 / (cost.samples_per_second * cost.rays_per_sample)) for cost in at.values())}
    return Sweep("Length of paths: an empty box, no roulette", "bounces", cases, rays | times)


SWEEPS = {"threads": threads, "triangles": triangles, "instances": instances, "resolution": resolution,
          "lights": lamps, "hall": hall, "length": length}
