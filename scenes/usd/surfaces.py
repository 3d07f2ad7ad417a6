"""What material and colour of a USD mesh mean for shadows and for pictures.

Sources: "UsdPreviewSurface Specification" (Pixar) and OpenUSD, "UsdShadeMaterialBindingAPI".
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from pxr import UsdGeom, UsdShade

from scenes.errors import LevelError
from scenes.level import NoteBook
from scenes.scene import Triangles
from scenes.usd.geometry import Faces, Flags
from scenes.usd.values import MEND, Prim, array, path_of, value
from scenes.usd.walk import Item

Color = tuple[float, float, float]

PLAIN: Color = (0.8, 0.8, 0.8)


@dataclass(frozen=True)
class Surface:
    """Whether something casts shadows, and its colour in linear RGB."""

    casts: bool = True
    base_color: Color = PLAIN


_PLAIN = Surface()


class Covered(NamedTuple):
    """Triangles of one surface: (t, 3) int32, read-only."""

    triangles: Triangles
    surface: Surface


class SurfaceReader:
    """Reads materials, each once."""

    def __init__(self, notes: NoteBook) -> None:
        self._notes = notes
        self._materials: dict[str, Surface | None] = {}

    def parts(self, item: Item, faces: Faces) -> list[Covered]:
        """The triangles of a prim by surface: one part for each material that covers some of its faces.

        Raises:
            LevelError: A subset names a face that does not exist.
        """
        prim = item.prim
        own = (self._bound(prim) if item.bound else None) or _displayed(item)
        # Without children it has no subsets.
        return [Covered(faces.triangles, own)] if item.leaf else list(self._subsets(prim, faces, own))

    def _subsets(self, prim: Prim, faces: Faces, own: Surface) -> Iterator[Covered]:
        rest = np.ones(len(faces.triangles), bool)
        for subset in UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets():
            surface = self._bound(subset.GetPrim())
            if surface is None:
                continue
            inside = _covered(subset, faces) & rest
            rest &= ~inside
            if inside.any():
                yield Covered(_frozen(faces.triangles[inside]), surface)
        if rest.all():
            yield Covered(faces.triangles, own)
        elif rest.any():
            yield Covered(_frozen(faces.triangles[rest]), own)

    def _bound(self, prim: Prim) -> Surface | None:
        material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()
        if not material:
            return None
        path = str(material.GetPath())
        if path not in self._materials:
            self._materials[path] = self._material(material)
        return self._materials[path]

    def _material(self, material: UsdShade.Material) -> Surface | None:
        shader, *_ = material.ComputeSurfaceSource()
        where = path_of(material.GetPrim())
        if not shader or shader.GetIdAttr().Get() != "UsdPreviewSurface":
            self._notes.info(where, "No UsdPreviewSurface: read as opaque.")
            return None
        opacity, threshold = _input(shader, "opacity"), _input(shader, "opacityThreshold")
        casts = True
        cut = isinstance(threshold, int | float) and threshold > 0.0
        if cut and opacity != 1.0 and opacity is not None:
            self._notes.warning(
                where, "Opacity with a threshold: what it covers casts as if it had no holes."
            )
        elif opacity == _TEXTURED or (isinstance(opacity, int | float) and opacity < 1.0):
            self._notes.warning(where, "Not opaque: what it covers casts no shadow.")
            casts = False
        diffuse = _input(shader, "diffuseColor")
        return Surface(casts, PLAIN if diffuse is None or diffuse == _TEXTURED else _color(diffuse))


_TEXTURED = "textured"


def _input(shader: UsdShade.Shader, name: str) -> Any:
    """The value of an input, by way of node graphs' interfaces; `_TEXTURED` where a shader makes it."""
    found = shader.GetInput(name)
    if not found:
        return None
    for attribute in found.GetValueProducingAttributes():
        if UsdShade.Output.IsOutput(attribute):
            return _TEXTURED
        return value(attribute)
    return None


def _displayed(item: Item) -> Surface:
    names = ("primvars:displayOpacity", "primvars:displayColor")
    if item.authored.isdisjoint(names):
        return _PLAIN
    opacity = array(item.prim.GetAttribute(names[0]), np.float64)
    colors = array(item.prim.GetAttribute(names[1]), np.float64, (-1, 3))
    # One opacity is for all; where they vary, part of it casts.
    casts = not (len(opacity) == 1 and opacity[0] < 1.0)
    return Surface(casts, _color(colors.mean(axis=0)) if len(colors) else PLAIN)


def _color(values: Any) -> Color:
    """A colour of finite numbers; the plain one where they are none."""
    try:
        red, green, blue = (float(part) for part in values)
    except (TypeError, ValueError):
        return PLAIN
    return (red, green, blue) if np.isfinite((red, green, blue)).all() else PLAIN


def _covered(subset: UsdGeom.Subset, faces: Faces) -> Flags:
    named = array(subset.GetIndicesAttr(), np.int64)
    count = len(faces.counts)
    if len(named) and (named.min() < 0 or named.max() >= count):
        worst = int(named.min() if named.min() < 0 else named.max())
        raise LevelError(
            f"This subset names face {worst}, which does not exist.",
            where=path_of(subset.GetPrim()),
            known=f"The mesh has {count:,} faces, counted from 0.",
            remedy=MEND,
        )
    covered = np.zeros(count, bool)
    covered[named] = True
    return faces.marked(covered)


def _frozen(triangles: Triangles) -> Triangles:
    triangles.flags.writeable = False
    return triangles
