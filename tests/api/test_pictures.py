from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenImageIO
import pytest

from api.pictures import file_word, light_words, png_bytes, write_png
from scenes.errors import OutputError
from tests.small_level import POINT, SPOT, SUN


def test_a_png_holds_the_very_pixels(tmp_path: Path) -> None:
    picture = np.random.default_rng(1).integers(0, 256, (7, 5, 3), np.uint8)
    write_png(tmp_path / "p.png", picture)
    read = OpenImageIO.ImageBuf(str(tmp_path / "p.png"))
    assert np.array_equal(read.get_pixels(OpenImageIO.UINT8), picture)


def test_the_same_picture_gives_the_same_bytes() -> None:
    picture = np.random.default_rng(1).integers(0, 256, (7, 5, 3), np.uint8)
    assert png_bytes(picture) == png_bytes(picture.copy())


def test_a_png_that_cannot_be_written_is_an_output_error(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="folder does not exist"):
        write_png(tmp_path / "missing/p.png", np.zeros((2, 2, 3), np.uint8))


@pytest.mark.parametrize(
    ("name", "word"),
    [
        ("Street lamp", "Street-lamp"),
        ("../../etc/passwd", "etc-passwd"),
        ("a\\b:c*d?", "a-b-c-d"),
        ("..", "unnamed"),
        ("", "unnamed"),
        ("街灯", "街灯"),
        ("\x1b[2J\n", "2J"),
    ],
)
def test_names_become_file_names(name: str, word: str) -> None:
    assert file_word(name) == word


def test_long_names_fit_any_file_system() -> None:
    assert len(file_word("x" * 999).encode()) <= 80
    assert len(file_word("街" * 999).encode()) <= 80


def test_lights_of_one_name_get_files_of_their_own() -> None:
    lights = [
        replace(SPOT, name="Torch", node=3),
        replace(POINT, name="torch", node=4),
        replace(SUN, name="Sun", node=5),
    ]
    assert light_words(lights) == {0: "Torch.node3", 1: "torch.node4", 2: "Sun"}


def test_a_light_called_like_another_s_file_gets_one_of_its_own() -> None:
    names = ["lamp", "lamp", "lamp.node3", "LAMP.node3.node5"]
    lights = [replace(SPOT, name=name, node=3 + index) for index, name in enumerate(names)]
    words = light_words(lights)
    assert len({word.casefold() for word in words.values()}) == 4
