"""Furnished room: the thesis' Room with some of its furniture, lit from inside."""

from __future__ import annotations

from scenes.corpus.parts_ground import ground
from scenes.corpus.stage import Plan, Stage
from scenes.scene import LightKind, Mesh
from scenes.thesis.room import room

SUMMARY = (
    "The thesis' Room: walls around turned furniture, books and a screen; detailed shadows and large ones."
)
INDOOR = True
TRIANGLES = (4_000, 1_000_000)
KINDS = (LightKind.SPOT, LightKind.POINT, LightKind.DIRECTIONAL)

_WALLS = 4
_ALWAYS = ("walls and ceiling", "window frames", "skirting", "dining table", "columns")


def build(plan: Plan) -> Stage:
    """The walls, the table, and pieces in random order while there are triangles for them."""
    pieces = room().meshes[1:]
    kept = [mesh for mesh in pieces if mesh.name in _ALWAYS]
    others = [mesh for mesh in pieces if mesh.name not in _ALWAYS]
    crowd = round(plan.by_crowding(6, len(others)))
    order = plan.draws("pieces").order(len(others))[:crowd].tolist()
    if plan.spec.grain < 2:
        order.sort(key=lambda index: others[index].triangle_count)
    left = 1.1 * plan.triangles - sum(mesh.triangle_count for mesh in kept)
    for index in order:
        if others[index].triangle_count <= left:
            kept.append(others[index])
            left -= others[index].triangle_count
    floor: Mesh = ground(12.5, 9.375, (0.42, 0.27, 0.15), plan.triangles / 10)
    vistas = (
        ((-5.25, 2.125, 4.0), (0.5, 0.75, -1.0)),
        ((-3.0, 2.5, 4.1), (0.5, 0.5, -1.5)),
    )
    low, high = (-5.75, 0.25, -4.25), (5.75, 3.25, 4.25)
    return Stage((floor, *kept), start=(-5.25, 3.25, 4.0), room=(low, high), vistas=vistas)
