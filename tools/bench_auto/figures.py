"""The time of estimators to the same noise, from images with several seeds."""

import math
from collections import Counter
from dataclasses import dataclass

import numpy as np

#: Added to the square of a pixel's mean, as by `bidir compare`.
EPSILON = 0.01
#: The fraction of the noisiest pixels that is left out.
TRIMMED = 1e-3
#: The side of blocks, which measure the correlated noise of neighbours. Unit: pixels.
BLOCK = 16


@dataclass
class Row:
    """The figures of all estimators in one scene."""

    scene: str
    #: By estimator, of pixels and of blocks; None if the film is smaller than a block.
    products: dict[str, tuple[float, float | None]]
    #: The plans of `auto`, by seed.
    plans: list[str]

    def behind(self):
        """Return the figure of `auto` relative to the better of `path` and `bdpt`."""
        pixels = {name: product[0] for name, product in self.products.items()}
        return pixels["auto"] / min(pixels["path"], pixels["bdpt"])

    def plan(self):
        """Return the most frequent plan, and its number of seeds."""
        [(plan, count)] = Counter(self.plans).most_common(1)
        return f"{plan} ({count} of {len(self.plans)})"


def products(images, seconds, spp):
    """Return variance times microseconds, both per sample, of pixels and of blocks, by estimator.

    `images` and `seconds` have those of each seed first. Means that variances are relative to are
    those of all estimators, which have the same expectation.
    """
    mean = np.mean([image.mean(axis=0) for image in images.values()], axis=0)
    found = {}
    for name, image in images.items():
        time = seconds[name] * 1e6 * spp
        pair = [product(image, mean, time)]
        means = blocks(image), blocks(mean[None])[0]
        pair.append(product(*means, time) if means[1].size else None)
        found[name] = tuple(pair)
    return found


def product(images, mean, time):
    """Return the mean over seeds of squared differences from their mean, each times its time."""
    seeds = len(images)
    squares = (images - images.mean(axis=0)) ** 2 * seeds / (seeds - 1)
    relative = (squares / (mean**2 + EPSILON)).mean(axis=-1)
    return float(trimmed_mean(np.tensordot(time, relative, 1) / seeds))


def trimmed_mean(values):
    """Return the mean without the largest thousandth."""
    values = np.sort(values, axis=None)
    return values[: values.size - math.floor(values.size * TRIMMED)].mean()


def blocks(images):
    """Return the means of whole blocks. Shape: (seeds, rows, columns, 3), of blocks, too."""
    seeds, height, width, channels = images.shape
    rows, columns = height // BLOCK, width // BLOCK
    cut = images[:, : rows * BLOCK, : columns * BLOCK]
    return cut.reshape(seeds, rows, BLOCK, columns, BLOCK, channels).mean(axis=(2, 4))


def table(rows):
    """Return Markdown, with the geometric mean of `auto` relative to the better of `path` and `bdpt`."""
    names = list(rows[0].products)
    lines = [
        f"| | {' | '.join(f'`{name}`' for name in names)} | `auto` over the better | plan |",
        "|---|" + "---:|" * (len(names) + 1) + "---|",
    ]
    for row in rows:
        cells = " | ".join(cell(*row.products[name]) for name in names)
        lines.append(f"| {row.scene} | {cells} | {row.behind():.2f} | {row.plan()} |")
    behind = [row.behind() for row in rows]
    mean = math.exp(sum(map(math.log, behind)) / len(behind))
    lines += ["", f"{len(rows)} scenes: {mean:.2f} (geometric mean), {min(behind):.2f} to {max(behind):.2f}."]
    return "\n".join(lines)


def cell(pixels, of_blocks):
    """Format both figures."""
    return f"{pixels:.3g}" + ("" if of_blocks is None else f" ({of_blocks * BLOCK**2:.3g})")
