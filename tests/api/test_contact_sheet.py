from __future__ import annotations

import numpy as np
import pytest

from api.canvas import Canvas, Picture, shortened, text_width, wrapped
from api.contact_sheet import (
    BACKGROUND,
    CHOSEN,
    COLUMNS,
    SheetTexts,
    _Corner,
    _free_corner,
    _most_different,
    _Spot,
    contact_sheet,
)
from scenes.scene import Mobility
from selector.measurement import LightMeasurement, Status
from selector.recommendation import recommend
from tests.selector.measurements import SV, figures, light_measurement, measured, shadow_map, view

TEXTS = SheetTexts("Lamp (point light)", "level.glb")
LABELS = [shadow_map(size) for size in (256, 512)]


def flat(value: int) -> Picture:
    return np.full((90, 160, 3), value, np.uint8)


def measurement() -> LightMeasurement:
    return light_measurement(
        measured(LABELS[0], view([1.0], figures(3.0))),
        measured(LABELS[1], view([2.0], figures(0.5))),
        measured(SV, status=Status.OUT_OF_MEMORY, reason="the device is full"),
    )


def sheet(found: LightMeasurement, pictures: dict[object, Picture]) -> Picture:
    recommendation = recommend(found, Mobility.DYNAMIC)
    return contact_sheet(TEXTS, flat(100), pictures, found.measurements, recommendation)  # type: ignore[arg-type]


def test_the_chosen_tile_and_no_other_is_framed() -> None:
    drawn = sheet(measurement(), {LABELS[0]: flat(90), LABELS[1]: flat(95)})
    frame = (drawn == CHOSEN).all(axis=2)
    upright = np.flatnonzero(frame.sum(axis=0) > 200)
    assert len(upright) == 10, "two upright bars of five pixels"
    middle = (upright.min() + upright.max()) / 2
    # Truth, 256, 512: the third of three columns.
    assert middle > drawn.shape[1] * 2 / COLUMNS


def test_every_candidate_has_its_picture() -> None:
    drawn = sheet(measurement(), {LABELS[0]: flat(90), LABELS[1]: flat(95)})
    for value in (100, 90, 95):
        assert (drawn == value).all(axis=2).sum() > 50_000


def test_without_a_recommendation_nothing_is_framed() -> None:
    found = light_measurement(measured(SV, status=Status.GL_ERROR, reason="broken"))
    assert not (sheet(found, {}) == CHOSEN).all(axis=2).any()


def test_the_place_where_candidates_differ_most_is_magnified() -> None:
    picture = flat(100)
    picture[40:44, 120:124] = (0, 255, 0)
    pure = (0, 255, 0)
    drawn = sheet(measurement(), {LABELS[0]: picture, LABELS[1]: flat(100)})
    # Four by four pixels, four times as wide and high in the inset, besides those in the picture itself.
    assert (drawn == pure).all(axis=2).sum() >= 16 * 16
    assert not (sheet(measurement(), {LABELS[0]: flat(100)}) == pure).all(axis=2).any()


def test_the_same_result_gives_the_same_sheet() -> None:
    pictures: dict[object, Picture] = {LABELS[0]: flat(90)}
    assert np.array_equal(sheet(measurement(), pictures), sheet(measurement(), pictures))


@pytest.mark.parametrize("shape", [(90, 160), (16, 16), (17, 640), (640, 17)])
def test_pictures_of_any_shape_are_drawn(shape: tuple[int, int]) -> None:
    truth, other = np.zeros((*shape, 3), np.uint8), np.full((*shape, 3), 9, np.uint8)
    found = measurement()
    drawn = contact_sheet(TEXTS, truth, {LABELS[0]: other}, found.measurements, None)
    assert drawn.shape[2] == 3
    assert drawn.shape[0] < 2 * drawn.shape[1]
    assert (drawn == 9).all(axis=2).any()


def test_text_is_drawn_where_it_was_asked_for() -> None:
    canvas = Canvas(200, 60, BACKGROUND)
    canvas.text(190, 40, "SM 1024", 20, (255, 255, 255), right=True)
    rows, columns = np.nonzero((canvas.picture != BACKGROUND).any(axis=2))
    assert 190 - text_width("SM 1024", 20) - 2 <= columns.min()
    assert columns.max() <= 191
    assert rows.min() >= 20
    assert rows.max() <= 46


def test_long_lines_are_shortened_and_wrapped() -> None:
    text = "the quick brown fox jumps over the lazy dog " * 4
    assert text_width(shortened(text, 120, 16), 16) <= 120
    assert shortened(text, 120, 16).endswith("...")
    assert shortened("short", 120, 16) == "short"
    rows = wrapped(text, 200, 16, 3)
    assert len(rows) == 3
    assert all(text_width(row, 16) <= 200 for row in rows)
    assert wrapped("a b", 200, 16, 3) == ["a b"]
    assert wrapped("", 200, 16, 3) == []


def test_the_inset_hides_least_of_what_differs() -> None:
    spot = _Spot(10, 10, 20)
    everywhere = np.zeros((360, 640))
    everywhere[10:30, 10:30] = 9.0
    assert _free_corner(everywhere, spot, 0.7) == _Corner(right=True, low=True)
    everywhere[300:, 500:] = 1.0
    assert _free_corner(everywhere, spot, 0.7) == _Corner(right=True, low=False)


def test_a_spot_off_the_border_is_preferred_where_it_is_nearly_as_good() -> None:
    difference = np.zeros((100, 200))
    difference[0:4, 0:4], difference[60, 100:112] = 1.0, 1.0
    spot = _most_different(difference, 20)
    assert spot is not None
    assert spot.top >= 10
    assert spot.top <= 60 < spot.top + spot.side
    difference[0:4, 0:4] = 2.0
    assert _most_different(difference, 20) == _Spot(0, 0, 20)
