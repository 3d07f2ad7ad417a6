"""The prims of a stage as trees: the stage itself, and each prototype that instances share.

A tree is walked once, however often it is placed. Sources: OpenUSD, "Scenegraph Instancing" (native
instances) and "UsdGeomPointInstancer"; "UsdGeomImageable" for visibility and purpose, which are inherited.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import Enum, auto
from typing import Any

import numpy as np
from pxr import Usd, UsdGeom, UsdLux

from scenes.errors import LevelError
from scenes.level import NoteBook
from scenes.scene import Array
from scenes.usd.instancer import read_instancer
from scenes.usd.values import FIRST_TIME, Prim, matrix, path_of, value

# Prototypes of point instancers often hang below an `over`, which keeps them from being drawn in place.
_IN_A_PROTOTYPE = Usd.PrimIsActive & Usd.PrimIsLoaded & ~Usd.PrimIsAbstract
_IDENTITY = np.eye(4)
_NOT_DRAWN = ("guide", "proxy")


class Kind(Enum):
    """What a prim is to the reader."""

    GEOMETRY = auto()
    LIGHT = auto()
    CAMERA = auto()


@dataclass(frozen=True)
class Item:
    """A prim that is read.

    Attributes:
        kind: What it is.
        prim: The prim.
        matrix: (4, 4) float64, from its own space to that of its tree.
        visible: Whether neither it nor one above it in its tree is invisible.
    """

    kind: Kind
    prim: Prim
    matrix: Array
    visible: bool


@dataclass(frozen=True)
class Edge:
    """Placements of another tree in this one.

    Attributes:
        prim: The instance, or the point instancer.
        tree: The key of the other tree.
        matrices: (k, 4, 4) float64, from its space to that of this tree.
        native: Whether it is one native instance.
        visible: Whether neither its prim nor one above it in its tree is invisible.
        drawn: Whether it is visible and of no purpose that is left out.
    """

    prim: Prim
    tree: str
    matrices: Array
    native: bool
    visible: bool
    drawn: bool


@dataclass(frozen=True)
class Tree:
    """All that hangs below one prim, in depth-first order; its root's own transform is not applied."""

    root: Prim
    entries: tuple[Item | Edge, ...]


@dataclass
class Forest:
    """The stage's tree, which has the key "/", and those of its prototypes.

    Attributes:
        trees: Key to tree, a tree before those that it places.
        skipped: How many prims were left out, by what they are.
    """

    trees: dict[str, Tree] = field(default_factory=dict)
    skipped: dict[str, int] = field(default_factory=dict)


@dataclass(frozen=True)
class _Step:
    prim: Prim
    above: Array
    visible: bool
    purpose: str


def walk(stage: Any, notes: NoteBook) -> Forest:
    """All trees of a stage.

    Raises:
        LevelError: A transform is not finite, a point instancer is broken, or places itself.
    """
    found: dict[str, Tree] = {}
    skipped: dict[str, int] = {}
    waiting: list[tuple[str, Prim]] = [("/", stage.GetPseudoRoot())]
    while waiting:
        key, root = waiting.pop()
        if key in found:
            continue
        entries = tuple(_entries(key, root, notes, skipped))
        found[key] = Tree(root, entries)
        edges = [entry for entry in entries if isinstance(entry, Edge)]
        waiting += [(edge.tree, stage.GetPrimAtPath(edge.tree)) for edge in edges]
    return Forest({key: found[key] for key in _outer_first(found)}, skipped)


def product(above: Array, local: Array) -> Array:
    """(..., 4, 4) float64 products of affine matrices, elementwise: `@` may fuse or reorder them."""
    with np.errstate(over="ignore", invalid="ignore"):
        terms = [above[..., :, axis, None] * local[..., None, axis, :] for axis in range(4)]
        result: Array = ((terms[0] + terms[1]) + terms[2]) + terms[3]
    return result


