"""Measures the error of every renderer in equal CPU time, several times in turn."""

import json
import os
import platform
import re
import statistics
import sys
from typing import NamedTuple

import score
import verify
from renderers import Failed, Job, pixels


class Bench(NamedTuple):
    """The environment, folder, scenes and renderers of a benchmark."""

    environment: object
    program: str
    renderers: list
    scenes: str
    threads: int

    def able(self, scene):
        """Returns the renderers that can describe a scene."""
        return [renderer for renderer in self.renderers if scene in renderer.scenes]

    def job(self, scene, seconds, seed, image):
        return Job(self.environment.path("scenes"), scene, seconds, self.threads, seed, image)

    def image(self, kind, renderer, scene, number):
        """Returns the file of an image."""
        folder = self.environment.path(kind)
        os.makedirs(folder, exist_ok=True)
        name = re.sub(r"[^A-Za-z0-9]+", "-", renderer.name)
        return os.path.join(folder, "%s-%s-%s.exr" % (scene, name, number))


class Record(NamedTuple):
    """One render and its error."""

    renderer: str
    ours: bool
    scene: str
    samples: float
    cpu: float
    wall: float
    relmse: float
    ratio: float

    @property
    def merit(self):
        """Returns relMSE × CPU seconds, which is constant over time for an unbiased renderer."""
        return self.relmse * self.cpu

    @property
    def variance(self):
        """Returns relMSE × samples per pixel, the error of one sample."""
        return self.relmse * self.samples

    @property
    def speed(self):
        """Returns the samples per CPU second."""
        return self.samples * pixels() / self.cpu


def measure(bench, seconds, repetitions):
    """Returns all records. Renderers take turns within each repetition, so that other work of the machine
    affects all of them; another renderer is the first, cold one in each repetition."""
    records, failed = [], set()
    for repetition in range(repetitions):
        for scene in bench.scenes:
            reference = score.Reference.load(scene)
            able = bench.able(scene)
            first = repetition * len(able) // repetitions
            for renderer in able[first:] + able[:first]:
                try:
                    record = _measure(bench, renderer, scene, seconds, repetition, reference)
                except Failed as error:
                    failed.add(renderer.name)
                    print("peers: %s failed: %s" % (renderer.name, error), file=sys.stderr)
                    continue
                records.append(record)
                print("%d/%d  %s  %-32s %8.1f spp  %6.2f s  relMSE %.3e" % (
                    repetition + 1, repetitions, scene, record.renderer, record.samples,
                    record.cpu, record.relmse), file=sys.stderr, flush=True)
    return records, failed


def _measure(bench, renderer, scene, seconds, repetition, reference):
    image = bench.image("bench", renderer, scene, repetition)
    run = renderer.render(bench.job(scene, seconds, repetition, image))
    found = score.compare(bench.program, [run.image], reference)
    return Record(renderer.name, renderer.ours, scene, run.samples, run.cpu, run.wall,
                  score.relmse(found, reference), found["mean_ratio"])


class Row(NamedTuple):
    """Returns medians over the repetitions of one renderer in one scene."""

    renderer: str
    ours: bool
    speed: float
    variance: float
    merit: float
    low: float
    high: float
    ratio: float


def rows(records, scene):
    """Sorts the renderers, the best first."""
    names = dict.fromkeys((r.renderer, r.ours) for r in records if r.scene == scene)
    found = []
    for name, ours in names:
        mine = [r for r in records if r.scene == scene and r.renderer == name]
        merits = [r.merit for r in mine]
        found.append(Row(
            renderer=name,
            ours=ours,
            speed=statistics.median(r.speed for r in mine),
            variance=statistics.median(r.variance for r in mine),
            merit=statistics.median(merits),
            low=min(merits),
            high=max(merits),
            ratio=statistics.mean(r.ratio for r in mine),
        ))
    return sorted(found, key=lambda row: row.merit)


def table(records, scene):
    """Formats the records of a scene as Markdown."""
    lines = ["| scene %s | samples per CPU second | relMSE × samples per pixel "
             "| relMSE × CPU seconds | from, to | mean / reference |" % scene,
             "|---|---:|---:|---:|---:|---:|"]
    for row in rows(records, scene):
        name = "**%s**" % row.renderer if row.ours else row.renderer
        lines.append("| %s | %.3g M | %.3g | %.3g | %.3g, %.3g | %.4f |" % (
            name, row.speed / 1e6, row.variance, row.merit, row.low, row.high, row.ratio))
    return "\n".join(lines)


def verdict(records, scene):
    """Compares the best bidir integrator with the best peer, in a sentence."""
    found = rows(records, scene)
    ours = next((row for row in found if row.ours), None)
    peer = next((row for row in found if not row.ours), None)
    if not (ours and peer):
        return "Scene %s: nothing to compare." % scene
    return "Scene %s: our best, %s, is at %.2f of the best peer, %s; %.2f of its samples per " \
        "second, %.2f of its error per sample." % (
            scene, ours.renderer, ours.merit / peer.merit, peer.renderer,
            ours.speed / peer.speed, ours.variance / peer.variance)


def differing(records):
    """Returns the renderers whose images differ from the reference, as far as these short runs show it;
    `verify` is more sensitive."""
    found = []
    for scene in sorted({r.scene for r in records}):
        for row in rows(records, scene):
            samples = sum(r.samples for r in records
                          if (r.scene, r.renderer) == (scene, row.renderer))
            noise = (row.variance / (samples * pixels())) ** 0.5
            if abs(row.ratio - 1) > verify.RATIO + 5 * noise:
                found.append("%s in %s" % (row.renderer, scene))
    return found


def machine(environment):
    """Describes processor, cores and versions in a line."""
    model = platform.processor() or platform.machine()
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            model = re.search(r"model name\s*: (.*)", file.read())[1]
    except (OSError, TypeError):
        pass
    versions = environment.versions()
    peers = ["%s %s" % (name, versions[name])
             for name in ("mitsuba", "drjit", "pyluxcore", "bpy") if name in versions]
    return "%s, %d cores; %s" % (model, os.cpu_count(), ", ".join(peers))


def save(path, records):
    with open(path, "w", encoding="utf-8") as file:
        json.dump([record._asdict() for record in records], file, indent=1)
