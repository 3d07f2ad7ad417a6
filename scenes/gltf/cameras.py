"""Cameras of a glTF file, one for every node that carries one.

Source: glTF 2.0 specification (Khronos), section 3.10 "Cameras": it looks along -Z with +Y up.
"""

from __future__ import annotations

import math

from scenes.entry import Entry
from scenes.errors import LevelError
from scenes.gltf.asset import Asset
from scenes.gltf.nodes import PlacedNode
from scenes.level import NoteBook
from scenes.magnitudes import require_divisor, require_near
from scenes.scene import Camera
from scenes.vectors import unit, upright, vector


def read_camera(asset: Asset, node: PlacedNode, notes: NoteBook) -> Camera | None:
    """The perspective camera that a node carries, in world space; None without one.

    Raises:
        LevelError: The camera does not exist or is malformed or has numbers beyond float32, or the node's
            transform leaves it without a direction or moves it too far.
    """
    if not node.entry.has("camera"):
        return None
    _, definition = asset.linked(node.entry, "camera", "cameras")
    camera = Entry(definition.values, f"{definition.where} on {node.entry.where}")
    kind = camera.text("type")
    if kind == "orthographic":
        notes.warning(camera.where, "Orthographic cameras are not read yet: skipped.")
        return None
    if kind != "perspective":
        raise camera.wrong("type", '"perspective" or "orthographic"')
    lens = camera.child("perspective")
    yfov, near = lens.number("yfov"), lens.number("znear")
    if not 0.0 < yfov < math.pi:
        raise lens.wrong("yfov", "a full angle in (0, pi) radians")
    if near <= 0.0:
        raise lens.wrong("znear", "above 0 metres")
    require_divisor(lens, "yfov", yfov, "radians")
    require_divisor(lens, "znear", near, "metres")
    forward = unit(vector(-node.world[:3, 2]))
    up = upright(vector(node.world[:3, 1]), forward) if forward is not None else None
    if forward is None or up is None:
        raise LevelError(
            "The transform of this node leaves its camera without a direction.",
            where=camera.where,
            remedy="Give the node, and those above it, a scale other than 0.",
        )
    return Camera(
        name=node.entry.text("name") or camera.text("name") or f"camera {node.index}",
        position=require_near(vector(node.world[:3, 3]), "camera", camera.where),
        forward=forward,
        up=up,
        yfov_rad=yfov,
        near_m=near,
        node=node.index,
    )
