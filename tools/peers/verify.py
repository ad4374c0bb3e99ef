"""Checks that all renderers converge to the same image, so that their errors are comparable."""

import json
import os
import subprocess

import harness
import score

RATIO = 0.003         # allowed relative difference between the means of an image and the reference
SIGNIFICANCE = 0.001  # a difference of less probability is no noise
SYSTEMATIC = 0.01     # the part of a render's error that need not be noise


def verify(bench, seconds, replicates):
    """Renders replicates with every renderer, and compares their mean with the reference.

    Its own mean has to be within 0.3 %, give or take its noise. Blocks of 16 pixels have to differ
    by noise alone, or else by less than 1 % of the relMSE of one replicate: in Cycles the edge of
    a lamp lies a hundredth of a pixel elsewhere, which is detected, but changes no comparison. Prints a line
    for each renderer. Returns the number of failures."""
    failures = 0
    print("| scene | renderer | mean / reference | p of blocks | systematic part of its error | |")
    print("|---|---|---:|---:|---:|---|")
    for scene in bench.scenes:
        for renderer in bench.able(scene):
            try:
                row, same = _verify(bench, scene, renderer, seconds, replicates)
            except harness.Failed as error:
                row, same = "| | | | failed: %s |" % " ".join(str(error).split()), False
            print("| %s | %s %s" % (scene, renderer.name, row), flush=True)
            failures += not same
    return failures


def _verify(bench, scene, renderer, seconds, replicates):
    images = []
    for seed in range(replicates):
        image = bench.image("verify", renderer, scene, seed)
        images.append(renderer.render(bench.job(scene, seconds, seed, image)).image)
    reference = score.Reference.load(scene)
    ratio = score.compare(bench.program, images, reference)["mean_ratio"]
    mean = bench.image("verify", renderer, scene, "mean")
    noise = pool(bench.environment, "mean", mean, [reference.path, *images])["noise"]
    found = score.compare(bench.program, [mean], reference)
    p = found["z_test"]["blocks"]["p"]
    systematic = (score.relmse(found, reference) - noise) / (noise * replicates)
    wide = (ratio["high"] - ratio["low"]) / 2
    same = abs(ratio["mean"] - 1) <= RATIO + wide and (
        p >= SIGNIFICANCE or systematic <= SYSTEMATIC)
    return "| %.4f ± %.4f | %.2g | %.2f %% | %s |" % (
        ratio["mean"], wide, p, 100 * systematic, "same" if same else "DIFFERS"), same


def pool(environment, kind, out, images):
    """Runs `pool.py` in the environment, whose packages it needs; returns its report."""
    script = os.path.join(score.HERE, "pool.py")
    command = [environment.python, script, kind, out, *images]
    return json.loads(subprocess.check_output(command, env=environment.variables()))
