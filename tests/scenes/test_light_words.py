"""Lights as words of a command line."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from scenes.errors import LevelError
from scenes.formats.registry import read_level
from scenes.light_words import EXAMPLE, light_in_words, lights_file
from scenes.scene import LightKind, Mobility


def test_the_example_is_a_light() -> None:
    light = light_in_words(EXAMPLE)
    assert light.kind is LightKind.SPOT
    assert light.position == (0.0, 3.0, 0.0)
    assert light.direction == pytest.approx([part / math.sqrt(14) for part in (1, -3, 2)])
    assert math.degrees(light.outer_cone_rad) == pytest.approx(30)
    assert (light.range_m, light.node) == (12.0, None)


def test_names_have_blanks_in_quotes() -> None:
    light = light_in_words('point position_m=0,-2.5,1e1 name="Left lamp" mobility=static color=1,.5,0')
    assert (light.name, light.mobility, light.color) == ("Left lamp", Mobility.STATIC, (1.0, 0.5, 0.0))
    assert light.position == (0.0, -2.5, 10.0)
    assert light_in_words("directional direction=0,-1,0", node=3).node == 3


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("", "begins with its kind"),
        ("lamp position_m=0,0,0", "begins with its kind"),
        ("point", '"position_m" is missing'),
        ("point position_m=0,0", '"position_m" must be'),
        ("point position_m=0,0,x", '"position_m" must be'),
        ("point position_m=0,0,nan", '"position_m" must be'),
        ("point position_m=0,0,inf", '"position_m" must be'),
        ("point position_m", "no key=value"),
        ("point position_m=", "no key=value"),
        ("point =5", "no key=value"),
        ("point position_m=0,0,0 position_m=1,1,1", "said twice"),
        ("point position_m=0,0,0 radius=4", 'has no "radius"'),
        ("point position_m=0,0,0 node=3", 'has no "node"'),
        ("point position_m=0,0,0 index=0", 'has no "index"'),
        ("point position_m=0,0,0 gnomon=1", 'has no "gnomon"'),
        ("point position_m=0,0,0 gnomon_technique=SV", 'has no "gnomon_technique"'),
        ("point position_m=0,0,0 Range_m=4", "It has color, "),
        ("point kind=spot position_m=0,0,0", "said twice"),
        ("point position_m=0,0,0 range_m=-4", '"range_m" must be'),
        ("point position_m=0,0,0 range_m=1,2", '"range_m" must be'),
        ("point position_m=0,0,0 mobility=maybe", '"mobility" must be'),
        ("spot position_m=0,0,0", '"direction" is missing'),
        ("spot position_m=0,0,0 target_m=0,0,0", '"target_m" must be'),
        ("spot position_m=0,0,0 direction=0,1,0 outer_cone_deg=120", "half angle"),
        ('point name="x', "quotes"),
    ],
)
def test_what_is_no_light_is_refused_with_an_example(words: str, message: str) -> None:
    with pytest.raises(LevelError) as caught:
        light_in_words(words)
    assert message in str(caught.value)
    assert caught.value.where.startswith('light "')
    assert EXAMPLE in caught.value.remedy


def test_lights_in_words_can_be_written_down_and_read(tmp_path: Path) -> None:
    (tmp_path / "level.obj").write_bytes(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    words = [EXAMPLE, 'directional direction=0,-1,0 name="é"', "point position_m=1,2,3"]
    lights = [light_in_words(one, node) for node, one in enumerate(words)]
    content = lights_file("level.obj", lights)
    assert json.loads(content)["geometry"] == "level.obj"
    (tmp_path / "level.lights.json").write_bytes(content)
    assert list(read_level(tmp_path / "level.obj").scene.lights) == lights
