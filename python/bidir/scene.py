"""Scenes: files of pbrt-v4 or glTF 2.0, or texts with files in memory."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeAlias

from bidir import _bidir
from bidir.errors import SceneError, SceneWarning

__all__ = ["Scene", "StrPath", "from_text", "load"]

StrPath: TypeAlias = str | os.PathLike[str]
#: Names of one file, and its bytes.
MemoryFile: TypeAlias = tuple[list[str], bytes]


class Scene:
    """A scene that can be rendered; immutable.

    Made by :func:`load`, :func:`from_text` or :class:`bidir.SceneBuilder`. It can be pickled: its files
    go with it, so that it is the same scene in another process and on another machine.
    """

    def __init__(self, name: StrPath, source: Mapping[str, Any]) -> None:
        """Read a scene; use :func:`load` or :func:`from_text`."""
        self._source = dict(source)
        self._native = _bidir.Scene(os.fspath(name), self._source)

    @property
    def name(self) -> str:
        """The scene file, as it was named."""
        return self._native.name

    @property
    def digest(self) -> str:
        """The SHA-256 of all that was read for the scene, in hexadecimal."""
        return self._native.digest

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the whole film. Unit: pixels."""
        width, height = self._native.resolution
        return (width, height)

    @property
    def crop(self) -> tuple[int, int, int, int]:
        """Left, top, right, bottom of what is rendered, the last two exclusive. Unit: pixels."""
        left, top, right, bottom = self._native.crop
        return (left, top, right, bottom)

    @property
    def shape(self) -> tuple[int, int, int]:
        """The shape of the scene's images: rows, columns, 3."""
        left, top, right, bottom = self.crop
        return (bottom - top, right - left, 3)

    @property
    def spp(self) -> int:
        """Samples per pixel that the file asks for."""
        return self._native.spp

    @property
    def settings(self) -> dict[str, str]:
        """The settings that the file asks for, by the names of flags."""
        return self._native.settings

    @property
    def light_groups(self) -> list[str]:
        """The groups of the scene's lights."""
        return self._native.light_groups

    @property
    def summary(self) -> dict[str, int]:
        """What the scene is made of: how many shapes, primitives, instances, lights and more."""
        return self._native.summary

    @property
    def warnings(self) -> list[str]:
        """What is odd but no error, each as ``file:line:column: text``."""
        return self._native.warnings

    @property
    def files(self) -> list[str]:
        """Every file that was read, by each name that it was asked for; the scene is the first."""
        return [os.fspath(name) for name in self._native.files]

    def __repr__(self) -> str:
        """Tell the file, the size and the beginning of the digest."""
        width, height = self.size
        return f"<bidir.Scene {self.name!r} {width} x {height} {self.digest[:12]}>"

    def packed(self) -> tuple[str, dict[str, Any]]:
        """Return the name and all files of the scene: what pickles have.

        Errors: :class:`bidir.FileError` where a file is no longer there.
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
    """Tell the warnings of a scene to who asked for it."""
    for text in scene.warnings:
        warnings.warn(text, SceneWarning, stacklevel=3)
    return scene


def _source(
    size: tuple[int, int] | None,
    crop: tuple[int, int, int, int] | None,
    lenient: bool,
    memory: list[MemoryFile],
) -> dict[str, Any]:
    return {"size": size, "crop": crop, "lenient": lenient, "memory": memory, "sealed": False}


def load(
    path: StrPath,
    *,
    size: tuple[int, int] | None = None,
    crop: tuple[int, int, int, int] | None = None,
    lenient: bool = False,
) -> Scene:
    """Read a scene: glTF 2.0 where the name ends in .gltf or .glb, else pbrt-v4.

    Args:
        path: The file.
        size: Width and height of the whole film instead of the file's; the view stays. Unit: pixels.
        crop: Left, top, right, bottom of what is rendered, the last two exclusive. Unit: pixels.
        lenient: Let something simpler stand in for what is not supported, with a warning.

    Warns: :class:`bidir.SceneWarning` of what is odd.

    Errors: :class:`bidir.SceneError` with file, line and column where the scene is wrong,
    :class:`bidir.UnsupportedError` where bidir lacks something, :class:`bidir.MissingFileError`.
    """
    return _told(Scene(path, _source(size, crop, lenient, [])))


def from_text(
    text: str,
    *,
    files: Mapping[str, bytes] | None = None,
    name: StrPath = "scene.pbrt",
    size: tuple[int, int] | None = None,
    crop: tuple[int, int, int, int] | None = None,
    lenient: bool = False,
) -> Scene:
    """Make a scene of a text of pbrt-v4.

    Args:
        text: The text.
        files: The bytes of meshes and images that the text names, by the names that it gives them;
            others are looked for on the disk.
        name: What errors call the text; files on the disk are looked for in its folder.
        size, crop, lenient: As for :func:`load`.

    Errors: as for :func:`load`.
    """
    folder = Path(name).parent
    memory: list[MemoryFile] = [([os.fspath(name)], text.encode())]
    for file, data in (files or {}).items():
        memory.append(([os.fspath(folder / file)], bytes(data)))
    return _told(Scene(name, _source(size, crop, lenient, memory)))
