"""The eight houses of the example street.

In its own space a house stands on y = 0 with its front in the plane z = 0, looking along -Z.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum, auto

import numpy as np

from scenes.scene import Array, Mesh
from scenes.solids import Color, Shell, box, cards, cells, joined, loft, placed

STOREY_M = 3.0
FOUNDATION_M = 0.25
RECESS_M = 0.25
EAVES_M = 0.375
VERGE_M = 0.1875
# Parts that meet overlap by this much: no two surfaces share a plane.
SUNK_M = 0.0625
ROOF_M = 0.25
WINDOW_M = (1.0, 2.25)

BRICK: Color = (0.36, 0.13, 0.08)
GLASS: Color = (0.05, 0.08, 0.11)
STONE: Color = (0.42, 0.40, 0.36)
TILES: Color = (0.40, 0.12, 0.05)
SLATE: Color = (0.10, 0.11, 0.14)

# A roof's cross-section is two boards that meet at the ridge.
_RAFTERS = ((0, 1, 4), (0, 4, 5), (1, 2, 3), (1, 3, 4))


class Ridge(Enum):
    """How a roof's ridge runs: along the street, or across it with a gable to the front."""

    ALONG = auto()
    ACROSS = auto()


@dataclass(frozen=True)
class House:
    """One house; lengths in metres.

    Attributes:
        x: World place of its middle along the street.
        side: 1 for the south side of the street (front towards -Z), -1 for the north side.
        bays: Windows or doors beside each other.
        door: The bay with the door.
        ridge: How the ridge runs.
        rise: Height of the ridge over the walls.
    """

    x: float
    side: int
    width: float
    depth: float
    storeys: int
    bays: int
    door: int
    ridge: Ridge
    rise: float
    wall: Color
    roof: Color
    paint: Color

    @property
    def top(self) -> float:
        """Height of the walls."""
        return STOREY_M * self.storeys

    @property
    def bay_middles(self) -> Array:
        """(bays,) x of each bay's middle."""
        return ((np.arange(self.bays) + 0.5) / self.bays - 0.5) * self.width


HOUSES = (
    House(-16.5, 1, 8.0, 7.0, 2, 2, 0, Ridge.ALONG, 2.25, (0.70, 0.58, 0.40), TILES, (0.10, 0.22, 0.16)),
    House(-8.25, 1, 7.5, 8.0, 2, 2, 1, Ridge.ACROSS, 3.0, BRICK, SLATE, (0.55, 0.50, 0.42)),
    House(8.5, 1, 7.0, 6.5, 1, 2, 0, Ridge.ALONG, 2.5, (0.74, 0.72, 0.66), TILES, (0.08, 0.16, 0.30)),
    House(16.5, 1, 8.0, 8.0, 2, 2, 1, Ridge.ACROSS, 2.75, (0.55, 0.33, 0.13), SLATE, (0.30, 0.05, 0.04)),
    House(-17.0, -1, 7.5, 7.0, 1, 2, 1, Ridge.ACROSS, 3.25, (0.27, 0.34, 0.40), SLATE, (0.60, 0.45, 0.12)),
    House(-9.0, -1, 7.5, 7.5, 2, 2, 0, Ridge.ALONG, 2.5, (0.72, 0.66, 0.52), TILES, (0.28, 0.06, 0.05)),
    House(-1.0, -1, 7.5, 7.0, 2, 2, 1, Ridge.ACROSS, 2.75, (0.60, 0.30, 0.20), TILES, (0.10, 0.20, 0.14)),
    House(15.5, -1, 8.0, 7.5, 1, 2, 0, Ridge.ALONG, 2.75, (0.38, 0.43, 0.30), SLATE, (0.62, 0.58, 0.50)),
)


def houses() -> Iterator[Mesh]:
    """Walls, roof, chimney, door, panes and sills of every house."""
    for number, house in enumerate(HOUSES, start=1):
        parts = {
            "walls": (joined([_walls(house), _gable(house)]), house.wall),
            "roof": (_roof(house), house.roof),
            "chimney": (_chimney(house), BRICK),
            "door": (_door(house), house.paint),
            "panes": (_panes(house), GLASS),
            "sills": (_sills(house), STONE),
        }
        for part, (shell, color) in parts.items():
            yield placed(f"House {number} {part}", shell, color, _placement(house))


