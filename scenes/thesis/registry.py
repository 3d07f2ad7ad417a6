"""The thesis' scenes by key, built when called.

Source: J. Sindholt, A comparison of Shadow Algorithms, IMM-Thesis-2005-37 (DTU 2005), section 7: what each
scene is, how many triangles it has and what it is to show. The meshes are not those of the thesis.
"""

from __future__ import annotations

from collections.abc import Callable

from scenes.scene import Scene
from scenes.thesis.box_grid import box_grid
from scenes.thesis.open_geometry import fence, moebius, tree
from scenes.thesis.rocks import rocks
from scenes.thesis.room import room
from scenes.thesis.street import street
from scenes.thesis.water_tower import water_tower

THESIS_SCENES: dict[str, Callable[[], Scene]] = {
    "box_grid": box_grid,
    "rocks": rocks,
    "street": street,
    "room": room,
    "water_tower": water_tower,
}
"""In the order of figure 46. All closed meshes, over an open floor."""

OPEN_SCENES: dict[str, Callable[[], Scene]] = {"tree": tree, "fence": fence, "moebius": moebius}
"""The tree of figure 57, and two more on which volumes of closed meshes fail."""
