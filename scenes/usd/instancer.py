"""Point instancers: many placements of few prototypes.

Source: OpenUSD, "UsdGeomPointInstancer" of its API documentation.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt
from pxr import UsdGeom

from scenes.errors import LevelError
from scenes.level import NoteBook
from scenes.scene import Array
from scenes.usd.values import FIRST_TIME, Prim, array, path_of


def read_instancer(prim: Prim, notes: NoteBook) -> Iterator[tuple[str, Array]]:
    """Prototype path and its (k, 4, 4) placements, in the space of the instancer, for each that has any.

    The prototype's own transform is part of the placements, and what the instancer hides is left out.

    Raises:
        LevelError: Its arrays do not fit together, or a placement is not finite.
    """
    instancer = UsdGeom.PointInstancer(prim)
    order = array(instancer.GetProtoIndicesAttr(), np.int64)
    if not len(order):
        notes.info(path_of(prim), "A point instancer without instances.")
        return
    targets = [str(path) for path in instancer.GetPrototypesRel().GetForwardedTargets()]
    _check(prim, order, targets)
    if instancer.GetPositionsAttr().ValueMightBeTimeVarying():
        notes.info(path_of(prim), "It moves over time: it stands where its first time sample puts it.")
    shown = np.array(instancer.ComputeMaskAtTime(FIRST_TIME), dtype=bool)
    order = order[shown] if len(shown) else order
    matrices = _matrices(prim, instancer, len(order))
    for index in np.unique(order):
        target = targets[int(index)]
        if not prim.GetStage().GetPrimAtPath(target):
            notes.warning(path_of(prim), f"Its prototype {target} is not there: its instances are left out.")
            continue
        yield target, matrices[order == index]


def _check(prim: Prim, order: npt.NDArray[np.int64], targets: list[str]) -> None:
    if order.min() < 0 or order.max() >= len(targets):
        worst = int(order.min() if order.min() < 0 else order.max())
        raise LevelError(
            f"An instance is of prototype {worst}, which does not exist.",
            where=path_of(prim),
            known=f"The instancer has {len(targets)} prototypes, counted from 0.",
            remedy="Check protoIndices and prototypes.",
        )


def _matrices(prim: Prim, instancer: UsdGeom.PointInstancer, count: int) -> Array:
    found = instancer.ComputeInstanceTransformsAtTime(FIRST_TIME, FIRST_TIME)
    placements: Array = np.array(found, dtype=np.float64).reshape(-1, 4, 4).swapaxes(1, 2)
    if len(placements) != count:
        raise LevelError(
            "The arrays of this point instancer do not fit together.",
            where=path_of(prim),
            known=f"{count} instances are shown, and USD makes {len(placements)} placements of them.",
            remedy="Give positions, orientations and scales as many entries as protoIndices.",
        )
    if not np.isfinite(placements).all():
        raise LevelError(
            "A placement of this point instancer is not finite.",
            where=path_of(prim),
            remedy="Check its positions, orientations and scales.",
        )
    return placements
