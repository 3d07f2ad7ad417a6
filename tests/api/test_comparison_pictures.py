from __future__ import annotations

import base64
from pathlib import Path

import numpy as np
import OpenImageIO
import pytest

from api.comparison_pictures import PictureBook, data_uri, layer
from api.error_map import error_map
from api.pictures import Picture
from renderers.frame import Surfaces
from selector.measurement import Truth
from selector.truth import Reference, Shown
from tests.selector.measurements import SV, shadow_map
from tests.small_level import CAMERA, POINT

HEIGHT, WIDTH = 24, 40
SHAPE = (HEIGHT, WIDTH)
NOISE = np.random.default_rng(1)


def noise() -> Picture:
    return NOISE.integers(0, 256, (*SHAPE, 3), dtype=np.uint8)


@pytest.fixture
def reference() -> Reference:
    nothing = Surfaces(np.zeros((*SHAPE, 3)), np.zeros((*SHAPE, 3)), np.ones(SHAPE, bool))
    lit, domain = NOISE.random(SHAPE) < 0.5, NOISE.random(SHAPE) < 0.8
    joined = np.ones((HEIGHT, WIDTH - 1), bool), np.ones((HEIGHT - 1, WIDTH), bool)
    return Reference(nothing, domain, lit, noise(), joined, Truth.SHADOW_VOLUME)


def seen(reference: Reference) -> Shown:
    """Another picture in a few places, and a mask that is wrong in some."""
    changed = NOISE.random(SHAPE) < 0.1
    picture = np.where(changed[..., None], noise(), reference.picture)
    mask = np.where(changed, NOISE.random(SHAPE), reference.lit).astype(np.float32)
    return Shown(picture, mask, reference)


def decoded(uri: str, folder: Path) -> Picture:
    kind, _, data = uri.partition(";base64,")
    assert kind == "data:image/webp"
    path = folder / "picture.webp"
    path.write_bytes(base64.b64decode(data))
    pixels = OpenImageIO.ImageBuf(str(path)).get_pixels(OpenImageIO.UINT8)
    assert pixels is not None
    return np.asarray(pixels)


def laid_over(over: Picture, below: Picture) -> Picture:
    assert set(np.unique(over[..., 3])) <= {0, 255}
    return np.where(over[..., 3:] == 255, over[..., :3], below[..., :3])


def test_a_picture_on_the_page_is_exact(tmp_path: Path) -> None:
    picture = noise()
    assert np.array_equal(decoded(data_uri(picture), tmp_path)[..., :3], picture)


def test_a_layer_on_the_truth_is_the_candidate_to_the_last_bit(reference: Reference, tmp_path: Path) -> None:
    book, shown, candidate = PictureBook(), seen(reference), shadow_map(256)
    book.keep(POINT, CAMERA, None, reference.shown())
    book.keep(POINT, CAMERA, candidate, shown)
    (view,) = book.taken()
    layers = view.layers[candidate]
    picture = laid_over(decoded(layers.picture, tmp_path), decoded(view.truth, tmp_path))
    assert np.array_equal(picture, shown.picture)
    errors = laid_over(decoded(layers.error_map, tmp_path), decoded(view.faultless, tmp_path))
    expected = error_map(shown.mask, reference.lit, reference.domain, reference.picture)
    assert np.array_equal(errors, expected)


def test_the_truth_lays_nothing_over_itself(reference: Reference) -> None:
    assert not layer(reference.picture, reference.picture).any()


def test_candidates_that_come_later_join_their_view(reference: Reference) -> None:
    book = PictureBook()
    first, second = shadow_map(256), shadow_map(512)
    for candidate in (first, second):
        book.keep(POINT, CAMERA, None, reference.shown())
        book.keep(POINT, CAMERA, candidate, seen(reference))
    (view,) = book.taken()
    assert list(view.layers) == [first, second]


def test_the_next_light_begins_with_nothing(reference: Reference) -> None:
    book = PictureBook()
    book.keep(POINT, CAMERA, None, reference.shown())
    book.keep(POINT, CAMERA, SV, seen(reference))
    (view,) = book.taken()
    assert list(view.layers) == [SV]
    assert list(book.taken()) == []
