"""Which glTF node is which light of Blender's.

Names do not tell: libraries may hold two lights of one name, and a light in an instanced collection becomes
a node for each instance. So the exporter is asked to write the light's number on each node made of it.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, ClassVar

import bpy

MARK = "gnomon_blender_light"
LIGHTS = "KHR_lights_punctual"


class NodeMarker:
    """Marks nodes of lights, but only while `marking` is on: other exports are no business of ours."""

    on: ClassVar[bool] = False

    def gather_node_hook(self, node: Any, source: bpy.types.Object | None, settings: Any) -> None:  # noqa: ARG002
        """Is called by Blender's exporter with each node and the object that it comes from."""
        if NodeMarker.on and source is not None and source.type == "LIGHT":
            node.extras = {**(node.extras or {}), MARK: source.session_uid}


@contextmanager
def marking() -> Iterator[None]:
    """Within the block, the exporter marks lights."""
    NodeMarker.on = True
    try:
        yield
    finally:
        NodeMarker.on = False


def light_nodes(level: bytes) -> dict[int, int | None]:
    """Node index to the light's `session_uid`; None for lights that geometry nodes have made.

    Args:
        level: A GLB as Blender writes it.
    """
    length = int.from_bytes(level[12:16], "little")
    nodes = json.loads(level[20 : 20 + length]).get("nodes", [])
    return {
        index: node.get("extras", {}).get(MARK)
        for index, node in enumerate(nodes)
        if LIGHTS in node.get("extensions", {})
    }
