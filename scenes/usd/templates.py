"""What a stage holds without drawing it: classes, and opinions about prims that nothing defines.

Source: OpenUSD, glossary: "Class", "Over", "Active / Inactive".
"""

from __future__ import annotations

from typing import Any

from pxr import Usd, UsdGeom, UsdLux

from scenes.level import NoteBook
from scenes.usd.values import Prim
from scenes.usd.walk import Forest

_WHY = {
    "class": "are below a class, which others may inherit and which is not drawn itself",
    "over": "are below an over, which defines nothing by itself",
    "inactive": "are switched off (active = false)",
    "unloaded": "have a payload that is not loaded",
}
# The four that `_reason` tells apart; asked at once, since there are thousands of prims.
_DRAWN = Usd.PrimIsActive & Usd.PrimIsLoaded & Usd.PrimIsDefined & ~Usd.PrimIsAbstract


def note_templates(stage: Any, forest: Forest, notes: NoteBook) -> None:
    """Notes how many meshes and lights are left out since USD does not draw them, and where the first is."""
    found: dict[str, list[str]] = {}
    # A point instancer places what is below these.
    placed = forest.trees.keys() - {"/"}
    prims = iter(Usd.PrimRange(stage.GetPseudoRoot(), Usd.PrimAllPrimsPredicate))
    for prim in prims:
        if placed and str(prim.GetPath()) in placed:
            prims.PruneChildren()
        elif not _DRAWN(prim) and (prim.IsA(UsdGeom.Gprim) or prim.HasAPI(UsdLux.LightAPI)):
            found.setdefault(_reason(prim), []).append(str(prim.GetPath()))
    for why, paths in found.items():
        count = "1 mesh or light" if len(paths) == 1 else f"{len(paths):,} meshes and lights"
        notes.info(
            paths[0], f"{count}, this one first, {_WHY[why] if len(paths) > 1 else _one(why)}: left out."
        )


def _one(why: str) -> str:
    return _WHY[why].replace("are ", "is ", 1).replace("have ", "has ", 1)


def _reason(prim: Prim) -> str:
    if not prim.IsActive():
        return "inactive"
    if not prim.IsLoaded():
        return "unloaded"
    return "class" if prim.IsAbstract() else "over"
