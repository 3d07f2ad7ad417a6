"""What a level contains: meshes, lights and cameras, frozen and comparable by digest.

Metres, radians, right-handed, Y up, column vectors. Arrays are read-only.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, fields
from enum import StrEnum
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Positions = npt.NDArray[np.float32]
Triangles = npt.NDArray[np.int32]


class LightKind(StrEnum):
    """The three light kinds of KHR_lights_punctual."""

    SPOT = "spot"
    POINT = "point"
    DIRECTIONAL = "directional"


class Mobility(StrEnum):
    """Whether a light's map or volumes may be kept from one frame to the next."""

    STATIC = "static"
    DYNAMIC = "dynamic"


# World positions that are held at once where all placements are gone through.
EXPANDED_AT_ONCE = 250_000

# What a rounding to float32 leaves of a unit vector is nearer to length 1 than this.
_UNIT_TOLERANCE = 1e-6


def frozen_array(values: npt.ArrayLike, dtype: npt.DTypeLike, shape: tuple[int, ...]) -> npt.NDArray[Any]:
    """`values` as a read-only C-contiguous array; -1 in `shape` stands for any length.

    Where they are one already, the very same array, so that meshes that share it can be told by identity.
    """
    array = np.ascontiguousarray(values, dtype=dtype)
    shaped = array.reshape(shape)
    array = array if array.shape == shaped.shape else shaped
    if array.flags.writeable:
        array = array.copy()
        array.flags.writeable = False
    return array


@dataclass(frozen=True, eq=False)
class Mesh:
    """One geometry, placed once or many times.

    Attributes:
        name: The author's name for it.
        positions: (v, 3) float32, local space.
        triangles: (t, 3) int32, indices into `positions`, stored winding.
        placements: (k, 4, 4) float64, world from local, column vectors, metres.
        casts: Whether it casts shadows (alpha-blended surfaces do not).
        base_color: Linear RGB, for pictures only.
        node: Index of the node that places it in the source file, if there is one.
        promised_closed: Whether the author promises closed geometry: of it alone, or of it and the other
            meshes of its node together.
    """

    name: str
    positions: Positions
    triangles: Triangles
    placements: Array = field(default_factory=lambda: np.eye(4)[None])
    casts: bool = True
    base_color: tuple[float, float, float] = (0.8, 0.8, 0.8)
    node: int | None = None
    promised_closed: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "positions", frozen_array(self.positions, np.float32, (-1, 3)))
        object.__setattr__(self, "triangles", frozen_array(self.triangles, np.int32, (-1, 3)))
        object.__setattr__(self, "placements", frozen_array(self.placements, np.float64, (-1, 4, 4)))

    @property
    def triangle_count(self) -> int:
        """Triangles drawn, over all placements."""
        return len(self.triangles) * len(self.placements)

    def world_positions(self) -> Array:
        """(k, v, 3) float64 world positions in metres, the same bits on every machine.

        Elementwise products and sums in a fixed order: `@` may fuse or reorder them.
        """
        return _placed(self.positions, self.placements)


