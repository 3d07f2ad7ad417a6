"""The node graph of a glTF file: which scene, which nodes, and where each stands in the world.

Source: glTF 2.0 specification (Khronos), section 3.5 "Scenes": nodes form disjoint strict trees.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from scenes.entry import Entry
from scenes.errors import LevelError
from scenes.gltf.asset import Asset
from scenes.gltf.transforms import composed, local_matrix
from scenes.level import NoteBook
from scenes.magnitudes import MOST_NODES
from scenes.scene import Array

SHOWN_OF_A_CYCLE = 8


@dataclass(frozen=True)
class PlacedNode:
    """A node with its place in the world.

    Attributes:
        index: Its index in the file.
        entry: Its JSON.
        world: (4, 4) float64, world from local, column vectors, metres.
    """

    index: int
    entry: Entry
    world: Array


@dataclass(frozen=True)
class ChosenScene:
    """One scene of the file: the author's name for it, and its root nodes."""

    name: str
    roots: tuple[int, ...]


def walk(asset: Asset, scene: ChosenScene) -> Iterator[PlacedNode]:
    """The nodes of a scene, parents before children, in the order of the file's lists.

    Raises:
        LevelError: A node or its transform is malformed, or its world matrix is not finite.
    """
    # A stack, not recursion: real hierarchies are shallow, hostile ones 10,000 levels deep.
    stack: list[tuple[int, Array | None]] = [(root, None) for root in reversed(scene.roots)]
    while stack:
        index, parent = stack.pop()
        entry = asset.entry("nodes", index, "scene")
        local = local_matrix(entry)
        world = local if parent is None else composed(parent, local, entry.where)
        yield PlacedNode(index, entry, world)
        stack.extend((child, world) for child in reversed(entry.integers("children")))


def parents(asset: Asset) -> list[int | None]:
    """The parent of every node, None for roots.

    Raises:
        LevelError: There are too many, one has two parents or is its own ancestor, or a child does not exist.
    """
    if asset.count("nodes") > MOST_NODES:
        raise LevelError(
            f"This level has {asset.count('nodes'):,} nodes.",
            known=f"At most {MOST_NODES:,} are read.",
            remedy="Join meshes that do not move, or let one node draw a mesh many times: "
            "EXT_mesh_gpu_instancing.",
        )
    found: list[int | None] = [None] * asset.count("nodes")
    for index in range(len(found)):
        node = asset.entry("nodes", index, "nodes")
        for child in node.integers("children"):
            entry = asset.entry("nodes", child, node.where)
            if found[child] is not None:
                raise LevelError(
                    "This node has two parents.",
                    where=entry.where,
                    known=f"It is a child of node {found[child]} and of node {index}.",
                    remedy="A node may be listed as a child once: duplicate it, or share its mesh.",
                )
            found[child] = index
    _refuse_cycles(asset, found)
    return found


def _refuse_cycles(asset: Asset, parent: list[int | None]) -> None:
    # Every node has at most one parent, so climbing from a node ends at a root or runs in a circle.
    safe = np.zeros(len(parent), bool)
    for start in range(len(parent)):
        trail: dict[int, None] = {}
        node: int | None = start
        while node is not None and not safe[node]:
            if node in trail:
                raise _cycle(asset, list(trail)[list(trail).index(node) :])
            trail[node] = None
            node = parent[node]
        safe[list(trail)] = True


def _cycle(asset: Asset, upwards: list[int]) -> LevelError:
    chain = [*reversed(upwards), upwards[-1]]
    shown = " > ".join(map(str, chain[:SHOWN_OF_A_CYCLE]))
    return LevelError(
        "This node is its own ancestor.",
        where=asset.entry("nodes", chain[0], "nodes").where,
        known=f"Its descent is {shown}{' > ...' if len(chain) > SHOWN_OF_A_CYCLE else ''}.",
        remedy="Remove one of these nodes from its parent's children.",
    )


def choose_scene(asset: Asset, wanted: str | None, notes: NoteBook) -> ChosenScene:
    """The scene of that name or index; else the file's default, else its first, else all root nodes.

    Raises:
        LevelError: There is no such scene, or its list of nodes is malformed.
    """
    parent = parents(asset)
    count = asset.count("scenes")
    if wanted is not None:
        return _scene(asset, _index_of(asset, wanted), parent)
    if asset.root.has("scene"):
        return _scene(asset, asset.linked(asset.root, "scene", "scenes")[0], parent)
    if count:
        notes.info("scenes", f"The file names no default scene: the first of {count} is read.")
        return _scene(asset, 0, parent)
    notes.info("scenes", "The file has no scene: all its nodes are read.")
    return ChosenScene("", tuple(index for index, above in enumerate(parent) if above is None))


def _scene(asset: Asset, index: int, parent: list[int | None]) -> ChosenScene:
    scene = asset.entry("scenes", index, "JSON root")
    roots = scene.integers("nodes")
    seen: set[int] = set()
    for root in roots:
        node = asset.entry("nodes", root, scene.where)
        if parent[root] is not None:
            raise LevelError(
                f"{node.where} is no root.",
                where=scene.where,
                known=f"It is a child of node {parent[root]}.",
                remedy="A scene may list root nodes only.",
            )
        if root in seen:
            raise LevelError(f"{node.where} is listed twice.", where=scene.where)
        seen.add(root)
    return ChosenScene(scene.text("name"), tuple(roots))


def _index_of(asset: Asset, wanted: str) -> int:
    names = [asset.entry("scenes", index, "scenes").text("name") for index in range(asset.count("scenes"))]
    if wanted in names:
        return names.index(wanted)
    if wanted in map(str, range(len(names))):
        return int(wanted)
    known = ", ".join(f'{index} "{name}"' if name else str(index) for index, name in enumerate(names))
    raise LevelError(
        f'There is no scene "{wanted}".',
        where="scenes",
        known=f"The file has: {known}." if known else "The file has no scenes.",
        remedy="Name one of these with --scene." if known else "Leave --scene out.",
    )
