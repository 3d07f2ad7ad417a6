"""A depth map on which casters cover every texel that they touch, however thin they are."""

from __future__ import annotations

from typing import cast

import moderngl

from renderers import shader
from renderers.map_pass import MapPass
from renderers.run_drawer import RunDrawer
from renderers.world import World
from scenes.frusta import Reach
from scenes.map_frusta import MapFit


class CoveringMapPass(MapPass):
    """The same map from casters that a geometry shader has grown by half a texel on all sides.

    A triangle that reaches behind the light is not grown.
    """

    def __init__(self, world: World, side: int, faces: int, offset: tuple[float, float]) -> None:
        super().__init__(world, side, faces, offset)
        gpu = world.gpu
        self._growing = shader.program(
            gpu,
            shader.source("map_pass.glsl", "caster_vertex"),
            shader.source("map_pass.glsl", "nothing"),
            shader.source("covering_map.glsl", "grow"),
        )
        self._matrix = cast(moderngl.Uniform, self._growing["map_from_scene"])
        self._casters = RunDrawer(gpu, world.vertex_array(self._growing), len(world.clusters.low))
        self._owned.append(self._casters)

    def draw(self, fit: MapFit, within: Reach) -> None:
        """Fill the map with the casters that `within` may hold, as `fit` sees them."""
        cast(moderngl.Uniform, self._growing["half_texel"]).value = (1 / self.side, 1 / self.side)
        super().draw(fit, within)
