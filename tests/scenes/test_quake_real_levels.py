"""Maps of id Software against glTF files that somebody else made of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scenes.formats.registry import read_level
from scenes.topology import Topology
from tests import tolerances
from tests.scenes.quake_samples import volume

LEVELS = Path(__file__).parents[2] / "../shared/levels/quake"
NAMES = ["start", "e1m1", "dm4", "dm6"]

pytestmark = pytest.mark.skipif(not LEVELS.is_dir(), reason="the folder of real levels is not here")


@pytest.mark.parametrize("name", NAMES)
def test_triangles_volume_and_bounds_are_those_of_the_glb(name: str) -> None:
    ours, theirs = (read_level(LEVELS / f"{name}{suffix}").scene for suffix in (".map", ".glb"))
    assert ours.triangle_count == theirs.triangle_count
    assert volume(ours) == pytest.approx(volume(theirs), rel=tolerances.QUAKE_VOLUME)
    np.testing.assert_array_equal(ours.bounds, theirs.bounds)


@pytest.mark.parametrize("name", NAMES)
def test_lights_are_those_of_the_glb(name: str) -> None:
    ours, theirs = (read_level(LEVELS / f"{name}{suffix}").scene for suffix in (".map", ".glb"))
    for mine, other in zip(ours.lights, theirs.lights, strict=True):
        assert mine.kind == other.kind
        assert mine.position == other.position
        assert mine.range_m == other.range_m
        assert mine.intensity == pytest.approx(other.intensity)


@pytest.mark.parametrize("name", NAMES)
def test_every_brush_is_closed(name: str) -> None:
    for mesh in read_level(LEVELS / f"{name}.map").scene.meshes:
        topology = Topology.of(mesh.triangles)
        assert not topology.balances.any()
        assert (topology.valences == 2).all()


@pytest.mark.parametrize("name", NAMES)
def test_what_is_left_out_is_told_once_and_four_starts_are_cameras(name: str) -> None:
    level = read_level(LEVELS / f"{name}.map")
    places = [note.where for note in level.notes]
    assert len(places) == len(set(places))
    assert {"sky", "liquids", "triggers", "player starts"} <= set(places)
    assert all(note.severity == "info" for note in level.notes)
    assert len(level.scene.cameras) == 4
    low, high = level.scene.bounds
    assert all(
        (low < camera.position).all() and (camera.position < high).all() for camera in level.scene.cameras
    )
