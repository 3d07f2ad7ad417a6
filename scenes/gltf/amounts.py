"""How much a level draws, told from what its accessors state before any of it is read."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

from scenes.entry import Entry
from scenes.errors import LevelError
from scenes.gltf.asset import Asset
from scenes.gltf.geometry import LINES_AND_POINTS, TRIANGLES
from scenes.gltf.instancing import instance_count
from scenes.gltf.nodes import PlacedNode
from scenes.magnitudes import MOST_TRIANGLES, MOST_VERTICES


class Amount(NamedTuple):
    """What is drawn; a primitive without triangles counts as one, since it takes as much work."""

    triangles: int
    vertices: int


def refuse_too_much(asset: Asset, nodes: Iterable[PlacedNode]) -> None:
    """Checks what all nodes draw together: for each node and each instance its mesh counts once more.

    What is stored is never more than what is drawn, and instances are not expanded by reading them; but
    whoever renders the level expands them.

    Raises:
        LevelError: They draw more triangles or vertices than this program takes on.
    """
    uses: dict[int, int] = {}
    for node in nodes:
        mesh = node.entry.values.get("mesh")
        # A node with a scale of 0 on all axes is hidden.
        if isinstance(mesh, int) and 0 <= mesh < asset.count("meshes") and node.world[:3, :3].any():
            uses[mesh] = uses.get(mesh, 0) + instance_count(asset, node.entry)
    amounts = {mesh: _stated(asset, mesh) for mesh in uses}
    triangles = sum(amounts[mesh].triangles * count for mesh, count in uses.items())
    vertices = sum(amounts[mesh].vertices * count for mesh, count in uses.items())
    for drawn, limit, what in (
        (triangles, MOST_TRIANGLES, "triangles"),
        (vertices, MOST_VERTICES, "vertices"),
    ):
        if drawn > limit:
            worst = max(uses, key=lambda mesh: getattr(amounts[mesh], what) * uses[mesh])
            each = getattr(amounts[worst], what)
            stored = sum(getattr(amount, what) for amount in amounts.values())
            raise LevelError(
                f"This level draws {drawn:,} {what}; at most {limit:,} are read.",
                where=asset.entry("meshes", worst, "scene").where,
                known=f"This mesh alone has {each:,} {what}, and nodes and their instances draw it "
                f"{uses[worst]:,} times; the file stores {stored:,}.",
                remedy="Split the level, simplify its meshes, or draw them less often.",
            )


def _stated(asset: Asset, mesh: int) -> Amount:
    primitives = asset.entry("meshes", mesh, "scene").values.get("primitives")
    listed = primitives if isinstance(primitives, list) else []
    amounts = [_primitive(asset, values) for values in listed if isinstance(values, dict)]
    return Amount(sum(one.triangles for one in amounts), sum(one.vertices for one in amounts))


def _primitive(asset: Asset, values: dict[str, Any]) -> Amount:
    primitive = Entry(values, "primitive")
    try:
        mode, attributes = primitive.integer("mode", TRIANGLES), primitive.child("attributes")
        if mode in LINES_AND_POINTS or not attributes.has("POSITION"):
            return Amount(0, 0)
        _, positions = asset.linked(attributes, "POSITION", "accessors")
        order = asset.linked(primitive, "indices", "accessors")[1] if primitive.has("indices") else positions
        vertices, corners = positions.integer("count"), order.integer("count")
    except LevelError:
        # Its reader refuses it before it reads its data, and names the node that draws it.
        return Amount(0, 0)
    return Amount(max(corners // 3 if mode == TRIANGLES else corners - 2, 1), vertices)
