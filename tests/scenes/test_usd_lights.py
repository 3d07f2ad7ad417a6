"""UsdLux lights as punctual ones, each with words about what that loses."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from scenes.level import Level
from scenes.scene import LightKind, Mobility
from tests.scenes.usd_samples import read, xform

SHAPING = '(prepend apiSchemas = ["ShapingAPI"])'


def noted(level: Level, where: str, what: str) -> bool:
    return any(note.where == where and what in note.text for note in level.notes)


@pytest.mark.parametrize(
    ("text", "kind", "intensity", "said"),
    [
        # A sphere's shadow is a disc: L pi r^2, and a quarter of the power where that is given.
        ("SphereLight; float inputs:radius = 2", LightKind.POINT, 3 * math.pi * 4, "sphere of 2 m"),
        ("SphereLight; float inputs:radius = 0", LightKind.POINT, 3 / 4, ""),
        ("SphereLight; bool inputs:normalize = 1", LightKind.POINT, 3 / 4, "sphere of 0.5 m"),
        ("DiskLight; float inputs:radius = 2", LightKind.SPOT, 3 * math.pi * 4, "disc of 2 m"),
        ("RectLight; float inputs:width = 2; float inputs:height = 5", LightKind.SPOT, 30, "2 x 5 m"),
        (
            "CylinderLight; float inputs:radius = 1; float inputs:length = 4",
            LightKind.POINT,
            3 * 2 * math.pi * 4 / 4,
            "tube of 4 m",
        ),
        ("DistantLight; float inputs:angle = 0", LightKind.DIRECTIONAL, 3, ""),
        ("DistantLight; bool inputs:normalize = 1", LightKind.DIRECTIONAL, 3, "0.53 degrees"),
        (
            "DistantLight; float inputs:angle = 60",
            LightKind.DIRECTIONAL,
            3 * math.pi * math.sin(math.radians(30)) ** 2,
            "60 degrees",
        ),
        ("SphereLight; float inputs:radius = 0; float inputs:exposure = 2", LightKind.POINT, 3, ""),
    ],
)
def test_kind_and_intensity(tmp_path: Path, text: str, kind: LightKind, intensity: float, said: str) -> None:
    schema, _, rest = text.partition(";")
    level = read(tmp_path, f'def {schema} "L" {{ float inputs:intensity = 3; {rest} }}')
    (light,) = level.scene.lights
    assert light.kind is kind
    assert light.intensity == pytest.approx(intensity)
    assert light.direction == (0.0, 0.0, -1.0)
    assert light.range_m == math.inf
    assert noted(level, "/L", said) == bool(said)
    if kind is LightKind.SPOT:
        assert light.outer_cone_rad == pytest.approx(math.radians(80))
        assert light.inner_cone_rad == 0.0


def test_sizes_are_those_in_the_world(tmp_path: Path) -> None:
    lamp = 'def RectLight "L" { float inputs:intensity = 1 }'
    (light,) = read(tmp_path, xform(lamp, "scale", value="(2, 3, 1)"), "metersPerUnit = 0.5").scene.lights
    assert light.intensity == pytest.approx(2 * 3 / 4)


@pytest.mark.parametrize(
    ("angle", "kind", "degrees"), [(40, "spot", 40), (90, "spot", 90), (120, "point", 0)]
)
def test_shaping_makes_a_spot_of_a_sphere(tmp_path: Path, angle: int, kind: str, degrees: int) -> None:
    cone = f"float inputs:shaping:cone:angle = {angle}; float inputs:shaping:cone:softness = 0.25"
    (light,) = read(tmp_path, f'def SphereLight "L" {SHAPING} {{ {cone} }}').scene.lights
    assert light.kind == kind
    if degrees:
        assert light.outer_cone_rad == pytest.approx(math.radians(degrees))
        assert light.inner_cone_rad == pytest.approx(0.75 * math.radians(degrees))


def test_shaping_narrows_a_flat_lamp(tmp_path: Path) -> None:
    for angle, degrees in ((30, 30), (85, 80), (180, 80)):
        text = f'def DiskLight "L" {SHAPING} {{ float inputs:shaping:cone:angle = {angle} }}'
        (light,) = read(tmp_path, text).scene.lights
        assert light.outer_cone_rad == pytest.approx(math.radians(degrees))


def test_what_is_left_out_or_lost_is_noted(tmp_path: Path) -> None:
    level = read(
        tmp_path,
        'def DomeLight "Dome" { }'
        'def SphereLight "Off" (prepend apiSchemas = ["ShadowAPI"]) { bool inputs:shadow:enable = 0 }'
        'def SphereLight "Hidden" { token visibility = "invisible" }'
        'def SphereLight "Linked" { rel collection:lightLink:includes = </Dome> }'
        'def SphereLight "Negative" { float inputs:intensity = -1 }'
        f'def SphereLight "Focused" {SHAPING} {{ float inputs:shaping:focus = 3 }}'
        'def Mesh "Shining" (prepend apiSchemas = ["MeshLightAPI"]) { }',
    )
    assert [(light.name, light.node) for light in level.scene.lights] == [
        ("Linked", 3),
        ("Negative", 4),
        ("Focused", 5),
    ]
    for where, what in (
        ("/Dome", "ignored: it shines from everywhere"),
        ("/Off", "turned its shadow off"),
        ("/Hidden", "invisible"),
        ("/Linked", "Light linking is ignored"),
        ("/Negative", "takes light away"),
        ("/Focused", "focus"),
        ("/Shining", "not as a light"),
    ):
        assert noted(level, where, what), where


def test_colour_and_mobility(tmp_path: Path) -> None:
    level = read(
        tmp_path,
        'def SphereLight "A" { color3f inputs:color = (1, 0.5, 0.25);'
        ' custom token gnomon:mobility = "static" }'
        'def SphereLight "B" { bool inputs:enableColorTemperature = 1; float inputs:colorTemperature = 3000 }'
        'def SphereLight "C" { custom token gnomon:mobility = "sometimes" }',
    )
    plain, warm, odd = level.scene.lights
    assert (plain.color, plain.mobility) == ((1.0, 0.5, 0.25), Mobility.STATIC)
    assert warm.color[0] > warm.color[1] > warm.color[2]
    assert odd.mobility is Mobility.DYNAMIC
    assert noted(level, "/C", "gnomon:mobility")


def test_lights_of_instances_have_numbers_and_names(tmp_path: Path) -> None:
    lamp = 'class Xform "Lamp" { def Xform "Arm" { def SphereLight "Bulb" { } } }'
    top = 'def "Top" (instanceable = true; inherits = </Lamp>) { }'
    post = f'class Xform "Post" {{ {top} def SphereLight "Foot" {{ }} }}'
    placed = "".join(f'def "P{index}" (instanceable = true; inherits = </Post>) {{ }}' for index in range(2))
    # Prototypes hang below an `over` where they are not to be drawn in place.
    crowd = (
        'def PointInstancer "Many" { rel prototypes = </Off/Lamp>; int[] protoIndices = [0];'
        " point3f[] positions = [(0, 0, 0)] }"
        'over "Off" { def Xform "Lamp" { def SphereLight "Bulb" { } def Cube "C" { } } }'
    )
    level = read(tmp_path, lamp + post + 'def SphereLight "First" { }' + placed + crowd)
    assert [(light.node, light.name) for light in level.scene.lights] == [
        (0, "First"),
        (1, "P0/Top/Arm/Bulb"),
        (2, "P0/Foot"),
        (3, "P1/Top/Arm/Bulb"),
        (4, "P1/Foot"),
    ]
    assert noted(level, "/Many", "ignored")
    assert level.scene.triangle_count == 12
