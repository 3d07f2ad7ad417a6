"""What a pass makes on its way to the mask, for those who want to look at it."""

from __future__ import annotations

from dataclasses import dataclass

import moderngl

from renderers.map_pass import MapPass
from renderers.volume_pass import VolumePass
from scenes.map_frusta import MapFit


@dataclass(frozen=True)
class DrawnMap:
    """A map as it was last drawn.

    Attributes:
        drawing: Its texture, and where the faces stand in it.
        fit: How its faces look at the scene.
        linear: Whether depth is stored linear in the distance along a face's axis.
    """

    drawing: MapPass
    fit: MapFit
    linear: bool = False


@dataclass(frozen=True)
class Internals:
    """What there is to see of a pass after its last `render`; None where it has none.

    Attributes:
        map: The map that it compares with.
        volumes: The volumes that it counts.
        silhouette_pixels: A reversed depth texture of the frame's size, 0 wherever the volumes are not asked.
    """

    map: DrawnMap | None = None
    volumes: VolumePass | None = None
    silhouette_pixels: moderngl.Texture | None = None
