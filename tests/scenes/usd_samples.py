"""Small USD levels as text."""

from __future__ import annotations

from pathlib import Path

from scenes.formats.registry import read_level
from scenes.level import Level

METRES = 'metersPerUnit = 1\nupAxis = "Y"'
TRIANGLE = """
point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
int[] faceVertexCounts = [3]
int[] faceVertexIndices = [0, 1, 2]
"""


def written(folder: Path, body: str, head: str = METRES, name: str = "level.usda") -> Path:
    """A stage with that body; braces may stand on one line with what is between them."""
    path = folder / name
    body = body.replace("{", "{\n").replace("}", "\n}\n").replace(";", "\n")
    path.write_text(f"#usda 1.0\n(\n{head}\n)\n{body}\n")
    return path


def read(folder: Path, body: str, head: str = METRES) -> Level:
    return read_level(written(folder, body, head))


def mesh(
    counts: list[int], indices: list[int], points: list[tuple[float, float, float]], more: str = ""
) -> str:
    return (
        f'def Mesh "M" {{ int[] faceVertexCounts = {counts}; int[] faceVertexIndices = {indices};'
        f" point3f[] points = {points}; {more} }}"
    )


def xform(inside: str, operation: str, kind: str = "double3", value: str = "(0, 0, 0)") -> str:
    return (
        f'def Xform "X" {{ {kind} xformOp:{operation} = {value};'
        f' uniform token[] xformOpOrder = ["xformOp:{operation}"]; {inside} }}'
    )


def instancer(
    indices: list[int], positions: list[tuple[float, float, float]], prototype: str, more: str = ""
) -> str:
    return (
        f'def PointInstancer "P" {{ int[] protoIndices = {indices}; point3f[] positions = {positions};'
        f" {more}; rel prototypes = </P/C>; {prototype} }}"
    )
