"""USD files that are damaged in ways that its own library may not survive."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, UsdLux, Vt

from scenes.errors import LevelError
from scenes.formats import usd
from scenes.formats.registry import format_of, read_level
from scenes.limited_process import LimitedProcess
from tests.api.command import gnomon
from tests.scenes.usd_samples import TRIANGLE, written

MESH = f'def Mesh "M" {{ {TRIANGLE} }}'


class Stuck(LimitedProcess):
    """Does something else than what it is asked for."""

    def __init__(self, *instead: Any, seconds: float = 60.0) -> None:
        super().__init__(2**33, seconds)
        self.instead = instead

    def call(self, *_: object) -> object:  # type: ignore[override]  # whatever it is asked for
        return super().call(*self.instead)


def test_a_level_that_hangs_usd_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = written(tmp_path, MESH)
    monkeypatch.setattr(usd, "_PROCESS", Stuck("time", "sleep", 60, seconds=0.5))
    result = gnomon("inspect", path)
    assert result.exit_code == 3
    assert "USD gave up on this level" in result.stderr
    assert "more than 0.5 seconds" in result.stderr
    assert str(path) in result.stderr


def test_a_level_that_crashes_usd_is_refused_by_everything(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = written(tmp_path, MESH)
    monkeypatch.setattr(usd, "_PROCESS", Stuck("os", "abort"))
    level_format, source = format_of(path), path.read_bytes()
    for action in (
        lambda: read_level(path),
        lambda: level_format.annotate(source, {}),
        lambda: level_format.read_annotations(source),
        lambda: level_format.clear(source),
        lambda: level_format.companions(source, path),
    ):
        with pytest.raises(LevelError, match="USD gave up") as caught:
            action()
        assert "It crashed" in caught.value.known
        assert caught.value.where == str(path)


def test_damaged_binary_files_are_read_or_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = _binary(tmp_path / "whole.usdc")
    monkeypatch.setattr(usd, "_PROCESS", LimitedProcess(usd.MOST_BYTES, 20.0))
    path, random = tmp_path / "level.usdc", np.random.default_rng(7)
    outcomes = {"read": 0, "refused": 0}
    for number in range(60):
        content = bytearray(whole)
        if number % 4 == 0:
            del content[int(random.integers(8, len(content))) :]
        else:
            for place in random.integers(8, len(content), 1 + number % 5):
                content[place] = int(random.integers(256))
        path.write_bytes(content)
        try:
            level = read_level(path)
        except LevelError as error:
            assert error.what  # noqa: PT017  either is right
            outcomes["refused"] += 1
        else:
            assert all(np.isfinite(mesh.positions).all() for mesh in level.scene.meshes)
            outcomes["read"] += 1
    assert min(outcomes.values()) > 0, outcomes
    path.write_bytes(whole)
    assert read_level(path).scene.triangle_count == 3 * 98


def _binary(path: Path) -> bytes:
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    x, y = np.meshgrid(np.arange(8), np.arange(8), indexing="ij")
    points = np.stack([x, np.sin(x + y), y], axis=-1).reshape(-1, 3).astype(np.float32)
    first = (np.arange(7)[:, None] * 8 + np.arange(7)).ravel()
    corners = np.stack([first, first + 1, first + 9, first + 8], axis=1).astype(np.int32)
    for number in range(3):
        mesh = UsdGeom.Mesh.Define(stage, f"/M{number}")
        mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(points * np.float32(number + 1)))
        mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(corners.ravel()))
        mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(corners), 4, np.int32)))
        mesh.AddTranslateOp().Set(Gf.Vec3d(number, 0.0, 0.0))
    UsdLux.SphereLight.Define(stage, "/Lamp")
    stage.Save()
    return path.read_bytes()
