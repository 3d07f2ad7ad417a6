"""A USD stage, composed from all its layers, with its units.

Sources: OpenUSD, "UsdStage", "UsdGeomLinearUnits" and "UsdGeomSetStageUpAxis" of its API documentation.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Pcp, Sdf, Usd, UsdGeom, UsdUtils

from scenes.errors import LevelError
from scenes.level import NoteBook
from scenes.level_file import read_level_file
from scenes.scene import Array

Stage = Any
Layer = Any

# What the files of the format begin with: text, binary ("crate") and package.
COOKIES = (b"#usda", b"PXR-USDC", b"PK\x03\x04")
LONGEST_COOKIE = max(map(len, COOKIES))

# X, Y, Z of a level whose Z points up, in one whose Y does.
_Y_FROM_Z = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])

_CYCLES = (Pcp.ErrorType_ArcCycle, Pcp.ErrorType_SublayerCycle)
_BROKEN_LAYERS = (Pcp.ErrorType_InvalidSublayerPath,)
_SITE = re.compile(r",?@anon:0x[0-9a-f]+:[^@]*@")


def require_usd(start: bytes) -> None:
    """Checks that bytes begin as a USD file does.

    Raises:
        LevelError: They do not.
    """
    if not start.startswith(COOKIES):
        raise LevelError(
            "This is no USD file.",
            known="It begins neither as text (#usda), nor as binary (PXR-USDC), nor as a package (zip).",
            remedy="Export it again as .usda, .usdc or .usdz.",
        )


def open_file(path: Path) -> Stage:
    """The stage whose root layer is that file, with what it composed from other files.

    USD's own resolver finds those: beside the file, by absolute paths, and in its search path.

    Raises:
        LevelError: There is no such file, or it is no USD.
        pxr.Tf.ErrorException: USD cannot read it.
    """
    require_usd(read_level_file(path, LONGEST_COOKIE))
    # Relative names would make USD take the same file for two layers.
    stage = Usd.Stage.Open(os.path.abspath(path))  # noqa: PTH100 - `resolve` would follow links
    # Layers stay in memory while anybody holds them: one that has changed on disk since is read again.
    stage.Reload()
    return stage


def open_layer(layer: Layer, folder: Path) -> Stage:
    """The stage whose root is a layer in memory that stands in `folder`; the layer itself is changed.

    Raises:
        pxr.Tf.ErrorException: USD cannot compose it.
    """
    UsdUtils.ModifyAssetPaths(layer, lambda name: anchored(name, folder))
    return Usd.Stage.Open(layer)


def anchored(name: str, folder: Path) -> str:
    """A file that a layer in the folder names, as an absolute path where the name is a relative one."""
    return os.path.abspath(folder / name) if name else name  # noqa: PTH100 - `resolve` would follow links


def text_layer(source: bytes) -> Layer:
    """A layer in memory from the text of one.

    Raises:
        LevelError: It is no text of a layer.
        pxr.Tf.ErrorException: Likewise.
    """
    layer = Sdf.Layer.CreateAnonymous(".usda")
    if not layer.ImportFromString(source.decode("utf-8", "replace")):
        raise LevelError("This is no text of a USD layer.", remedy="Export it again.")
    return layer


def judge_composition(stage: Stage, notes: NoteBook) -> None:
    """Notes what could not be composed; what breaks the whole level is an error.

    Raises:
        LevelError: A sublayer is missing or broken, or layers or references run in a circle.
    """
    errors = sorted(stage.GetCompositionErrors(), key=str)
    for error in errors:
        words = _site_words(str(error))
        place = str(error.rootSite.path)
        where = "" if place == "/" else place
        if error.errorType in _CYCLES:
            raise LevelError(
                "This level contains itself: its layers or references run in a circle.",
                where=where,
                known=f"USD says: {words}",
                remedy="Take one of these references or sublayers out.",
            )
        if error.errorType in _BROKEN_LAYERS:
            raise LevelError(
                "A layer of this level cannot be read.",
                where=where,
                known=f"USD says: {words}",
                remedy="Put the layer where the level looks for it, or take it out of its subLayers.",
            )
        notes.warning(place, f"Left out, since it could not be composed. USD says: {words}")


def world_from_stage(stage: Stage, notes: NoteBook) -> Array:
    """(4, 4) float64: metres, Y up, from the stage's units and axes.

    Raises:
        LevelError: The stage's unit is none.
    """
    unit = float(UsdGeom.GetStageMetersPerUnit(stage))
    if not (math.isfinite(unit) and 1e-12 <= unit <= 1e12):
        raise LevelError(
            "metersPerUnit must be a length in metres.",
            where="stage",
            known=f"It is {unit}.",
            remedy="State 1 for metres, 0.01 for centimetres.",
        )
    if not UsdGeom.StageHasAuthoredMetersPerUnit(stage):
        notes.warning("stage", "It states no metersPerUnit: a unit is 0.01 m then, as USD says.")
    scale = np.diag([unit, unit, unit, 1.0])
    return scale @ _Y_FROM_Z if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.z else scale


def layers_outside(stage: Stage, folder: Path) -> Iterable[str]:
    """The files outside a folder of which the stage is composed, in the order of their names."""
    inside = os.path.realpath(folder) + os.sep
    names = (layer.realPath for layer in stage.GetUsedLayers() if layer.realPath)
    return sorted(name for name in names if not os.path.realpath(name).startswith(inside))


def _site_words(text: str) -> str:
    return " ".join(_SITE.sub("", text).split())
