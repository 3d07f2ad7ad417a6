"""Cameras of a USD stage.

Source: OpenUSD, "UsdGeomCamera": it looks along -Z with +Y up; focal length and aperture share a unit.
"""

from __future__ import annotations

import math

from scenes.level import NoteBook
from scenes.magnitudes import LARGEST, SMALLEST_DIVISOR
from scenes.scene import Array, Camera
from scenes.usd.values import Prim, number, path_of, value
from scenes.vectors import unit, upright, vector


def read_camera(
    prim: Prim, world: Array, name: str, unit_m: float, index: int, notes: NoteBook
) -> Camera | None:
    """The perspective camera of a prim; None, with a note, where it is none that can be rendered.

    Args:
        prim: The camera.
        world: (4, 4) float64, metres and Y up from its own space.
        name: What to call it.
        unit_m: Length of a stage unit in metres.
        index: Its number among the stage's cameras.
        notes: For what is odd about it.

    Raises:
        LevelError: One of its numbers is not finite.
    """
    where = path_of(prim)
    if str(value(prim.GetAttribute("projection"))) != "perspective":
        notes.warning(where, "Orthographic cameras are not read yet: skipped.")
        return None
    focal = number(prim, prim.GetAttribute("focalLength"))
    aperture = number(prim, prim.GetAttribute("verticalAperture"))
    clipping = value(prim.GetAttribute("clippingRange"))
    try:
        near = float(clipping[0]) * unit_m
    except (TypeError, IndexError):
        near = 0.0
    forward = unit(vector(-world[:3, 2]))
    up = upright(vector(world[:3, 1]), forward) if forward is not None else None
    position = vector(world[:3, 3])
    problem = (
        "its focal length and vertical aperture must be above 0"
        if not (focal > 0.0 and aperture > 0.0)
        else "its clippingRange must begin above 0"
        if not SMALLEST_DIVISOR <= near <= LARGEST
        else "its transform leaves it without a direction"
        if forward is None or up is None
        else f"it is farther than {LARGEST:g} metres from the origin"
        if max(map(abs, position)) > LARGEST
        else ""
    )
    if problem or forward is None or up is None:
        notes.warning(where, f"Skipped: {problem}.")
        return None
    yfov = 2.0 * math.atan(aperture / (2.0 * focal))
    return Camera(name, position, forward, up, yfov, near, node=index)
