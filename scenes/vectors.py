"""Vectors of three floats, with the same bits on every machine.

Only products, sums, divisions and square roots in a fixed order.
"""

from __future__ import annotations

import math

from scenes.scene import Array

Vector = tuple[float, float, float]

# A vector this close to length 1 came out of a normalisation (whose rounding is at most 4 units in the
# last place of the squared length): dividing again would only change its last bits.
UNIT_ROUNDING = 1e-15

# Unit columns whose box has less volume than this lie in a plane: float32 text alone is off by 1e-7 each
# way, double arithmetic by 1e-16.
FLAT_VOLUME = 1e-12


def vector(values: Array) -> Vector:
    """Three floats, without negative zeros, which would spell the same place in another way."""
    x, y, z = (float(value) + 0.0 for value in values)
    return x, y, z


def unit(values: Vector) -> Vector | None:
    """The vector divided by its length; itself where its length is 1; None where it has no direction."""
    largest = max(map(abs, values))
    if largest == 0.0 or not math.isfinite(largest):
        return None
    if abs(_squared(values) - 1.0) <= UNIT_ROUNDING:
        return values
    x, y, z = (value / largest for value in values)
    length = math.sqrt(_squared((x, y, z)))
    return x / length + 0.0, y / length + 0.0, z / length + 0.0


def upright(up: Vector, forward: Vector) -> Vector | None:
    """The unit vector nearest to `up` that is orthogonal to the unit vector `forward`; None without one."""
    start = unit(up)
    if start is None:
        return None
    along = (start[0] * forward[0] + start[1] * forward[1]) + start[2] * forward[2]
    if abs(along) <= UNIT_ROUNDING:
        return start
    x, y, z = (start[axis] - along * forward[axis] for axis in range(3))
    return unit((x, y, z)) if _squared((x, y, z)) > FLAT_VOLUME else None


def _squared(values: Vector) -> float:
    x, y, z = values
    return (x * x + y * y) + z * z
