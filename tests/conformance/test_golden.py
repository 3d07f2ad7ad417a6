"""Pictures that must not change by accident; GNOMON_REGENERATE_GOLDEN=1 writes them anew."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import numpy.typing as npt
import OpenImageIO
import pytest

from renderers.context import Gpu
from scenes.scene import Light, LightKind, Mesh, Scene
from tests import tolerances
from tests.random_scenes import look_at
from tests.rendering import framed, prepared
from tests.solids import box, floor, moved, placed, plane, sheet

Picture = npt.NDArray[np.uint8]

FOLDER = Path(__file__).parent / "golden"
REGENERATE = "GNOMON_REGENERATE_GOLDEN" in os.environ
SIZE = (240, 180)
LARGEST_BYTES = 30_000


def painted(mesh: Mesh, *color: float) -> Mesh:
    red, green, blue = color
    return Mesh(mesh.name, mesh.positions, mesh.triangles, mesh.placements, mesh.casts, (red, green, blue))


def street() -> Scene:
    """A road between houses, with a post, a bench, an awning and two trees of crossed leaves."""
    houses = [
        painted(box((x, 1.5 + 0.3 * i, z), (1.2, 1.5 + 0.3 * i, 1.0)), 0.8, 0.6 + 0.1 * i, 0.5)
        for i, (x, z) in enumerate([(-3.2, -3.0), (-3.2, 0.0), (3.2, -2.5), (3.2, 1.0)])
    ]
    roof = sheet(lambda u, v: np.stack([1.3 * u, 4.6 - 1.1 * np.abs(u), 1.1 * v], axis=-1), 4)
    leaves = [
        moved(plane(n, 0.5, cells=2), placed(offset=(x, 1.6, 2.2))) for x in (-1.6, 1.6) for n in np.eye(3)
    ]
    trunks = [box((x, 0.6, 2.2), (0.07, 0.6, 0.07)) for x in (-1.6, 1.6)]
    post = [box((-1.2, 1.2, -1.4), (0.06, 1.2, 0.06)), box((-0.9, 2.4, -1.4), (0.35, 0.05, 0.05))]
    bench = [box((1.3, 0.4, -0.6), (0.25, 0.04, 0.7)), box((1.3, 0.2, -0.6), (0.04, 0.2, 0.6))]
    awning = moved(plane((0.4, 1, 0), 0.8), placed(offset=(-1.7, 1.9, 0.2)))
    meshes = [
        painted(floor(8.0, cells=8), 0.6, 0.6, 0.6),
        *houses,
        painted(moved(roof, placed(offset=(3.2, 0, 1.0))), 0.7, 0.3, 0.2),
        *(painted(leaf, 0.2, 0.6, 0.2) for leaf in leaves),
        *trunks,
        *post,
        *bench,
        painted(awning, 0.3, 0.4, 0.8),
    ]
    return Scene("street", tuple(meshes))


def unit(*direction: float) -> tuple[float, float, float]:
    x, y, z = np.array(direction) / np.linalg.norm(direction)
    return float(x), float(y), float(z)


SUN = Light("sun", LightKind.DIRECTIONAL, direction=unit(-0.5, -0.8, -0.33))
LAMP = Light("lamp", LightKind.SPOT, (-0.6, 2.3, -1.4), unit(0.3, -0.9, 0.316), 0.5, 1.1, range_m=9.0)
VIEWS = {
    "sun-shadow-volume": (SUN, "shadow_volume", {}),
    "lamp-shadow-map": (LAMP, "shadow_map", {"map_size": 256, "filter": "2x2", "focus": "light"}),
    "sun-shaded": (SUN, "shadow_volume", {}),
}


def rendered(gpu: Gpu, name: str) -> Picture:
    """(h, w, 1) a mask, or (h, w, 3) a shaded picture."""
    light, technique, settings = VIEWS[name]
    camera = look_at((0.4, 4.2, 7.0), (0, 0.8, -0.5))
    with framed(gpu, street(), light, camera, SIZE) as frame, prepared(frame, technique, settings):
        if name.endswith("shaded"):
            frame.shade()
            return frame.read_picture()
        return np.round(frame.read_mask() * 255).astype(np.uint8)[..., None]


def save(path: Path, picture: Picture) -> None:
    height, width, channels = picture.shape
    output = OpenImageIO.ImageBuf(OpenImageIO.ImageSpec(width, height, channels, OpenImageIO.UINT8))
    output.set_pixels(OpenImageIO.ROI(), np.ascontiguousarray(picture))
    output.specmod().attribute("png:compressionLevel", 9)
    assert output.write(str(path)), output.geterror()


def load(path: Path) -> Picture:
    picture: Picture = np.asarray(OpenImageIO.ImageBuf(str(path)).get_pixels(OpenImageIO.UINT8), np.uint8)
    return picture


@pytest.mark.parametrize("name", VIEWS)
def test_pictures_are_as_they_were(gpu: Gpu, name: str) -> None:
    path, picture = FOLDER / f"{name}.png", rendered(gpu, name)
    assert len(np.unique(picture)) > 1
    if not gpu.device.software:
        pytest.skip(f"golden pictures come from llvmpipe, not from {gpu.device.renderer}")
    if REGENERATE:
        FOLDER.mkdir(exist_ok=True)
        save(path, picture)
    assert path.stat().st_size <= LARGEST_BYTES
    golden = load(path)
    assert golden.shape == picture.shape
    differing = (np.abs(golden.astype(int) - picture) > tolerances.GOLDEN_LEVELS).any(axis=2)
    assert differing.mean() <= tolerances.GOLDEN_SHARE
