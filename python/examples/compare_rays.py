"""A comparison of rules for shadow rays: cost and benefit of one ray for each pair of subpaths."""

from pathlib import Path

import bidir

METHODS: dict[str, bidir.Integrator] = {
    "all": bidir.Bdpt(),
    "one": bidir.Bdpt(shadow_rays=bidir.PerPair()),
    "two": bidir.Bdpt(shadow_rays=bidir.Budget(2)),
}


def main(folder: Path) -> bidir.Results:
    """Run the experiment; the same call continues after an interruption."""
    experiment = bidir.Experiment.of(
        title="Shadow rays in the Cornell box",
        scenes={"cornell": "scenes/cornell.pbrt"},
        methods=METHODS,
        budgets=[{"rays": 100}],
        seeds=3,
        size=(64, 64),
        reference_spp=512,
    )
    results = experiment.run(folder)
    for method in METHODS:
        errors = results.values("relmse", scene="cornell", method=method, budget="100 rays per pixel")
        print(method, [f"{error:.4f}" for error in errors])
    return results


if __name__ == "__main__":
    print(main(Path("out/compare-rays")))
