from __future__ import annotations

import math

import pytest

from api.comparison_words import difference, digits, edge_words, light_facts, memory, percent, pixels
from scenes.scene import Light, LightKind, Mobility
from selector.recommendation import recommend
from tests.selector.measurements import SV, figures, light_measurement, measured, shadow_map, view


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (0, "0"),
        (0.0001, "< 0.001"),
        (0.0123, "0.012"),
        (0.5, "0.500"),
        (1.234, "1.23"),
        (12.34, "12.3"),
        (123.4, "123"),
        (12345.6, "12,346"),
    ],
)
def test_numbers_have_the_digits_they_deserve(value: float, words: str) -> None:
    assert digits(value) == words


def test_units_go_with_their_numbers() -> None:
    assert (pixels(0.523), pixels(0.001), pixels(0.0), pixels(None)) == (
        "0.52 px",
        "< 0.01 px",
        "0.00 px",
        "-",
    )
    assert (percent(0.028), percent(1e-7), percent(0.0), percent(None)) == ("2.80 %", "< 0.001 %", "0 %", "-")
    assert (difference(0.00514), difference(0.0), difference(None)) == ("0.0051", "0", "-")
    assert (memory(4 << 20), memory(1536), memory(0)) == ("4.0 MiB", "1.5 KiB", "-")


def test_the_edge_is_said_as_the_choice_weighs_it() -> None:
    ones = [
        measured(shadow_map(256), view([1, 1, 1], figures(0.52))),
        measured(shadow_map(512), view([1, 1, 1], figures(None, wrong_share=0.017, boundary_px=20))),
        measured(shadow_map(1024), view([1, 1, 1], figures(None, boundary_px=0))),
        measured(SV, view([1, 1, 1], figures(0.0))),
    ]
    found = recommend(light_measurement(*ones), Mobility.DYNAMIC)
    assert found is not None
    rated = {one.candidate: one for one in found.rated}
    said = [edge_words(one, rated[one.candidate]) for one in ones]
    assert said == ["0.52 px", "17 wrong pixels", "no edge", "exact"]
    assert edge_words(ones[0], None) == "0.52 px"


def test_a_light_is_described_by_what_it_has() -> None:
    spot = Light("", LightKind.SPOT, node=3, outer_cone_rad=math.radians(30), range_m=16)
    assert light_facts(spot) == ["spot light", "cone 60°", "range 16 m", "node 3"]
    assert light_facts(Light("", LightKind.POINT)) == ["point light", "no range limit"]
    assert light_facts(Light("", LightKind.DIRECTIONAL)) == ["directional light"]
