"""Sparse accessors: elements that stand in place of those of a buffer view, or of zeros.

Source: glTF 2.0 specification (Khronos), section 3.6.2.3 "Sparse accessors".
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from scenes.entry import Entry
from scenes.errors import LevelError
from scenes.gltf.views import COMPONENTS, Shape, ViewReader

INDEX_COMPONENTS = (5121, 5123, 5125)


def substituted(
    elements: npt.NDArray[Any], accessor: Entry, shape: Shape, views: ViewReader
) -> npt.NDArray[Any]:
    """(length, width): `elements`, or a copy where they are the file's own, with those of `sparse` in place.

    Raises:
        LevelError: There are none or more than elements, their places do not rise strictly or lie beyond
            the last element, or they lie outside their buffer views.
    """
    sparse = accessor.child("sparse")
    count = sparse.integer("count")
    if not 1 <= count <= shape.length:
        raise sparse.wrong("count", f"from 1 to {shape.length}, the accessor's own")
    indices = sparse.child("indices")
    component = indices.integer("componentType")
    if component not in INDEX_COMPONENTS:
        raise indices.wrong("componentType", "one of 5121, 5123, 5125 (unsigned) for indices")
    places = views.elements(indices, Shape(COMPONENTS[component], 1, count))[:, 0].astype(np.int64)
    values = views.elements(sparse.child("values"), Shape(shape.component, shape.width, count))
    _require_rising(places, shape.length, indices)
    replaced = elements if elements.flags.owndata else elements.copy()
    replaced[places] = values
    return replaced


def _require_rising(places: npt.NDArray[np.int64], count: int, indices: Entry) -> None:
    falls = np.flatnonzero(np.diff(places) <= 0)
    if len(falls):
        first = int(falls[0])
        raise LevelError(
            f"Sparse index {first + 1} is not above the one before it.",
            where=indices.where,
            known=f"They are {places[first]} and {places[first + 1]}.",
            remedy="Sparse indices must rise strictly: export the level again.",
        )
    if places[-1] >= count:
        raise LevelError(
            f"Sparse index {len(places) - 1} stands for element {places[-1]}, which does not exist.",
            where=indices.where,
            known=f"The accessor has {count} elements, counted from 0.",
            remedy="The file is damaged: export it again.",
        )
