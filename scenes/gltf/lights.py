"""Punctual lights of a glTF file, one for every node that carries one.

Source: KHR_lights_punctual (Khronos), which defines kinds, units, defaults and legal intervals.
"""

from __future__ import annotations

import math
import reprlib
from dataclasses import replace

import numpy as np

from scenes.entry import Entry, printable
from scenes.errors import LevelError
from scenes.gltf.asset import LIGHTS, Asset
from scenes.gltf.nodes import PlacedNode
from scenes.level import NoteBook
from scenes.light_annotation import MOBILITY_KEY
from scenes.magnitudes import require_divisor, require_moderate, require_near
from scenes.scene import Light, LightKind, Mobility
from scenes.vectors import Vector, unit, vector

RIGHT_ANGLE = math.pi / 2

# Exporters write 90 degrees as the nearest float32, which lies above pi / 2.
RIGHT_ANGLE_IN_FLOAT32 = float(np.nextafter(np.float32(RIGHT_ANGLE), np.float32(2)))


def read_light(asset: Asset, node: PlacedNode, notes: NoteBook) -> Light | None:
    """The light that a node carries, in world space; None where it carries none.

    Raises:
        LevelError: The light does not exist, is malformed, has an illegal cone or range or numbers beyond
            float32, or the node's transform leaves it without a direction or moves it too far.
    """
    link = node.entry.extension(LIGHTS)
    if link is None:
        return None
    _, definition = asset.linked(link, "light", "lights")
    light = Entry(definition.values, f"{definition.where} on {node.entry.where}")
    kind = _kind(light)
    red, green, blue = light.numbers("color", 3, (1.0, 1.0, 1.0))
    require_moderate(light, "color", red, green, blue)
    intensity = light.number("intensity", 1.0)
    require_moderate(light, "intensity", intensity)
    plain = Light(
        name=node.entry.text("name") or light.text("name") or f"light {node.index}",
        kind=kind,
        position=require_near(vector(node.world[:3, 3]), "light", light.where),
        range_m=_range(light),
        intensity=intensity,
        color=(red, green, blue),
        mobility=_mobility(node.entry, light, notes),
        node=node.index,
    )
    if plain.intensity < 0.0 or min(plain.color) < 0.0:
        notes.warning(light.where, "It takes light away (a negative intensity or colour); it is kept so.")
    if kind is LightKind.POINT:
        return plain
    aimed = replace(plain, direction=_direction(light, node))
    return _with_cone(aimed, light, notes) if kind is LightKind.SPOT else aimed


def _kind(light: Entry) -> LightKind:
    try:
        return LightKind(light.text("type"))
    except ValueError:
        raise light.wrong("type", " or ".join(f'"{kind}"' for kind in LightKind)) from None


def _range(light: Entry) -> float:
    distance = light.number("range", math.inf)
    if distance <= 0.0:
        raise light.wrong("range", "above 0 metres, or absent for no end")
    if math.isfinite(distance):
        require_divisor(light, "range", distance, "metres, or absent for no end")
    return distance


def _direction(light: Entry, node: PlacedNode) -> Vector:
    direction = unit(vector(-node.world[:3, 2]))
    if direction is None:
        raise LevelError(
            "The transform of this node leaves its light without a direction.",
            where=light.where,
            known="The node's z axis has length 0 in the world.",
            remedy="Give the node, and those above it, a scale other than 0.",
        )
    return direction


def _with_cone(light: Light, entry: Entry, notes: NoteBook) -> Light:
    spot = entry.child("spot")
    outer = spot.number("outerConeAngle", math.pi / 4)
    inner = spot.number("innerConeAngle", 0.0)
    if not 0.0 < outer <= RIGHT_ANGLE_IN_FLOAT32:
        raise _wrong_angle(spot, "outerConeAngle", outer, "(0, pi/2]")
    outer = min(outer, RIGHT_ANGLE)
    # Blender writes inner = outer for a spot whose blend is 0, which the specification just forbids.
    if inner > RIGHT_ANGLE_IN_FLOAT32 or not 0.0 <= min(inner, RIGHT_ANGLE) <= outer:
        raise _wrong_angle(spot, "innerConeAngle", inner, f"[0, outerConeAngle = {outer})")
    inner = min(inner, RIGHT_ANGLE)
    if inner == outer:
        notes.info(entry.where, "Its inner cone is as wide as its outer: it ends without a fall-off.")
    return replace(light, inner_cone_rad=inner, outer_cone_rad=outer)


def _wrong_angle(spot: Entry, key: str, value: float, interval: str) -> LevelError:
    error = spot.wrong(key, f"a half angle in {interval} radians")
    if RIGHT_ANGLE < value <= 90.0:
        error.remedy = f"Are these degrees? {value:g} degrees are {math.radians(value):.4g} radians."
    return error


def _mobility(node: Entry, light: Entry, notes: NoteBook) -> Mobility:
    for entry in (node, light):
        extras = entry.values.get("extras")
        hint = extras.get(MOBILITY_KEY) if isinstance(extras, dict) else None
        if hint is None:
            continue
        if isinstance(hint, str) and hint in set(Mobility):
            return Mobility(hint)
        known = " or ".join(f'"{mobility}"' for mobility in Mobility)
        found = printable(reprlib.repr(hint))
        notes.warning(entry.where, f"{MOBILITY_KEY} in its extras must be {known}; it is {found}: ignored.")
    return Mobility.DYNAMIC
