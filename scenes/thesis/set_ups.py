"""The light and the camera behind each figure of the thesis.

Source: J. Sindholt, A comparison of Shadow Algorithms, IMM-Thesis-2005-37 (DTU 2005), sections 7 and 7.2,
figures 46 and 52-57. It describes the places in words and gives no coordinates: those here are chosen to do
what the words say.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from math import degrees, radians

from scenes.scene import Camera, Light, Scene
from scenes.solids import Point
from scenes.thesis.registry import OPEN_SCENES, THESIS_SCENES
from scenes.thesis.staging import camera, spot

# The cut-off of the narrowest cone around the tower, 0.18141 rad, rounded up to 1/1024: 10.4 degrees.
NARROWEST_TOWER_RAD = 186 / 1024
WIDER_TOWER_RAD = (radians(30.0), radians(45.0), radians(60.0))

_SIZES = (256, 512, 1024, 2048)
_TIMED_SIZE = (1024,)
_TOWER_LAMP: Point = (-24.0, 38.0, 10.0)
_TOWER_MIDDLE: Point = (0.0, 7.625, 0.0)


@dataclass(frozen=True)
class SetUp:
    """One figure's question.

    Attributes:
        name: What it shows.
        figure: The figure of the thesis.
        scene: Its key in `THESIS_SCENES` or `OPEN_SCENES`.
        light: The one light.
        camera: The one camera.
        map_sizes: Sides of the shadow maps that the figure compares, in texels.
    """

    name: str
    figure: str
    scene: str
    light: Light
    camera: Camera
    map_sizes: tuple[int, ...]

    def staged(self) -> Scene:
        """The scene with this light and this camera only."""
        scene = (THESIS_SCENES | OPEN_SCENES)[self.scene]()
        return Scene(scene.name, scene.meshes, (self.light,), (self.camera,))


@cache
def set_ups() -> tuple[SetUp, ...]:
    """All of them, in the order of the figures. Names are distinct."""
    return (*_overviews(), *_tower_quality(), *_rocks_quality(), _thin_objects(), _open_geometry())


def _overviews() -> Iterator[SetUp]:
    """Figures 46 to 51: each scene as it comes, at the map size of the timings."""
    for letter, key in zip("abcde", THESIS_SCENES, strict=True):
        scene = THESIS_SCENES[key]()
        yield SetUp(scene.name, f"46{letter}", key, scene.lights[0], scene.cameras[0], _TIMED_SIZE)


def _tower_quality() -> Iterator[SetUp]:
    """Figures 52 and 53: the same view of the tower's shadow under ever wider cones."""
    view = THESIS_SCENES["water_tower"]().cameras[1]
    light = spot("Narrowest spot", _TOWER_LAMP, _TOWER_MIDDLE, NARROWEST_TOWER_RAD)
    yield SetUp("Tower, narrowest cone", "52", "water_tower", light, view, _SIZES)
    for cut_off in WIDER_TOWER_RAD:
        wider = spot("Wider spot", _TOWER_LAMP, _TOWER_MIDDLE, cut_off)
        name = f"Tower, cut-off of {round(degrees(cut_off))} degrees"
        yield SetUp(name, "53", "water_tower", wider, view, _SIZES)


def _rocks_quality() -> Iterator[SetUp]:
    """Figures 54 and 55: one view of the rocks, the light around it."""
    rocks = THESIS_SCENES["rocks"]()
    view = rocks.cameras[0]
    right = replace(rocks.lights[0], name="Right of the viewer")
    front = spot("In front of the viewer", (-2.0, 16.0, -34.0), (-1.0, 0.0, 4.0), radians(40.0))
    behind = spot("Behind the viewer", (1.5, 10.0, 24.0), (-1.0, 0.0, 2.5), radians(40.0))
    # 3.6 m from the nearest stones, where the camera is 13 m from them, and in its view.
    closer = spot("Closer than the viewer", (1.0, 6.0, 10.0), (-5.0, 0.0, 4.0), radians(50.0))
    for light, figure in ((right, "54"), (front, "54"), (behind, "54"), (closer, "55")):
        yield SetUp(f"Rocks, light {light.name.lower()}", figure, "rocks", light, view, (512,))


def _thin_objects() -> SetUp:
    """Figure 56: braces and rungs of 3 to 5 cm; a texel at the tower is 55 cm at 256 and 7 cm at 2048."""
    wide = spot("Wide spot", _TOWER_LAMP, _TOWER_MIDDLE, WIDER_TOWER_RAD[-1])
    view = camera("Shadows of braces", (6.5, 4.0, 9.5), (3.0, 0.0, -0.5))
    return SetUp("Tower, thin braces", "56", "water_tower", wide, view, _SIZES)


def _open_geometry() -> SetUp:
    tree = OPEN_SCENES["tree"]()
    return SetUp(tree.name, "57", "tree", tree.lights[0], tree.cameras[0], _TIMED_SIZE)
