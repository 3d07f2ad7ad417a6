"""Attribute values as plain numbers and arrays, at the one time at which a level is read.

That time is the earliest: an attribute with time samples gives its first one, any other its default.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt
from pxr import Usd

from scenes.errors import LevelError
from scenes.magnitudes import LARGEST

Prim = Any
"""A Usd.Prim: usd-core comes without types."""

MEND = "Mend it in the editor that made it, and export it again."
FIRST_TIME = Usd.TimeCode.EarliestTime()


def value(attribute: Any) -> Any:
    """What an attribute says at the one time; None where it says nothing, or does not exist.

    Raises:
        LevelError: Its value has a type that USD does not know outside of itself.
    """
    if not attribute:
        return None
    try:
        return attribute.Get(FIRST_TIME)
    except TypeError:
        raise wrong(attribute.GetPrim(), attribute, "a value", "a background or an opaque value") from None


def path_of(prim: Prim) -> str:
    """The path of a prim, for messages; where instances share it, the path by its first instance."""
    inner = ""
    # The numbers in the names of prototypes differ from run to run.
    while prim.IsInPrototype():
        prototype = prim
        while not prototype.IsPrototype():
            prototype = prototype.GetParent()
        inner = str(prim.GetPath())[len(str(prototype.GetPath())) :] + inner
        prim = min(prototype.GetInstances(), key=lambda instance: str(instance.GetPath()))
    return str(prim.GetPath()) + inner


def number(prim: Prim, attribute: Any, fallback: float = 0.0) -> float:
    """A number of moderate size; `fallback` where the attribute has no value.

    Raises:
        LevelError: It is not finite, or beyond what the GPU reckons with.
    """
    found = value(attribute)
    if found is None:
        return fallback
    if not (isinstance(found, int | float) and math.isfinite(found) and abs(found) <= LARGEST):
        raise wrong(prim, attribute, f"a number within {LARGEST:g}", found)
    return float(found)


def color(prim: Prim, attribute: Any) -> tuple[float, float, float]:
    """Three moderate numbers; white where the attribute has no value.

    Raises:
        LevelError: One is not finite, or beyond what the GPU reckons with.
    """
    found = value(attribute)
    if found is None:
        return 1.0, 1.0, 1.0
    try:
        red, green, blue = (float(part) for part in found)
    except (TypeError, ValueError):
        raise wrong(prim, attribute, "three numbers", found) from None
    if not all(math.isfinite(part) and abs(part) <= LARGEST for part in (red, green, blue)):
        raise wrong(prim, attribute, f"three numbers within {LARGEST:g}", found)
    return red, green, blue


def array(attribute: Any, dtype: npt.DTypeLike, shape: tuple[int, ...] = (-1,)) -> npt.NDArray[Any]:
    """The attribute's array as a read-only copy of that shape, empty where it has no value.

    Raises:
        LevelError: It is no array of numbers.
    """
    copied = np.array(borrowed(attribute, dtype, shape))
    copied.flags.writeable = False
    return copied


def borrowed(attribute: Any, dtype: npt.DTypeLike, shape: tuple[int, ...] = (-1,)) -> npt.NDArray[Any]:
    """The same, perhaps in USD's own memory: to be copied and not to be kept.

    USD maps binary files, and their numbers change with the file on disk.

    Raises:
        LevelError: It is no array of numbers.
    """
    found = value(attribute)
    try:
        # Asked for the type that it has already, numpy takes longer.
        numbers = np.asarray(() if found is None else found)
        if numbers.dtype != dtype:
            numbers = numbers.astype(dtype)
        return numbers if numbers.shape[1:] == shape[1:] else numbers.reshape(shape)
    except (TypeError, ValueError, OverflowError):
        raise wrong(attribute.GetPrim(), attribute, "an array of numbers", type(found).__name__) from None


def wrong(prim: Prim, attribute: Any, expected: str, found: object) -> LevelError:
    """The error for an attribute that is not what is expected."""
    return LevelError(
        f"{attribute.GetName()} must be {expected}.",
        where=path_of(prim),
        known=f"It is {found}.",
        remedy=MEND,
    )
