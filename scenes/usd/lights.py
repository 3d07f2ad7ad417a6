"""Lights of a USD stage as punctual ones; what that loses is noted for each.

Source: OpenUSD, "UsdLux" and "UsdLuxLightAPI": every light shines along its -Z, a cylinder lies along X,
intensity is a luminance in nits, times 2^exposure, and with `normalize` divided by the area.

A closed convex lamp of luminance L and surface A shines L A / 4 on average over directions (Cauchy: its
shadow has a quarter of its surface), a flat one L A straight ahead.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

from pxr import UsdLux

from scenes.errors import LevelError
from scenes.level import NoteBook
from scenes.magnitudes import LARGEST
from scenes.scene import Array, Light, LightKind, Mobility
from scenes.usd.values import Prim, color, number, path_of, value, wrong
from scenes.vectors import Vector, unit, vector

# A flat lamp shines with the cosine of the angle: 17 % are left at 80 degrees, and a single map covers that.
FLAT_CONE_RAD = math.radians(80.0)
MOBILITY = "gnomon:mobility"
# The rest has no direction that its shadows could have, or no place.
UNREAD = {
    "DomeLight": "it shines from everywhere",
    "DomeLight_1": "it shines from everywhere",
    "PortalLight": "it only guides a dome light",
    "GeometryLight": "it has the shape of a mesh",
}


@dataclass(frozen=True)
class _Shape:
    """The kind that a lamp is read as, with its luminous area in square metres: 0 for a point.

    `share` of luminance times area is its intensity; `words` tells the author what it was.
    """

    kind: LightKind
    area_m2: float
    share: float
    words: str


def read_light(prim: Prim, world: Array, name: str, index: int, notes: NoteBook) -> Light | None:
    """The punctual light that stands for a light of USD; None, with a note, where none does.

    Args:
        prim: The light.
        world: (4, 4) float64, metres and Y up from its own space.
        name: What to call it.
        index: Its number among the stage's lights.
        notes: For what was approximated.

    Raises:
        LevelError: One of its numbers is not finite, or it is too far away.
    """
    where = path_of(prim)
    if not _wanted(prim, notes):
        return None
    shape = _shape(prim, world)
    if shape is None:
        reason = UNREAD.get(str(prim.GetTypeName()), "Gnomon does not know its kind")
        notes.warning(where, f"This {prim.GetTypeName()} is ignored: {reason}.")
        return None
    position, direction = vector(world[:3, 3]), unit(vector(-world[:3, 2]))
    if direction is None:
        notes.warning(where, "Skipped: its transform leaves it without a direction.")
        return None
    if max(map(abs, position)) > LARGEST:
        raise LevelError(
            f"This light is farther than {LARGEST:g} metres from the origin.",
            where=where,
            remedy="Check the xformOps of the prim and of those above it.",
        )
    light = Light(
        name=name,
        kind=shape.kind,
        position=position,
        direction=direction,
        outer_cone_rad=FLAT_CONE_RAD,
        intensity=_intensity(prim, shape),
        color=_color(prim),
        mobility=_mobility(prim, notes),
        node=index,
    )
    if light.intensity < 0.0 or min(light.color) < 0.0:
        notes.warning(where, "It takes light away (a negative intensity or colour); it is kept so.")
    light, cone = _shaped(light, prim, notes)
    if shape.words or cone:
        notes.info(where, f"{shape.words or 'A point'}: read as a {light.kind} light{cone}.")
    _note_what_is_lost(prim, notes)
    return light


def _wanted(prim: Prim, notes: NoteBook) -> bool:
    shadow = prim.GetAttribute("inputs:shadow:enable")
    if shadow and value(shadow) is False:
        notes.info(path_of(prim), "Its author has turned its shadow off (inputs:shadow:enable): left out.")
        return False
    return True


def _shape(prim: Prim, world: Array) -> _Shape | None:
    kind = str(prim.GetTypeName())
    x, y, z = (math.hypot(*world[:3, axis]) for axis in range(3))
    if kind == "DistantLight":
        angle = number(prim, _input(prim, "angle"))
        words = f"A disc of {angle:g} degrees in the sky, without its soft edges" if angle > 0.0 else ""
        # E = L times the projected solid angle of the disc.
        return _Shape(LightKind.DIRECTIONAL, math.pi * math.sin(math.radians(angle) / 2) ** 2, 1.0, words)
    if kind == "SphereLight":
        radius = _length(prim, "radius") * math.sqrt((x * x + y * y + z * z) / 3.0)
        if value(prim.GetAttribute("treatAsPoint")) or radius == 0.0:
            return _Shape(LightKind.POINT, 4.0 * math.pi * radius**2, 0.25, "")
        words = f"A sphere of {radius:.4g} m radius, without its soft edges"
        return _Shape(LightKind.POINT, 4.0 * math.pi * radius**2, 0.25, words)
    if kind == "CylinderLight":
        radius, length = (
            _length(prim, "radius") * math.sqrt((y * y + z * z) / 2.0),
            _length(prim, "length") * x,
        )
        words = f"A tube of {length:.4g} m and {radius:.4g} m radius, from its middle"
        return _Shape(LightKind.POINT, 2.0 * math.pi * radius * length, 0.25, words)
    if kind == "DiskLight":
        radius = _length(prim, "radius")
        area, words = math.pi * radius**2 * x * y, f"A disc of {radius * math.sqrt(x * y):.4g} m radius"
    elif kind == "RectLight":
        width, height = _length(prim, "width") * x, _length(prim, "height") * y
        area, words = width * height, f"A rectangle of {width:.4g} x {height:.4g} m"
    else:
        return None
    return _Shape(LightKind.SPOT, area, 1.0, f"{words}, from its middle")


def _length(prim: Prim, name: str) -> float:
    length = number(prim, _input(prim, name))
    if length < 0.0:
        raise wrong(prim, _input(prim, name), "0 or above", length)
    return length


def _input(prim: Prim, name: str) -> Any:
    return prim.GetAttribute(f"inputs:{name}")


def _intensity(prim: Prim, shape: _Shape) -> float:
    """Candela, or lux for a directional light."""
    exposure = number(prim, _input(prim, "exposure"))
    luminance = number(prim, _input(prim, "intensity"), 1.0) * math.exp2(min(max(exposure, -200.0), 200.0))
    luminance *= number(prim, _input(prim, "diffuse"), 1.0)
    # A lamp without an area can only be stated by its power, and USD then takes its area for 1.
    per_area = bool(value(_input(prim, "normalize"))) or shape.area_m2 == 0.0
    return min(max(luminance * shape.share * (1.0 if per_area else shape.area_m2), -LARGEST), LARGEST)


def _color(prim: Prim) -> Vector:
    red, green, blue = color(prim, _input(prim, "color"))
    if value(_input(prim, "enableColorTemperature")):
        kelvin = number(prim, _input(prim, "colorTemperature"), 6500.0)
        warm = UsdLux.BlackbodyTemperatureAsRgb(kelvin)
        red, green, blue = red * warm[0], green * warm[1], blue * warm[2]
    return red, green, blue


def _shaped(light: Light, prim: Prim, notes: NoteBook) -> tuple[Light, str]:
    """The light within its ShapingAPI's cone, and words for that."""
    where = path_of(prim)
    flat = f" of {math.degrees(FLAT_CONE_RAD):.0f} degrees half angle" if light.kind is LightKind.SPOT else ""
    if light.kind is LightKind.DIRECTIONAL or not prim.HasAPI(UsdLux.ShapingAPI):
        return light, flat
    for name, what in (("focus", "a focus"), ("ies:file", "an IES profile")):
        attribute = _input(prim, f"shaping:{name}")
        if attribute and value(attribute):
            notes.warning(where, f"It has {what}, which is ignored.")
    degrees = number(prim, _input(prim, "shaping:cone:angle"), 90.0)
    outer = math.radians(degrees)
    limit = FLAT_CONE_RAD if light.kind is LightKind.SPOT else math.pi / 2
    if outer > limit:
        return light, flat
    if outer <= 0.0:
        raise wrong(prim, _input(prim, "shaping:cone:angle"), "a half angle above 0 degrees", degrees)
    softness = min(max(number(prim, _input(prim, "shaping:cone:softness")), 0.0), 1.0)
    cone = replace(light, kind=LightKind.SPOT, outer_cone_rad=outer, inner_cone_rad=outer * (1.0 - softness))
    return cone, f" of {degrees:g} degrees half angle"


