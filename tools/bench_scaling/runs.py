"""Renders and their cost: speed, loading, memory."""

from typing import NamedTuple

import harness


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


def measure(options, folder, cases):
    """Returns medians of all cases: {(size, method): cost}."""
    costs = {(case.size, case.method): [] for case in cases}
    for case in harness.turns(cases, options.rounds):
        flags = case.flags if "--spp" in case.flags else (*case.flags, "--time", str(options.seconds))
        stats, usage = harness.render([options.bidir], folder, case.scene, "--integrator", case.method, *flags)
        costs[case.size, case.method].append(cost(stats, usage.peak))
    return {name: Cost(*harness.medians(found)) for name, found in costs.items()}


def cost(stats, peak):
    return Cost(stats["samples_per_second"], stats["rays"]["total"] / stats["samples"], stats["load_seconds"],
                peak, stats["film_bytes"], stats["bvh_bytes"])
