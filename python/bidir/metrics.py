"""Error metrics of an image against a reference.

Numbers are those of ``bidir compare``, over red, green and blue of all pixels; ε = 0.01. Images are
linear Rec. 709, of one shape: (rows, columns, 3).
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

from bidir import _bidir
from bidir.errors import SettingsError
from bidir.image import Array, Image, _array, _pixels

__all__ = [
    "METRICS",
    "compare",
    "error_map",
    "flip",
    "flip_hdr",
    "identical",
    "mape",
    "metric",
    "mse",
    "relmse",
    "rmse",
]

#: The names of all metrics.
METRICS: tuple[str, ...] = tuple(_bidir.METRICS)

ImageLike = npt.ArrayLike | Image


def _pair(image: ImageLike, reference: ImageLike) -> tuple[tuple[int, int], bytes, bytes]:
    a, b = _pixels(image), _pixels(reference)
    if a.shape != b.shape:
        raise SettingsError(f"the images differ in shape: {a.shape} and {b.shape}")
    return (a.shape[1], a.shape[0]), a.tobytes(), b.tobytes()


def metric(name: str, image: ImageLike, reference: ImageLike) -> float:
    """Return the metric ``name``, one of :data:`METRICS`.

    Errors: :class:`bidir.SettingsError` for an unknown name, or if the shapes differ.
    """
    return _bidir.metric(name, *_pair(image, reference))


def error_map(name: str, image: ImageLike, reference: ImageLike) -> Array:
    """Return the error of every pixel by a metric. Shape: (rows, columns).

    Errors: as :func:`metric`.
    """
    (width, height), a, b = _pair(image, reference)
    return _array(_bidir.error_map(name, (width, height), a, b), height, width, 1)


def compare(image: ImageLike, reference: ImageLike, names: Iterable[str] | None = None) -> dict[str, float]:
    """Return metrics by name: ``names``, or all except FLIP, which takes longer.

    Errors: as :func:`metric`.
    """
    chosen = [name for name in METRICS if "flip" not in name] if names is None else list(names)
    pair = _pair(image, reference)
    return {name: _bidir.metric(name, *pair) for name in chosen}


def identical(image: ImageLike, reference: ImageLike) -> bool:
    """Return True if both have the same shape and the same bits in every channel."""
    a, b = _pixels(image), _pixels(reference)
    return a.shape == b.shape and bool(np.array_equal(a.view(np.uint32), b.view(np.uint32)))


def mse(image: ImageLike, reference: ImageLike) -> float:
    """Return mean (a - b)²."""
    return rmse(image, reference) ** 2


def rmse(image: ImageLike, reference: ImageLike) -> float:
    """Return √mean (a - b)²."""
    return metric("rmse", image, reference)


def relmse(image: ImageLike, reference: ImageLike) -> float:
    """Return mean (a - b)² / (b² + ε)."""
    return metric("relmse", image, reference)


def mape(image: ImageLike, reference: ImageLike) -> float:
    """Return mean |a - b| / (|b| + ε)."""
    return metric("mape", image, reference)


def flip(image: ImageLike, reference: ImageLike) -> float:
    """Return the mean of FLIP for a screen that shows [0, 1]: visible difference from 0 to 1."""
    return metric("flip", image, reference)


def flip_hdr(image: ImageLike, reference: ImageLike) -> float:
    """Return the mean of HDR-FLIP: visible difference from 0 to 1 at the worst of several exposures."""
    return metric("flip_hdr", image, reference)
