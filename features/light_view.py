"""One light of a level in one view: what the features are numbers about. Everything is found out once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from features.level_survey import LevelSurvey
from features.texel_sizes import TexelSizes, texel_sizes
from scenes.frusta import Reach, reach
from scenes.light_rays import in_reach, layers, light_rays, ways_to_light
from scenes.ray_caster import OFFSET_PER_EXTENT, Bools
from scenes.scene import Array, Light, View
from scenes.topology import face_signs
from scenes.view_samples import ViewSamples

GRID = (48, 30)
"""Cells across and down of the grid over the view: 1,440 rays, a few milliseconds."""

LIGHT_RAYS = 1024

NEIGHBOUR = 1 / 128
"""Of the view's height: how far apart the two places are between which a shadow's edge may run."""


@dataclass(frozen=True)
class Receivers:
    """What of a grid over the view lies in the light's reach and faces it.

    Attributes:
        asked: (m,) bool: which cells do.
        lit: (m,) bool: which of them the light sees.
        points: (m, 3) float64 world, metres.
        normals: (m, 3) float64 unit, towards the eye.
        ways: (m, 3) float64 unit, to the light.
        to_light: (m,) float64 metres; `inf` for a directional light.
        to_eye: (m,) float64 metres.
    """

    asked: Bools
    lit: Bools
    points: Array
    normals: Array
    ways: Array
    to_light: Array
    to_eye: Array


@dataclass(frozen=True, eq=False)
class LightView:
    """A light in a view of a level.

    Attributes:
        level: The level.
        light: One of its lights.
        view: From where, and how large.
    """

    level: LevelSurvey
    light: Light
    view: View

    @cached_property
    def within(self) -> Reach:
        """What the light can light, scene space."""
        return reach(self.light, self.level.origin)

    @cached_property
    def casting(self) -> Bools:
        """(t,) bool: which casting triangles the light may reach, by their boxes."""
        corners = self.level.corners
        return self.within.touches(corners.min(axis=1), corners.max(axis=1))

    @cached_property
    def casting_meshes(self) -> int:
        """Casting meshes, as drawn, whose boxes the light may reach."""
        return int(self.within.touches(*self.level.mesh_boxes).sum())

    @cached_property
    def silhouette(self) -> Array:
        """(s,) float64 lengths in metres of the edges at which the reached casters' volumes need a side."""
        light = self.light.homogeneous
        light[:3] -= light[3] * self.level.origin
        signs = np.where(self.casting, face_signs(self.level.corners, light), 0).astype(np.int8)
        topology = self.level.topology
        ends = self.level.positions.astype(np.float64)[topology.edges[topology.multiplicities(signs) != 0]]
        lengths: Array = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        return lengths

    @cached_property
    def layers(self) -> Array:
        """(n,) float64: casting surfaces along each of the light's rays."""
        rays = light_rays(self.light, self.level.scene.bounds, LIGHT_RAYS)
        return layers(self.level.casting, *rays)

    @cached_property
    def receivers(self) -> Receivers:
        """The middle of each cell."""
        return self._receivers((0.0, 0.0))

    @cached_property
    def asked_share(self) -> float:
        """Share of the view in which the light's shadows can be seen."""
        return float(self.receivers.asked.mean())

    @cached_property
    def crossings(self) -> tuple[Bools, Bools]:
        """(2, m) bool each: to the right and below, pairs of receivers, and those of which one is lit."""
        here = self.receivers
        there = [self._receivers((NEIGHBOUR, 0.0)), self._receivers((0.0, NEIGHBOUR))]
        both = np.stack([here.asked & other.asked for other in there])
        return both, both & np.stack([here.lit != other.lit for other in there])

    @cached_property
    def shadowed_layers(self) -> Array:
        """(n,) float64: casting surfaces between each shadowed receiver and the light."""
        found = self.receivers
        dark = found.asked & ~found.lit
        lifted = found.points[dark] + OFFSET_PER_EXTENT * self.level.extent_m * found.normals[dark]
        return layers(self.level.casting, lifted, found.ways[dark], found.to_light[dark])

    @cached_property
    def edge_distances(self) -> Array:
        """(n,) float64 metres from the eye to the cells beside which a shadow's edge runs."""
        _, crossed = self.crossings
        distances: Array = self.receivers.to_eye[crossed.any(axis=0)]
        return distances

    @cached_property
    def texels(self) -> TexelSizes:
        """How large the texels of maps would look."""
        found = self.receivers
        points = found.points[found.asked] - self.level.origin
        return texel_sizes(self.level, self.light, self.view, points, found.normals[found.asked])

    def _receivers(self, shift: tuple[float, float]) -> Receivers:
        samples = ViewSamples.of(self.level.seen, self.view, GRID, shift)
        ways, distances = ways_to_light(samples.points, self.light)
        asked = samples.shown & (np.einsum("ij,ij->i", samples.normals, ways) > 0)
        asked &= in_reach(self.light, ways, distances)
        lit = np.zeros(len(asked), bool)
        error = OFFSET_PER_EXTENT * self.level.extent_m
        lit[asked] = self.level.casting.lit(
            samples.points[asked], samples.normals[asked], self.light, position_error=error
        )
        return Receivers(asked, lit, samples.points, samples.normals, ways, distances, samples.distances)
