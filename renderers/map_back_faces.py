"""Maps of only those faces that are turned away from the light: lit faces need no bias then."""

from __future__ import annotations

import numpy as np

from renderers.volume_closure import UNDECIDED, Bodies, closure, times_around
from renderers.world import World
from scenes.scene import Array, Light, Scene, Triangles


def back_faces_fall_short(light: Light, scene: Scene) -> str | None:
    """Why the back faces alone may miss shadows of `light`, or None where they cannot.

    What stands between a point outside all bodies and a light outside them is left through a back face, if
    it is closed; a sheet has none, and of a room around the light only the walls' far sides would be back.
    """
    casting = [mesh for mesh in scene.meshes if mesh.casts]
    for mesh in casting:
        count = closure(mesh).open_edges * len(mesh.placements)
        if count:
            return (
                f'it needs closed meshes, but {count:,} edges of "{mesh.name}" lack a face '
                "on one side; map_faces=both takes any"
            )
    for mesh in casting:
        if (np.abs(times_around(light, mesh)) >= UNDECIDED).any():
            return f'it needs a light outside, but "{mesh.name}" encloses that; map_faces=both takes any'
    return _enclosing(scene)


def _enclosing(scene: Scene) -> str | None:
    """Why not, where one casting mesh may hold another: inside, only the front of what is around is seen."""
    boxes = [
        (mesh, mesh.world_positions().min(axis=(0, 1)), mesh.world_positions().max(axis=(0, 1)))
        for mesh in scene.meshes
        if len(mesh.positions)
    ]
    for mesh, low, high in boxes:
        inside = (other for other in boxes if (low < other[1]).all() and (other[2] < high).all())
        if mesh.casts and (held := next(inside, None)):
            return (
                f'it needs receivers outside, but "{mesh.name}" may hold "{held[0].name}"; '
                "map_faces=both takes any"
            )
    return None


def outward_corners(world: World) -> Triangles:
    """(t, 3) int32 casting faces, counter-clockwise seen from outside the closed mesh that each is of.

    Stored corners run the other way round in a mirrored placement, and in a mesh that is inside out.
    """
    triangles = world.triangles[: world.caster_count].copy()
    bodies = Bodies.of(world.scene)
    # Where every mesh is closed, as asked for, those left over look inwards.
    inside_out = bodies.of_faces((~bodies.closed).astype(np.int32))[world.clusters.order] > 0
    triangles[inside_out] = triangles[inside_out][:, ::-1]
    return triangles


def mirrors(face: Array) -> bool:
    """Whether a map's (4, 4) face shows counter-clockwise what runs clockwise as the light sees it.

    x, y and w of all maps vanish at the light, where z is positive: that leaves the sign to the determinant.
    """
    return bool(np.linalg.slogdet(face)[0] < 0)
