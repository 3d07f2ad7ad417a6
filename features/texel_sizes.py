"""How large texels of a light's maps would look on the screen: ordinary, fitted to the view, and warped."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from features.level_survey import LevelSurvey
from scenes.convex import Body, clip_planes
from scenes.frusta import camera_view, reach, reversed_infinite
from scenes.light_space_warp import light_space_warps
from scenes.map_frusta import face_bodies, fit_faces
from scenes.perspective_warp import ahead_of, warps
from scenes.receivers import receiver_body
from scenes.scene import Array, Light, View
from scenes.texel_footprint import screen_footprints, weighted_percentile
from scenes.virtual_camera import virtual_cameras
from scenes.warped_map import PERCENT, STEEPEST, WIDEST_CONE_RAD

MAP_SIDE = 1024
SHRINK = 1 - 8 / MAP_SIDE
"""What is left between four guard texels on either side; maps of other sizes differ by a per cent."""

WARPS = np.array([0.02, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2])
"""Free parameters of the light-space warp (Wimmer, Scherzer and Purgathofer 2004, section 4)."""

SLIDES = np.array([0.0, 0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0])
"""How far the virtual camera moves back, in depths of the receivers (Stamminger and Drettakis 2002)."""


@dataclass(frozen=True)
class TexelSizes:
    """Longest extent in pixels of a texel of maps of 1024 a side: 95th percentile of what is seen, else 0.

    Attributes:
        light: Of a map that covers all that the light lights.
        view: Of one that covers what the view shows of it.
        warped: Of the best warped one of either kind, even where it is worse; of `view` where none can be.
    """

    light: float
    view: float
    warped: float


def texel_sizes(level: LevelSurvey, light: Light, view: View, points: Array, normals: Array) -> TexelSizes:
    """The sizes at (n, 3) points with (n, 3) unit normals, scene space, all seen and facing the light."""
    camera = view.camera
    rotation = camera_view(camera)
    eye_from_scene = rotation.copy()
    eye_from_scene[:3, 3] = -rotation[:3, :3] @ (np.asarray(camera.position) - level.origin)
    aspect = view.width / view.height
    clip_from_scene = reversed_infinite(camera.yfov_rad, aspect, camera.near_m) @ eye_from_scene
    ahead = points @ -eye_from_scene[2, :3] - eye_from_scene[2, 3] > camera.near_m
    points, normals = points[ahead], normals[ahead]
    if not len(points):
        return TexelSizes(0.0, 0.0, 0.0)
    within, low, high = reach(light, level.origin), *level.receivers
    planes = clip_planes(clip_from_scene)
    planes[-1, 3] -= camera.near_m
    sizes = _Sizes(light, within.centre, points, normals, clip_from_scene, (view.width, view.height))
    whole, focused = receiver_body(low, high, within), receiver_body(low, high, within, planes)
    return TexelSizes(
        light=_percentile(sizes.ordinary(whole)),
        view=_percentile(sizes.ordinary(focused)),
        warped=_percentile(sizes.warped(focused, level.origin, eye_from_scene)),
    )


@dataclass(frozen=True)
class _Sizes:
    light: Light
    centre: Array
    points: Array
    normals: Array
    clip_from_scene: Array
    size: tuple[int, int]

    def ordinary(self, body: Body) -> Array:
        """(n,) float64 pixels on the ordinary map of a body; 0 where no face shows a point."""
        bodies = face_bodies(self.light, self.centre, body)
        fit = fit_faces(self.light, self.centre, bodies, SHRINK)
        found = np.zeros(len(self.points))
        for part, face in zip(bodies, fit.faces, strict=False):
            inside = self._inside(part)
            if face.any() and inside.any():
                found[inside] = self._extents(face[None, [0, 1, 3]], inside)[0]
        return found

    def warped(self, body: Body, origin: Array, eye_from_scene: Array) -> Array:
        """(n,) float64 pixels on warped maps, face by face the best in the 95th percentile."""
        found = self.ordinary(body)
        light = self.light.homogeneous
        light[:3] -= light[3] * origin
        for part in face_bodies(self.light, self.centre, body):
            inside = self._inside(part)
            if not inside.any():
                continue
            rows = _warped_maps(light, ahead_of(light, part.corners), eye_from_scene)
            # Points are exact and boxes generous, but rays are float32: a hair outside, w may vanish.
            rows = rows[(self.points[inside] @ rows[:, 2, :3].T + rows[:, 2, 3]).min(axis=0) > 0]
            if len(rows):
                extents = self._extents(rows, inside)
                sizes = weighted_percentile(extents, np.ones(extents.shape[1]), PERCENT)
                found[inside] = extents[int(sizes.argmin())]
        return found

    def _inside(self, body: Body) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
        if not len(body.planes):
            return np.zeros(len(self.points), bool)
        planes = body.planes / np.linalg.norm(body.planes[:, :3], axis=1, keepdims=True)
        slack = 1e-6 * np.abs(self.points).max(initial=1e-30)
        inside = (self.points @ planes[:, :3].T + planes[:, 3] >= -slack).all(axis=1)
        return np.asarray(inside)

    def _extents(self, maps: Array, inside: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> Array:
        points, normals = self.points[inside], self.normals[inside]
        return screen_footprints(points, normals, maps, MAP_SIDE, self.clip_from_scene, self.size)


def _warped_maps(light: Array, corners: Array, eye_from_scene: Array) -> Array:
    """(k, 3, 4) rows x, y and w of those warps of either kind in which the receivers lie well inside."""
    across = light_space_warps(light, corners, -eye_from_scene[2, :3], WARPS, SHRINK)
    w = corners @ across[:, 2, :3].T + across[:, 2, 3]
    cameras = virtual_cameras(eye_from_scene, corners, SLIDES, tight=True, clipped=True)
    found = warps(cameras, light, SHRINK)
    after = np.einsum("kc,knc->kn", found.rows[:, 2, :3], cameras.corners) + found.rows[:, 2, 3:]
    usable = (found.half_angles < WIDEST_CONE_RAD) & (after.min(axis=1) > STEEPEST * after.max(axis=1))
    return np.concatenate([across[w.min(axis=0) > STEEPEST * w.max(axis=0)], found.rows[usable]])


def _percentile(values: Array) -> float:
    known = values[values > 0]
    return float(np.percentile(known, PERCENT)) if len(known) else 0.0
