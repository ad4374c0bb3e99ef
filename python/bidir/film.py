"""Films: the exact sums of a render, to keep, to merge and to develop."""

from __future__ import annotations

import os
from collections.abc import Iterable
from functools import reduce
from typing import TYPE_CHECKING

from bidir import _bidir
from bidir.errors import FilmError
from bidir.scene import StrPath

if TYPE_CHECKING:
    from bidir.image import Image

__all__ = ["Film"]


class Film:
    """The exact sums of some passes of a render; immutable.

    A pass is one sample of every pixel. Sums are integers, so merging films of different passes in any
    order gives the bits of one render. ``a == b`` compares render, passes and bits. Films can be pickled.
    """

    def __init__(self, native: _bidir.Film) -> None:
        """Wrap a native film; use :meth:`load` or :attr:`bidir.Image.film`."""
        self._native = native

    @classmethod
    def load(cls, path: StrPath) -> Film:
        """Read a film file, as ``bidir render --checkpoint`` and :meth:`save` write them.

        Errors: :class:`bidir.MissingFileError`, :class:`bidir.DataError` if it is damaged.
        """
        return cls(_bidir.Film.load(os.fspath(path)))

    @classmethod
    def from_bytes(cls, data: bytes) -> Film:
        """Read the bytes of a film file; errors are those of :meth:`load`."""
        return cls(_bidir.Film.from_bytes(data))

    @staticmethod
    def merge(*films: Film | Iterable[Film]) -> Film:
        """Add films of different passes of one render; the order does not matter.

        Errors: :class:`bidir.FilmError` if there is no film, if they belong to different renders, or if
        passes overlap.
        """
        all_films: list[Film] = []
        for film in films:
            all_films.extend([film] if isinstance(film, Film) else film)
        if not all_films:
            raise FilmError("there is no film to merge")
        return reduce(lambda a, b: Film(a._native.merged(b._native)), all_films)

    def save(self, path: StrPath) -> None:
        """Write a film file; after an error, an older file is unchanged.

        Errors: :class:`bidir.FileError`, also if it would replace a file of the scene.
        """
        self._native.save(os.fspath(path))

    def to_bytes(self) -> bytes:
        """Return the bytes of a film file."""
        return self._native.to_bytes()

    def develop(self) -> Image:
        """Return the image of all passes."""
        from bidir.image import Image

        return Image(self)

    @property
    def passes(self) -> list[range]:
        """The passes, as disjoint ranges in ascending order."""
        return [range(begin, end) for begin, end in self._native.passes]

    @property
    def spp(self) -> int:
        """The number of passes: samples per pixel."""
        return sum(map(len, self.passes))

    def missing(self, passes: range) -> list[range]:
        """Return the missing ones of ``passes``, as ranges in ascending order."""
        gaps = []
        begin = passes.start
        for here in self.passes:
            if begin < min(here.start, passes.stop):
                gaps.append(range(begin, min(here.start, passes.stop)))
            begin = max(begin, here.stop)
        if begin < passes.stop:
            gaps.append(range(begin, passes.stop))
        return gaps

    @property
    def identity(self) -> str:
        """A hash of all that determines the bits, except the passes; films of one identity can be merged."""
        return self._native.identity

    @property
    def settings(self) -> dict[str, str]:
        """The contents of the identity by name: every setting, the scene's digest, versions."""
        return self._native.settings

    @property
    def scene(self) -> str:
        """The name of the scene file, without folders."""
        return self._native.scene

    @property
    def stopping(self) -> str:
        """The stopping rule: ``fixed``, ``time`` or ``noise``."""
        return self._native.stopping

    @property
    def seconds(self) -> float:
        """Render time, summed over all parts. Unit: seconds."""
        return self._native.seconds

    @property
    def counts(self) -> dict[str, int]:
        """Counters: ``samples``, ``rays.total``, ``candidates-evaluated``, ``dropped`` and more."""
        return self._native.counts

    @property
    def noise(self) -> float:
        """The estimated RMS error of the pixels relative to the mean."""
        return self._native.noise

    def __eq__(self, other: object) -> bool:
        """Return True if both have the same passes of the same render, bit for bit."""
        if not isinstance(other, Film):
            return NotImplemented
        return self._native.equals(other._native)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the bytes of the film file."""
        return (Film.from_bytes, (self.to_bytes(),))

    def __repr__(self) -> str:
        """Return the scene, the passes and the beginning of the identity."""
        passes = ", ".join(f"{part.start}..{part.stop}" for part in self.passes) or "none"
        return f"<bidir.Film {self.scene!r} passes {passes} {self.identity[:12]}>"
