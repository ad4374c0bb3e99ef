"""Renders and what they cost: speed, loading, memory."""

import json
import os
import statistics
import subprocess
import sys
from typing import NamedTuple


# What the system counts memory in. Unit: bytes.
RSS_UNIT = 1 if sys.platform == "darwin" else 1024


class Failed(Exception):
    """A render ended with an error."""


class Case(NamedTuple):
    """One render: how much of what is varied, the method, the scene, and flags."""

    size: int
    method: str
    scene: str
    flags: tuple = ()


class Cost(NamedTuple):
    """What a render took: medians over its repetitions."""

    samples_per_second: float
    rays_per_sample: float
    load_seconds: float
    peak_bytes: float
    film_bytes: float
    bvh_bytes: float


class Runner(NamedTuple):
    """How renders are started."""

    program: str
    folder: str
    seconds: float
    rounds: int

    def measure(self, cases):
        """Medians of all cases; they take turns, so that what else the machine does falls on all:
        {(size, method): cost}."""
        costs = {(case.size, case.method): [] for case in cases}
        for number in range(self.rounds):
            turn = cases if number % 2 == 0 else reversed(cases)
            for case in turn:
                costs[case.size, case.method].append(self._render(case))
        return {name: Cost(*map(statistics.median, zip(*found)))
                for name, found in costs.items()}

    def _render(self, case):
        stats, image = [os.path.join(self.folder, name) for name in ("stats.json", "image.exr")]
        command = [self.program, "render", case.scene, "-q", "-o", image, "--stats", stats,
                   "--integrator", case.method] + list(case.flags)
        if not {"--spp", "--time"} & set(command):
            command += ["--time", str(self.seconds)]
        environment = {name: value for name, value in os.environ.items()
                       if not name.startswith("BIDIR_")}
        with open(os.path.join(self.folder, "said"), "w+b") as said:
            child = subprocess.Popen(command, env=environment, stdout=said, stderr=said)
            # Unlike `wait`, this tells the memory of this very child.
            _, status, usage = os.wait4(child.pid, 0)
            child.returncode = os.waitstatus_to_exitcode(status)
            if child.returncode != 0:
                said.seek(0)
                raise Failed("%s: %s" % (" ".join(command), said.read().decode(errors="replace")))
        with open(stats, encoding="utf-8") as file:
            return cost(json.load(file), usage.ru_maxrss * RSS_UNIT)


def cost(stats, peak):
    return Cost(
        samples_per_second=stats["samples_per_second"],
        rays_per_sample=stats["rays"]["total"] / stats["samples"],
        load_seconds=stats["load_seconds"],
        peak_bytes=peak,
        film_bytes=stats["film_bytes"],
        bvh_bytes=stats["bvh_bytes"],
    )
