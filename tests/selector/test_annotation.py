from __future__ import annotations

import json
import re
from dataclasses import replace

from scenes.scene import LightKind, Mobility
from selector.annotation import annotation
from selector.candidate import candidates
from selector.measurement import LightMeasurement, Status
from selector.recommendation import recommend
from tests.selector.measurements import DEVICE, SV, figures, light_measurement, measured, shadow_map, view


def written(measurement: LightMeasurement) -> tuple[dict[str, object], dict[str, object]]:
    recommendation = recommend(measurement, Mobility.DYNAMIC)
    assert recommendation is not None
    one = annotation(recommendation)
    return dict(one.extras), dict(one.extension)


def measurement() -> LightMeasurement:
    return light_measurement(
        measured(shadow_map(512), view([2.00004] * 3, figures(0.123456))),
        measured(SV, view([5.0] * 3, figures(0.0))),
        measured(shadow_map(8192), status=Status.REFUSED, reason="too large"),
    )


def test_scalars_are_flat_and_short() -> None:
    extras, _ = written(measurement())
    assert extras == {
        "gnomon_technique": "SM",
        "gnomon_map_size": 512,
        "gnomon_filter": "2x2",
        "gnomon_focus": "light",
        "gnomon_shadow_ms": 2.0,
        "gnomon_edge_error_px": 0.1235,
        "gnomon_confidence": 1.0,
        "gnomon_source": "measured",
    }


def test_what_a_technique_lacks_is_left_out() -> None:
    extras, _ = written(light_measurement(measured(SV, view([5.0], figures(None, boundary_px=3.0)))))
    assert extras == {
        "gnomon_technique": "SV",
        "gnomon_shadow_ms": 5.0,
        "gnomon_confidence": 1.0,
        "gnomon_source": "measured",
    }


def test_a_map_without_a_filter_is_written_without_one() -> None:
    hybrid = next(one for one in candidates(LightKind.SPOT, DEVICE.limits) if one.technique == "chan_hybrid")
    extras, _ = written(light_measurement(measured(hybrid, view([5.0], figures(0.2)))))
    assert extras["gnomon_technique"] == "Chan"
    assert extras["gnomon_map_size"] == dict(hybrid.settings)["map_size"]
    assert "gnomon_filter" not in extras


def test_the_story_holds_choice_alternatives_and_provenance() -> None:
    _, story = written(measurement())
    assert (story["technique"], story["id"]) == ("SM", "shadow_map")
    alternatives = story["alternatives"]
    assert isinstance(alternatives, list)
    assert [one["technique"] for one in alternatives] == ["SV", "SM"]
    assert alternatives[1]["status"] == "refused"
    assert alternatives[1]["statusReason"] == "too large"
    provenance = story["provenance"]
    assert isinstance(provenance, dict)
    assert provenance["device"] == "made up"
    assert provenance["rounds"] == 3


def test_the_same_recommendation_gives_the_same_text_and_no_date() -> None:
    first, second = (json.dumps(written(measurement()), allow_nan=False) for _ in range(2))
    assert first == second
    assert not re.search(r"20\d\d-\d\d|\d\d:\d\d|time_?stamp|date", first)


def test_a_light_with_no_range_can_be_written() -> None:
    endless = measurement()
    light = replace(endless.light, range_m=float("inf"))
    json.dumps(written(replace(endless, light=light)), allow_nan=False)
