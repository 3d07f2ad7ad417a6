from __future__ import annotations

import numpy as np

from api.error_map import FALSE_LIT, FALSE_SHADOW, error_map

DARK = np.zeros((1, 4, 3), np.uint8)
EVERYWHERE = np.ones((1, 4), bool)


def row(*values: float) -> np.ndarray:
    return np.array([values], np.float32)


def test_what_is_wrong_has_the_colour_of_its_kind() -> None:
    truth = row(0, 1, 0, 1) > 0
    picture = error_map(row(1, 0, 0, 1), truth, EVERYWHERE, DARK)[0]
    assert picture.dtype == np.uint8
    assert tuple(picture[0]) == FALSE_LIT
    assert tuple(picture[1]) == FALSE_SHADOW
    for right in picture[2:]:
        assert len(set(right.tolist())) == 1, "what is right is grey"
    assert picture[2, 0] < picture[3, 0], "shadow is darker than light"


def test_a_fraction_is_as_strong_as_it_is_wrong() -> None:
    shadowed, lit = np.zeros((1, 4), bool), np.ones((1, 4), bool)
    for truth, color in ((shadowed, FALSE_LIT), (lit, FALSE_SHADOW)):
        wrong = np.abs(row(0, 0.25, 0.5, 1) - truth[0])
        picture = error_map(row(0, 0.25, 0.5, 1), truth, EVERYWHERE, DARK)[0].astype(float)
        right = picture[np.argmin(wrong)]
        expected = right + wrong[0][:, None] * (np.array(color) - right)
        assert np.abs(picture - expected).max() <= 0.5


def test_where_no_answer_counts_nothing_is_wrong() -> None:
    picture = error_map(row(1, 1, 0, 0), row(0, 1, 0, 1) > 0, ~EVERYWHERE, DARK)
    assert len(np.unique(picture)) == 1


def test_the_view_shows_through_in_grey() -> None:
    shade = np.array([[[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]]], np.uint8)
    picture = error_map(row(1, 1, 1, 1), row(1, 1, 1, 1) > 0, EVERYWHERE, shade)[0]
    assert (picture == picture[:, :1]).all()
    blue, red, green, white = (int(picture[index, 0]) for index in (2, 0, 1, 3))
    assert blue < red < green < white
