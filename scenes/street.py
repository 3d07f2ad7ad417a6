"""The example level: a small street with the three kinds of light. Written to examples/street.glb."""

from __future__ import annotations

import math

from scenes.scene import Camera, Light, LightKind, Mobility, Scene
from scenes.solids import Point
from scenes.street_furniture import LAMP_HEADS, LANTERN, furniture
from scenes.street_houses import houses


def street() -> Scene:
    """A street of eight houses under a sun, with a street lamp (spot) and a lantern (point), seen twice."""
    return Scene("Street", (*furniture(), *houses()), _lights(), _cameras())


def _lights() -> tuple[Light, ...]:
    return (
        Light(
            name="Sun",
            kind=LightKind.DIRECTIONAL,
            direction=(6 / 11, -7 / 11, -6 / 11),
            intensity=40.0,
            color=(1.0, 0.90, 0.74),
        ),
        Light(
            name="Street lamp",
            kind=LightKind.SPOT,
            position=LAMP_HEADS[1],
            direction=(-2 / 7, -6 / 7, -3 / 7),
            inner_cone_rad=0.625,
            outer_cone_rad=0.8125,
            range_m=16.0,
            intensity=900.0,
            color=(1.0, 0.82, 0.55),
            mobility=Mobility.STATIC,
        ),
        Light(
            name="Lantern",
            kind=LightKind.POINT,
            position=LANTERN,
            range_m=12.0,
            intensity=150.0,
            color=(1.0, 0.66, 0.34),
        ),
    )


def _cameras() -> tuple[Camera, ...]:
    return (
        _looking("Pedestrian", (-12.0, 1.6875, 1.75), (3.0, 0.75, -1.75), 0.9375),
        _looking("Overview", (-11.5, 9.5, 0.5), (1.5, 0.0, 0.75), 0.9375),
    )


def _looking(name: str, eye: Point, target: Point, yfov_rad: float) -> Camera:
    """A camera that looks from one point at another, upright. Square roots and quotients only."""
    x, y, z = (there - here for here, there in zip(eye, target, strict=True))
    across = math.sqrt(x * x + z * z)
    length = math.sqrt(across * across + y * y)
    return Camera(
        name=name,
        position=eye,
        forward=(x / length, y / length, z / length),
        up=(-x * y / (across * length), across / length, -z * y / (across * length)),
        yfov_rad=yfov_rad,
        near_m=0.125,
    )
