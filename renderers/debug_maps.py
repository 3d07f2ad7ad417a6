"""What a shadow map holds and how well it samples the screen, as numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from renderers.frame import Frame
from renderers.internals import DrawnMap
from scenes.scene import Array
from scenes.texel_footprint import screen_footprints

LARGEST_SHOWN = 1024
"""Texels along a face; of a larger one each block of texels is shown by the one nearest the light."""
LARGEST_OF_SIX = 512

FACE_NAMES = ("+X", "-X", "+Y", "-Y", "+Z", "-Z")
Depths = npt.NDArray[np.float32]


def light_place(frame: Frame) -> Array:
    """(4,) float64: the frame's light in scene space, (position, 1) or (unit vector towards it, 0)."""
    place = frame.light.homogeneous
    place[:3] -= place[3] * frame.world.origin
    return place


def face_depths(shown: DrawnMap, most: int = LARGEST_SHOWN) -> Depths:
    """(k, s, s) float32: depths of the faces as they are stored, top row first, 0 where nothing was drawn.

    Args:
        shown: The map.
        most: s at most.
    """
    drawing = shown.drawing
    side, rows, columns = drawing.side, drawing.rows, drawing.columns
    atlas = np.frombuffer(drawing.texture.read(alignment=1), np.float32)
    cells = atlas.reshape(rows, side, columns, side).swapaxes(1, 2).reshape(-1, side, side)
    faces: Depths = cells[: len(shown.fit.faces), ::-1]
    block = -(-side // most)
    if block == 1 or not len(faces):
        return faces
    missing = -side % block
    padded = np.pad(faces, ((0, 0), (0, missing), (0, missing))) if missing else faces
    count = padded.shape[1] // block
    nearest: Depths = padded.reshape(-1, count, block, count, block).max(axis=(2, 4))
    return nearest


def distances(shown: DrawnMap, light: Array, most: int = LARGEST_SHOWN) -> Array:
    """(k, s, s) float64 metres from the light to what each texel holds, NaN where nothing, top row first.

    From a sun, the distance along its rays from where the first thing stands that is on the map.

    Args:
        shown: The map; warped or not, depth is taken back through its own projection.
        light: (4,) its place in scene space.
        most: s at most.
    """
    depths = face_depths(shown, most)
    if not len(depths):
        return np.zeros((0, 0, 0))
    found = np.stack(
        [_distances(face, depth, light, shown) for face, depth in zip(shown.fit.faces, depths, strict=True)]
    )
    if light[3] == 0 and np.isfinite(found).any():
        found -= np.nanmin(found)
    return found


def _distances(face: Array, depth: Depths, light: Array, shown: DrawnMap) -> Array:
    drawn = depth > 0
    if not face.any() or not drawn.any():
        return np.full(depth.shape, np.nan)
    z = _projected(face, depth.astype(float)) if shown.linear else depth.astype(float)
    block = -(-shown.drawing.side // len(depth))
    middles = (np.arange(len(depth)) + 0.5) * block / shown.drawing.side * 2 - 1
    back = np.linalg.inv(face)
    across, down = back[:, 0, None] * middles, back[:, 1, None] * -middles
    places = across[:, None, :] + down[:, :, None] + back[:, 2, None, None] * z + back[:, 3, None, None]
    positions = places[:3] / np.where(drawn, places[3], 1)
    if light[3] == 0:
        lengths = -np.einsum("c,cij->ij", light[:3], positions)
    else:
        lengths = np.linalg.norm(positions - light[:3, None, None], axis=0)
    return np.where(drawn, lengths, np.nan)


def _projected(face: Array, depth: Array) -> Array:
    """Depth as projected, from depth that is linear along the axis; see `map_linear_depth.glsl`."""
    a = face[2, :3] @ face[3, :3] / (face[3, :3] @ face[3, :3])
    b = face[2, 3] - a * face[3, 3]
    near, far = b / (1 - a), -b / a
    projected: Array = a + b / (far - depth * (far - near))
    return projected


@dataclass(frozen=True)
class Sampling:
    """How a map samples what the camera sees, top row first.

    Attributes:
        footprints: (h, w) float64 the longest extent of a texel in pixels; NaN where the map shows nothing.
        texels: (h, w, 3) int64 face, column and row of each pixel's texel; -1 where there is none.
    """

    footprints: Array
    texels: npt.NDArray[np.int64]


def sampling(frame: Frame, shown: DrawnMap) -> Sampling:
    """How the map samples the surfaces that the frame's camera sees within its light's reach."""
    surfaces, domain = frame.read_surfaces(), frame.read_domain()
    footprints = np.full(domain.shape, np.nan)
    texels = np.full((*domain.shape, 3), -1)
    points = surfaces.positions[domain] - frame.world.origin
    normals = surfaces.normals[domain]
    of_face = _faces_towards(points - light_place(frame)[:3]) if len(shown.fit.faces) == 6 else None
    found, places = np.full(len(points), np.nan), np.full((len(points), 3), -1)
    for index, face in enumerate(shown.fit.faces):
        rows = face[[0, 1, 3]]
        q = points @ rows[:, :3].T + rows[:, 3]
        inside = (q[:, 2] > 0) & (np.abs(q[:, :2]) <= q[:, 2:]).all(axis=1)
        if of_face is not None:
            inside &= of_face == index
        if not face.any() or not inside.any():
            continue
        side = shown.drawing.side
        size = frame.width, frame.height
        found[inside] = screen_footprints(
            points[inside], normals[inside], rows[None], side, frame.clip_from_scene, size
        )[0]
        cells = (q[inside, :2] / q[inside, 2:] + 1) / 2 * side
        places[inside, 0] = index
        places[inside, 1:] = np.floor(cells)
    footprints[domain], texels[domain] = found, places
    return Sampling(footprints, texels)


def _faces_towards(from_light: Array) -> npt.NDArray[np.int64]:
    """(n,) the cube's face that each direction (n, 3) points to."""
    axis = np.argmax(np.abs(from_light), axis=1)
    negative = np.take_along_axis(from_light, axis[:, None], axis=1)[:, 0] < 0
    faces: npt.NDArray[np.int64] = 2 * axis + negative
    return faces
