"""A camera that moves a little from frame to frame, to see what flickers."""

from __future__ import annotations

from dataclasses import replace
from math import cos, radians, sin, tan

import numpy as np

from scenes.scene import Array, Camera

STEP_PX = 0.5
"""Image motion per frame: errors that are glued to the world move along, those glued to the map do not."""

_HEADING_RAD = radians(
    27.0
)  # above the picture's right: no row and no column of pixels is moved along itself
_TURNED = 0.2  # of the motion comes from turning, which moves near and far alike


def camera_path(
    camera: Camera, distance_m: float, height_px: int, steps: int, *, step_px: float = STEP_PX
) -> tuple[Camera, ...]:
    """A steady move aside and a slight turn in `steps` steps; it begins with `camera` itself.

    Args:
        camera: Where it begins.
        distance_m: Along the line of sight, of what is to move by `step_px` a step: the median receiver's.
            What is nearer moves faster, what is farther never by less than a fifth of that.
        height_px: Pixels down the picture.
        steps: How many; one less than there are frames.
        step_px: Image motion in a step, in the middle of the picture.
    """
    pixel_rad = 2 * tan(camera.yfov_rad / 2) / height_px
    step_m = (1 - _TURNED) * step_px * pixel_rad * distance_m
    turn_rad = _TURNED * step_px * pixel_rad
    forward, up = np.array(camera.forward), np.array(camera.up)
    heading = cos(_HEADING_RAD) * np.cross(forward, up) + sin(_HEADING_RAD) * up
    axis = np.cross(forward, heading)

    def frame(index: int) -> Camera:
        turned_forward = cos(index * turn_rad) * forward + sin(index * turn_rad) * heading
        turned_heading = cos(index * turn_rad) * heading - sin(index * turn_rad) * forward
        turned_up = sin(_HEADING_RAD) * turned_heading - cos(_HEADING_RAD) * axis
        return replace(
            camera,
            name=f"{camera.name}, frame {index + 1}",
            position=_triple(np.array(camera.position) + index * step_m * heading),
            forward=_triple(turned_forward),
            up=_triple(turned_up),
        )

    return (camera, *(frame(index) for index in range(1, steps + 1)))


def _triple(vector: Array) -> tuple[float, float, float]:
    return float(vector[0]), float(vector[1]), float(vector[2])
