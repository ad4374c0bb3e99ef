"""What goes wrong, by whose fault it is.

Every exception of the package is a :class:`BidirError`. Those about a file have its place as
attributes, and their text is ``file:line:column: reason; hint``.
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
    "MissingFileError",
    "RenderError",
    "RenderInterruptedError",
    "SceneError",
    "SceneWarning",
    "SettingsError",
    "UnsupportedError",
]


class BidirError(Exception):
    """Anything that goes wrong in this package."""


class SettingsError(BidirError, ValueError):
    """A setting has a value that is not known, or does not fit the scene."""

    def __init__(self, message: str, **_place: object) -> None:
        super().__init__(message)


class RenderError(BidirError, RuntimeError):
    """A render cannot begin, such as for want of memory."""


class FilmError(BidirError, ValueError):
    """Films cannot become one: they are of different renders, or have the same passes."""


class _PlacedError(BidirError):
    """An error about a place in a file."""

    #: What is wrong, without the place and the hint.
    reason: str
    #: What to do about it, if there is something.
    hint: str | None
    #: The file that is at fault, if it is one.
    file: str | None
    #: The line, counted from 1; None where the whole file is at fault.
    line: int | None
    #: The column in characters, counted from 1; None where ``line`` is.
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
        """Pickles the place with the text, so that errors of other processes keep it."""
        return (_restore, (type(self), str(self), self.__dict__))


def _restore(kind: type[_PlacedError], message: str, place: dict[str, object]) -> _PlacedError:
    error = kind(message)
    error.__dict__.update(place)
    return error


class SceneError(_PlacedError):
    """A scene's text breaks the grammar of its format, or means nothing valid."""


class SceneWarning(UserWarning):
    """Something in a scene is odd but no error, told as ``file:line:column: text``."""


class UnsupportedError(SceneError):
    """The format has this and bidir does not; ``lenient=True`` may let something stand in."""


class DataError(_PlacedError):
    """A mesh, an image or a film file is broken."""


class FileError(_PlacedError, OSError):
    """The system refuses to read or write a file."""

    def __str__(self) -> str:
        """Tell the place and the reason, as all errors about files do."""
        return str(self.args[0]) if self.args else ""


class MissingFileError(FileError, FileNotFoundError):
    """A file that was named does not exist."""


class ExperimentError(_PlacedError):
    """An experiment has no results: its description is wrong, or something that it names."""


class RenderInterruptedError(KeyboardInterrupt):
    """Ctrl-C stopped a render; what was rendered is kept.

    It is a :class:`KeyboardInterrupt`, so that loops over renders end as they should. In a notebook
    ``sys.last_value.image`` has the picture.
    """

    #: The picture of the finished passes; None where there was none.
    image: Image | None

    def __init__(self, message: str, image: Image | None) -> None:
        super().__init__(message)
        self.image = image
