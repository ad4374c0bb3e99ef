"""Checks of arguments: what is meant is accepted, and all else is a :class:`bidir.SettingsError`.

Its text names the argument, the expected values and the given one.
"""

from __future__ import annotations

import inspect
import math
import operator
import os
from collections.abc import Iterable
from typing import NoReturn

from bidir import _bidir
from bidir.errors import SettingsError

__all__ = ["count", "name", "number", "refuse", "size", "value", "whole_numbers"]

#: The pixels of a side of a film.
_LARGEST_SIDE = 65536


def refuse(argument: str, expected: str, given: object) -> NoReturn:
    """Raise the error of an argument."""
    shown = _bidir.printable(repr(given))
    raise SettingsError(f"{argument}: expected {expected}, not {shown[:80]}")


def _whole(given: object) -> int | None:
    """Return a whole number, of numpy too. None: it is none."""
    if isinstance(given, bool):
        return None
    try:
        return operator.index(given)  # type: ignore[arg-type]
    except TypeError:
        return None


def count(argument: str, given: object, least: int = 0, most: int = 2**64 - 1) -> int:
    """Return a whole number within a range."""
    number = _whole(given)
    if number is not None and least <= number <= most:
        return number
    refuse(argument, f"a whole number from {least} to {'2**64 - 1' if most == 2**64 - 1 else most}", given)


def number(argument: str, given: object, *, above: bool = False) -> float:
    """Return a number of at least 0; ``above``: more than 0."""
    expected = "a number above 0" if above else "a number, 0 or more"
    if isinstance(given, (str, bytes, bool)):
        refuse(argument, expected, given)
    try:
        found = float(given)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        refuse(argument, expected, given)
    if math.isnan(found) or found < 0 or (above and found == 0):
        refuse(argument, expected, given)
    return found


def whole_numbers(argument: str, given: object, length: int, example: str) -> tuple[int, ...]:
    """Return a fixed number of whole numbers, of 32 bits each."""
    if isinstance(given, Iterable) and not isinstance(given, (str, bytes)):
        numbers = [_whole(each) for each in given]
        found = [each for each in numbers if each is not None and 0 <= each < 2**32]
        if len(numbers) == len(found) == length:
            return tuple(found)
    refuse(argument, f"{length} whole numbers, such as {example}", given)


def size(argument: str, given: object) -> tuple[int, int]:
    """Return width and height, also of a text as ``--size`` has it."""
    sides = given.lower().split("x") if isinstance(given, str) else given
    if isinstance(sides, Iterable) and not isinstance(sides, bytes):
        numbers = [
            int(side) if isinstance(side, str) and side.strip().isdecimal() else _whole(side)
            for side in sides
        ]
        found = [side for side in numbers if side is not None and 1 <= side <= _LARGEST_SIDE]
        if len(numbers) == len(found) == 2:
            return (found[0], found[1])
    refuse(argument, f'width and height, such as (640, 480) or "640x480", up to {_LARGEST_SIDE} each', given)


def name(argument: str, given: object, expected: str = "the name of a file") -> str:
    """Return the name of a file."""
    try:
        found = os.fspath(given)  # type: ignore[call-overload]
    except TypeError:
        refuse(argument, expected, given)
    if not isinstance(found, str):
        refuse(argument, expected, given)
    return found


def value(given: object, kind: type) -> object:
    """Return the value of a class of settings that was given without parentheses; anything else as it is."""
    if not (inspect.isclass(given) and issubclass(given, kind) and given is not kind):
        return given
    try:
        return given()
    except TypeError as error:
        message = f"{given.__name__} needs arguments, such as bidir.{given.__name__}(…): {error}"
        raise SettingsError(message) from error
