"""Measures the error of every renderer in equal CPU time, several times in turn."""

import json
import os
import re
import statistics
import sys
from pathlib import Path
from typing import NamedTuple

import harness
import score
import verify
from renderers import Job, pixels


class Bench(NamedTuple):
    """The environment, program, renderers and scenes of a benchmark."""

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
            able = bench.able(scene)
            first = repetition * len(able) // repetitions
            for renderer in able[first:] + able[:first]:
                try:
                    record = _measure(bench, renderer, scene, seconds, repetition)
                except harness.Failed as error:
                    failed.add(renderer.name)
                    print("peers: %s failed: %s" % (renderer.name, error), file=sys.stderr)
                    continue
                records.append(record)
                print("%d/%d  %s  %-32s %8.1f spp  %6.2f s  relMSE %.3e" % (
                    repetition + 1, repetitions, scene, record.renderer, record.samples,
                    record.cpu, record.relmse), file=sys.stderr, flush=True)
    return records, failed


def _measure(bench, renderer, scene, seconds, repetition):
    image = bench.image("bench", renderer, scene, repetition)
    run = renderer.render(bench.job(scene, seconds, repetition, image))
    return record(bench.program, renderer, scene, run)


def record(program, renderer, scene, run):
    """Returns a render with its error."""
    reference = score.Reference.load(scene)
    found = score.compare(program, [run.image], reference)
    return Record(renderer.name, renderer.ours, scene, run.samples, run.cpu, run.wall,
                  score.relmse(found, reference), found["mean_ratio"])


class Row(NamedTuple):
    """The records of one renderer in one scene."""

    records: list

    def median(self, figure):
        return statistics.median(getattr(record, figure) for record in self.records)

    @property
    def name(self):
        return self.records[0].renderer

    @property
    def ours(self):
        return self.records[0].ours

    @property
    def ratio(self):
        return statistics.mean(record.ratio for record in self.records)

    def cells(self):
        merits = [record.merit for record in self.records]
        return ["**%s**" % self.name if self.ours else self.name, "%.3g M" % (self.median("speed") / 1e6),
                "%.3g" % self.median("variance"), "%.3g" % self.median("merit"),
                "%.3g, %.3g" % (min(merits), max(merits)), "%.4f" % self.ratio]


def rows(records, scene):
    """Returns the renderers in a scene, the best first."""
    found = {}
    for one in records:
        if one.scene == scene:
            found.setdefault(one.renderer, []).append(one)
    return sorted(map(Row, found.values()), key=lambda row: row.median("merit"))


def table(records, scene):
    """Formats the records of a scene as Markdown."""
    head = ["scene %s" % scene, "samples per CPU second", "relMSE × samples per pixel", "relMSE × CPU seconds",
            "from, to", "mean / reference"]
    return harness.table(head, [row.cells() for row in rows(records, scene)])


def verdict(records, scene):
    """Compares the best bidir integrator with the best peer, in a sentence."""
    found = rows(records, scene)
    ours = next((row for row in found if row.ours), None)
    peer = next((row for row in found if not row.ours), None)
    if not (ours and peer):
        return "Scene %s: nothing to compare." % scene
    merit, speed, variance = (ours.median(figure) / peer.median(figure) for figure in ("merit", "speed", "variance"))
    return "Scene %s: our best, %s, is at %.2f of the best peer, %s; %.2f of its samples per second, " \
        "%.2f of its error per sample." % (scene, ours.name, merit, peer.name, speed, variance)


def differing(records):
    """Returns the renderers whose images differ from the reference, as far as these short runs show it;
    `verify` is more sensitive."""
    found = []
    for scene in sorted({one.scene for one in records}):
        for row in rows(records, scene):
            samples = sum(one.samples for one in row.records)
            noise = (row.median("variance") / (samples * pixels())) ** 0.5
            if abs(row.ratio - 1) > verify.RATIO + 5 * noise:
                found.append("%s in %s" % (row.name, scene))
    return found


def machine(environment):
    """Describes processor, cores and versions in a line."""
    versions = environment.versions()
    peers = ["%s %s" % (name, versions[name])
             for name in ("mitsuba", "drjit", "pyluxcore", "bpy") if name in versions]
    return "%s; %s" % (harness.machine(), ", ".join(peers))


def save(path, records):
    Path(path).write_text(json.dumps([one._asdict() for one in records], indent=1), encoding="utf-8")
