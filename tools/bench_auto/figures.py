"""The time of estimators to the same noise, from images with several seeds."""

import math
from collections import Counter
from dataclasses import dataclass

import harness
import numpy as np

#: Added to the square of a pixel's mean, as by `bidir compare`.
EPSILON = 0.01
#: The fraction of the noisiest pixels that is left out.
TRIMMED = 1e-3
#: The side of blocks, which measure the correlated noise of neighbours. Unit: pixels.
BLOCK = 16
#: How often seeds and blocks are resampled for an interval.
RESAMPLED = 2000


@dataclass
class Product:
    """Variance times microseconds, both per sample: the figure of an estimator in one scene."""

    #: That of each seed and block, without the noisiest thousandth of pixels; their mean is the figure.
    #: Shape: (seeds, blocks).
    parts: np.ndarray
    #: Of means over blocks; None if the film is smaller than a block.
    of_blocks: float | None = None

    def pixels(self):
        """Return the figure of pixels."""
        return float(self.parts.mean())


@dataclass
class Row:
    """The figures of all estimators in one scene."""

    scene: str
    products: dict[str, Product]
    #: The plans of `auto`, by seed.
    plans: list[str]

    def best(self):
        """Return the name of the best estimator that `auto` could have taken."""
        others = [name for name in self.products if name != "auto"]
        return min(others, key=lambda name: self.products[name].pixels())

    def behind(self, other=None):
        """Return the figure of `auto` relative to that of another estimator, or of the best."""
        return self.products["auto"].pixels() / self.products[other or self.best()].pixels()

    def interval(self):
        """Return the ends of the 90 % interval of `behind`, by resampled seeds and blocks [Owen07].

        Both are drawn apart, as a block is hard for all seeds and a plan serves all blocks. Which estimator
        is the best, and which pixels are left out, stays as it was found.
        """
        random = np.random.default_rng(1)
        auto, best = (self.products[name].parts for name in ("auto", self.best()))
        seeds, blocks = (
            random.multinomial(size, np.full(size, 1.0 / size), RESAMPLED) for size in auto.shape
        )
        ratios = np.sum((seeds @ auto) * blocks, axis=1) / np.sum((seeds @ best) * blocks, axis=1)
        return tuple(np.quantile(ratios, [0.05, 0.95]))

    def plan(self):
        """Return the most frequent plan, and its number of seeds."""
        [(plan, count)] = Counter(self.plans).most_common(1)
        return f"{plan} ({count} of {len(self.plans)})"


def products(images, seconds, spp):
    """Return the Product of each estimator.

    `images` and `seconds` have those of each seed first. Means that variances are relative to are
    those of all estimators, which have the same expectation.
    """
    mean = np.mean([image.mean(axis=0) for image in images.values()], axis=0)
    found = {}
    for name, image in images.items():
        time = seconds[name] * 1e6 * spp
        product = Product(by_block(trimmed(noise(image, mean, time))))
        means = blocks(image), blocks(mean[None])[0]
        if means[1].size:
            product.of_blocks = float(noise(*means, time).mean())
        found[name] = product
    return found


def noise(images, mean, time):
    """Return relative squared differences from the mean of all seeds, times the time of each.

    Shape: (seeds, rows, columns).
    """
    seeds = len(images)
    squares = (images - images.mean(axis=0)) ** 2 * seeds / (seeds - 1)
    return time[:, None, None] * (squares / (mean**2 + EPSILON)).mean(axis=-1)


def trimmed(values):
    """Return values with zeros in the thousandth of pixels that is the noisiest over all seeds.

    The others are scaled, so that the mean of all is that of the others.
    """
    of_pixels = values.mean(axis=0)
    left_out = math.floor(of_pixels.size * TRIMMED)
    kept = np.ones(of_pixels.size)
    kept[np.argsort(of_pixels, axis=None)[of_pixels.size - left_out :]] = 0.0
    return values * kept.reshape(of_pixels.shape) / kept.mean()


def by_block(values):
    """Return the part of each block in the mean of `values`, times the number of blocks.

    Shape: (seeds, blocks).
    """
    height, width = values.shape[1:]
    rows, columns = (np.arange(size) // BLOCK for size in (height, width))
    index = (rows[:, None] * (columns[-1] + 1) + columns).ravel()
    count = index[-1] + 1
    sums = [np.bincount(index, of_seed.ravel(), count) for of_seed in values]
    return np.array(sums) * count / index.size


def blocks(images):
    """Return the means of whole blocks. Shape: (seeds, rows, columns, 3), of blocks, too."""
    seeds, height, width, channels = images.shape
    rows, columns = height // BLOCK, width // BLOCK
    cut = images[:, : rows * BLOCK, : columns * BLOCK]
    return cut.reshape(seeds, rows, BLOCK, columns, BLOCK, channels).mean(axis=(2, 4))


def table(rows):
    """Return Markdown, with the geometric mean of `auto` relative to the best of the others."""
    names = (f"`{name}`" for name in rows[0].products)
    head = ["", *names, "over the best", "90 %", "`bdpt` over `auto`", "plan"]
    lines = [
        [
            row.scene,
            *map(cell, row.products.values()),
            f"{row.behind():.2f}",
            "{:.2f} to {:.2f}".format(*row.interval()),
            f"{1.0 / row.behind('bdpt'):.2f}",
            row.plan(),
        ]
        for row in rows
    ]
    behind = [row.behind() for row in rows]
    mean = math.exp(sum(map(math.log, behind)) / len(behind))
    total = f"{len(rows)} scenes: {mean:.3f} (geometric mean), {min(behind):.2f} to {max(behind):.2f}."
    return f"{harness.table(head, lines)}\n\n{total}"


def cell(product):
    """Format both figures."""
    of_blocks = product.of_blocks
    return f"{product.pixels():.3g}" + ("" if of_blocks is None else f" ({of_blocks * BLOCK**2:.3g})")
