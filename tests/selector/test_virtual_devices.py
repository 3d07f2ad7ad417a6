from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from scenes.scene import Array, Mobility
from selector.evidence.rows import CandidateRow
from selector.virtual_devices import (
    VIRTUAL_DEVICES,
    UnknownVirtualDeviceError,
    VirtualDevice,
    virtual_device,
)

UNIT = VirtualDevice("unit", "Everything once a second", 0.0, *[1.0] * 6, bytes=np.inf, bytes_per_count=0.0)
"""So a stage's milliseconds are a thousand times its largest count."""

PIXELS = np.array([10.0])
SM = CandidateRow("shadow_map", {"map_size": 4, "filter": "2x2", "focus": "light"})
SV = CandidateRow("shadow_volume", {})
CHAN = CandidateRow("chan_hybrid", {"map_size": 4, "kernel": "2x2", "focus": "light"})
MAP = {"map_triangles": 7.0, "map_texels_cleared": 16.0, "map_texels_written": 5.0}
VOLUMES = {
    "cap_triangles": 6.0,
    "silhouette_edges": 4.0,
    "volume_fragments": 100.0,
    "volume_fragments_counted": 30.0,
}


def arrays(counts: dict[str, float]) -> dict[str, Array]:
    return {name: np.array([count]) for name, count in counts.items()}


def stages(
    device: VirtualDevice, candidate: CandidateRow, counts: dict[str, float], mobility: Mobility
) -> dict[str, float]:
    found = device.stages_ms(candidate, arrays(counts), PIXELS, mobility)
    return {name: float(values[0]) for name, values in found.items()}


def test_a_map_by_hand() -> None:
    found = stages(UNIT, SM, MAP, Mobility.DYNAMIC)
    # Seven triangles outweigh five texels; ten pixels read depth, normal and one filtered comparison.
    assert found == {"map": 7000.0, "visibility": 30_000.0}
    four = replace_setting(SM, "filter", "4x4")
    assert stages(UNIT, four, MAP, Mobility.DYNAMIC)["visibility"] == 110_000.0
    assert stages(replace(UNIT, pass_s=1.0), SM, MAP, Mobility.DYNAMIC) == {
        "map": 8000.0,
        "visibility": 31_000.0,
    }
    # Six faces are six passes.
    six = MAP | {"map_texels_cleared": 96.0}
    assert stages(replace(UNIT, pass_s=1.0), SM, six, Mobility.DYNAMIC)["map"] == 13_000.0


def test_volumes_by_hand() -> None:
    found = stages(UNIT, SV, VOLUMES, Mobility.DYNAMIC)
    assert found == {"edges": 6000.0, "volumes": 100_000.0, "visibility": 10_000.0}
    slow_counts = stages(replace(UNIT, count_fragments=0.5), SV, VOLUMES, Mobility.DYNAMIC)
    assert slow_counts["volumes"] == 70_000.0 + 60_000.0
    vertices = stages(replace(UNIT, triangles=0.1), SV, VOLUMES, Mobility.DYNAMIC)
    assert vertices["volumes"] == pytest.approx(1000 * (6 + 8) / 0.1)
    memory = stages(replace(UNIT, bytes=1.0, bytes_per_count=8.0), SV, VOLUMES, Mobility.DYNAMIC)
    assert memory["volumes"] == 240_000.0


def test_tiles_are_stored_once_whatever_was_drawn() -> None:
    slow = replace(UNIT, triangles=1e9, depth_fragments=1e9, bytes=1.0)
    overdrawn = MAP | {"map_texels_written": 500.0}
    assert stages(slow, SM, overdrawn, Mobility.DYNAMIC)["map"] == 4 * 500_000.0
    assert stages(replace(slow, stores_tiles=True), SM, overdrawn, Mobility.DYNAMIC)["map"] == 4 * 16_000.0


def test_the_hybrid_has_the_stages_of_both() -> None:
    counts = MAP | VOLUMES | {"silhouette_pixels": 3.0, "volume_triangles": 9.0}
    found = stages(UNIT, CHAN, counts, Mobility.DYNAMIC)
    assert list(found) == ["map", "silhouette_pixels", "computation_mask", "edges", "volumes", "visibility"]
    assert found["computation_mask"] == 9000.0
    assert found["silhouette_pixels"] == 60_000.0


def test_a_static_light_keeps_what_does_not_follow_the_view() -> None:
    assert list(stages(UNIT, SM, MAP, Mobility.STATIC)) == ["visibility"]
    follows = replace_setting(SM, "focus", "view")
    assert list(stages(UNIT, follows, MAP, Mobility.STATIC)) == ["map", "visibility"]
    warped = CandidateRow("perspective_shadow_map", {"map_size": 4, "filter": "2x2"})
    assert list(stages(UNIT, warped, MAP, Mobility.STATIC)) == ["map", "visibility"]
    assert list(stages(UNIT, SV, VOLUMES, Mobility.STATIC)) == ["volumes", "visibility"]


@pytest.mark.parametrize("device", VIRTUAL_DEVICES, ids=lambda one: one.name)
def test_more_work_takes_no_less_time(device: VirtualDevice) -> None:
    counts = {name: 1e6 * count for name, count in (MAP | VOLUMES).items()}
    counts |= {"silhouette_pixels": 3e6, "volume_triangles": 9e6}
    before = stages(device, CHAN, counts, Mobility.DYNAMIC)
    for name in counts:
        after = stages(device, CHAN, counts | {name: counts[name] * 3}, Mobility.DYNAMIC)
        if name != "volume_fragments_counted":
            assert all(after[stage] >= before[stage] for stage in before), name
    assert all(value > 0 for value in before.values())


def test_what_nobody_counted_has_no_time() -> None:
    assert stages(UNIT, SM, {}, Mobility.DYNAMIC) == {}
    gap = UNIT.stages_ms(
        SM,
        {name: np.array([count, np.nan]) for name, count in MAP.items()},
        np.array([10.0, 10.0]),
        Mobility.DYNAMIC,
    )
    assert np.isnan(gap["map"]).tolist() == [False, True]


def test_virtual_devices_say_what_they_are() -> None:
    names = [one.name for one in VIRTUAL_DEVICES]
    assert names == ["fill-bound-2005", "desktop", "phone"]
    assert len({one.row.key for one in VIRTUAL_DEVICES}) == 3
    assert all(one.row.virtual == f"virtual:{one.name}" for one in VIRTUAL_DEVICES)
    assert virtual_device("virtual:phone") is virtual_device("phone") is VIRTUAL_DEVICES[2]
    with pytest.raises(UnknownVirtualDeviceError, match=r"virtual:desktop"):
        virtual_device("abacus")


def replace_setting(candidate: CandidateRow, name: str, value: str) -> CandidateRow:
    return CandidateRow(candidate.technique, {**candidate.settings, name: value})