@dataclass(frozen=True)
class Light:
    """One light in the level.

    Attributes:
        name: The author's name for it.
        kind: Spot, point or directional.
        position: World position in metres; ignored for a directional light.
        direction: Unit vector in which the light shines; ignored for a point light.
        inner_cone_rad: Half angle where a spot's fall-off starts.
        outer_cone_rad: Half angle where a spot ends.
        range_m: Distance at which the light ends; `inf` where the file sets none.
        intensity: Candela (spot, point) or lux (directional).
        color: Linear RGB.
        mobility: Whether the light, and what it lights, stands still.
        node: Index of the node that carries it in the source file, if there is one.

    Raises:
        ValueError: A number is not finite (`range_m` may be `inf`), a vector has not length 1, a cone or the
            range is none: whoever makes a light of unknown numbers checks them first.
    """

    name: str
    kind: LightKind
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    direction: tuple[float, float, float] = (0.0, 0.0, -1.0)
    inner_cone_rad: float = 0.0
    outer_cone_rad: float = float(np.pi / 4)
    range_m: float = float("inf")
    intensity: float = 1.0
    color: tuple[float, float, float] = (1.0, 1.0, 1.0)
    mobility: Mobility = Mobility.DYNAMIC
    node: int | None = None

    def __post_init__(self) -> None:
        cones = (self.inner_cone_rad, self.outer_cone_rad)
        _require_finite(self, (*self.position, *self.direction, *cones, self.intensity, *self.color))
        _require(self, self.range_m > 0.0, f"range_m must be > 0; it is {self.range_m}")
        if self.kind is not LightKind.POINT:
            _require_unit(self, "direction", self.direction)
        if self.kind is LightKind.SPOT:
            right = 0.0 <= cones[0] <= cones[1] <= math.pi / 2 and cones[1] > 0.0
            _require(self, right, f"cones must be 0 <= inner <= outer <= pi/2, outer > 0; they are {cones}")

    @property
    def homogeneous(self) -> Array:
        """(4,) float64: (position, 1), or (unit vector towards the light, 0) for a directional light."""
        if self.kind is LightKind.DIRECTIONAL:
            return np.array([*(-component for component in self.direction), 0.0])
        return np.array([*self.position, 1.0])


@dataclass(frozen=True)
class Camera:
    """A perspective camera.

    Attributes:
        name: The author's name, or the rule that placed it.
        position: World position in metres.
        forward: Unit vector in which it looks.
        up: Unit vector, orthogonal to `forward`.
        yfov_rad: Full vertical field of view.
        near_m: Distance of the near plane. The far plane is at infinity for rendering.
        node: Index of the node that carries it in the source file, if there is one.

    Raises:
        ValueError: A number is not finite, a vector has not length 1, they are not orthogonal, or the field
            of view or the near plane is none.
    """

    name: str
    position: tuple[float, float, float]
    forward: tuple[float, float, float] = (0.0, 0.0, -1.0)
    up: tuple[float, float, float] = (0.0, 1.0, 0.0)
    yfov_rad: float = float(np.pi / 4)
    near_m: float = 0.1
    node: int | None = None

    def __post_init__(self) -> None:
        _require_finite(self, (*self.position, *self.forward, *self.up, self.yfov_rad, self.near_m))
        _require_unit(self, "forward", self.forward)
        _require_unit(self, "up", self.up)
        along = sum(one * other for one, other in zip(self.forward, self.up, strict=True))
        _require(self, abs(along) <= _UNIT_TOLERANCE, f"up must be orthogonal to forward; it is {self.up}")
        _require(self, 0.0 < self.yfov_rad < math.pi, f"yfov_rad must be in (0, pi); it is {self.yfov_rad}")
        _require(self, self.near_m > 0.0, f"near_m must be > 0; it is {self.near_m}")


@dataclass(frozen=True)
class View:
    """A camera with a resolution in pixels."""

    camera: Camera
    width: int
    height: int


@dataclass(frozen=True, eq=False)
class Scene:
    """Everything that decides how a level's shadows look."""

    name: str
    meshes: tuple[Mesh, ...]
    lights: tuple[Light, ...] = ()
    cameras: tuple[Camera, ...] = ()

    @property
    def triangle_count(self) -> int:
        """Triangles drawn, over all meshes and placements."""
        return sum(mesh.triangle_count for mesh in self.meshes)

    @cached_property
    def bounds(self) -> Array:
        """(2, 3) float64: lowest and highest world corner of all geometry in metres; zeros without any."""
        corners = [extremes for mesh in self.meshes if mesh.triangle_count for extremes in _extremes(mesh)]
        if not corners:
            return np.zeros((2, 3))
        low, high = zip(*corners, strict=True)
        return np.stack([np.min(low, axis=0), np.max(high, axis=0)])

    @cached_property
    def digest(self) -> str:
        """SHA-256 of geometry, colors, lights and cameras, the same on every machine. Names do not count.

        One mesh placed twice spells the same as two meshes placed once. What draws nothing does not count.
        """
        sha = hashlib.sha256(b"gnomon-scene-2")
        shapes: dict[tuple[int, int], bytes] = {}
        for mesh in self.meshes:
            if not mesh.triangle_count:
                continue
            key = (id(mesh.positions), id(mesh.triangles))
            if key not in shapes:
                shapes[key] = _shape_digest(mesh)
            surface = b"Mesh\0" + shapes[key] + _word(mesh.casts) + _word(mesh.base_color)
            for placement in _spelled(mesh.placements, "<f8"):
                sha.update(surface + placement.tobytes())
        for light in self.lights:
            sha.update(_words(light))
        for camera in self.cameras:
            sha.update(_words(camera))
        return sha.hexdigest()


