"""Gnomon in Blender: asks the service which shadow technique each light should use."""

from __future__ import annotations

from . import operators, panels, preferences, session
from .light_nodes import NodeMarker

CLASSES = (*preferences.CLASSES, *operators.CLASSES, *panels.CLASSES)


class glTF2ExportUserExtension(NodeMarker):  # noqa: N801  Blender's exporter looks for this name
    """What Blender's glTF exporter calls for each node that it makes."""


def register() -> None:
    """Adds panels, operators and preferences to Blender."""
    import bpy  # noqa: PLC0415  the modules above can be read without Blender, this function cannot

    for one in CLASSES:
        bpy.utils.register_class(one)


def unregister() -> None:
    """Takes everything away again, and ends what is being asked. What lights were told stays with them."""
    import bpy  # noqa: PLC0415

    session.shut_down()
    for one in reversed(CLASSES):
        bpy.utils.unregister_class(one)
