"""glTF 2.0, as .gltf with its buffers and as .glb."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from scenes.errors import LevelError
from scenes.gltf import annotation
from scenes.gltf import companions as named_files
from scenes.gltf.amounts import refuse_too_much
from scenes.gltf.asset import Asset
from scenes.gltf.cameras import read_camera
from scenes.gltf.container import open_container, parse_json
from scenes.gltf.extensions import check_extensions
from scenes.gltf.geometry import GeometryReader
from scenes.gltf.lights import read_light
from scenes.gltf.nodes import choose_scene, walk
from scenes.gltf.placement import MeshPlacer
from scenes.level import Level, NoteBook
from scenes.level_file import read_level_file
from scenes.light_annotation import Cleared, LightAnnotation
from scenes.scene import Camera, Light, Mesh, Scene

NAME = "glTF 2.0"
SUFFIXES = (".gltf", ".glb")
MEND = "Mend it in the editor that made the level, and export it again."


def read(path: Path, scene_name: str | None = None) -> Level:
    """The scene of a glTF file, in world space: one mesh per node and primitive, one light per node.

    A node that draws many instances gives meshes with as many placements.

    Args:
        path: A .gltf or .glb file.
        scene_name: Name or index of one of its scenes; the file's default scene where None, else the first.

    Raises:
        LevelError: The file cannot be read, is broken, or needs what this version does not read yet.
    """
    source = read_level_file(path)
    try:
        return _read(source, path, scene_name)
    except LevelError as error:
        error.where = f"{path}, {error.where}" if error.where else str(path)
        error.remedy = error.remedy or MEND
        raise


def annotate(source: bytes, annotations: Mapping[int, LightAnnotation]) -> bytes:
    """The file with these annotations, by node index, in place of any earlier ones of ours.

    Raises:
        LevelError: The file is not valid glTF JSON or GLB, or has no such node.
    """
    return annotation.annotate(source, annotations)


def read_annotations(source: bytes) -> dict[int, LightAnnotation]:
    """What our annotations in the file say, by node index: given to `annotate`, the same once more.

    Raises:
        LevelError: The file is not valid glTF JSON or GLB.
    """
    return annotation.read_annotations(source)


def clear(source: bytes) -> Cleared:
    """The file without our annotations.

    Raises:
        LevelError: The file is not valid glTF JSON or GLB.
    """
    return annotation.clear(source)


def companions(source: bytes, path: Path) -> tuple[Path, ...]:
    """The existing files that a .gltf names, relative to its folder; none for a GLB.

    Raises:
        LevelError: The file is not valid glTF JSON or GLB.
    """
    return named_files.companions(source, path)


def _read(source: bytes, path: Path, scene_name: str | None) -> Level:
    container = open_container(source, binary_expected=path.suffix.lower() == ".glb")
    asset = Asset(parse_json(container.json_text), container.binary, path.parent)
    notes = NoteBook()
    if container.trailing_bytes:
        notes.info("GLB header", f"{container.trailing_bytes} bytes after the stated length are ignored.")
    check_extensions(asset, notes)
    scene = _scene(asset, path, scene_name, notes)
    return Level(path, NAME, scene, tuple(notes.notes))


def _scene(asset: Asset, path: Path, scene_name: str | None, notes: NoteBook) -> Scene:
    chosen = choose_scene(asset, scene_name, notes)
    nodes = list(walk(asset, chosen))
    refuse_too_much(asset, nodes)
    geometry = GeometryReader(asset, notes)
    placer = MeshPlacer(asset, geometry, {node.index: node.world for node in nodes}, notes)
    meshes: list[Mesh] = []
    lights: list[Light] = []
    cameras: list[Camera] = []
    for node in nodes:
        meshes += placer.meshes(node)
        light, camera = read_light(asset, node, notes), read_camera(asset, node, notes)
        lights += [light] if light is not None else []
        cameras += [camera] if camera is not None else []
    scene = Scene(chosen.name or path.stem, tuple(meshes), tuple(lights), tuple(cameras))
    _judge(asset, scene, geometry, notes)
    return scene


def _judge(asset: Asset, scene: Scene, geometry: GeometryReader, notes: NoteBook) -> None:
    if geometry.lost and not scene.triangle_count:
        raise LevelError(
            "All geometry of this level is stored in a way that this version does not read yet.",
            where="meshes",
            known=f"It uses {', '.join(geometry.lost)}.",
            remedy="Export it plainly: no meshopt compression, positions in every primitive.",
        )
    if not scene.triangle_count:
        notes.warning("scene", "This level has no triangles: nothing casts a shadow.")
    if not scene.lights:
        notes.lightless("scene", "This level has no lights that cast shadows (KHR_lights_punctual).")
    if asset.count("animations"):
        notes.info("animations", "Animations are not played: everything stands as the nodes say.")