def _mobility(prim: Prim, notes: NoteBook) -> Mobility:
    attribute = prim.GetAttribute(MOBILITY)
    hint = value(attribute)
    if hint is None:
        return Mobility.DYNAMIC
    if str(hint) in set(Mobility):
        return Mobility(str(hint))
    known = " or ".join(f'"{mobility}"' for mobility in Mobility)
    notes.warning(path_of(prim), f"{MOBILITY} must be {known}; it is {str(hint)!r}: ignored.")
    return Mobility.DYNAMIC


def _note_what_is_lost(prim: Prim, notes: NoteBook) -> None:
    where = path_of(prim)
    for collection, what in (("lightLink", "Light linking"), ("shadowLink", "Shadow linking")):
        names = [f"collection:{collection}:{list_}" for list_ in ("includes", "excludes")]
        if any((link := prim.GetRelationship(name)) and link.HasAuthoredTargets() for name in names):
            notes.warning(where, f"{what} is ignored: it lights and shadows everything.")
    filters = prim.GetRelationship("light:filters")
    if filters and filters.HasAuthoredTargets():
        notes.warning(where, "Its light filters are ignored.")
    if number(prim, _input(prim, "shadow:distance"), -1.0) > 0.0:
        notes.info(where, "Its shadow distance is ignored.")
