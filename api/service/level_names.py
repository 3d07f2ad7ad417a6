"""Names of level files as clients give them, made fit for a file system, a header and a message."""

from __future__ import annotations

import re
from urllib.parse import quote

GLB, GLTF = "model/gltf-binary", "model/gltf+json"
SUFFIXES = {GLB: ".glb", GLTF: ".gltf"}
FALLBACK = "level"
LONGEST_BYTES = 100
KEPT = frozenset(" ._-+()[]")


def safe_name(name: str, media_type: str) -> str:
    """The last part of a name, of letters, digits and harmless signs only, with the right suffix."""
    last = re.split(r"[/\\]", name)[-1]
    stem = last[: -len(suffix)] if (suffix := suffix_of(last)) else last
    plain = "".join(one if one.isalnum() or one in KEPT else "_" for one in stem).lstrip(".").strip()
    short = plain.encode()[:LONGEST_BYTES].decode(errors="ignore").strip()
    return (short or FALLBACK) + SUFFIXES[media_type]


def suffix_of(name: str) -> str:
    """`.glb` or `.gltf`, in whatever case the name has it; empty where it has neither."""
    found = re.search(r"\.(glb|gltf)$", name, re.IGNORECASE)
    return found[0] if found else ""


def media_type_of(name: str) -> str:
    """What a file of this name holds."""
    return GLB if suffix_of(name).lower() == ".glb" else GLTF


def annotated_name(name: str) -> str:
    """`tower.annotated.glb` of `tower.glb`."""
    stem, dot, suffix = name.rpartition(".")
    return f"{stem}.annotated{dot}{suffix}"


def attachment(name: str) -> str:
    """A `Content-Disposition` that saves under this name."""
    plain = name.encode("ascii", "replace").decode().replace("?", "_")
    return f"attachment; filename=\"{plain}\"; filename*=UTF-8''{quote(name)}"
