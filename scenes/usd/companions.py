"""The files of which a USD level is made, besides itself."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from pxr import UsdUtils

from scenes.usd.diagnostics import quiet
from scenes.usd.layer_mark import is_layer
from scenes.usd.stage import anchored, require_usd, text_layer


def companions(source: bytes, path: Path) -> tuple[Path, ...]:
    """The existing files that the level at `path` names, and those that they name, relative to its folder.

    Layers, textures and whatever else USD counts as a dependency; what is inside a package is not listed.

    Raises:
        LevelError: The level cannot be read.
    """
    with quiet():
        require_usd(source)
        folder = Path(os.path.abspath(path.parent))  # noqa: PTH100 - `resolve` would follow links
        itself = folder / path.name
        roots = _named(source, folder) if is_layer(source) else [itself]
        found = {name for root in roots for name in (root, *_dependencies(root))}
        # A layer that is not written yet may be asked about where the level below it lies.
        found -= set() if is_layer(source) else {itself}
        return tuple(sorted(Path(os.path.relpath(name, folder)) for name in found if name.is_file()))


def _named(source: bytes, folder: Path) -> list[Path]:
    layer = text_layer(source)
    names = [*layer.GetCompositionAssetDependencies(), *layer.GetExternalAssetDependencies()]
    return [Path(anchored(name, folder)) for name in names if name]


def _dependencies(root: Path) -> Iterator[Path]:
    layers, assets, _ = UsdUtils.ComputeAllDependencies(str(root))
    for name in (*(layer.realPath for layer in layers), *assets):
        # "level.usdz[wood.png]" is inside a package.
        if name and not name.endswith("]"):
            yield Path(os.path.abspath(name))  # noqa: PTH100 - `resolve` would follow links
