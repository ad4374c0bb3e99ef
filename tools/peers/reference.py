"""References of the scenes: the best mix of two bidir estimators that agree.

`bidir reference` renders each and tests that they do; `verify` tests that the peers agree, too.
"""

import json
import os
import subprocess
from pathlib import Path

import renderers
import score
import verify

# The two best of each scene, which have little in common.
ESTIMATORS = {
    "A": ("bdpt", "path --path-roulette albedo:5"),
    "B": ("bdpt", "light --path-roulette albedo:2"),
    "C": ("bdpt", "path"),
}


def render(bench, seconds):
    """Renders both estimators for a number of CPU seconds, and writes the mix of both next to this
    file. Returns an exit code: 1 if they disagree."""
    for scene in bench.scenes:
        folder = bench.environment.path("reference-" + scene)
        estimators = ESTIMATORS[scene]
        source = os.path.join(bench.environment.path("scenes"), scene + ".pbrt")
        samples = min(_affordable(bench, scene, flags, seconds) for flags in estimators)
        made = subprocess.call([
            bench.program, "reference", source, "-o", folder, "--spp", str(samples),
            "--threads", str(bench.threads), "--estimator", estimators[0],
            "--against", estimators[1]])
        if made != 0:
            return 1
        keep(bench, scene, folder)
    return 0


def _affordable(bench, scene, flags, seconds):
    """Returns the samples per pixel of an estimator in a number of CPU seconds."""
    renderer = renderers.Ours(bench.program, flags + " --sampler independent")
    image = bench.image("bench", renderer, scene, "cost")
    run = renderer.render(bench.job(scene, min(seconds, 8.0), 0, image))
    return max(16, int(run.samples * seconds / run.cpu))


def keep(bench, scene, folder):
    """Mixes the two images of a folder of `bidir reference`, and records their origin."""
    path = os.path.join(score.REFERENCES, scene + ".exr")
    pictures = [os.path.join(folder, name + ".exr") for name in ("picture", "against")]
    noise = verify.pool(bench.environment, "mix", path, pictures)["noise"]
    made = json.loads(Path(folder, "provenance.json").read_text(encoding="utf-8"))
    known = score.provenance()
    known[scene] = {
        "noise": noise,
        "program": made["program"],
        "estimator_version": made["estimator_version"],
        "estimators": ESTIMATORS[scene],
        "samples": [estimator["spp"] for estimator in made["estimators"]],
        "p_of_agreement": made["agreement"]["p"],
    }
    text = json.dumps(known, indent=2, sort_keys=True) + "\n"
    Path(score.PROVENANCE).write_text(text, encoding="utf-8")
