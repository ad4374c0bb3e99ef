"""Scenes: files of pbrt-v4 or glTF 2.0, or texts with files in memory."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeAlias

from bidir import _bidir, check
from bidir.errors import SceneError, SceneWarning

__all__ = ["Scene", "StrPath", "from_text", "load"]

StrPath: TypeAlias = str | os.PathLike[str]
#: Names of one file, and its bytes.
MemoryFile: TypeAlias = tuple[list[str], bytes]


class Scene:
    """An immutable scene.

    :func:`load`, :func:`from_text` and :class:`bidir.SceneBuilder` make scenes. A pickle contains the
    scene's files, so it is the same scene in another process and on another machine.
    """

    def __init__(self, name: StrPath, source: Mapping[str, Any]) -> None:
        """Read a scene; use :func:`load` or :func:`from_text`."""
        self._source = dict(source)
        self._native = _bidir.Scene(os.fspath(name), self._source)

    @property
    def name(self) -> str:
        """The name of the scene file, as given."""
        return self._native.name

    @property
    def digest(self) -> str:
        """The SHA-256 of all files of the scene, in hexadecimal."""
        return self._native.digest

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the whole film. Unit: pixels."""
        width, height = self._native.resolution
        return (width, height)

    @property
    def crop(self) -> tuple[int, int, int, int]:
        """Left, top, right, bottom of the rendered rectangle, the last two exclusive. Unit: pixels."""
        left, top, right, bottom = self._native.crop
        return (left, top, right, bottom)

    @property
    def shape(self) -> tuple[int, int, int]:
        """The shape of the scene's images: rows, columns, 3."""
        left, top, right, bottom = self.crop
        return (bottom - top, right - left, 3)

    @property
    def spp(self) -> int:
        """Samples per pixel set in the file."""
        return self._native.spp

    @property
    def settings(self) -> dict[str, str]:
        """The settings in the file, by the names of flags."""
        return self._native.settings

    @property
    def light_groups(self) -> list[str]:
        """The groups of the scene's lights."""
        return self._native.light_groups

    @property
    def summary(self) -> dict[str, int]:
        """Numbers of shapes, primitives, instances, lights and more."""
        return self._native.summary

    @property
    def warnings(self) -> list[str]:
        """The warnings, each as ``file:line:column: text``; in glTF ``file: value: text``."""
        return self._native.warnings

    @property
    def files(self) -> list[str]:
        """Every file read, under each name used for it; the scene is the first."""
        return [os.fspath(name) for name in self._native.files]

    def __repr__(self) -> str:
        """Return the file, the size and the beginning of the digest."""
        width, height = self.size
        return f"<bidir.Scene {self.name!r} {width} x {height} {self.digest[:12]}>"

    def packed(self) -> tuple[str, dict[str, Any]]:
        """Return the name and all files of the scene, as pickles contain them.

        Errors: :class:`bidir.FileError` if a file no longer exists.
        """
        known = {name: data for names, data in self._source["memory"] for name in names}
        names_of: dict[str, list[str]] = {}
        for name in self.files:
            identity = name if name in known else os.path.realpath(name)
            names = names_of.setdefault(identity, [])
            if name not in names:
                names.append(name)
        memory: list[MemoryFile] = []
        for identity, names in names_of.items():
            data = known[identity] if identity in known else Path(identity).read_bytes()
            memory.append((names, data))
        return self.name, {**self._source, "memory": memory, "sealed": True}

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the scene with its files."""
        return (_unpack, (*self.packed(), self.digest))


def _unpack(name: str, source: Mapping[str, Any], digest: str) -> Scene:
    scene = Scene(name, source)
    if scene.digest != digest:
        # A file changed between reading and packing.
        raise SceneError(f"{name}: a file of the scene changed after it was read")
    return scene


def _told(scene: Scene) -> Scene:
    """Warn the caller of each warning of a scene."""
    for text in scene.warnings:
        warnings.warn(_bidir.printable(text), SceneWarning, stacklevel=3)
    return scene


def _source(
    size: tuple[int, int] | str | None,
    crop: tuple[int, int, int, int] | None,
    lenient: bool,
    memory: list[MemoryFile],
) -> dict[str, Any]:
    if size is not None:
        size = check.size("size", size)
    if crop is not None:
        left, top, right, bottom = check.whole_numbers("crop", crop, 4, "(0, 0, 320, 240)")
        crop = (left, top, right, bottom)
        if left >= right or top >= bottom:
            check.refuse("crop", "left, top, right and bottom of a rectangle with pixels", crop)
    return {"size": size, "crop": crop, "lenient": bool(lenient), "memory": memory, "sealed": False}


def load(
    path: StrPath,
    *,
    size: tuple[int, int] | str | None = None,
    crop: tuple[int, int, int, int] | None = None,
    lenient: bool = False,
) -> Scene:
    """Read a scene: glTF 2.0 if the name ends in .gltf or .glb, otherwise pbrt-v4.

    Args:
        path: The file.
        size: Width and height of the whole film instead of the file's, such as ``(640, 480)`` or
            ``"640x480"``; the view stays. Unit: pixels.
        crop: Left, top, right, bottom of the rendered rectangle, the last two exclusive. Unit: pixels.
        lenient: Replace unsupported features by simpler ones, with a warning.

    Warns: :class:`bidir.SceneWarning` for each warning of the scene.

    Errors: :class:`bidir.SceneError` with file, line and column if the scene is invalid,
    :class:`bidir.UnsupportedError` for unsupported features, :class:`bidir.MissingFileError`.
    """
    return _told(Scene(check.name("path", path), _source(size, crop, lenient, [])))


def from_text(
    text: str,
    *,
    files: Mapping[str, bytes] | None = None,
    name: StrPath = "scene.pbrt",
    size: tuple[int, int] | str | None = None,
    crop: tuple[int, int, int, int] | None = None,
    lenient: bool = False,
) -> Scene:
    """Make a scene from pbrt-v4 text.

    Args:
        text: The text.
        files: Contents of meshes and images by their names in the text; other files are read from disk.
        name: The name of the text in messages; files on disk are relative to its folder.
        size, crop, lenient: As for :func:`load`.

    Errors: as for :func:`load`.
    """
    folder = Path(name).parent
    memory: list[MemoryFile] = [([os.fspath(name)], text.encode())]
    for file, data in (files or {}).items():
        memory.append(([os.fspath(folder / file)], bytes(data)))
    return _told(Scene(name, _source(size, crop, lenient, memory)))
