"""The lights of a scene: which go into a level, and why others do not."""

from __future__ import annotations

import bpy

MOST_NAMES = 3


def scene_lights(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    """Every light of the scene, instances' sources left out."""
    return [one for one in scene.objects if one.type == "LIGHT"]


def why_left_out(light: bpy.types.Object) -> str:
    """Why a light does not go into a level; empty where it does."""
    if light.data.type == "AREA":
        return "glTF has no area lights"
    collections = light.users_collection
    if light.hide_render or (collections and all(one.hide_render for one in collections)):
        return "it is switched off in renders"
    return ""


def left_out_words(scene: bpy.types.Scene) -> str:
    """A sentence on the lights that are not asked about; empty where there are none."""
    reasons: dict[str, list[str]] = {}
    for light in scene_lights(scene):
        reason = why_left_out(light)
        if reason:
            reasons.setdefault(reason.replace("it is", "they are"), []).append(light.name)
    return " ".join(f"Left out, as {reason}: {_listed(names)}." for reason, names in sorted(reasons.items()))


def light_by_uid(uid: int) -> bpy.types.Object | None:
    """The light of this number, whatever its name is by now; None where it is gone."""
    return next((one for one in bpy.data.objects if one.session_uid == uid and one.type == "LIGHT"), None)


def _listed(names: list[str]) -> str:
    more = len(names) - MOST_NAMES
    return ", ".join(names[:MOST_NAMES]) + (f" and {more} more" if more > 0 else "")
