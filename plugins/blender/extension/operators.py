"""What can be done: recommend, cancel, clear."""

from __future__ import annotations

import bpy

from . import session
from .annotation import clear
from .client.asking import Ask
from .client.errors import AddressError
from .level_export import ExportedLevel, ExportError, exported_level
from .preferences import connection_problem, preferences
from .scene_lights import left_out_words, scene_lights, why_left_out

FINISHED, CANCELLED = {"FINISHED"}, {"CANCELLED"}
MOST_NODES = 100
"""Instances of a light that are asked about: the service takes no more names."""


class _Recommending:
    """What both questions share: export, ask in the background, and say what is in the way."""

    bl_options = {"REGISTER"}  # noqa: RUF012  Blender's own convention

    wait: bpy.props.BoolProperty(
        name="Wait",
        description="Return only when the answer is there: for scripts, which have no timers",
        default=False,
        options={"HIDDEN", "SKIP_SAVE"},
    )

    @classmethod
    def ready(cls, context: bpy.types.Context) -> bool:
        """Whether a question can be asked now; if not, the tool tip says why."""
        if session.SESSION.question is not None:
            cls.poll_message_set("A question is being asked; cancel it first")
        elif context.mode != "OBJECT":
            cls.poll_message_set("Leave the edit mode first")
        else:
            return True
        return False

    def asked(self, context: bpy.types.Context, light: bpy.types.Object | None) -> set[str]:
        """Exports the scene and asks about one light, or about all."""
        wanted = preferences(context)
        problem = connection_problem(wanted)
        if problem:
            return self.refused(problem)
        try:
            level = exported_level()
            ask = Ask(policy=wanted.policy, name=level.name, lights=_chosen(level, light))
            note = "" if light else left_out_words(context.scene)
            session.ask(level, ask, wanted.url, wanted.token, wanted.timeout_s, note)
        except (ExportError, AddressError) as error:
            return self.refused(str(error))
        session.redraw()
        if self.wait:
            session.finish(wanted.timeout_s)
            self.report({"ERROR" if session.SESSION.failed else "INFO"}, session.SESSION.status)
            return CANCELLED if session.SESSION.failed else FINISHED
        return FINISHED

    def refused(self, words: str) -> set[str]:
        """Says why nothing was asked, here and in the panels."""
        session.tell(words, failed=True)
        # Blender shows it at the pointer; in a script it becomes a RuntimeError.
        self.report({"ERROR"}, words)
        return CANCELLED


def _chosen(level: ExportedLevel, light: bpy.types.Object | None) -> tuple[str, ...]:
    """The nodes to ask about; empty for all.

    Raises:
        ExportError: The level has none of them.
    """
    if not level.lights:
        raise ExportError("The scene has no light that glTF can hold: point, sun or spot.")
    if light is None:
        return ()
    nodes = [f"node:{node}" for node, uid in level.lights.items() if uid == light.session_uid]
    if not nodes:
        raise ExportError(f"{light.name} is not in this scene.")
    return tuple(nodes[:MOST_NODES])


class GNOMON_OT_recommend_light(_Recommending, bpy.types.Operator):  # noqa: N801  Blender's own convention
    """Ask Gnomon which shadow technique this light should use."""

    bl_idname = "gnomon.recommend_light"
    bl_label = "Recommend This Light"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only with a light that goes into a level."""
        light = context.object
        if light is None or light.type != "LIGHT":
            cls.poll_message_set("Select a light")
            return False
        reason = why_left_out(light)
        if reason:
            cls.poll_message_set(f"This light is left out: {reason}")
            return False
        return cls.ready(context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Asks about the active light."""
        return self.asked(context, context.object)


class GNOMON_OT_recommend_scene(_Recommending, bpy.types.Operator):  # noqa: N801  Blender's own convention
    """Ask Gnomon which shadow technique each light of the scene should use."""

    bl_idname = "gnomon.recommend_scene"
    bl_label = "Recommend the Scene"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only while nothing else is being asked."""
        return cls.ready(context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Asks about all lights."""
        return self.asked(context, None)


class GNOMON_OT_cancel(bpy.types.Operator):  # noqa: N801  Blender's own convention
    """Stop waiting for Gnomon's answer."""

    bl_idname = "gnomon.cancel"
    bl_label = "Cancel"
    bl_options = {"REGISTER"}  # noqa: RUF012  Blender's own convention

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:  # noqa: ARG003  Blender's signature
        """Only while something is being asked."""
        return session.SESSION.question is not None

    def execute(self, context: bpy.types.Context) -> set[str]:  # noqa: ARG002  Blender's signature
        """Ends the question; the timer notices."""
        if session.SESSION.question:
            session.SESSION.question.cancel()
        return FINISHED


class GNOMON_OT_clear(bpy.types.Operator):  # noqa: N801  Blender's own convention
    """Remove Gnomon's recommendations from lights."""

    bl_idname = "gnomon.clear"
    bl_label = "Clear"
    bl_options = {"REGISTER", "UNDO"}  # noqa: RUF012  Blender's own convention

    only_active: bpy.props.BoolProperty(
        name="Only This Light", description="Leave the other lights of the scene as they are", default=False
    )

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Clears the active light, or all of the scene."""
        active = context.object
        lights = [active] if self.only_active and active else scene_lights(context.scene)
        cleared = [one.name for one in lights if one.is_editable and clear(one)]
        count = f"{len(cleared)} light" + ("" if len(cleared) == 1 else "s")
        session.tell(f"Cleared {count}.", failed=False)
        self.report({"INFO"}, session.SESSION.status)
        return FINISHED if cleared else CANCELLED


CLASSES = (GNOMON_OT_recommend_light, GNOMON_OT_recommend_scene, GNOMON_OT_cancel, GNOMON_OT_clear)
