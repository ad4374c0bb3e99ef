"""Prints the results of the authors' FLIP for the images in crates/lab/src/flip/tests.rs.

Needs the packages flip-evaluator and numpy; the images are those formulas in numpy.
"""

from importlib.metadata import version

import flip_evaluator
import numpy as np

PLACES = [(0, 0), (39, 0), (5, 17), (20, 12), (33, 23)]

y, x, c = np.meshgrid(np.arange(24), np.arange(40), np.arange(3), indexing="ij")
stripes = (x * (c + 2) + y * (5 - c)) % 32 / 32
stripes = np.where((x // 8 + y // 6) % 2 == 0, stripes / 4, stripes)
noise = (x * x + 3 * y * y + 7 * c + x * y) % 16 - 8
firefly = np.where((x * 7 + y * 13) % 97 == 0, 64.0, 0.0)
bright = stripes * 2.0 ** ((x // 5 + y // 4) % 9 - 3)
SCREEN = stripes, np.clip(stripes + noise / 64, 0, 1)
LIGHT = bright, bright * (1 + noise / 16) + firefly


def show(kind, images, parameters):
    reference, image = (np.float32(pixels) for pixels in images)
    # Linear channels; errors as they are, without colours.
    errors, mean, used = flip_evaluator.evaluate(
        reference, image, kind, False, False, True, parameters
    )
    errors = errors.reshape(24, 40, -1)[..., 0]
    print(kind, parameters, used)
    print(f"  mean: {mean:.9f}")
    print("  pixels: " + ", ".join(f"{errors[py, px]:.9f}" for px, py in PLACES))


print("flip-evaluator", version("flip-evaluator"))
show("LDR", SCREEN, {})
show("LDR", SCREEN, {"ppd": 30.0})
show("HDR", LIGHT, {})
show("HDR", LIGHT, {"ppd": 30.0})
show("HDR", LIGHT, {"startExposure": -3.0, "stopExposure": 2.0, "numExposures": 4})
