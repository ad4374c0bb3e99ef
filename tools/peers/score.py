"""Errors of images by `bidir compare`: one measure for all renderers."""

import json
import os
import subprocess
from pathlib import Path
from typing import NamedTuple

HERE = os.path.dirname(os.path.abspath(__file__))
REFERENCES = os.path.join(HERE, "reference")
PROVENANCE = os.path.join(REFERENCES, "provenance.json")


def provenance():
    """Returns the provenance of the references: {scene: facts}."""
    return json.loads(Path(PROVENANCE).read_text(encoding="utf-8"))


class Reference(NamedTuple):
    """A nearly noise-free image, and its noise."""

    path: str
    noise: float  # its own relMSE, which is in that of every image that is compared with it

    @classmethod
    def load(cls, scene):
        return cls(os.path.join(REFERENCES, scene + ".exr"), provenance()[scene]["noise"])


def compare(program, images, reference):
    """Runs `bidir compare` for an image, or for several with independent seeds; returns its results."""
    command = [program, "compare", "--json", *images, "--reference", reference.path]
    return json.loads(subprocess.check_output(command))


def relmse(comparison, reference):
    """Returns the relMSE without the reference's own noise, which is independent of the image's."""
    return comparison["relmse"] - reference.noise