def _placement(house: House) -> Array:
    placement = np.diag([house.side, 1.0, house.side, 1.0])
    placement[:3, 3] = house.x, 0.0, 6.25 * house.side
    return placement[None]


def _walls(house: House) -> Shell:
    edges = house.bay_middles[:, None] + [-0.5, 0.5]
    x = [-house.width / 2, *edges.ravel(), house.width / 2]
    floors = STOREY_M * np.arange(house.storeys)[:, None] + WINDOW_M
    y = [-FOUNDATION_M, *floors.ravel(), house.top]
    filled = np.ones((len(x) - 1, len(y) - 1, 2), dtype=bool)
    filled[1::2, 1::2, 0] = False
    filled[2 * house.door + 1, 0, 0] = False
    return cells(x, y, [0.0, RECESS_M, house.depth], filled)


def _ridged(house: House, profile: Array, overhang: tuple[float, float], cap: Array | None = None) -> Shell:
    """`profile`, (n, 2) across the ridge and up, drawn out along the ridge."""
    length, middle = (house.depth, house.depth / 2) if house.ridge is Ridge.ACROSS else (house.width, 0.0)
    low, high = middle - length / 2 - overhang[0], middle + length / 2 + overhang[1]
    across, up = profile.T
    if house.ridge is Ridge.ACROSS:
        return loft(
            np.stack([across, up, np.full_like(up, low)], axis=1),
            np.stack([across, up, np.full_like(up, high)], axis=1),
            cap,
        )
    return loft(
        np.stack([np.full_like(up, high), up, across + house.depth / 2], axis=1),
        np.stack([np.full_like(up, low), up, across + house.depth / 2], axis=1),
        cap,
    )


def _half_span(house: House) -> float:
    return (house.width if house.ridge is Ridge.ACROSS else house.depth) / 2


def _gable(house: House) -> Shell:
    half = _half_span(house)
    profile = np.array([(-half, house.top), (half, house.top), (0.0, house.top + house.rise)])
    return _ridged(house, profile - [0.0, SUNK_M], (-SUNK_M, -SUNK_M))


def _roof(house: House) -> Shell:
    half = _half_span(house)
    slope = house.rise / half
    eaves = (half + EAVES_M, house.top - slope * EAVES_M)
    under = np.array([(-eaves[0], eaves[1]), (0.0, house.top + house.rise), eaves]) - [0.0, 2 * SUNK_M]
    profile = np.concatenate([under, under[::-1] + np.array([0.0, ROOF_M])])
    return _ridged(house, profile, (VERGE_M, VERGE_M), np.array(_RAFTERS))


def _chimney(house: House) -> Shell:
    x, z = (
        (0.75, 0.625 * house.depth)
        if house.ridge is Ridge.ACROSS
        else (house.width / 4, house.depth / 2 - 0.5)
    )
    high = house.top + house.rise + 0.75
    return box((x - 0.3125, house.top, z - 0.3125), (x + 0.3125, high, z + 0.3125))


def _door(house: House) -> Shell:
    x = float(house.bay_middles[house.door])
    half = 0.5 + SUNK_M
    return box((x - half, -FOUNDATION_M / 2, 0.125), (x + half, WINDOW_M[1] + SUNK_M, RECESS_M + SUNK_M))


def _windows(house: House) -> Array:
    """(n, 2) x of the middle and y of the lower edge of every window."""
    x, y = np.meshgrid(house.bay_middles, STOREY_M * np.arange(house.storeys) + WINDOW_M[0], indexing="ij")
    places = np.stack([x, y], axis=-1)
    is_window = np.ones(x.shape, dtype=bool)
    is_window[house.door, 0] = False
    return np.asarray(places[is_window])


def _panes(house: House) -> Shell:
    x, y = _windows(house).T
    corner = np.stack([x + 0.5, y, np.full_like(x, RECESS_M - SUNK_M)], axis=1)
    height = WINDOW_M[1] - WINDOW_M[0]
    return cards(corner, np.tile([-1.0, 0.0, 0.0], (len(x), 1)), np.tile([0.0, height, 0.0], (len(x), 1)))


def _sills(house: House) -> Shell:
    return joined(
        box((x - 0.625, y - 0.125, -0.125), (x + 0.625, y + SUNK_M / 2, SUNK_M))
        for x, y in _windows(house).tolist()
    )
