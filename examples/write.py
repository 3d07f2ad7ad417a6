"""Writes the example level from the code that makes it: `make examples`."""

from __future__ import annotations

from pathlib import Path

from scenes.gltf.writer import write_glb
from scenes.street import street

if __name__ == "__main__":
    write_glb(street(), Path(__file__).with_name("street.glb"))
