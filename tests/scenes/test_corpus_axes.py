"""The axes are measured right where the answer is known, and instances show light and shadow."""

from __future__ import annotations

from math import degrees, inf, pi

import numpy as np
import pytest

from scenes.corpus.axes import Surveyed
from scenes.corpus.bins import AXES
from scenes.corpus.corpora import corpus
from scenes.corpus.staging import instance
from scenes.scene import Camera, Light, LightKind, Mesh, Scene
from scenes.solids import box, cards, placed
from scenes.thesis.staging import camera as looking
from tests.tolerances import CORPUS_SHOWS, RAY_DISTANCE

SUN = Light("Sun", LightKind.DIRECTIONAL, direction=(0.0, -1.0, 0.0))
DOWN = Camera("Down", (0.0, 20.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0), yfov_rad=pi / 8)
SLANTED = looking("Slanted", (0.0, 2.25, 7.0), (0.0, 0.0, 0.0))


def plates(heights: tuple[float, ...]) -> tuple[Mesh, ...]:
    """A floor of 20 m, and over its middle single sheets of 2 m at these heights."""
    floor = placed("floor", box((-10.0, -1.0, -10.0), (10.0, 0.0, 10.0)), (0.5, 0.5, 0.5))
    corner = np.array([(-1.0, height, 1.0) for height in heights]).reshape(-1, 3)
    along, across = (np.tile(way, (len(heights), 1)) for way in ([2.0, 0.0, 0.0], [0.0, 0.0, -2.0]))
    return (floor, placed("plates", cards(corner, along, across), (0.5, 0.5, 0.5))) if heights else (floor,)


@pytest.mark.parametrize("count", [1, 2, 5])
def test_overlap_counts_the_sheets_before_the_light(count: int) -> None:
    scene = Scene("", plates(tuple(3.0 + 0.5 * number for number in range(count))), (SUN,))
    axes = Surveyed.of(scene).axes(SUN, SLANTED)
    assert axes.overlap == pytest.approx(count)
    assert 0.0 < axes.shadow_share < 0.5
    assert np.isfinite(axes.boundary_distance)


def test_an_empty_floor_has_no_shadow() -> None:
    scene = Scene("", plates(()), (SUN,))
    axes = Surveyed.of(scene).axes(SUN, DOWN)
    assert (axes.overlap, axes.shadow_share, axes.sky_blocked, axes.closed_share) == (0.0, 0.0, 0.0, 1.0)
    assert axes.lit_share == 1.0
    assert (axes.boundary_distance, axes.light_distance, axes.range_share) == (inf, inf, inf)
    assert axes.view_light_deg == pytest.approx(0.0, abs=1e-5)
    assert (axes.triangles, axes.instances, axes.lights, axes.cut_off_deg) == (12, 1, 1, 90.0)


def test_a_light_against_the_view_is_at_180_degrees() -> None:
    below = Camera("Up", (0.0, -20.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), yfov_rad=pi / 8)
    lamp = Light("Lamp", LightKind.DIRECTIONAL, direction=(0.0, -1.0, 0.0))
    assert np.isnan(Surveyed.of(Scene("", plates(()), (lamp,))).axes(lamp, below).view_light_deg)
    up = Light("Up", LightKind.DIRECTIONAL, direction=(0.0, 1.0, 0.0))
    assert Surveyed.of(Scene("", plates(()), (up,))).axes(up, below).view_light_deg == pytest.approx(
        0, abs=1e-5
    )


def test_closed_share_range_cone_and_distances() -> None:
    scene = Scene("", plates((3.0,)))
    extent = float(np.linalg.norm([20.0, 4.0, 20.0]))
    lamp = Light("Lamp", LightKind.SPOT, (0.0, 10.0, 0.0), (0.0, -1.0, 0.0), 0.1, 0.25, range_m=12.0)
    narrow = Camera("Down", (0.0, 20.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0), yfov_rad=0.02)
    axes = Surveyed.of(scene).axes(lamp, narrow)
    assert axes.closed_share == pytest.approx(12 / 14)
    assert axes.extent_m == pytest.approx(extent)
    assert axes.cut_off_deg == pytest.approx(degrees(0.25))
    assert axes.range_share == pytest.approx(12.0 / extent)
    assert axes.light_distance == pytest.approx(7.0 / extent, rel=1e-3)
    assert axes.eye_distance == pytest.approx(17.0 / extent, rel=1e-3)
    assert axes.lit_share == 1.0
    short = Light("Short", LightKind.SPOT, lamp.position, lamp.direction, 0.1, 0.25, range_m=6.0)
    assert Surveyed.of(scene).axes(short, narrow).lit_share == 0.0
    assert extent > RAY_DISTANCE


def test_a_closed_room_hides_the_sky() -> None:
    walls = placed("walls", box((-5.0, 0.0, -5.0), (5.0, 4.0, 5.0)), (0.5, 0.5, 0.5))
    scene = Scene("", (walls,), (SUN,))
    assert Surveyed.of(scene).axes(SUN, looking("In", (0.0, 2.0, 4.0), (0.0, 1.0, -1.0))).sky_blocked == 1.0


def test_bins_take_every_value_once() -> None:
    scene = Scene("", plates((3.0,)), (SUN,))
    rows = [Surveyed.of(scene).axes(SUN, SLANTED), Surveyed.of(scene).axes(SUN, DOWN)]
    for axis in AXES:
        assert sum(axis.counts(rows)) == len(rows), axis.name
        assert len(set(axis.labels)) == len(axis.labels) == len(axis.counts([]))


def test_most_quick_instances_show_light_and_shadow() -> None:
    """By Embree, where lights and cameras were chosen by cells: the rules work on real rays."""
    shows = []
    for spec in corpus("quick")[::2]:
        scene = instance(spec)
        axes = Surveyed.of(scene).axes(scene.lights[0], scene.cameras[0])
        dull = min(axes.lit_share, axes.shadow_share) < 0.01
        shows.append(not dull)
    assert np.mean(shows) > CORPUS_SHOWS
