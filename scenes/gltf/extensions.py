"""Which glTF extensions the reader reads, which it may ignore, and which it names and does without."""

from __future__ import annotations

from scenes.errors import LevelError
from scenes.gltf.asset import LIGHTS, Asset
from scenes.level import NoteBook

INSTANCING = "EXT_mesh_gpu_instancing"
DRACO = "KHR_draco_mesh_compression"
MESHOPT = ("EXT_meshopt_compression", "KHR_meshopt_compression")

MANIFOLD = "EXT_mesh_manifold"

READ = (LIGHTS, "KHR_mesh_quantization", INSTANCING, DRACO, MANIFOLD)

# What a level needs that lists the extension, to follow "needs".
NOT_READ = dict.fromkeys(MESHOPT, "meshopt decompression")

# Looks, sounds and metadata: neither geometry, nor lights, nor cameras.
HARMLESS_PREFIXES = (
    "KHR_materials_",
    "KHR_texture_",
    "KHR_xmp",
    "KHR_audio",
    "EXT_texture_",
    "MSFT_texture_",
)

# Optional ones that change what is drawn or lit, and how they are read.
APPROXIMATED = {
    "KHR_node_visibility": "hidden nodes are read as visible",
    "EXT_lights_image_based": "image-based light casts no shadow here and is left out",
    "EXT_lights_ies": "light profiles are left out",
    "MSFT_lod": "levels of detail are read as the scene lists them",
}


def check_extensions(asset: Asset, notes: NoteBook) -> None:
    """Notes what the file uses and the reader ignores.

    Raises:
        LevelError: The file requires an extension that is not read yet and without which geometry is missing.
    """
    required = asset.root.texts("extensionsRequired")
    for name in required:
        if name in NOT_READ:
            raise LevelError(
                f"This level needs {NOT_READ[name]}, which this version does not read yet.",
                where="extensionsRequired",
                known=f"It requires the extension {name}.",
                remedy="Switch it off in the exporter's settings.",
            )
    for name in dict.fromkeys(required):
        if name.startswith(HARMLESS_PREFIXES):
            notes.info("extensionsRequired", f"{name} changes looks only and is ignored.")
        elif name not in READ and name not in APPROXIMATED:
            notes.warning("extensionsRequired", f"{name} is unknown here: what it changes is not seen.")
    for name in dict.fromkeys([*required, *asset.root.texts("extensionsUsed")]):
        if name in APPROXIMATED:
            notes.warning("extensionsUsed", f"{name} is not read: {APPROXIMATED[name]}.")
