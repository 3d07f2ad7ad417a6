"""The thesis' scenes as level files."""

from __future__ import annotations

from pathlib import Path

from scenes.gltf.writer import write_glb
from scenes.thesis.registry import OPEN_SCENES, THESIS_SCENES


def write_thesis_scenes(folder: Path) -> list[Path]:
    """Writes each scene as `KEY.glb` into an existing folder, and says which files these are.

    The same scenes give the same bytes. Files of these names are overwritten.

    Raises:
        OutputError: A file cannot be written.
    """
    paths = []
    for key, scene in (THESIS_SCENES | OPEN_SCENES).items():
        path = folder / f"{key}.glb"
        write_glb(scene(), path)
        paths.append(path)
    return paths
