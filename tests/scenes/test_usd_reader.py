"""Geometry, placement, units and cameras of USD stages, against USD's own figures where it has some."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from pxr import Usd, UsdGeom

from scenes.errors import LevelError
from scenes.formats.registry import read_level
from scenes.gltf import amounts
from scenes.usd import placement
from scenes.usd.reader import read_scene
from tests.scenes.usd_samples import METRES, TRIANGLE, instancer, mesh, read, written, xform
from tests.tolerances import USD_BOUNDS, USD_ROUND

SAMPLES = Path(__file__).parent / "samples"
SQUARE = [(0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (2.0, 2.0, 0.0), (0.0, 2.0, 0.0), (1.0, 3.0, 0.0)]
CUBE = 'def Cube "C" { double size = 1 }'
RESETTING = f'def Xform "Y" {{ uniform token[] xformOpOrder = ["!resetXformStack!"]; {CUBE} }}'
TURNED = "quath[] orientations = [(1, 0, 0, 0), (0.7, 0.7, 0, 0)]"
LEFT_HANDED = 'uniform token orientation = "leftHanded"'


def usd_bounds(path: Path) -> np.ndarray:
    """(2, 3) bounds of what is drawn, as USD computes them, in metres with Y up."""
    stage = Usd.Stage.Open(str(path))
    cache = UsdGeom.BBoxCache(Usd.TimeCode.EarliestTime(), [UsdGeom.Tokens.default_, UsdGeom.Tokens.render])
    box = cache.ComputeWorldBound(stage.GetPseudoRoot()).ComputeAlignedRange()
    corners = np.array([box.GetMin(), box.GetMax()]) * UsdGeom.GetStageMetersPerUnit(stage)
    if UsdGeom.GetStageUpAxis(stage) == "Z":
        corners = corners[:, [0, 2, 1]] * (1, 1, -1)
    return np.sort(corners, axis=0)


@pytest.mark.parametrize(
    "body",
    [
        mesh([3], [0, 1, 2], SQUARE[:3]),
        xform(CUBE, "rotateXYZ", "float3", "(10, 20, 30)"),
        xform(xform(CUBE, "translate", value="(1, 2, 3)"), "scale", value="(-2, 1, 3)"),
        xform(
            f'def Xform "Y" {{ uniform token[] xformOpOrder = ["!resetXformStack!"]; {CUBE} }}',
            "scale",
            value="(2, 2, 2)",
        ),
        instancer(
            [0, 0], [(0, 0, 0), (5, 6, 7)], CUBE, "quath[] orientations = [(1, 0, 0, 0), (0.7, 0.7, 0, 0)]"
        ),
        'def Plane "C" { double width = 3; double length = 5; uniform token axis = "X" }',
        'def Plane "C" { double width = 3; double length = 5; uniform token axis = "Y" }',
        'def Plane "C" { double width = 3; double length = 5 }',
        'def Cylinder "C" { double height = 3; double radius = 0.5; uniform token axis = "X" }',
        'def Cone "C" { double height = 3; double radius = 0.5; uniform token axis = "Y" }',
        'def Capsule "C" { double height = 3; double radius = 0.5; uniform token axis = "Z" }',
        'def Sphere "C" { double radius = 2 }',
        'def Cylinder_1 "C" { double height = 3; double radiusTop = 0.5; double radiusBottom = 1 }',
    ],
)
@pytest.mark.parametrize("head", [METRES, 'metersPerUnit = 0.01\nupAxis = "Z"'])
def test_bounds_are_those_of_usd(tmp_path: Path, body: str, head: str) -> None:
    path = written(tmp_path, body, head)
    found, expected = read_level(path).scene.bounds, usd_bounds(path)
    assert np.abs(found - expected).max() <= USD_BOUNDS * np.abs(expected).max()


@pytest.mark.parametrize("kind", ["Cube", "Sphere", "Cylinder", "Cone", "Capsule", "Cylinder_1", "Capsule_1"])
def test_shapes_are_closed_and_face_outwards(tmp_path: Path, kind: str) -> None:
    scene = read(
        tmp_path, f'def {kind} "C" {{ }} def {kind} "D" {{ uniform token orientation = "leftHanded" }}'
    ).scene
    outside, inside = (one.positions.astype(float)[one.triangles] for one in scene.meshes)
    volumes = [np.linalg.det(corners).sum() / 6 for corners in (outside, inside)]
    assert volumes[0] == pytest.approx(-volumes[1])
    assert volumes[0] > 0
    directed = np.sort(scene.meshes[0].triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    _, uses = np.unique(directed, axis=0, return_counts=True)
    assert set(uses.tolist()) == {2}


def test_a_sphere_is_nearly_round(tmp_path: Path) -> None:
    (ball,) = read(tmp_path, 'def Sphere "C" { double radius = 1 }').scene.meshes
    volume = np.linalg.det(ball.positions.astype(float)[ball.triangles]).sum() / 6
    assert volume == pytest.approx(4 / 3 * math.pi, rel=USD_ROUND)


def test_faces_become_fans_and_holes_are_left_out(tmp_path: Path) -> None:
    indices = [0, 1, 2, 0, 1, 2, 3, 0, 1, 2, 4, 3, 0, 1]
    (whole,) = read(tmp_path, mesh([3, 4, 5, 2], indices, SQUARE)).scene.meshes
    expected = [[0, 1, 2], [0, 1, 2], [0, 2, 3], [0, 1, 2], [0, 2, 4], [0, 4, 3]]
    assert whole.triangles.tolist() == expected
    (holed,) = read(tmp_path, mesh([3, 4, 5, 2], indices, SQUARE, "int[] holeIndices = [1]")).scene.meshes
    assert holed.triangles.tolist() == [expected[0], *expected[3:]]
    quads = [0, 1, 2, 3, 3, 2, 1, 0]
    (plain,) = read(tmp_path, mesh([4, 4], quads, SQUARE)).scene.meshes
    assert plain.triangles.tolist() == [[0, 1, 2], [0, 2, 3], [3, 2, 1], [3, 1, 0]]
    (left,) = read(
        tmp_path, mesh([4], quads[:4], SQUARE, 'uniform token orientation = "leftHanded"')
    ).scene.meshes
    assert left.triangles.tolist() == [[2, 1, 0], [3, 2, 0]]


MATERIALS = "".join(
    f'def Material "{name}" {{ token outputs:surface.connect = </{name}/S.outputs:surface>;'
    f' def Shader "S" {{ uniform token info:id = "UsdPreviewSurface"; {inputs}; token outputs:surface }} }}'
    for name, inputs in (
        ("Red", "color3f inputs:diffuseColor = (1, 0, 0)"),
        ("Glass", "float inputs:opacity = 0.2"),
        ("Leaf", "float inputs:opacity = 0.2; float inputs:opacityThreshold = 0.5"),
    )
)


def test_materials_cast_and_colour_by_subset(tmp_path: Path) -> None:
    def subset(name: str, faces: str) -> str:
        return (
            f'def GeomSubset "{name}" (prepend apiSchemas = ["MaterialBindingAPI"])'
            ' { uniform token elementType = "face"; uniform token familyName = "materialBind";'
            f" int[] indices = {faces}; rel material:binding = </{name}> }}"
        )

    body = MATERIALS + mesh(
        [4, 3, 3],
        [0, 1, 2, 3, 0, 1, 2, 2, 3, 4],
        SQUARE,
        f"color3f[] primvars:displayColor = [(0, 0, 1)]; {subset('Red', '[0]')} {subset('Glass', '[1]')}",
    )
    level = read(tmp_path, body)
    found = [(one.triangles.tolist(), one.casts, one.base_color) for one in level.scene.meshes]
    assert found == [
        ([[0, 1, 2], [0, 2, 3]], True, (1.0, 0.0, 0.0)),
        ([[0, 1, 2]], False, (0.8, 0.8, 0.8)),
        ([[2, 3, 4]], True, (0.0, 0.0, 1.0)),
    ]
    assert [note.where for note in level.notes if "no shadow" in note.text and note.where == "/Glass"]
    assert level.scene.meshes[0].positions is level.scene.meshes[1].positions
    with pytest.raises(LevelError, match="face 9"):
        read(tmp_path, body.replace("[1]; rel", "[9]; rel"))


def test_a_threshold_makes_holes_that_are_noted(tmp_path: Path) -> None:
    bound = CUBE.replace('"C"', '"C" (prepend apiSchemas = ["MaterialBindingAPI"])')
    level = read(tmp_path, MATERIALS + bound.replace("}", "; rel material:binding = </Leaf> }"))
    assert level.scene.meshes[0].casts
    assert any(note.where == "/Leaf" and "holes" in note.text for note in level.notes)


def test_instances_share_one_mesh(tmp_path: Path) -> None:
    prototype = f'class Xform "Proto" {{ {CUBE} }}'
    copies = "".join(
        f'def "I{index}" (instanceable = true; inherits = </Proto>)'
        f" {{ double3 xformOp:translate = ({index}, 0, 0);"
        ' uniform token[] xformOpOrder = ["xformOp:translate"] }'
        for index in range(4)
    )
    hidden = 'def "Hidden" (instanceable = true; inherits = </Proto>) { token visibility = "invisible" }'
    scene = read(tmp_path, prototype + copies + hidden).scene
    (one,) = scene.meshes
    assert one.placements[:, 0, 3].tolist() == [0.0, 1.0, 2.0, 3.0]
    assert scene.triangle_count == 48


def test_instancers_hide_squash_and_nest(tmp_path: Path) -> None:
    inner = (
        instancer([0, 0], [(0, 0, 0), (0, 1, 0)], CUBE).replace('"P"', '"C"').replace("</P/C>", "</P/C/C>")
    )
    body = instancer([0, 0, 0], [(0, 0, 0), (10, 0, 0), (20, 0, 0)], inner, "int64[] invisibleIds = [1]")
    (one,) = read(tmp_path, body).scene.meshes
    assert sorted(map(tuple, one.placements[:, :2, 3].tolist())) == [(0, 0), (0, 1), (20, 0), (20, 1)]
    flat = read(
        tmp_path, instancer([0, 0], [(0, 0, 0), (1, 0, 0)], CUBE, "float3[] scales = [(1, 0, 1), (1, 1, 1)]")
    )
    assert len(flat.scene.meshes[0].placements) == 1
    assert any("1 of 2 placements" in note.text for note in flat.notes)


def test_a_million_instances_are_placed_or_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    body = instancer([0, 0], [(0, 0, 0), (1, 0, 0)], CUBE)
    monkeypatch.setattr(placement, "MOST_TRIANGLES", 24)
    scene, _ = read_scene(written(tmp_path, body), None)
    assert scene.triangle_count == 24
    monkeypatch.setattr(placement, "MOST_TRIANGLES", 23)
    with pytest.raises(LevelError, match="draws 24 triangles; at most 23") as caught:
        read_scene(written(tmp_path, body), None)
    assert "/P/C" in caught.value.where
    assert amounts.MOST_TRIANGLES == 8_000_000


def test_what_is_not_drawn_is_left_out_and_counted(tmp_path: Path) -> None:
    body = (
        'def Xform "A" { token visibility = "invisible"; def Cube "C" { } }'
        'def Xform "B" { uniform token purpose = "guide"; def Cube "C" { } }'
        'def Cube "P" { uniform token purpose = "proxy" } def Cube "R" { uniform token purpose = "render" }'
        'def BasisCurves "Hair" { }'
    )
    level = read(tmp_path, body)
    assert [one.name for one in level.scene.meshes] == ["R"]
    said = {note.text for note in level.notes}
    assert {
        f"1 meshes and shapes are {what}: left out." for what in ("invisible", "of purpose guide")
    } <= said
    assert any(note.where == "/Hair" and "BasisCurves" in note.text for note in level.notes)


def test_the_first_time_sample_counts(tmp_path: Path) -> None:
    moving = xform(CUBE, "translate").replace(
        "= (0, 0, 0);", ".timeSamples = { 5: (7, 0, 0), 9: (8, 0, 0), };", 1
    )
    level = read(tmp_path, moving)
    assert level.scene.meshes[0].placements[0, 0, 3] == 7.0
    assert any(note.where == "/X" and "first time sample" in note.text for note in level.notes)


def test_units_and_axes(tmp_path: Path) -> None:
    body = xform(CUBE, "translate", value="(1, 2, 3)")
    assert read(tmp_path, body, 'metersPerUnit = 2\nupAxis = "Z"').scene.meshes[0].placements[0].tolist() == [
        [2, 0, 0, 2],
        [0, 0, 2, 6],
        [0, -2, 0, -4],
        [0, 0, 0, 1],
    ]
    silent = read(tmp_path, body, 'doc = "no units"')
    assert silent.scene.meshes[0].placements[0, 0, 0] == 0.01
    assert any("metersPerUnit" in note.text for note in silent.notes)


def test_cameras(tmp_path: Path) -> None:
    lens = "float focalLength = 20; float verticalAperture = 24; float2 clippingRange = (5, 1000)"
    body = (
        xform(f'def Camera "A" {{ {lens} }}', "rotateXYZ", "float3", "(0, 90, 0)")
        + f'def Camera "B" {{ {lens}; token projection = "orthographic" }}'
        + 'def Camera "D" { float focalLength = 0 }'
        + 'def Camera "E" { float2 clippingRange = (0, 9) }'
    )
    level = read(tmp_path, body, "metersPerUnit = 0.01")
    (camera,) = level.scene.cameras
    assert camera.node == 0
    assert camera.forward == pytest.approx((-1, 0, 0))
    assert camera.yfov_rad == pytest.approx(2 * math.atan(12 / 20))
    assert camera.near_m == pytest.approx(0.05)
    assert [note.where for note in level.notes if "kipped" in note.text] == ["/B", "/D", "/E"]


def test_the_digest_is_of_what_is_there(tmp_path: Path) -> None:
    digests = {
        read_level(SAMPLES / f"yard.{suffix}").scene.digest for suffix in ("usd", "usda", "usdc", "usdz")
    }
    assert len(digests) == 1
    text = (SAMPLES / "yard.usda").read_text()
    (tmp_path / "yard.usda").write_text(text.replace("(100, 0, 50)", "(101, 0, 50)"))
    assert read_level(tmp_path / "yard.usda").scene.digest not in digests


def test_what_usd_does_not_draw_is_noted(tmp_path: Path) -> None:
    body = (
        f'class "Trees" {{ def Mesh "Oak" {{ {TRIANGLE} }} def Mesh "Elm" {{ {TRIANGLE} }} }}'
        f'over "Lost" {{ def Mesh "M" {{ {TRIANGLE} }} }}'
        f'def Mesh "Off" (active = false) {{ {TRIANGLE} }}'
        'over "Empty" { }'
        f'def Mesh "M" {{ {TRIANGLE} }}'
    )
    level = read(tmp_path, body)
    assert level.scene.triangle_count == 1
    said = {note.where: note.text for note in level.notes if "left out" in note.text}
    assert set(said) == {"/Trees/Oak", "/Lost/M", "/Off"}
    assert said["/Trees/Oak"].startswith("2 meshes and lights, this one first, are below a class")
    assert said["/Lost/M"].startswith("1 mesh or light, this one first, is below an over")
    assert {note.severity for note in level.notes if note.where in said} == {"info"}


def test_the_prototypes_of_an_instancer_are_not_left_out(tmp_path: Path) -> None:
    hidden = f'over "Parts" {{ def Mesh "M" {{ {TRIANGLE} }} }}'
    body = instancer([0, 0], [(0, 0, 0), (1, 0, 0)], hidden).replace("</P/C>", "</P/Parts/M>")
    level = read(tmp_path, body)
    assert level.scene.triangle_count == 2
    assert not [note for note in level.notes if "below an over" in note.text]
