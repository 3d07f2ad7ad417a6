"""The scene as a level that the service reads."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy

from .light_nodes import light_nodes, marking

LONGEST_NAME = 100
OPTIONS = {
    "export_format": "GLB",
    "use_active_scene": True,
    "use_renderable": True,
    "export_lights": True,
    "export_cameras": True,
    "export_apply": True,
    "export_yup": True,
    # `gnomon_mobility` is the user's word on a light, and read.
    "export_extras": True,
    "export_import_convert_lighting_mode": "SPEC",
    # Nothing of this changes a shadow's place.
    "export_image_format": "NONE",
    "export_texcoords": False,
    "export_normals": False,
    "export_attributes": False,
    "export_vertex_color": "NONE",
    "export_animations": False,
    "export_morph": False,
    "export_skins": False,
    "check_existing": False,
    "will_save_settings": False,
}


class ExportError(Exception):
    """The scene could not be exported; its text is a sentence."""


@dataclass(frozen=True)
class ExportedLevel:
    """A level, and which of its nodes are which lights.

    Attributes:
        data: A GLB.
        name: For display.
        lights: Node index to the light's `session_uid`; None for lights that geometry nodes have made.
    """

    data: bytes
    name: str
    lights: dict[int, int | None]


def exported_level() -> ExportedLevel:
    """The active scene as it would be rendered. Takes as long as Blender's own export, in the main thread.

    Raises:
        ExportError: Blender's exporter could not.
    """
    with TemporaryDirectory(prefix="gnomon-", dir=bpy.app.tempdir or None) as folder:
        path = Path(folder) / "level.glb"
        try:
            with marking():
                done = bpy.ops.export_scene.gltf(filepath=str(path), **OPTIONS)
            data = path.read_bytes() if done == {"FINISHED"} else b""
        except AttributeError:
            raise ExportError(
                "The add-on glTF 2.0 format, which comes with Blender, is switched off."
            ) from None
        except (RuntimeError, OSError) as error:
            lines = str(error).strip().splitlines() or ["no reason given"]
            raise ExportError(f"Blender could not export the scene: {lines[-1]}") from error
    if not data:
        raise ExportError("Blender could not export the scene as glTF.")
    name = Path(bpy.data.filepath).stem[:LONGEST_NAME] or "untitled"
    return ExportedLevel(data, f"{name}.glb", light_nodes(data))
