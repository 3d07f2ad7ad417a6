from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenImageIO
import pytest

from api.canvas import Picture
from api.picture_folder import PictureFolder
from scenes.formats.registry import read_level
from selector.level_measuring import Answer, SeenLight
from tests.selector.measurements import SV, shadow_map
from tests.small_level import CAMERA, POINT, small_level

CAMERAS = tuple(replace(CAMERA, name=name) for name in ("near", "far", "side"))
FIRST, SECOND = shadow_map(256), shadow_map(512)


def flat(value: int) -> Picture:
    return np.full((64, 96, 3), value, np.uint8)


def level_of(path: Path) -> int:
    """The one value of a flat picture."""
    pixels = OpenImageIO.ImageBuf(str(path)).get_pixels(OpenImageIO.UINT8)
    assert pixels is not None
    assert pixels.min() == pixels.max()
    return int(pixels.max())


@pytest.fixture
def folder(tmp_path: Path) -> PictureFolder:
    level = read_level(small_level(tmp_path))
    (tmp_path / "pictures").mkdir()
    return PictureFolder(tmp_path / "pictures", level, [SeenLight(POINT, CAMERAS)])


def show(folder: PictureFolder, candidates: dict[object, list[int]]) -> None:
    """Truths of 100, 110 and 120, and what each candidate shows instead."""
    for index, camera in enumerate(CAMERAS):
        folder.keep(POINT, camera, None, flat(100 + 10 * index))
        for candidate, values in candidates.items():
            folder.keep(POINT, camera, candidate, flat(values[index]))  # type: ignore[arg-type]


def test_the_view_that_differs_most_is_kept(folder: PictureFolder, tmp_path: Path) -> None:
    show(folder, {FIRST: [101, 180, 125], SV: [100, 110, 120]})
    folder.write(Answer(POINT))
    assert level_of(tmp_path / "pictures/Torch.truth.png") == 110
    assert level_of(tmp_path / "pictures/Torch.SM-256-2x2.png") == 180
    assert level_of(tmp_path / "pictures/Torch.SV.png") == 110


def test_candidates_that_come_later_join_the_view_of_the_first(folder: PictureFolder, tmp_path: Path) -> None:
    show(folder, {FIRST: [101, 180, 125]})
    show(folder, {SECOND: [250, 115, 250]})
    folder.write(Answer(POINT))
    assert level_of(tmp_path / "pictures/Torch.truth.png") == 110
    assert level_of(tmp_path / "pictures/Torch.SM-256-2x2.png") == 180
    assert level_of(tmp_path / "pictures/Torch.SM-512-2x2.png") == 115
