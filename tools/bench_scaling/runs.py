"""Renders and their cost: speed, loading, memory."""

import json
import os
import statistics
import subprocess
import sys
from typing import NamedTuple


# The system's unit of memory. Unit: bytes.
RSS_UNIT = 1 if sys.platform == "darwin" else 1024


class Failed(Exception):
    """A render ended with an error."""


class Case(NamedTuple):
    """One render: the amount of the varied quantity, the method, the scene, and flags."""

    size: int
    method: str
    scene: str
    flags: tuple = ()


class Cost(NamedTuple):
    """The cost of a render: medians over its repetitions."""

    samples_per_second: float
    rays_per_sample: float
    load_seconds: float
    peak_bytes: float
    film_bytes: float
    bvh_bytes: float


class Runner(NamedTuple):
    """The settings of all renders."""

    program: str
    folder: str
    seconds: float
    rounds: int

    def measure(self, cases):
        """Returns medians of all cases: {(size, method): cost}. Cases take turns, so that other work of
        the machine affects all of them."""
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
            # Unlike `wait`, this returns the memory of this child only.
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
