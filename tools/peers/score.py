"""How far images are from a reference, by `bidir compare`: one measure for all renderers."""

import json
import os
import subprocess
from typing import NamedTuple

HERE = os.path.dirname(os.path.abspath(__file__))
REFERENCES = os.path.join(HERE, "reference")
PROVENANCE = os.path.join(REFERENCES, "provenance.json")


def provenance():
    """How the references were made: {scene: facts}."""
    if not os.path.exists(PROVENANCE):
        return {}
    with open(PROVENANCE, encoding="utf-8") as file:
        return json.load(file)


class Reference(NamedTuple):
    """An image that is nearly without noise, and how much it has."""

    path: str
    noise: float  # its own relMSE, which is in that of every image that is compared with it

    @classmethod
    def load(cls, scene):
        return cls(os.path.join(REFERENCES, scene + ".exr"), provenance()[scene]["noise"])


def compare(program, images, reference):
    """What `bidir compare` says of an image, or of several of independent seeds."""
    command = [program, "compare", "--json", *images, "--reference", reference.path]
    return json.loads(subprocess.run(command, stdout=subprocess.PIPE, check=True).stdout)


def relmse(comparison, reference):
    """relMSE without the reference's own noise, which is independent of the image's."""
    return comparison["relmse"] - reference.noise
