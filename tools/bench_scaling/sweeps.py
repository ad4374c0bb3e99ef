"""The varied quantities, and their tables."""

import os
from typing import NamedTuple

from runs import Case

METHODS = ("path", "bdpt")
ONE_THREAD = ("--threads", "1")


class Sweep(NamedTuple):
    """Cases by size, and the columns beside the speeds: names, and a function of the size and of
    the costs by method."""

    title: str
    size: str
    cases: list
    columns: list
    values: object

    def table(self, costs):
        """Formats the costs as Markdown."""
        methods = list(dict.fromkeys(case.method for case in self.cases))
        speeds = [name for method in methods
                  for name in ("`%s`, samples per second" % method, "of the first")]
        head = [self.size] + speeds + self.columns
        lines = ["| %s |" % " | ".join(head), "|" + "---:|" * len(head)]
        sizes = list(dict.fromkeys(case.size for case in self.cases))
        first = {method: costs[sizes[0], method] for method in methods}
        for size in sizes:
            at = {method: costs[size, method] for method in methods}
            cells = [amount(size)] + _speeds(at, first) + self.values(size, at)
            lines.append("| %s |" % " | ".join(cells))
        return "\n".join(lines)


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


def _cases(size, scene, *flags):
    return [Case(size, method, scene, flags) for method in METHODS]


def threads(worlds, scenes):
    """Powers of two up to the number of processors."""
    del worlds
    scene = os.path.join(scenes, "room-indirect.pbrt")
    counts = [1 << i for i in range(os.cpu_count().bit_length()) if 1 << i <= os.cpu_count()]
    cases = [case for count in counts
             for case in _cases(count, scene, "--threads", str(count), "--size", "160x120")]
    return Sweep("Threads: `room-indirect`, 160 x 120", "threads", cases, [], lambda *_: [])


def triangles(worlds, scenes):
    """One mesh of more and more triangles."""
    del scenes
    built = [worlds.triangles(10 ** i) for i in range(2, 7)]
    cases = [case for scene, count in built for case in _cases(count, scene, *ONE_THREAD)]
    return Sweep("Triangles: a terrain in a box", "triangles", cases,
                 ["load (s)", "tree (bytes per triangle)", "peak of memory (MB)"],
                 lambda size, at: [_load(at), "%.0f" % (at["path"].bvh_bytes / size), _peak(at)])


def instances(worlds, scenes):
    """One mesh at more and more places."""
    del scenes
    built = [worlds.instances(places) for places in (1, 10, 100, 1000, 10000)]
    cases = [case for scene, count in built for case in _cases(count, scene, *ONE_THREAD)]
    return Sweep("Instances: a terrain of 968 triangles, at 1 to 10 000 places",
                 "triangles placed", cases,
                 ["load (s)", "tree (MB)", "peak of memory (MB)"],
                 lambda _, at: [_load(at), "%.2f" % (at["path"].bvh_bytes / 1e6), _peak(at)])


def resolution(worlds, scenes):
    """More and more pixels, one sample of each."""
    del worlds
    scene = os.path.join(scenes, "cornell.pbrt")
    flags = ONE_THREAD + ("--max-depth", "1", "--spp", "1", "--size")
    cases = [Case(side * side, "path", scene, flags + ("%dx%d" % (side, side),))
             for side in (128, 256, 512, 1024)]
    return Sweep("Resolution: `cornell`, one pass of one bounce", "pixels", cases,
                 ["film (bytes per pixel)", "peak of memory (MB)", "peak (bytes per pixel)"],
                 lambda size, at: ["%.0f" % (at["path"].film_bytes / size), _peak(at),
                                   "%.0f" % (at["path"].peak_bytes / size)])


def lamps(worlds, scenes):
    """More and more lamps of the same power together."""
    del scenes
    built = [worlds.lamps(10 ** i) for i in range(6)]
    cases = [case for scene, count in built for case in _cases(count, scene, *ONE_THREAD)]
    return Sweep("Lights: triangles that emit, of the same power together", "lights", cases,
                 ["load (s)", "peak of memory (MB)"], lambda _, at: [_load(at), _peak(at)])


def hall(worlds, scenes):
    """More and more lamps, each of which lights what is near."""
    del scenes
    built = [worlds.hall(10 ** i) for i in range(6)]
    cases = [case for scene, count in built for case in _cases(count, scene, *ONE_THREAD)]
    return Sweep("Lights all over a hall, of the same power together", "lights", cases,
                 ["load (s)", "peak of memory (MB)"], lambda _, at: [_load(at), _peak(at)])


def length(worlds, scenes):
    """Longer and longer paths; none ends by chance."""
    del scenes
    scene, _ = worlds.lamps(1)
    cases = [case for depth in (1, 2, 4, 8, 16)
             for case in _cases(depth, scene, *ONE_THREAD, "--max-depth", str(depth),
                                "--path-roulette", "off")]
    def nanoseconds(_, at):
        rays = [cost.rays_per_sample for cost in at.values()]
        speeds = [cost.samples_per_second for cost in at.values()]
        return ["%.1f, %.1f" % tuple(rays),
                "%.0f, %.0f" % tuple(1e9 / (speed * ray) for speed, ray in zip(speeds, rays))]
    return Sweep("Length of paths: an empty box, no roulette", "bounces", cases,
                 ["rays per sample, of both", "ns per ray, of both"], nanoseconds)


SWEEPS = {"threads": threads, "triangles": triangles, "instances": instances,
          "resolution": resolution, "lights": lamps, "hall": hall,
          "length": length}


def _load(at):
    return "%.2f" % at["path"].load_seconds


def _peak(at):
    return "%.0f" % (at["path"].peak_bytes / 1e6)
