"""Which lights and cameras a stage has, numbered, and the prim that carries what is written about a light.

`Light.node` is the number of a light among all lights of the composed stage, from 0 in depth-first order,
those in native instances included wherever they are placed. Invisible ones and kinds that are not read count.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from scenes.errors import LevelError
from scenes.level import NoteBook
from scenes.scene import Array
from scenes.usd.transforms import product
from scenes.usd.values import Prim, path_of
from scenes.usd.walk import Edge, Forest, Item, Kind

# Each is an object in memory; instances multiply them.
MOST_LIGHTS = 100_000


@dataclass(frozen=True)
class Lamp:
    """One light or camera of the stage, in its place.

    Attributes:
        prim: Its prim, in a prototype where instances share it.
        matrix: (4, 4) float64, stage from its own space.
        visible: Whether neither it nor one above it is invisible.
        owner: Path of the prim that carries its annotation: the light itself, or the outermost instance,
            since a layer cannot speak of what is inside one.
        inside: Path from the owner, empty where that is the light itself.
    """

    prim: Prim
    matrix: Array
    visible: bool
    owner: str
    inside: str

    @property
    def name(self) -> str:
        """What to call it: its path from the outermost instance on, else its own name."""
        return self.owner.rpartition("/")[2] + self.inside


@dataclass(frozen=True)
class _Place:
    tree: str
    matrix: Array
    visible: bool
    owner: str
    inside: str


def lamps(forest: Forest, kind: Kind) -> Iterator[Lamp]:
    """All lights or all cameras of the stage, in the order of their numbers.

    Raises:
        LevelError: There are more than any level has.
    """
    holding = _trees_with(forest, kind)
    count = 0
    stack: list[tuple[_Place, Iterator[Item | Edge]]] = []
    if "/" in holding:
        stack.append(_entered(forest, _Place("/", np.eye(4), visible=True, owner="", inside="")))
    while stack:
        place, entries = stack[-1]
        entry = next(entries, None)
        if entry is None:
            stack.pop()
        elif isinstance(entry, Edge):
            if entry.native and entry.tree in holding:
                stack.append(_entered(forest, _inner(forest, place, entry)))
        elif entry.kind is kind:
            count += 1
            if count > MOST_LIGHTS:
                raise LevelError(
                    f"This level has more than {MOST_LIGHTS:,} lights or cameras.",
                    where=path_of(entry.prim),
                    remedy="Split the level, or let fewer instances share them.",
                )
            yield _lamp(forest, place, entry)


def note_unread_lamps(forest: Forest, notes: NoteBook) -> None:
    """Notes the point instancers whose prototypes hold lights: nothing could be written about one of them."""
    holding = _trees_with(forest, Kind.LIGHT)
    for tree in forest.trees.values():
        for entry in tree.entries:
            if isinstance(entry, Edge) and not entry.native and entry.tree in holding:
                notes.warning(
                    path_of(entry.prim),
                    "The lights in its prototypes are ignored: they have no prims of their own.",
                )


def _trees_with(forest: Forest, kind: Kind) -> set[str]:
    found: set[str] = set()
    for key, tree in reversed(forest.trees.items()):
        for entry in tree.entries:
            if (isinstance(entry, Item) and entry.kind is kind) or (
                isinstance(entry, Edge) and entry.tree in found
            ):
                found.add(key)
                break
    return found


def _entered(forest: Forest, place: _Place) -> tuple[_Place, Iterator[Item | Edge]]:
    return place, iter(forest.trees[place.tree].entries)


def _inner(forest: Forest, place: _Place, edge: Edge) -> _Place:
    matrix, visible = product(place.matrix, edge.matrices[0]), place.visible and edge.visible
    if not place.owner:
        return _Place(edge.tree, matrix, visible, str(edge.prim.GetPath()), "")
    return _Place(edge.tree, matrix, visible, place.owner, place.inside + _below(forest, place, edge.prim))


def _lamp(forest: Forest, place: _Place, item: Item) -> Lamp:
    matrix, visible = product(place.matrix, item.matrix), place.visible and item.visible
    if not place.owner:
        return Lamp(item.prim, matrix, visible, str(item.prim.GetPath()), "")
    inside = place.inside + _below(forest, place, item.prim)
    return Lamp(item.prim, matrix, visible, place.owner, inside)


def _below(forest: Forest, place: _Place, prim: Prim) -> str:
    return str(prim.GetPath())[len(str(forest.trees[place.tree].root.GetPath())) :]
