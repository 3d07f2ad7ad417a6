"""Cameras that hold a view's receivers tightly, for maps that are drawn after the camera's perspective."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scenes.scene import Array

# Virtual near and far stand off the receivers by this share.
NEAR_FAR_MARGIN = 0.02
# Of the far distance: what is nearer does not bend the perspective further.
NEAREST = 1e-3
NARROWEST = 1e-9


@dataclass(frozen=True)
class VirtualCameras:
    """Cameras on one axis, each further back than the one before, that hold the receivers.

    Attributes:
        clip_from_scene: (k, 4, 4) float64; receivers within -1 .. 1 in x, y and z.
        corners: (k, n, 3) float64, scene space: what the maps have to show.
        projected: (k, n, 3) float64: the same after each camera's perspective.
    """

    clip_from_scene: Array
    corners: Array
    projected: Array


def virtual_cameras(
    eye_from_scene: Array, corners: Array, slides: Array, *, tight: bool = True, clipped: bool = True
) -> VirtualCameras:
    """Cameras that hold the receivers, moved back along their axis.

    Args:
        eye_from_scene: (4, 4) float64 view matrix of the real camera.
        corners: (n, 3) float64 of the receivers' body, in front of the camera.
        slides: (k,) float64 how far back, in depths of the receivers. The farther back, the weaker the
            perspective, until the map is an ordinary one (Kozlov 2004).
        tight: Whether x and y fit the receivers too, rather than being centred on the axis.
        clipped: Whether maps show the receivers alone (Kozlov's cube clipping), or all that a camera sees.
    """
    local = corners @ eye_from_scene[:3, :3].T + eye_from_scene[:3, 3]
    depth = -local[:, 2]
    far = (1 + NEAR_FAR_MARGIN) * float(depth.max())
    near = max((1 - NEAR_FAR_MARGIN) * float(depth.min()), NEAREST * far)
    back = slides * (far - near)
    ratios = local[None, :, :2] / (back[:, None] + depth)[..., None]
    low, high = ratios.min(axis=1), ratios.max(axis=1)
    if not tight:
        high = np.abs(ratios).max(axis=1)
        low = -high
    forward = -eye_from_scene[2] + back[:, None] * np.array([0.0, 0, 0, 1])
    clip: Array = np.zeros((len(slides), 4, 4))
    clip[:, :2] = eye_from_scene[:2] - ((low + high) / 2)[..., None] * forward[:, None]
    clip[:, :2] /= np.maximum((high - low) / 2, NARROWEST)[..., None]
    first, last = near + back, far + back
    clip[:, 2] = (last + first)[:, None] * forward
    clip[:, 2, 3] -= 2 * first * last
    clip[:, 2] /= (last - first)[:, None]
    clip[:, 3] = forward
    if clipped:
        everywhere = np.broadcast_to(corners, (len(slides), *corners.shape))
        return VirtualCameras(clip, everywhere, projected(clip, everywhere))
    cube = np.array([[x, y, z] for x in (-1.0, 1) for y in (-1.0, 1) for z in (-1.0, 1)])
    cubes = np.broadcast_to(cube, (len(slides), 8, 3))
    return VirtualCameras(clip, projected(np.asarray(np.linalg.inv(clip), float), cubes), cubes)


def projected(matrices: Array, points: Array) -> Array:
    """(k, n, 3) float64: (k, n, 3) points through (k, 4, 4) projective matrices, divided by w."""
    q = np.einsum("krc,knc->knr", matrices[..., :3], points) + matrices[:, None, :, 3]
    divided: Array = q[..., :3] / q[..., 3:]
    return divided
