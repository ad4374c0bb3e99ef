"""Errors by cause.

Every exception of the package is a :class:`BidirError`. Those about a file have its place as
attributes, and their text is ``file:line:column: reason; hint``, or ``file: value: reason; hint``
for a value of a glTF file.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from bidir.image import Image

__all__ = [
    "BidirError",
    "DataError",
    "ExperimentError",
    "FileError",
    "FilmError",
    "LayerError",
    "MissingFileError",
    "RenderError",
    "RenderInterruptedError",
    "SceneError",
    "SceneWarning",
    "SettingsError",
    "UnsupportedError",
]


class BidirError(Exception):
    """Base class of all errors of this package, except ``RenderInterruptedError``."""


class SettingsError(BidirError, ValueError):
    """A setting has an unknown value, or one that does not fit the scene."""

    def __init__(self, message: str, **_place: object) -> None:
        super().__init__(message)


class LayerError(BidirError, KeyError):
    """An image lacks a layer."""

    def __str__(self) -> str:
        """Return the message without quotes, as other errors do."""
        return str(self.args[0]) if self.args else ""


class RenderError(BidirError, RuntimeError):
    """A render cannot start, for example because memory is short."""


class FilmError(BidirError, ValueError):
    """Films cannot be merged: they belong to different renders, or passes overlap."""


class _PlacedError(BidirError):
    """An error about a place in a file."""

    #: The reason, without place and hint.
    reason: str
    #: A remedy, if there is one.
    hint: str | None
    #: The file with the error, if there is one.
    file: str | None
    #: The line, counted from 1; None for glTF, and if the error concerns the whole file.
    line: int | None
    #: The column in characters, counted from 1; None if ``line`` is None.
    column: int | None

    def __init__(
        self,
        message: str,
        *,
        reason: str = "",
        hint: str | None = None,
        file: str | None = None,
        line: int | None = None,
        column: int | None = None,
    ) -> None:
        super().__init__(message)
        self.reason = reason or message
        self.hint = hint
        self.file = file
        self.line = line
        self.column = column

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the place with the text, so that errors of other processes keep it."""
        return (_restore, (type(self), str(self), self.__dict__))


def _restore(kind: type[_PlacedError], message: str, place: dict[str, object]) -> _PlacedError:
    error = kind(message)
    error.__dict__.update(place)
    return error


class SceneError(_PlacedError):
    """A scene is invalid."""


class SceneWarning(UserWarning):
    """A warning about a scene, as ``file:line:column: text``; in glTF ``file: value: text``."""


class UnsupportedError(SceneError):
    """bidir does not support a feature of the format; ``lenient=True`` replaces many."""


class DataError(_PlacedError):
    """A mesh, an image or a film file is broken."""


class FileError(_PlacedError, OSError):
    """The system cannot read or write a file."""

    def __str__(self) -> str:
        """Return the place and the reason, as all errors about files do."""
        return str(self.args[0]) if self.args else ""


class MissingFileError(FileError, FileNotFoundError):
    """A file does not exist."""


class ExperimentError(_PlacedError):
    """An experiment fails: its description is invalid, or a file it names."""


class RenderInterruptedError(KeyboardInterrupt):
    """Ctrl-C stopped a render; the image of the finished passes is kept.

    It is a :class:`KeyboardInterrupt`, so it ends loops over renders. In a notebook,
    ``sys.last_value.image`` is the image.
    """

    #: The image of the finished passes; None if no pass is finished.
    image: Image | None

    def __init__(self, message: str, image: Image | None) -> None:
        super().__init__(message)
        self.image = image
