"""The lights of a map: entities whose class begins with `light`, and the sun that worldspawn describes.

Sources: id Software's light (1996) for `light`, `target` and `angle`; ericw-tools' light (its documentation,
"Light Entity Keys" and "Worldspawn Keys") for all other keys; Half-Life for `_light` and `light_environment`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from scenes.level import NoteBook
from scenes.light_annotation import MOBILITY_KEY
from scenes.quake.map_text import Entity
from scenes.quake.units import UNITS_PER_M, heading, place
from scenes.quake.values import number, numbers
from scenes.scene import Light, LightKind, Mobility
from scenes.vectors import Vector, unit

DEFAULT_LIGHT = 300.0
DEFAULT_CONE_DEG = 40.0
# Lights that fade by 1 / x do so from here on (ericw-tools, LF_SCALE).
_FADE_FROM = 128.0
# Candela of a light that reaches 1 m: brightness has no unit in Quake, and this one suits the pictures.
_CANDELA = 0.1
# A sun of 300 is as bright as a light of 300 from 5 m away, about half its reach.
_LUX_PER_LIGHT = 0.001
# Metres: a light that reaches less reaches nothing.
_SHORTEST = 1e-3

_Targets = Mapping[str, Entity]


def read_lights(entities: Sequence[Entity], notes: NoteBook) -> tuple[Light, ...]:
    """One light for every entity that is one, in the order of the file; what is left out is noted.

    Raises:
        LevelError: A key holds something else than the numbers that it should.
    """
    targets: dict[str, Entity] = {}
    for entity in entities:
        if name := entity.value("targetname"):
            targets.setdefault(name, entity)
    fade = next((number(one, 1.0, "_dist") for one in entities if one.kind == "worldspawn"), 1.0)
    lights = []
    for entity in entities:
        if entity.kind == "worldspawn":
            light = _worldspawn_sun(entity, notes)
        elif entity.kind.startswith("light"):
            light = _light(entity, targets, fade if fade > 0.0 else 1.0, notes)
        else:
            continue
        lights += [light] if light else []
    return tuple(lights)


def _light(entity: Entity, targets: _Targets, fade: float, notes: NoteBook) -> Light | None:
    place_words = f"line {entity.line}, {entity.where}"
    if reason := _unlit(entity):
        notes.info(place_words, f"{reason}: left out.")
        return None
    brightness, color = _brightness(entity)
    if brightness <= 0.0:
        notes.warning(place_words, f"Its brightness is {brightness:g}: it gives no light, and is left out.")
        return None
    origin = numbers(entity, (3,), "origin")
    if origin is None:
        notes.warning(place_words, "It has no origin: it stands at 0 0 0, as in the game.")
    position = origin or (0.0, 0.0, 0.0)
    light = Light(
        name=f"{entity.kind} {entity.index}",
        kind=LightKind.POINT,
        position=place(*position),
        color=color,
        mobility=_mobility(entity, notes),
        node=entity.index,
    )
    aim = _aim(entity, position, targets, notes)
    if entity.kind == "light_environment" or number(entity, 0.0, "_sun"):
        return _sun(light, brightness, aim or heading(0.0, -90.0))
    reach = _reach_units(entity, brightness, fade)
    if reach / UNITS_PER_M < _SHORTEST:
        notes.warning(place_words, "It reaches less than a millimetre, and is left out.")
        return None
    range_m = reach / UNITS_PER_M
    strength = (range_m if math.isfinite(range_m) else brightness / UNITS_PER_M) ** 2 * _CANDELA
    light = replace(light, range_m=range_m, intensity=strength)
    return light if aim is None else _spot(light, entity, aim, notes)


def _unlit(entity: Entity) -> str:
    """Why the compiler takes no light from this entity; empty where it does."""
    if number(entity, 0.0, "_nostaticlight"):
        return "It has _nostaticlight"
    if entity.value("_surface"):
        return "It is a template for surfaces that shine (_surface)"
    if number(entity, 0.0, "_sunlight2") or number(entity, 0.0, "_sunlight3"):
        return "It lights from a dome, not from a place"
    return ""


def _brightness(entity: Entity) -> tuple[float, Vector]:
    """Quake's brightness, and linear RGB of at most 1.

    Half-Life writes `red green blue brightness` or `red green blue` in one key.
    """
    found = numbers(entity, (1, 3, 4), "light", "_light") or (DEFAULT_LIGHT,)
    color = numbers(entity, (3,), "_color", "color")
    if len(found) > 1:
        color = color or found[:3]
    red, green, blue = color or (1.0, 1.0, 1.0)
    # From 0 to 1 or from 0 to 255: the compilers tell them apart so.
    largest = 255.0 if max(red, green, blue) > 1.0 else 1.0
    brightness = {1: found[0], 3: DEFAULT_LIGHT, 4: found[-1]}[len(found)]
    return brightness, (max(red, 0.0) / largest, max(green, 0.0) / largest, max(blue, 0.0) / largest)


def _reach_units(entity: Entity, brightness: float, fade: float) -> float:
    """Where the light ends: at 0 where it fades evenly, else where one of 255 steps of brightness is left."""
    wait = number(entity, 1.0, "wait")
    faded = (wait if wait > 0.0 else 1.0) * fade
    delay = number(entity, 0.0, "delay")
    if delay == 0.0:
        end = number(entity, 0.0, "_falloff")
        return end if end > 0.0 else brightness / faded
    if delay == 1.0:
        return _FADE_FROM * brightness / faded
    if delay == 2.0:
        return _FADE_FROM * math.sqrt(brightness) / faded
    if delay == 5.0:
        return _FADE_FROM * max(math.sqrt(brightness) - 1.0, 0.0) / faded
    return math.inf


def _aim(entity: Entity, origin: tuple[float, ...], targets: _Targets, notes: NoteBook) -> Vector | None:
    """Where a spot or a sun shines; None for a light that shines everywhere."""
    mangle = numbers(entity, (3,), "mangle", "_sun_mangle")
    if mangle:
        return heading(mangle[0], mangle[1])
    if entity.kind == "light_environment":
        pitch, yaw, _ = numbers(entity, (3,), "angles") or (-90.0, number(entity, 0.0, "angle"), 0.0)
        return heading(yaw, number(entity, pitch, "pitch"))
    name = entity.value("target")
    if not name:
        return None
    place_words = f"line {entity.line}, {entity.where}"
    found = targets.get(name)
    if found is None:
        notes.warning(place_words, f'Nothing has its target "{name}" as targetname: it shines everywhere.')
        return None
    goal = numbers(found, (3,), "origin") or (0.0, 0.0, 0.0)
    direction = unit(place(*(there - here for there, here in zip(goal, origin, strict=True))))
    if direction is None:
        notes.warning(place_words, f'Its target "{name}" is where it stands itself: it shines everywhere.')
    return direction


def _spot(light: Light, entity: Entity, direction: Vector, notes: NoteBook) -> Light:
    cone = number(entity, 0.0, "angle", "_cone") or DEFAULT_CONE_DEG
    if not 0.0 < cone <= 180.0:
        notes.warning(
            f"line {entity.line}, {entity.where}",
            f"No cone has {cone:g} degrees: it has {DEFAULT_CONE_DEG:g}, as without that key.",
        )
        cone = DEFAULT_CONE_DEG
    # Without a soft angle Quake's spots end sharply.
    soft = number(entity, 0.0, "_softangle")
    inner = soft if 0.0 < soft < cone else cone
    outer_rad = min(math.radians(cone / 2), math.pi / 2)
    return replace(
        light,
        kind=LightKind.SPOT,
        direction=direction,
        inner_cone_rad=min(math.radians(inner / 2), outer_rad),
        outer_cone_rad=outer_rad,
    )


def _sun(light: Light, brightness: float, direction: Vector) -> Light:
    return replace(
        light,
        kind=LightKind.DIRECTIONAL,
        position=(0.0, 0.0, 0.0),
        direction=direction,
        intensity=brightness * _LUX_PER_LIGHT,
    )


def _worldspawn_sun(entity: Entity, notes: NoteBook) -> Light | None:
    if number(entity, 0.0, "_sun2"):
        notes.warning("worldspawn", "Its second sun (_sun2) is left out: make it a light entity with _sun 1.")
    if number(entity, 0.0, "_sunlight2") or number(entity, 0.0, "_sunlight3"):
        notes.info("worldspawn", "Light from a dome (_sunlight2, _sunlight3) has no direction: left out.")
    brightness = number(entity, 0.0, "_sunlight", "_sun_light")
    if brightness <= 0.0:
        return None
    mangle = numbers(entity, (3,), "_sunlight_mangle", "_sun_mangle", "_sun_angle") or (0.0, -90.0, 0.0)
    red, green, blue = numbers(entity, (3,), "_sunlight_color", "_sun_color") or (1.0, 1.0, 1.0)
    largest = 255.0 if max(red, green, blue) > 1.0 else 1.0
    plain = Light(
        name="sun",
        kind=LightKind.POINT,
        color=(max(red, 0.0) / largest, max(green, 0.0) / largest, max(blue, 0.0) / largest),
        mobility=_mobility(entity, notes),
        node=entity.index,
    )
    return _sun(plain, brightness, heading(mangle[0], mangle[1]))


def _mobility(entity: Entity, notes: NoteBook) -> Mobility:
    key = f"_{MOBILITY_KEY}"
    hint = entity.value(key)
    if not hint:
        return Mobility.DYNAMIC
    if hint in set(Mobility):
        return Mobility(hint)
    known = " or ".join(f'"{mobility}"' for mobility in Mobility)
    notes.warning(
        f"line {entity.line}, {entity.where}", f'{key} must be {known}; it is "{hint[:60]}": ignored.'
    )
    return Mobility.DYNAMIC
