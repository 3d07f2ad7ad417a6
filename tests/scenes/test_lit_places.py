"""Places that lights light: edge-on faces, panes, and what lies behind them."""

from __future__ import annotations

import numpy as np

from scenes.lit_places import lit_places
from scenes.playable_space import PlayableSpace
from scenes.ray_caster import Indices, RayCaster
from scenes.scene import Array, Light, LightKind, Mesh, Scene
from tests.solids import box, floor

SUN = Light("Sun", LightKind.DIRECTIONAL, direction=(0.0, -1.0, 0.0))
LAMP = Light("Lamp", LightKind.POINT, (0.0, 3.0, 0.0))
# It stands in the plane x = 0, which holds the lamp.
SCREEN = Mesh("screen", np.array([[0.0, 0, 1], [0, 2, 1], [0, 0, 2]]), np.array([[0, 1, 2]]))


class EdgeOn(RayCaster):
    """Strikes the screen with every ray that runs in its plane, as float32 now and then does."""

    screen = 0

    def hits(self, origins: Array, directions: Array) -> tuple[Array, Indices]:
        distance, triangle = super().hits(origins, directions)
        along = directions[:, 0] == 0.0
        return distance, np.where(along & (triangle >= 0), self.screen, triangle)


def test_a_face_that_is_struck_edge_on_is_no_lit_place() -> None:
    scene = Scene("screened", (SCREEN, floor(6.0)))
    caster = EdgeOn(scene, casters_only=False)
    _, struck = caster.hits(np.array([[0.0, 3, 0]]), np.array([[0.0, -1, 0]]))
    assert struck.tolist() == [EdgeOn.screen]
    places = lit_places(scene, LAMP, PlayableSpace.of(scene, caster))
    assert places
    for place in places:
        assert np.isfinite([*place.point, *place.normal, place.cost]).all()
        assert abs(place.normal @ place.to_light) > 0
        assert np.linalg.norm(place.normal) > 0.999


class AllEdgeOn(RayCaster):
    """All its triangles lie in the plane x = 0."""

    def corners(self, triangle: Indices) -> Array:
        return super().corners(triangle) * [0.0, 1.0, 1.0]


def test_a_light_that_strikes_edge_on_only_has_no_places() -> None:
    scene = Scene("box", (box((0, 0, 0), (1, 1, 1)),))
    assert lit_places(scene, SUN, PlayableSpace.of(scene, RayCaster(scene, casters_only=False)))
    assert lit_places(scene, SUN, PlayableSpace.of(scene, AllEdgeOn(scene, casters_only=False))) == []


def test_light_goes_through_what_casts_nothing() -> None:
    pane = box((0, 4, 0), (30, 0.1, 30), casts=False)
    scene = Scene("greenhouse", (floor(20.0), pane))
    heights = {
        round(float(place.point[1]), 3)
        for place in lit_places(scene, SUN, PlayableSpace.of(scene, RayCaster(scene, casters_only=False)))
    }
    assert 0.0 in heights
    assert heights <= {0.0, 3.9, 4.1}


def test_behind_what_casts_nothing_is_lit() -> None:
    roof = box((0, 4, 0), (30, 0.1, 30))
    scene = Scene("hall", (floor(20.0), roof))
    places = lit_places(scene, SUN, PlayableSpace.of(scene, RayCaster(scene, casters_only=False)))
    assert {round(float(place.point[1]), 3) for place in places} == {4.1}
