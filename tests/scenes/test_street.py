"""The example level is what its code makes, and loads as what was made."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from scenes.formats.registry import read_level
from scenes.gltf.writer import glb_bytes
from scenes.scene import LightKind
from scenes.solids import GRID_M
from scenes.street import street

EXAMPLE = Path(__file__).parents[2] / "examples/street.glb"


def test_the_file_is_byte_for_byte_what_the_code_makes() -> None:
    assert EXAMPLE.read_bytes() == glb_bytes(street()), "run `make examples`"


def test_counts() -> None:
    scene = read_level(EXAMPLE).scene
    assert scene.triangle_count == 3980
    assert [light.kind for light in scene.lights] == [
        LightKind.DIRECTIONAL,
        LightKind.SPOT,
        LightKind.POINT,
    ]
    assert [camera.name for camera in scene.cameras] == ["Pedestrian", "Overview"]


def test_the_reader_has_nothing_to_say_about_it() -> None:
    assert read_level(EXAMPLE).notes == ()


def test_the_level_loads_with_the_geometry_that_was_made() -> None:
    made, loaded = street(), read_level(EXAMPLE).scene
    np.testing.assert_array_equal(made.bounds, loaded.bounds)
    assert made.triangle_count == loaded.triangle_count


def test_coordinates_are_the_same_bits_everywhere() -> None:
    for mesh in street().meshes:
        steps = mesh.world_positions() / GRID_M
        np.testing.assert_array_equal(steps, np.round(steps))


def test_what_is_solid_is_closed_and_what_is_thin_is_open() -> None:
    closed = {mesh.name: _is_closed(mesh.triangles, mesh.positions) for mesh in street().meshes}
    open_meshes = {name for name, is_closed in closed.items() if not is_closed}
    assert open_meshes == {"Tree leaves", *(f"House {number} panes" for number in range(1, 9))}


def _is_closed(triangles: np.ndarray, positions: np.ndarray) -> bool:
    """Whether every directed edge has its opposite, and the volume inside is positive."""
    edges = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1).reshape(-1, 2)
    forth, back = (np.sort(pairs @ [len(positions), 1]) for pairs in (edges, edges[:, ::-1]))
    corners = positions[triangles].astype(np.float64)
    volume = (np.cross(corners[:, 0], corners[:, 1]) * corners[:, 2]).sum() / 6
    return bool(np.array_equal(forth, back) and volume > 0)
