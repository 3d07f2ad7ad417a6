from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from scenes.scene import LightKind, Mobility
from tests import tolerances
from tests.scenes.gltf_samples import (
    carrying,
    document,
    lit,
    notes_of,
    read,
)

HALF = math.sqrt(0.5)


def test_light_kinds_with_their_defaults_in_world_space(tmp_path: Path) -> None:
    turned = {"rotation": [-HALF, 0, 0, HALF], "translation": [1, 2, 3], "scale": [2, 2, 2]}
    nodes = [carrying(0, **turned), carrying(1, **turned), carrying(2, **turned)]
    lights = [
        {"type": "spot", "spot": {}},
        {"type": "point", "range": 7, "intensity": 40, "color": [1, 0.5, 0.25]},
        {"type": "directional"},
    ]
    spot, point, sun = read(tmp_path, lit(*lights, nodes=nodes)).scene.lights
    assert [light.kind for light in (spot, point, sun)] == [
        LightKind.SPOT,
        LightKind.POINT,
        LightKind.DIRECTIONAL,
    ]
    # A quarter turn about -x takes -z to -y.
    for light in (spot, sun):
        np.testing.assert_allclose(light.direction, (0, -1, 0), rtol=0, atol=tolerances.QUATERNION)
    assert spot.position == (1.0, 2.0, 3.0)
    assert (spot.inner_cone_rad, spot.outer_cone_rad) == (0.0, math.pi / 4)
    assert (spot.range_m, spot.intensity, spot.color) == (math.inf, 1.0, (1.0, 1.0, 1.0))
    # The range is in metres of the world: the node's scale leaves it alone.
    assert (point.range_m, point.intensity, point.color) == (7.0, 40.0, (1.0, 0.5, 0.25))


def test_an_untransformed_light_has_no_negative_zeros(tmp_path: Path) -> None:
    (light,) = read(tmp_path, lit({"type": "directional"})).scene.lights
    assert repr(light.direction) == "(0.0, 0.0, -1.0)"


def test_every_node_that_shares_a_light_definition_gets_its_own_light(tmp_path: Path) -> None:
    nodes = [
        carrying(0, name="Torch.001"),
        carrying(0),
        carrying(1),
        carrying(0, name="Torch.001", translation=[1, 0, 0]),
    ]
    lights = read(
        tmp_path, lit({"type": "point", "name": "Torch"}, {"type": "point"}, nodes=nodes)
    ).scene.lights
    assert [light.name for light in lights] == ["Torch.001", "Torch", "light 2", "Torch.001"]
    assert [light.node for light in lights] == [0, 1, 2, 3]


@pytest.mark.parametrize("outer", [math.pi / 2, float(np.float32(math.pi / 2))])
def test_a_spot_of_90_degrees_is_legal_as_float32_too(tmp_path: Path, outer: float) -> None:
    spot = {"type": "spot", "spot": {"outerConeAngle": outer, "innerConeAngle": outer}}
    level = read(tmp_path, lit(spot))
    assert level.scene.lights[0].outer_cone_rad == math.pi / 2
    assert level.scene.lights[0].inner_cone_rad == math.pi / 2
    assert "ends without a fall-off" in notes_of(level)


def test_mobility_comes_from_node_extras_before_light_extras(tmp_path: Path) -> None:
    static, dynamic = {"gnomon_mobility": "static"}, {"gnomon_mobility": "dynamic"}
    lights = [{"type": "point", "extras": static}, {"type": "point", "extras": "my lamp"}]
    nodes = [
        carrying(0),
        carrying(0, extras=dynamic),
        carrying(1, extras=static),
        carrying(1, extras=[1]),
        carrying(1, extras={"gnomon_mobility": "sttic"}, name="Typo"),
        carrying(1, extras={"gnomon_mobility": ["static"]}),
    ]
    level = read(tmp_path, lit(*lights, nodes=nodes))
    assert [light.mobility for light in level.scene.lights] == [
        Mobility.STATIC,
        Mobility.DYNAMIC,
        Mobility.STATIC,
        Mobility.DYNAMIC,
        Mobility.DYNAMIC,
        Mobility.DYNAMIC,
    ]
    assert 'warning node 4 "Typo": gnomon_mobility in its extras must be' in notes_of(level)


def test_cameras_are_orthonormal_under_scale_and_shear(tmp_path: Path) -> None:
    lens = {"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.25, "zfar": 10}}
    nodes = [
        {
            "camera": 0,
            "name": "Door",
            "scale": [3, 3, 3],
            "rotation": [0, HALF, 0, HALF],
            "translation": [1, 2, 3],
        },
        {"camera": 0, "matrix": [1, 0, 0, 0, 0, 2, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1]},
    ]
    source = document(nodes=nodes, scenes=[{"nodes": [0, 1]}], cameras=[lens])
    turned, sheared = read(tmp_path, source).scene.cameras
    assert (turned.name, turned.node, turned.position) == ("Door", 0, (1.0, 2.0, 3.0))
    assert (turned.yfov_rad, turned.near_m) == (0.8, 0.25)
    # A quarter turn about y takes -z to -x.
    np.testing.assert_allclose(turned.forward, (-1, 0, 0), rtol=0, atol=tolerances.QUATERNION)
    assert turned.up == (0.0, 1.0, 0.0)
    assert (sheared.name, sheared.forward, sheared.up) == ("camera 1", (0.0, 0.0, -1.0), (0.0, 1.0, 0.0))


def test_orthographic_cameras_are_skipped_with_a_note(tmp_path: Path) -> None:
    lens = {"type": "orthographic", "name": "Map", "orthographic": {}}
    level = read(tmp_path, document(nodes=[{"camera": 0}], scenes=[{"nodes": [0]}], cameras=[lens]))
    assert level.scene.cameras == ()
    assert 'warning camera 0 "Map" on node 0: Orthographic' in notes_of(level)
