"""Geometry without lights, as OBJ, PLY and STL, and the JSON file that gives it lights and cameras.

`yard.obj` is read together with `yard.lights.json` beside it. An annotation is such a lights file too, so the
geometry is never changed.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from scenes.errors import LevelError
from scenes.level import Level, NoteBook
from scenes.level_file import read_level_file
from scenes.light_annotation import Cleared, LightAnnotation
from scenes.plain import annotation
from scenes.plain.geometry import named_files, read_geometry, require_geometry
from scenes.plain.lights_file import (
    GEOMETRY_SUFFIXES,
    NO_LIGHTS,
    LightsFile,
    geometry_of,
    is_lights_file,
    lights_path,
    read_lights_file,
    root_of,
)
from scenes.scene import Scene

NAME = "plain geometry"
LAYER_SUFFIX = ".json"
SUFFIXES = (*GEOMETRY_SUFFIXES, LAYER_SUFFIX)


def read(path: Path, scene_name: str | None = None) -> Level:
    """The geometry of an OBJ, PLY or STL file with the lights and cameras of its lights file.

    Args:
        path: The geometry, or its lights file.
        scene_name: There is one scene, of the file's name or 0.

    Raises:
        LevelError: A file cannot be read or is broken, or there is no such scene.
    """
    source = read_level_file(path)
    if scene_name not in (None, path.stem, "0"):
        raise LevelError(
            f'There is no scene "{scene_name}".',
            where=str(path),
            known=f'It holds one scene, "{path.stem}".',
            remedy="Leave --scene out.",
        )
    notes = NoteBook()
    if path.suffix.lower() == LAYER_SUFFIX:
        with _placed(path):
            lights = read_lights_file(source, notes)
            geometry = path.parent / geometry_of(root_of(source).values, path)
        source = read_level_file(geometry)
    else:
        lights, geometry = _lights_beside(path, notes), path
    with _placed(geometry):
        meshes = read_geometry(source, geometry, lights.unit_m, notes, z_up=lights.z_up)
    scene = Scene(path.stem, meshes, lights.lights, lights.cameras)
    if not scene.lights:
        name = lights_path(geometry).name
        notes.lightless(
            "lights", f"No lights of its own: write them into {name} beside it (docs/level-formats.md)."
        )
    return Level(path, NAME, scene, tuple(notes.notes))


def annotate(source: bytes, annotations: Mapping[int, LightAnnotation], path: Path) -> bytes:
    """A lights file with these annotations, by light, over the geometry at `path`.

    Args:
        source: The geometry, whose lights file beside it is taken, or a lights file.
        annotations: Number of the light to annotation.
        path: Where the source was read.

    Raises:
        LevelError: The file is broken, or has no such light.
    """
    lights = _lights(source, path)
    named = path.suffix.lower() == LAYER_SUFFIX and annotations
    geometry = geometry_of(root_of(source).values, path) if named else Path(path.name)
    return annotation.annotate(lights, annotations, geometry.as_posix())


def read_annotations(source: bytes, path: Path) -> dict[int, LightAnnotation]:
    """What our annotations in the lights file say, by light: given to `annotate`, the same once more.

    Raises:
        LevelError: The file is broken.
    """
    return annotation.read_annotations(_lights(source, path))


def clear(source: bytes, path: Path) -> Cleared:
    """The lights file without our annotations.

    Raises:
        LevelError: The file is broken.
    """
    return annotation.clear(_lights(source, path))


def companions(source: bytes, path: Path) -> tuple[Path, ...]:
    """The geometry that a lights file names with its material library; of geometry, that and its lights file.

    Raises:
        LevelError: The file is broken.
    """
    if is_layer(source):
        geometry = geometry_of(root_of(source).values, path)
        place = path.parent / geometry
        if not place.is_file():
            return ()
        libraries = (geometry.parent / name for name in named_files(read_level_file(place), place))
        return (geometry, *libraries)
    require_geometry(source, _geometry_suffix(path))
    beside = lights_path(path)
    return (*([Path(beside.name)] if beside.is_file() else []), *named_files(source, path))


def is_layer(source: bytes) -> bool:
    """Whether a file is a lights file, which takes annotations, and no geometry."""
    return is_lights_file(source)


def _lights_beside(path: Path, notes: NoteBook) -> LightsFile:
    beside = lights_path(path)
    if not _is_there(beside):
        return NO_LIGHTS
    source = read_level_file(beside)
    with _placed(beside):
        _require_same(source, path)
        return read_lights_file(source, notes)


def _lights(source: bytes, path: Path) -> bytes:
    """The lights file that the source is, or that lies beside it; one without lights where there is none."""
    if is_layer(source):
        return source
    require_geometry(source, _geometry_suffix(path))
    beside = lights_path(path)
    if not _is_there(beside):
        return json.dumps({"geometry": path.name, "lights": []}).encode()
    lights = read_level_file(beside)
    with _placed(beside):
        _require_same(lights, path)
    return lights


def _is_there(path: Path) -> bool:
    """Whether anything has this name: of a link to a file that is gone, reading it tells."""
    return os.path.lexists(path)


def _require_same(source: bytes, path: Path) -> None:
    named = root_of(source).values.get("geometry")
    if named is not None and named != path.name:
        raise LevelError(
            f"These lights are for {str(named)[:80]}, not for {path.name}.",
            remedy='Take "geometry" out of it, or give it another name.',
        )


def _geometry_suffix(path: Path) -> str:
    suffix = path.suffix.lower()
    if suffix == LAYER_SUFFIX:
        raise LevelError(
            "This is no lights file: it does not begin with a JSON object.", remedy="Check its content."
        )
    return suffix


@contextmanager
def _placed(path: Path) -> Iterator[None]:
    """Names the file in errors that come up within."""
    try:
        yield
    except LevelError as error:
        error.where = f"{path}, {error.where}" if error.where else str(path)
        raise
