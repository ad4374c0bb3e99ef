"""Images with their layers, as numpy arrays."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from bidir import _bidir
from bidir.errors import LayerError, SettingsError
from bidir.film import Film
from bidir.scene import StrPath

__all__ = ["Array", "Image", "png", "read_image", "read_layers", "write_image"]

#: Numbers of 32 bits.
Array: TypeAlias = npt.NDArray[np.float32]

_FLOAT = np.dtype("<f4")


def _array(data: bytes, height: int, width: int, channels: int) -> Array:
    """Return a read-only view of bytes."""
    array: Array = np.frombuffer(data, _FLOAT)
    return array.reshape((height, width, channels) if channels > 1 else (height, width))


def _pixels(image: npt.ArrayLike | Image) -> Array:
    """Return an image as rows of pixels of three channels.

    Errors: :class:`bidir.SettingsError` where it has another shape.
    """
    array = np.asarray(image, _FLOAT)
    if array.ndim != 3 or array.shape[2] != 3 or array.size == 0:
        raise SettingsError(f"an image has the shape (rows, columns, 3), not {array.shape}")
    return np.ascontiguousarray(array)


class Layers(Mapping[str, Array]):
    """The layers of an image, by their names in files, such as ``Z``, or in calls, such as ``depth``."""

    def __init__(self, layers: dict[str, Array]) -> None:
        """Take the layers by their names in files."""
        self._layers = layers

    def __getitem__(self, name: str) -> Array:
        """Return a layer.

        Errors: :class:`bidir.LayerError` with the names of all layers.
        """
        layer = self._layers.get(_bidir.LAYER_NAMES.get(name, name))
        if layer is not None:
            return layer
        called = {file: call for call, file in _bidir.LAYER_NAMES.items()}
        names = [f"{file} ({called[file]})" if file in called else file for file in self._layers]
        has = f"it has {', '.join(names)}" if names else "it has none"
        raise LayerError(f"the image has no layer {name!r}: {has}; `layers` of bidir.render adds others")

    def __iter__(self) -> Iterator[str]:
        """Return the names in files."""
        return iter(self._layers)

    def __len__(self) -> int:
        """Return the number of layers."""
        return len(self._layers)

    def __repr__(self) -> str:
        """Return the names in files."""
        return f"<bidir layers {', '.join(self._layers) or 'none'}>"


class Image:
    """An image with the variance of its pixels, its layers and its statistics.

    ``np.asarray(image)`` is :attr:`pixels`. Notebooks display it.
    """

    def __init__(self, film: Film) -> None:
        """Develop a film."""
        (width, height), pixels, variance, layers = film._native.develop()
        self._film = film
        self._pixels = _array(pixels, height, width, 3)
        self._variance = _array(variance, height, width, 3)
        named: dict[str, Array] = {}
        for name, channels, data in layers:
            named[name or channels[0]] = _array(data, height, width, len(channels))
        self._layers = Layers(named)

    @property
    def pixels(self) -> Array:
        """Linear Rec. 709, row 0 at the top, read-only. Shape: (rows, columns, 3)."""
        return self._pixels

    @property
    def variance(self) -> Array:
        """The estimated variance of each pixel's mean; 0 after one pass. Shape: as :attr:`pixels`."""
        return self._variance

    @property
    def layers(self) -> Mapping[str, Array]:
        """The extra layers by name, such as ``Z`` or ``depth``; docs/reference/images.md has their units.

        Shape: (rows, columns, 3) for colours, points and normals, (rows, columns) for numbers.
        ``layers``, ``light_groups`` and ``strategy_layers`` of :func:`bidir.render` select them.
        """
        return self._layers

    @property
    def film(self) -> Film:
        """The film of the image."""
        return self._film

    @property
    def stats(self) -> dict[str, Any]:
        """Counters by name, with ``spp``, ``seconds``, ``noise``, ``stopping`` and ``settings``."""
        film = self._film
        return {
            "spp": film.spp,
            "seconds": film.seconds,
            "noise": film.noise,
            "stopping": film.stopping,
            "settings": film.settings,
            **film.counts,
        }

    @property
    def shape(self) -> tuple[int, int, int]:
        """Rows, columns, 3."""
        height, width, channels = self._pixels.shape
        return (height, width, channels)

    def save(self, path: StrPath) -> None:
        """Write NAME.exr, linear with layers and attributes, or NAME.png for the screen.

        Errors: :class:`bidir.FileError`, also if it would replace a file of the scene;
        :class:`bidir.SettingsError` for other names.
        """
        self._film._native.write_image(os.fspath(path))

    def png(self, exposure: float = 0.0) -> bytes:
        """Return the bytes of a PNG, ``exposure`` stops brighter; values above 1 are clipped."""
        return png(self._pixels, exposure)

    def _repr_png_(self) -> bytes:
        return self.png()

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> npt.NDArray[Any]:
        """Return the pixels, for numpy."""
        if dtype is None and not copy:
            return self._pixels
        return np.array(self._pixels, dtype=dtype)

    def __repr__(self) -> str:
        """Return the size, the samples per pixel and the noise."""
        height, width, _ = self.shape
        film = self._film
        return f"<bidir.Image {width} x {height}, {film.spp} spp, noise {film.noise:.3g}>"


def png(image: npt.ArrayLike | Image, exposure: float = 0.0) -> bytes:
    """Return the bytes of a PNG of linear pixels.

    Args:
        image: Linear Rec. 709. Shape: (rows, columns, 3).
        exposure: Exposure. Unit: stops.

    Errors: :class:`bidir.SettingsError` for another shape.
    """
    pixels = _pixels(image)
    if exposure:
        pixels = pixels * np.float32(2.0**exposure)
    height, width, _ = pixels.shape
    return _bidir.encode_png((width, height), pixels.tobytes())


def write_image(path: StrPath, image: npt.ArrayLike | Image) -> None:
    """Write linear pixels as NAME.exr, or as NAME.png for the screen.

    Args:
        path: The file.
        image: Linear Rec. 709. Shape: (rows, columns, 3).

    Errors: :class:`bidir.FileError`; :class:`bidir.SettingsError` for other names and shapes.
    """
    pixels = _pixels(image)
    height, width, _ = pixels.shape
    _bidir.write_image(os.fspath(path), (width, height), pixels.tobytes())


def read_image(path: StrPath) -> Array:
    """Read an EXR, PFM, HDR, PNG, JPEG or TGA image as linear pixels.

    Returns: Linear Rec. 709; grey is repeated, alpha ignored. Shape: (rows, columns, 3).

    Errors: :class:`bidir.MissingFileError`, :class:`bidir.DataError` if it is broken.
    """
    (width, height), data = _bidir.read_image(os.fspath(Path(path)))
    return _array(data, height, width, 3)


def read_layers(path: StrPath) -> dict[str, Array]:
    """Read all channels of an EXR by their names, such as ``R`` or ``Albedo.R``.

    Returns: Arrays of the shape (rows, columns).

    Errors: as :func:`read_image`.
    """
    (width, height), channels = _bidir.read_layers(os.fspath(path))
    return {name: _array(data, height, width, 1) for name, data in channels}
