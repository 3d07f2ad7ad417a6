"""Lights and cameras as JSON objects: of a lights file, or put together from words.

Their names and units are those that `gnomon inspect --json` prints: metres, radians, Y up; degrees and
targets are taken in their stead.
"""

from __future__ import annotations

import math

from scenes.entry import Entry
from scenes.level import NoteBook
from scenes.light_annotation import OWN_KEYS
from scenes.magnitudes import SMALLEST_DIVISOR, require_divisor, require_moderate, require_near
from scenes.scene import Camera, Light, LightKind, Mobility
from scenes.vectors import Vector, unit, upright

STORY = "gnomon"
# What is printed beside a light and says nothing of it, and what an annotation writes.
_SPARE = frozenset({"index", "node", STORY}) | OWN_KEYS
LIGHT_KEYS = frozenset(
    {"name", "kind", "position_m", "direction", "target_m", "range_m", "intensity", "color", "mobility"}
    | {"inner_cone_rad", "inner_cone_deg", "outer_cone_rad", "outer_cone_deg"}
)
_CAMERA_KEYS = frozenset(
    {"name", "position_m", "forward", "target_m", "up", "yfov_rad", "yfov_deg", "near_m"}
)
_UP = (0.0, 1.0, 0.0)
_NORTH = (0.0, 0.0, -1.0)
_KINDS = ", ".join(f'"{kind}"' for kind in LightKind)


def read_light(entry: Entry, node: int | None, notes: NoteBook) -> Light:
    """The light that an object describes; unknown keys are noted.

    Raises:
        LevelError: A value is missing, or is not what it should be.
    """
    _note_unknown(entry, LIGHT_KEYS, notes)
    try:
        kind = LightKind(entry.text("kind"))
    except ValueError:
        raise entry.wrong("kind", f"one of {_KINDS}") from None
    position = (0.0, 0.0, 0.0) if kind is LightKind.DIRECTIONAL else _place(entry, "position_m")
    directed = kind is not LightKind.POINT
    red, green, blue = entry.numbers("color", 3, (1.0, 1.0, 1.0))
    require_moderate(entry, "color", red, green, blue)
    intensity = entry.number("intensity", 1.0)
    require_moderate(entry, "intensity", intensity)
    inner, outer = _cones(entry) if kind is LightKind.SPOT else (0.0, math.pi / 4)
    return Light(
        name=entry.text("name") or (f"light {node}" if node is not None else str(kind)),
        kind=kind,
        position=position,
        direction=_direction(entry, "direction", position) if directed else (0.0, 0.0, -1.0),
        inner_cone_rad=inner,
        outer_cone_rad=outer,
        range_m=_range(entry),
        intensity=intensity,
        color=(red, green, blue),
        mobility=_mobility(entry),
        node=node,
    )


def read_camera(entry: Entry, node: int, notes: NoteBook) -> Camera:
    """The camera that an object describes; unknown keys are noted.

    Raises:
        LevelError: A value is missing, or is not what it should be.
    """
    _note_unknown(entry, _CAMERA_KEYS, notes)
    position = _place(entry, "position_m")
    forward = _direction(entry, "forward", position)
    x, y, z = entry.numbers("up", 3, _UP)
    up = upright((x, y, z), forward) or upright(_NORTH, forward)
    assert up, "no direction is parallel to both Y and Z"
    yfov = _angle(entry, "yfov", math.pi / 3)
    near = entry.number("near_m", 0.1)
    if not 0.0 < yfov < math.pi:
        raise entry.wrong(_written(entry, "yfov"), "between 0 and 180 degrees")
    if near <= 0.0:
        raise entry.wrong("near_m", "above 0 metres")
    require_divisor(entry, "near_m", near, "metres")
    return Camera(
        name=entry.text("name") or f"camera {node}",
        position=position,
        forward=forward,
        up=up,
        yfov_rad=yfov,
        near_m=near,
    )


def _place(entry: Entry, key: str) -> Vector:
    if not entry.has(key):
        raise entry.wrong(key, "a list of 3 finite numbers, in metres")
    x, y, z = entry.numbers(key, 3, ())
    return require_near((x + 0.0, y + 0.0, z + 0.0), key, entry.where)


def _direction(entry: Entry, key: str, position: Vector) -> Vector:
    """What `key` says, or where `target_m` lies from the position.

    Raises:
        LevelError: Neither is there, or it has no length.
    """
    known = key
    if entry.has("target_m"):
        target = _place(entry, "target_m")
        x, y, z = (there - here for there, here in zip(target, position, strict=True))
        known = "target_m"
    elif entry.has(key):
        x, y, z = entry.numbers(key, 3, ())
    else:
        raise entry.wrong(key, "a list of 3 finite numbers; target_m may take its place")
    direction = unit((x, y, z))
    if direction is None:
        raise entry.wrong(known, "a direction with a length, or a place elsewhere")
    return direction


def _range(entry: Entry) -> float:
    if not entry.has("range_m"):
        return math.inf
    distance = entry.number("range_m")
    if distance <= 0.0:
        raise entry.wrong("range_m", "above 0 metres, or absent for no end")
    require_divisor(entry, "range_m", distance, "metres, or absent for no end")
    return distance


def _angle(entry: Entry, name: str, default: float) -> float:
    if entry.has(f"{name}_deg"):
        return math.radians(entry.number(f"{name}_deg"))
    return entry.number(f"{name}_rad", default)


def _written(entry: Entry, name: str) -> str:
    """The key by which the file gives an angle: degrees go first, as in `_angle`."""
    return f"{name}_deg" if entry.has(f"{name}_deg") else f"{name}_rad"


def _cones(entry: Entry) -> tuple[float, float]:
    outer = _angle(entry, "outer_cone", math.pi / 4)
    inner = _angle(entry, "inner_cone", 0.0)
    for name, value, low, high in (
        ("outer_cone", outer, 0.0, math.pi / 2),
        ("inner_cone", inner, -1.0, outer),
    ):
        if not (low < value <= high and value >= 0.0):
            raise entry.wrong(_written(entry, name), f"a half angle, at most {math.degrees(high):g} degrees")
    if outer < SMALLEST_DIVISOR:
        raise entry.wrong(_written(entry, "outer_cone"), "a half angle that is not as good as none")
    return inner, outer


def _mobility(entry: Entry) -> Mobility:
    if not entry.has("mobility"):
        return Mobility.DYNAMIC
    try:
        return Mobility(entry.text("mobility"))
    except ValueError:
        raise entry.wrong("mobility", " or ".join(f'"{one}"' for one in Mobility)) from None


def _note_unknown(entry: Entry, known: frozenset[str], notes: NoteBook) -> None:
    unknown = [key for key in entry.values if key not in known | _SPARE]
    if unknown:
        names = ", ".join(unknown)[:80].encode("utf-8", "replace").decode()
        notes.warning(entry.where, f"Not known, and ignored: {names}.")