@dataclass(frozen=True)
class Instance:
    """One question for the selector: this light of this scene, seen in this view."""

    scene_digest: str
    light: Light
    view: View


def _placed(positions: Positions, placements: Array) -> Array:
    local = positions.astype(np.float64)
    columns = [placements[:, None, :3, axis] * local[None, :, axis, None] for axis in range(3)]
    return ((columns[0] + columns[1]) + columns[2]) + placements[:, None, :3, 3]


def _extremes(mesh: Mesh) -> Iterator[tuple[Array, Array]]:
    """Lowest and highest world corner of some placements after the other, so that few are ever expanded."""
    drawn = np.zeros(len(mesh.positions), bool)
    drawn[mesh.triangles.ravel()] = True
    corners = mesh.positions[drawn]
    step = max(EXPANDED_AT_ONCE // len(corners), 1)
    for first in range(0, len(mesh.placements), step):
        world = _placed(corners, mesh.placements[first : first + step])
        yield world.min(axis=(0, 1)), world.max(axis=(0, 1))


def _shape_digest(mesh: Mesh) -> bytes:
    sha = hashlib.sha256()
    for array, dtype in ((mesh.positions, "<f4"), (mesh.triangles, "<i4")):
        sha.update(str(array.shape).encode())
        sha.update(_spelled(array, dtype).ravel().data)
    return sha.digest()


def _spelled(array: npt.NDArray[Any], dtype: npt.DTypeLike) -> npt.NDArray[Any]:
    """A C-contiguous array, little-endian. Adding zero turns -0.0 into 0.0: both spell the same place."""
    return np.ascontiguousarray(array + 0, dtype=dtype)


def _require(thing: Light | Camera, holds: bool, sentence: str) -> None:  # noqa: FBT001
    if not holds:
        raise ValueError(f'{type(thing).__name__} "{thing.name}": {sentence}')


def _require_finite(thing: Light | Camera, numbers: Iterable[float]) -> None:
    _require(thing, all(map(math.isfinite, numbers)), f"all numbers must be finite; it is {thing}")


def _require_unit(thing: Light | Camera, what: str, vector: tuple[float, float, float]) -> None:
    right = abs(math.hypot(*vector) - 1.0) <= _UNIT_TOLERANCE
    _require(thing, right, f"{what} must be a unit vector; it is {vector}")


def _words(thing: Light | Camera) -> bytes:
    counted = [one.name for one in fields(thing) if one.name not in ("name", "node")]
    return type(thing).__name__.encode() + b"\0" + b"".join(_word(getattr(thing, name)) for name in counted)


def _word(value: object) -> bytes:
    """A field as bytes: an integer, NumPy's float or -0.0 spells the same as the float it equals."""
    if isinstance(value, tuple):
        return b"".join(map(_word, value))
    if isinstance(value, StrEnum):
        return value.encode() + b"\0"
    assert isinstance(value, int | float | np.number)
    # repr of a float is its shortest exact decimal: the same text on every machine.
    return repr(float(value) + 0.0).encode() + b"\0"