def _entries(key: str, root: Prim, notes: NoteBook, skipped: dict[str, int]) -> Iterator[Item | Edge]:
    # A stack, not recursion: hostile hierarchies are 10,000 levels deep.
    stack = [_Step(root, _IDENTITY, visible=True, purpose="")]
    predicate = Usd.PrimDefaultPredicate if key == "/" or root.IsPrototype() else _IN_A_PROTOTYPE
    while stack:
        step = stack.pop()
        prim = step.prim
        world = step.above if prim == root else _placed(prim, step.above, notes)
        purpose = step.purpose or _authored_purpose(prim)
        visible = step.visible and _text(prim, "visibility") != "invisible"
        drawn = visible and purpose not in _NOT_DRAWN
        if prim.IsInstance():
            tree = str(prim.GetPrototype().GetPath())
            yield Edge(prim, tree, world[None], native=True, visible=visible, drawn=drawn)
            continue
        if prim.IsA(UsdGeom.PointInstancer):
            if drawn:
                for target, matrices in read_instancer(prim, notes):
                    placed = product(world, matrices)
                    yield Edge(prim, target, placed, native=False, visible=True, drawn=True)
            continue
        kind = _kind(prim)
        if kind is Kind.GEOMETRY and not drawn:
            reason = "invisible" if not visible else f"of purpose {purpose}"
            skipped[reason] = skipped.get(reason, 0) + 1
        elif kind is not None:
            yield Item(kind, prim, world, visible)
        children = prim.GetFilteredChildren(predicate)
        stack += [_Step(child, world, visible, purpose) for child in reversed(children)]


def _kind(prim: Prim) -> Kind | None:
    # An emissive mesh is a mesh; its light is told apart later.
    if prim.IsA(UsdGeom.Gprim):
        return Kind.GEOMETRY
    if prim.HasAPI(UsdLux.LightAPI):
        return Kind.LIGHT
    return Kind.CAMERA if prim.IsA(UsdGeom.Camera) else None


def _placed(prim: Prim, above: Array, notes: NoteBook) -> Array:
    form = UsdGeom.Xformable(prim)
    if not form:
        return above
    operations = form.GetOrderedXformOps()
    resets = form.GetResetXformStack()
    if not operations and not resets:
        return above
    if form.TransformMightBeTimeVarying():
        notes.info(path_of(prim), "It moves over time: it stands where its first time sample puts it.")
    local = matrix(form.GetLocalTransformation(FIRST_TIME))
    world = local if resets or above is _IDENTITY else product(above, local)
    if not np.isfinite(world).all():
        raise LevelError(
            "The transform of this prim is not finite.",
            where=path_of(prim),
            remedy="Check the xformOps of the prim and of those above it.",
        )
    return world


def _authored_purpose(prim: Prim) -> str:
    attribute = prim.GetAttribute("purpose")
    if not attribute or not attribute.HasAuthoredValue():
        return ""
    return str(value(attribute) or "")


def _text(prim: Prim, name: str) -> str:
    attribute = prim.GetAttribute(name)
    return str(value(attribute) or "")


def _outer_first(trees: dict[str, Tree]) -> list[str]:
    """The keys, each before those that its tree places (depth-first postorder, reversed)."""
    done: list[str] = []
    state: dict[str, bool] = {"/": False}
    stack = ["/"]
    while stack:
        key = stack[-1]
        inner = list(dict.fromkeys(edge.tree for edge in trees[key].entries if isinstance(edge, Edge)))
        fresh = [name for name in inner if name not in state]
        looped = [name for name in inner if state.get(name) is False and not fresh]
        if looped:
            raise LevelError(
                "This prototype places itself.",
                where=looped[0],
                remedy="Take it out of the prototypes of the instancer below it.",
            )
        if fresh:
            state[fresh[0]] = False
            stack.append(fresh[0])
            continue
        state[key] = True
        done.append(stack.pop())
    return done[::-1]
