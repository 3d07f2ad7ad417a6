"""How much a level may draw, and how great and how small its numbers may be."""

from __future__ import annotations

from scenes.entry import Entry
from scenes.errors import LevelError
from scenes.vectors import Vector

# The GPU knows numbers up to 3.4e38: what is smaller by 1e8 survives sums and products with matrices.
LARGEST = 1e30
# What is divided by: its inverse is as great.
SMALLEST_DIVISOR = 1 / LARGEST

# 16 bytes for each fill a buffer of 128 MiB, as much as Mesa's software driver takes: longer lists do not
# fit into it.
MOST_TRIANGLES = 8_000_000
# As many as so many triangles have that share none.
MOST_VERTICES = 3 * MOST_TRIANGLES
# A node takes 50 to 100 microseconds to read, here as in trimesh: so many, a quarter of a minute.
MOST_NODES = 250_000


def require_moderate(entry: Entry, key: str, *values: float) -> None:
    """Checks a property's numbers.

    Raises:
        LevelError: One of them lies beyond what the GPU reckons with.
    """
    if any(abs(value) > LARGEST for value in values):
        raise entry.wrong(key, f"within {LARGEST:g}")


def require_divisor(entry: Entry, key: str, value: float, unit: str) -> None:
    """Checks a length or an angle by which shadows are divided.

    Raises:
        LevelError: It is so small or so great that the GPU would reckon with 0 or infinity.
    """
    if not SMALLEST_DIVISOR <= value <= LARGEST:
        raise entry.wrong(key, f"from {SMALLEST_DIVISOR:g} to {LARGEST:g} {unit}")


def require_near(position: Vector, what: str, where: str) -> Vector:
    """A world position as it is.

    Raises:
        LevelError: It lies farther out than the GPU reckons.
    """
    if max(map(abs, position)) > LARGEST:
        raise LevelError(
            f"This {what} is farther than {LARGEST:g} metres from the origin.",
            where=where,
            known=f"Its position is {position}.",
            remedy="Check the translations and scales of the node and of those above it.",
        )
    return position
