"""What a material means for shadows and for pictures: whether it casts, and its colour.

Source: glTF 2.0 specification (Khronos), section 3.9 "Materials".
"""

from __future__ import annotations

from dataclasses import dataclass

from scenes.entry import Entry
from scenes.gltf.asset import Asset
from scenes.level import NoteBook


@dataclass(frozen=True)
class Surface:
    """The part of a material that the scene keeps.

    Attributes:
        casts: Whether it casts shadows.
        base_color: Linear RGB.
    """

    casts: bool = True
    base_color: tuple[float, float, float] = (1.0, 1.0, 1.0)


def read_surface(asset: Asset, primitive: Entry, notes: NoteBook) -> Surface:
    """The surface of a primitive: opaque white where it names no material.

    Raises:
        LevelError: The material does not exist or states something that is no material.
    """
    if not primitive.has("material"):
        return Surface()
    _, material = asset.linked(primitive, "material", "materials")
    red, green, blue, _ = material.child("pbrMetallicRoughness").numbers(
        "baseColorFactor", 4, (1.0, 1.0, 1.0, 1.0)
    )
    mode = material.text("alphaMode") or "OPAQUE"
    if mode not in ("OPAQUE", "MASK", "BLEND"):
        raise material.wrong("alphaMode", '"OPAQUE", "MASK" or "BLEND"')
    if mode == "MASK":
        notes.warning(material.where, "alphaMode MASK: what it covers casts as if it had no holes.")
    if mode == "BLEND":
        notes.warning(material.where, "alphaMode BLEND: what it covers casts no shadow.")
    return Surface(mode != "BLEND", (red, green, blue))
