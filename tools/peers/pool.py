"""Combines several images into one, with its variance; runs in the peers' environment.

    pool.py mean OUT REFERENCE IMAGE...   the mean of independent images of equal cost
    pool.py mix OUT PICTURE OTHER         the best mix of two images with variances

OUT gets the layers `Variance` (of the mean) and `Samples`, by which `bidir compare` tests whether
a difference is noise. The noise of OUT, as relMSE relative to REFERENCE or PICTURE, is printed on
stdout.
"""

import json
import sys

import numpy as np

import images

EPSILON = 0.01  # of relMSE, as in `bidir compare`


def mean(paths):
    """Mean of replicates: (image, variance of the mean, number of replicates)."""
    replicates = np.stack([images.read(path) for path in paths])
    variance = replicates.var(axis=0, ddof=1) / len(paths)
    return replicates.mean(axis=0), variance, len(paths)


def mix(paths):
    """Two images, weighted against their noise: (image, variance, fewest samples)."""
    pictures = [images.read(path) for path in paths]
    variances = [images.read(path, "Variance.") for path in paths]
    noise = [relative(variance, pictures[0]) for variance in variances]
    weight = noise[1] / (noise[0] + noise[1])
    image = weight * pictures[0] + (1 - weight) * pictures[1]
    variance = weight**2 * variances[0] + (1 - weight) ** 2 * variances[1]
    return image, variance, min(images.read_channel(path, "Samples").min() for path in paths)


def relative(variance, image):
    """Returns the relMSE expected from a variance."""
    return float((variance / (image**2 + EPSILON)).mean())


def rounded(values, bits):
    """Rounds floats to `bits` bits of mantissa, which compress better."""
    mantissa, exponent = np.frexp(values)
    return np.ldexp(np.round(mantissa * 2**bits) / 2**bits, exponent)


def main():
    kind, out, first, *others = sys.argv[1:]
    found = mean(others) if kind == "mean" else mix([first, *others])
    # Rounding digits below the noise halves the file.
    image, variance = rounded(found[0], 12), rounded(found[1], 6)
    layers = {"Variance." + c: np.float32(variance[..., i]) for i, c in enumerate("RGB")}
    layers["Samples"] = np.full(image.shape[:2], found[2], np.float32)
    images.write(out, np.float32(image), layers)
    print(json.dumps({"noise": relative(variance, images.read(first))}))


if __name__ == "__main__":
    main()
