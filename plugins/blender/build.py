"""Builds the extension that Blender installs: the same sources give the same bytes.

    python plugins/blender/build.py [FOLDER]

writes FOLDER/gnomon-VERSION.zip (default: dist) and prints its path.
"""

from __future__ import annotations

import sys
import tomllib
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
EXTENSION, CLIENT = HERE / "extension", ROOT / "api/client"
LICENSE = ROOT / "LICENSE"
EPOCH = (1980, 1, 1, 0, 0, 0)
FILE_MODE = 0o100644 << 16


def contents() -> dict[str, bytes]:
    """Name in the zip to content: the extension, with the client of the service as its package `client`."""
    sources = {path.name: path for path in EXTENSION.iterdir() if path.suffix in (".py", ".toml")}
    sources |= {f"client/{path.name}": path for path in CLIENT.glob("*.py")}
    sources["LICENSE"] = LICENSE
    # Line ends as in the repository, wherever it was checked out.
    return {name: sources[name].read_bytes().replace(b"\r\n", b"\n") for name in sorted(sources)}


def build(folder: Path) -> Path:
    """Writes the extension into a folder."""
    manifest = tomllib.loads((EXTENSION / "blender_manifest.toml").read_text())
    path = folder / f"{manifest['id']}-{manifest['version']}.zip"
    folder.mkdir(parents=True, exist_ok=True)
    # Stored, not deflated: what zlib makes of it differs from version to version.
    with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED) as archive:
        for name, content in contents().items():
            entry = zipfile.ZipInfo(name, EPOCH)
            entry.create_system, entry.external_attr = 3, FILE_MODE
            archive.writestr(entry, content)
    return path


if __name__ == "__main__":
    print(build(Path(sys.argv[1] if len(sys.argv) > 1 else "dist")))  # noqa: T201  what a script says
