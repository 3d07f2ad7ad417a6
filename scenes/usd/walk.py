"""The prims of a stage as trees: the stage itself, and each prototype that instances share.

A tree is walked once, however often it is placed. Sources: OpenUSD, "Scenegraph Instancing" (native
instances) and "UsdGeomPointInstancer"; "UsdGeomImageable" for visibility and purpose, which are inherited.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum, auto
from typing import Any, NamedTuple

from pxr import Usd, UsdGeom, UsdLux

from scenes.errors import LevelError
from scenes.level import NoteBook
from scenes.scene import Array
from scenes.usd.instancer import read_instancer
from scenes.usd.transforms import Transforms, product
from scenes.usd.values import Prim, value

# Prototypes of point instancers often hang below an `over`, which keeps them from being drawn in place.
_IN_A_PROTOTYPE = Usd.PrimIsActive & Usd.PrimIsLoaded & ~Usd.PrimIsAbstract
_NOT_DRAWN = ("guide", "proxy")


class Kind(Enum):
    """What a prim is to the reader."""

    GEOMETRY = auto()
    LIGHT = auto()
    CAMERA = auto()
    INSTANCER = auto()


_SCHEMAS = {
    Kind.GEOMETRY: UsdGeom.Gprim,
    Kind.INSTANCER: UsdGeom.PointInstancer,
    Kind.CAMERA: UsdGeom.Camera,
}


@dataclass(frozen=True)
class Item:
    """A prim that is read.

    Attributes:
        kind: What it is.
        prim: The prim.
        matrix: (4, 4) float64, from its own space to that of its tree.
        visible: Whether neither it nor one above it in its tree is invisible.
        authored: The names of its properties that a layer says something of. One look at them costs as much
            as asking twice whether one of them is there.
        bound: Whether a material is bound to it or to one above it in its tree.
        leaf: Whether it has no children.
    """

    kind: Kind
    prim: Prim
    matrix: Array
    visible: bool
    authored: frozenset[str] = frozenset()
    bound: bool = False
    leaf: bool = False


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
        moving: Whether any layer has time samples.
    """

    trees: dict[str, Tree] = field(default_factory=dict)
    skipped: dict[str, int] = field(default_factory=dict)
    moving: bool = False


class _Step(NamedTuple):
    prim: Prim
    above: int
    visible: bool
    purpose: str
    bound: bool


class _Found(NamedTuple):
    """An entry of a tree before the transforms of the tree are multiplied; `kind` is None for an edge."""

    prim: Prim
    transform: int
    visible: bool
    kind: Kind | None = None
    authored: frozenset[str] = frozenset()
    bound: bool = False
    leaf: bool = False
    tree: str = ""
    matrices: Array | None = None
    drawn: bool = True


def walk(stage: Any, notes: NoteBook) -> Forest:
    """All trees of a stage.

    Raises:
        LevelError: A transform is not finite, a point instancer is broken, or places itself.
    """
    found: dict[str, Tree] = {}
    skipped: dict[str, int] = {}
    waiting: list[tuple[str, Prim]] = [("/", stage.GetPseudoRoot())]
    moving = any(layer.ListAllTimeSamples() for layer in stage.GetUsedLayers())
    walker = _Walker(notes, skipped, moving=moving, shared=bool(stage.GetPrototypes()))
    while waiting:
        key, root = waiting.pop()
        if key in found:
            continue
        found[key] = Tree(root, walker.entries(key, root))
        edges = [entry for entry in found[key].entries if isinstance(entry, Edge)]
        waiting += [(edge.tree, stage.GetPrimAtPath(edge.tree)) for edge in edges]
    return Forest({key: found[key] for key in _outer_first(found)}, skipped, moving)


class _Walker:
    """Walks the trees of one stage."""

    def __init__(self, notes: NoteBook, skipped: dict[str, int], *, moving: bool, shared: bool) -> None:
        self._notes = notes
        self._skipped = skipped
        self._moving = moving
        self._shared = shared
        self._kinds: dict[str, Kind | None] = {}

    def entries(self, key: str, root: Prim) -> tuple[Item | Edge, ...]:
        """What hangs below the root of a tree.

        Raises:
            LevelError: A transform is not finite, or a point instancer is broken.
        """
        transforms, found = Transforms(self._notes, moving=self._moving), list[_Found]()
        # A stack, not recursion: hostile hierarchies are 10,000 levels deep.
        stack = [_Step(root, 0, visible=True, purpose="", bound=False)]
        below = False
        predicate = Usd.PrimDefaultPredicate if key == "/" or root.IsPrototype() else _IN_A_PROTOTYPE
        while stack:
            step = stack.pop()
            prim = step.prim
            authored = frozenset(prim.GetAuthoredPropertyNames())
            place = transforms.add(prim, step.above, authored) if below else 0
            below = True
            purpose = step.purpose or (_authored_purpose(prim) if "purpose" in authored else "")
            shown = "visibility" not in authored or _text(prim, "visibility") != "invisible"
            visible = step.visible and shown
            bound = step.bound or "material:binding" in " ".join(authored)
            kind = self._kind(prim)
            if kind is Kind.INSTANCER or (self._shared and prim.IsInstance()):
                found += self._edges(_Step(prim, place, visible, purpose, bound))
                continue
            children = prim.GetFilteredChildren(predicate)
            if kind is Kind.GEOMETRY and not (visible and purpose not in _NOT_DRAWN):
                reason = f"of purpose {purpose}" if visible else "invisible"
                self._skipped[reason] = self._skipped.get(reason, 0) + 1
            elif kind is not None:
                found.append(_Found(prim, place, visible, kind, authored, bound, not children))
            stack += [_Step(child, place, visible, purpose, bound) for child in reversed(children)]
        worlds = transforms.worlds()
        return tuple(_placed(one, worlds) for one in found)

    def _edges(self, step: _Step) -> list[_Found]:
        prim, drawn = step.prim, step.visible and step.purpose not in _NOT_DRAWN
        if prim.IsInstance():
            tree = str(prim.GetPrototype().GetPath())
            return [_Found(prim, step.above, step.visible, tree=tree, drawn=drawn)]
        if not drawn:
            return []
        return [
            _Found(prim, step.above, visible=True, tree=target, matrices=matrices)
            for target, matrices in read_instancer(prim, self._notes)
        ]

    def _kind(self, prim: Prim) -> Kind | None:
        name = prim.GetTypeName()
        if name not in self._kinds:
            schemas = (kind for kind, schema in _SCHEMAS.items() if prim.IsA(schema))
            self._kinds[name] = next(schemas, None)
        kind = self._kinds[name]
        # An emissive mesh is a mesh; its light is told apart later.
        own = kind is Kind.GEOMETRY or kind is Kind.INSTANCER
        return Kind.LIGHT if not own and prim.HasAPI(UsdLux.LightAPI) else kind


def _placed(found: _Found, worlds: Array) -> Item | Edge:
    prim, world = found.prim, worlds[found.transform]
    if found.kind is not None:
        return Item(found.kind, prim, world, found.visible, found.authored, found.bound, found.leaf)
    native = found.matrices is None
    matrices = world[None] if found.matrices is None else product(world, found.matrices)
    return Edge(prim, found.tree, matrices, native, found.visible, found.drawn)


def _authored_purpose(prim: Prim) -> str:
    attribute = prim.GetAttribute("purpose")
    # A layer may also say that others' opinions do not count.
    return str(value(attribute) or "") if attribute and attribute.HasAuthoredValue() else ""


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
