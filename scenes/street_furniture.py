"""What stands about in the example street: ground, lamps, stall, tree, fence, car, bench, bins, crates."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scenes.scene import Array, Mesh
from scenes.solids import (
    Color,
    Point,
    Shell,
    box,
    cards,
    cells,
    joined,
    loft,
    moved,
    placed,
    post,
    turned,
    wheel,
)

PAVEMENT_M = 0.125
LANTERN: Point = (5.5, 2.4375, -6.0)
LAMP_HEADS: tuple[Point, ...] = ((-12.5, 5.0, 2.5), (-3.0, 5.0, 2.5), (6.5, 5.0, 2.5))

IRON: Color = (0.05, 0.06, 0.06)
WOOD: Color = (0.30, 0.17, 0.08)
BARK: Color = (0.14, 0.09, 0.05)
LEAVES: Color = (0.12, 0.24, 0.05)


def furniture() -> Iterator[Mesh]:
    """Everything but the houses."""
    yield from _ground()
    yield from _lamps()
    yield from _stall()
    yield from _lantern()
    yield from _tree()
    yield from _car()
    yield _mesh("Garden fence", _fence(), (0.68, 0.66, 0.60))
    yield _mesh("Bench", _bench(), WOOD, [(-9.5, PAVEMENT_M, 5.25), (1.5, PAVEMENT_M, 5.25)])
    yield _mesh("Bin", _bin(), (0.12, 0.20, 0.15), [(-11.75, PAVEMENT_M, 4.75), (3.5, PAVEMENT_M, -4.0)])
    yield _mesh("Bollard", _bollard(), IRON, [(x, 0.0, -3.75) for x in (-8.5, 4.5, 6.5, 8.5)])
    yield _mesh("Crates", _crates(), (0.42, 0.27, 0.13))


def _mesh(name: str, shell: Shell, color: Color, places: list[Point] | None = None) -> Mesh:
    placements = np.tile(np.eye(4), (len(places or [0]), 1, 1))
    if places:
        placements[:, :3, 3] = places
    return placed(name, shell, color, placements)


def _ground() -> Iterator[Mesh]:
    yield _mesh("Road", box((-26.0, -0.5, -20.0), (26.0, 0.0, 20.0)), (0.17, 0.17, 0.18))
    strips = {
        "Kerb": (3.25, 3.5, 0.140625, (0.46, 0.45, 0.42)),
        "Pavement": (3.5, 6.75, PAVEMENT_M, (0.36, 0.33, 0.29)),
        "Yard": (6.75, 19.0, 0.0625, (0.09, 0.15, 0.05)),
    }
    for name, (near, far, height, color) in strips.items():
        both = [
            box((-25.0, -0.25, near), (25.0, height, far)),
            box((-25.0, -0.25, -far), (25.0, height, -near)),
        ]
        yield _mesh(name, joined(both), color)


def _lamps() -> Iterator[Mesh]:
    pole = [
        box((-0.1875, 0.0, 1.3125), (0.1875, 0.375, 1.6875)),
        post((0.0, 0.25, 1.5), (0.0, 5.25, 1.5), 0.09375, 0.0625),
        box((-0.03125, 5.125, -0.1875), (0.03125, 5.1875, 1.5)),
        # The light hangs under its shade, not inside it.
        post((0.0, 5.0625, 0.0), (0.0, 5.25, 0.0), 0.3125, 0.125),
    ]
    yield _mesh("Street lamp", joined(pole), IRON, [(x, 0.0, z) for x, _, z in LAMP_HEADS])


def _stall() -> Iterator[Mesh]:
    posts = [
        box((x, 0.0, z), (x + 0.09375, y, z + 0.09375))
        for x in (6.0, 9.0)
        for z, y in ((-7.5, 3.0), (-5.5, 2.5))
    ]
    counter = [
        box((6.125, 0.875, -6.25), (8.96875, 0.9375, -5.4375)),
        box((6.1875, 0.0, -6.125), (8.90625, 0.90625, -5.5625)),
    ]
    yield _mesh("Market stall", joined([*posts, *counter]), WOOD)
    slope = np.array(
        [(5.75, 3.125, -7.75), (5.75, 2.375, -4.875), (9.375, 2.375, -4.875), (9.375, 3.125, -7.75)]
    )
    yield _mesh("Market stall awning", loft(slope, slope + np.array([0.0, 0.0625, 0.0])), (0.50, 0.10, 0.06))
    tray = cells(
        [0, 0.03125, 0.5625, 0.59375], [0, 0.03125, 0.1875], [0, 0.03125, 0.40625, 0.4375], _hollow()
    )
    goods = [
        moved(tray, (6.375, 0.9375, -6.0625)),
        box((7.125, 0.921875, -6.0625), (7.5, 1.125, -5.6875)),
        box((7.75, 0.921875, -6.0), (8.625, 1.0625, -5.5625)),
        box((7.875, 1.0625, -5.9375), (8.375, 1.1875, -5.625)),
    ]
    yield _mesh("Market stall goods", joined(goods), (0.50, 0.34, 0.18))


def _hollow() -> Array:
    filled = np.ones((3, 2, 3), dtype=bool)
    filled[1, 1, 1] = False
    return filled


def _lantern() -> Iterator[Mesh]:
    """A cage that is open on all sides: its light is inside, and the bars cast."""
    x, y, z = LANTERN
    bars = [
        box((x + dx, y - 0.1875, z + dz), (x + dx + 0.03125, y + 0.1875, z + dz + 0.03125))
        for dx in (-0.140625, 0.109375)
        for dz in (-0.140625, 0.109375)
    ]
    cage = [
        box((x - 0.15625, y - 0.21875, z - 0.15625), (x + 0.15625, y - 0.171875, z + 0.15625)),
        post((x, y + 0.171875, z), (x, y + 0.34375, z), 0.25, 0.03125),
        box((x - 0.015625, y + 0.3125, z - 0.015625), (x + 0.015625, y + 0.5625, z + 0.015625)),
    ]
    stand = [
        post((x, 0.0, z - 0.75), (x, y + 0.625, z - 0.75), 0.0625, 0.0625),
        box((x - 0.03125, y + 0.53125, z - 0.8125), (x + 0.03125, y + 0.59375, z + 0.0625)),
    ]
    yield _mesh("Lantern", joined([*bars, *cage, *stand]), IRON)


def _tree() -> Iterator[Mesh]:
    x, z = -1.0, 9.5
    limbs = [
        post((x, -0.125, z), (x + 0.125, 2.5, z), 0.3125, 0.1875),
        post((x + 0.125, 2.375, z), (x - 0.875, 4.5, z - 0.5), 0.15625, 0.0625),
        post((x + 0.125, 2.375, z), (x + 1.0, 4.25, z - 0.375), 0.15625, 0.0625),
        post((x + 0.125, 2.375, z), (x + 0.25, 4.75, z + 0.75), 0.15625, 0.0625),
    ]
    yield _mesh("Tree", joined(limbs), BARK)
    yield _mesh("Tree leaves", moved(_leaves(120), (x, 4.75, z)), LEAVES)


def _leaves(count: int) -> Shell:
    """Square cards in every direction, spread over the crown, a ball 2.25 m in radius."""
    # Raw words of the generator, because only they are promised to stay the same in every NumPy.
    words = np.random.PCG64(1977).random_raw(45 * count)
    numbers = ((words >> 11) * 2.0**-53 * 2 - 1).reshape(3, -1, 3)
    inside = (numbers**2).sum(axis=2) < 1
    middle, along, other = (numbers[i][inside[i]][:count] for i in range(3))
    across = np.cross(along, other)
    size = 0.21875 + 0.09375 * middle[:, :1]
    along, across = (
        edge / np.sqrt((edge**2).sum(axis=1, keepdims=True)) * size * 2 for edge in (along, across)
    )
    return cards(2.25 * middle - (along + across) / 2, along, across)


def _fence() -> Shell:
    pickets = [
        box((x, 0.0, 6.8125), (x + 0.125, 1.0, 6.84375)) for x in np.arange(-4.125, 4.5, 0.75).tolist()
    ]
    rails = [box((-4.25, y, 6.828125), (4.5, y + 0.0625, 6.890625)) for y in (0.3125, 0.75)]
    return joined([*pickets, *rails])


def _car() -> Iterator[Mesh]:
    middle = (-6.0, 0.0, -2.25)
    side = [(-2, 0.3125), (2, 0.3125), (2.0625, 0.75), (1.125, 0.9375), (-1.9375, 0.9375), (-2.0625, 0.5)]
    cabin = [(-1.8125, 0.875), (1.0, 0.875), (0.3125, 1.4375), (-1.25, 1.4375)]
    body = [
        loft(*(np.array([(x, y, z) for x, y in outline]) for z in (-half, half)))
        for outline, half in ((side, 0.8125), (cabin, 0.71875))
    ]
    yield _mesh("Parked car", moved(joined(body), middle), (0.10, 0.22, 0.34))
    wheels = [wheel((x, 0.3125, z), 0.3125, 0.1875) for x in (-1.25, 1.25) for z in (-0.75, 0.75)]
    yield _mesh("Parked car wheels", moved(joined(wheels), middle), (0.03, 0.03, 0.03))


def _bench() -> Shell:
    slats = [box((-0.75, 0.40625, z), (0.75, 0.453125, z + 0.109375)) for z in (-0.1875, -0.046875, 0.09375)]
    back = [box((-0.75, y, 0.21875), (0.75, y + 0.109375, 0.265625)) for y in (0.5625, 0.75)]
    legs = [
        cells([x, x + 0.0625], [0.0, 0.421875, 0.90625], [-0.15625, 0.203125, 0.234375], [[[1, 1], [0, 1]]])
        for x in (-0.625, 0.5625)
    ]
    return joined([*slats, *back, *legs])


def _bin() -> Shell:
    return joined(
        [
            post((0.0, 0.0, 0.0), (0.0, 0.8125, 0.0), 0.21875, 0.28125),
            post((0.0, 0.78125, 0.0), (0.0, 0.9375, 0.0), 0.3125, 0.15625),
        ]
    )


def _bollard() -> Shell:
    return post((0.0, 0.0, 0.0), (0.0, 0.9375, 0.0), 0.09375, 0.078125)


def _crates() -> Shell:
    # (3, 4, 5) and (5, 12, 13) are right-angled: turns without a cosine from libm.
    crate = box((-0.34375, 0.0, -0.34375), (0.34375, 0.625, 0.34375))
    return joined(
        [
            moved(turned(crate, 0.8, 0.6), (-1.75, 0.0, -2.5)),
            moved(turned(crate, 12 / 13, -5 / 13), (-0.875, 0.0, -2.375)),
            moved(turned(crate, 12 / 13, 5 / 13), (-1.3125, 0.625, -2.4375)),
        ]
    )
