"""What is shown: in a light's properties, and in the sidebar of the 3D view."""

from __future__ import annotations

import textwrap
from typing import Any

import bpy

from . import annotation
from .annotation import standing
from .applying import Detail
from .operators import GNOMON_OT_cancel, GNOMON_OT_clear, GNOMON_OT_recommend_light, GNOMON_OT_recommend_scene
from .preferences import preferences
from .scene_lights import why_left_out
from .session import SESSION

PIXELS_A_LETTER = 7
LEAST_LETTERS = 24


class GNOMON_PT_light(bpy.types.Panel):  # noqa: N801  Blender's own convention
    """Gnomon in the properties of a light."""

    bl_label = "Gnomon"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "data"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only for lights."""
        return context.object is not None and context.object.type == "LIGHT"

    def draw(self, context: bpy.types.Context) -> None:
        """The light, and what was said of it."""
        draw(self.layout, context, scene=False)


class GNOMON_PT_sidebar(bpy.types.Panel):  # noqa: N801  Blender's own convention
    """Gnomon in the sidebar of the 3D view."""

    bl_label = "Gnomon"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Gnomon"

    def draw(self, context: bpy.types.Context) -> None:
        """The scene, and the active light."""
        draw(self.layout, context, scene=True)


def draw(layout: Any, context: bpy.types.Context, *, scene: bool) -> None:
    """What both panels show."""
    letters = _letters(context)
    layout.prop(preferences(context), "policy")
    light = context.object if context.object and context.object.type == "LIGHT" else None
    column = layout.column(align=True)
    if light:
        column.operator(GNOMON_OT_recommend_light.bl_idname, icon="LIGHT")
    if scene:
        column.operator(GNOMON_OT_recommend_scene.bl_idname, icon="SCENE_DATA")
    if SESSION.question is not None:
        column.operator(GNOMON_OT_cancel.bl_idname, icon="CANCEL")
    if SESSION.status:
        _lines(layout, SESSION.status, letters, "ERROR" if SESSION.failed else "INFO")
    if light:
        _draw_light(layout, light, letters)
    if scene:
        layout.operator(GNOMON_OT_clear.bl_idname, text="Clear the Scene", icon="TRASH").only_active = False


def _draw_light(layout: Any, light: bpy.types.Object, letters: int) -> None:
    box = layout.box()
    box.label(text=light.name, icon="OUTLINER_OB_LIGHT")
    left_out, found, detail = why_left_out(light), standing(light), SESSION.details.get(light.session_uid)
    if left_out:
        _lines(box, f"This light is left out: {left_out}.", letters, "ERROR")
    if not found:
        if detail and detail.recommendation is None:
            _lines(box, detail.words, letters, "ERROR")
        return
    for name, value in rows(found):
        row = box.split(factor=0.4)
        row.label(text=name)
        row.label(text=value)
    _lines(box, _reason(found, detail), letters, "NONE")
    box.operator(GNOMON_OT_clear.bl_idname, text="Clear", icon="TRASH").only_active = True


def rows(found: dict[str, Any]) -> list[tuple[str, str]]:
    """A light's properties in words; those that somebody else has written may be of any type."""
    settings = [str(found[key]) for key in annotation.OF_MAPS.values() if key in found]
    words = [
        ("Technique", annotation.TECHNIQUE, "{}"),
        ("Time", annotation.SHADOW_MS, "{} ms"),
        ("Error", annotation.EDGE_ERROR_PX, "{} px"),
        ("Source", annotation.SOURCE, "{}"),
    ]
    shown = [(name, text.format(found[key])) for name, key, text in words if key in found]
    if settings:
        shown.insert(1, ("Map", " ".join(settings)))
    confidence = found.get(annotation.CONFIDENCE)
    if isinstance(confidence, (int, float)):
        shown.insert(-1, ("Confidence", f"{confidence:.0%}"))
    return shown


def _reason(found: dict[str, Any], detail: Detail | None) -> str:
    """Why, as long as it is still about what the light says: it may have been undone or edited since."""
    if detail and detail.recommendation and annotation.properties(detail.recommendation) == found:
        return detail.words
    return "Ask again to see why."


def _lines(layout: Any, text: str, letters: int, icon: str) -> None:
    column = layout.column(align=True)
    for index, line in enumerate(textwrap.wrap(text, letters)):
        column.label(text=line, icon=icon if index == 0 else "BLANK1" if icon != "NONE" else "NONE")


def _letters(context: bpy.types.Context) -> int:
    scale = context.preferences.system.ui_scale or 1.0  # 0 without a window
    width = context.region.width if context.region else 0
    return max(LEAST_LETTERS, int(width / (PIXELS_A_LETTER * scale)) - 6)


CLASSES = (GNOMON_PT_light, GNOMON_PT_sidebar)
