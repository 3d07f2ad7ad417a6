"""Levels that nobody on this project made; skipped where they are not at hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import Usd, UsdGeom

from scenes.formats.registry import format_of, read_level
from scenes.light_annotation import LightAnnotation
from tests.tolerances import USD_BOUNDS

LEVELS = Path(__file__).parents[3] / "shared" / "levels" / "usd"
ADVICE = LightAnnotation({"gnomon_technique": "SM"}, {})

pytestmark = pytest.mark.skipif(not LEVELS.is_dir(), reason="needs ../shared/levels/usd")


@pytest.mark.parametrize(
    ("name", "triangles", "lights", "cameras"),
    [("McUsd.usda", 880, 1, 1), ("linking_example.usda", 1920, 8, 0)],
)
def test_a_level_is_read_as_usd_sees_it(name: str, triangles: int, lights: int, cameras: int) -> None:
    path = LEVELS / name
    level = read_level(path)
    found = level.scene
    assert (found.triangle_count, len(found.lights), len(found.cameras)) == (triangles, lights, cameras)
    stage = Usd.Stage.Open(str(path))
    cache = UsdGeom.BBoxCache(Usd.TimeCode.EarliestTime(), [UsdGeom.Tokens.default_, UsdGeom.Tokens.render])
    # Of geometry only: lights have bounds too.
    boxes = [
        cache.ComputeWorldBound(prim).ComputeAlignedRange()
        for prim in stage.Traverse()
        if prim.IsA(UsdGeom.Gprim)
    ]
    corners = np.array([[box.GetMin(), box.GetMax()] for box in boxes]) * UsdGeom.GetStageMetersPerUnit(stage)
    expected = np.array([corners[:, 0].min(axis=0), corners[:, 1].max(axis=0)])
    assert np.abs(found.bounds - expected).max() <= USD_BOUNDS * np.abs(expected).max()
    do, source = format_of(path), path.read_bytes()
    every = {light.node: ADVICE for light in found.lights if light.node is not None}
    assert do.read_annotations(do.annotate(source, every)) == every
    assert path.read_bytes() == source
