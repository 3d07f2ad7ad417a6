"""The implicit shapes of USD (cube, sphere, cylinder, cone, capsule, plane) as triangles.

Source: OpenUSD, "UsdGeomCube", "UsdGeomSphere" and so on: centred at the origin, along an axis, with sizes in
stage units. Round ones become closed polyhedra whose corners lie on the shape.
"""

from __future__ import annotations

import numpy as np
from pxr import UsdGeom

from scenes.level import NoteBook
from scenes.scene import Array
from scenes.solids import Shell, box, cards
from scenes.usd.geometry import Faces
from scenes.usd.values import Prim, number, path_of, value, wrong

# The sides of a polygon of 32 corners come within 0.5 % of the circle's radius: cos(pi / 32) = 0.995.
SEGMENTS = 32
# Whatever the last bits of a machine's sine, its multiples of 2^-20 are the same.
_GRID = 2.0**-20


def read_shape(prim: Prim, notes: NoteBook) -> Faces | None:
    """The triangles of an implicit shape; None where the prim is of another kind, which is noted.

    Raises:
        LevelError: One of its sizes is none.
    """
    shell = _shell(prim)
    if shell is None:
        notes.warning(path_of(prim), f"A {prim.GetTypeName()} is not read: it casts no shadow here.")
        return None
    count = len(shell.triangles)
    if count > 12:
        notes.info(path_of(prim), f"A {prim.GetTypeName()}: read as a polyhedron of {count} triangles.")
    positions, triangles = shell.positions.astype(np.float32), shell.triangles.astype(np.int32)
    if value(prim.GetAttribute("orientation")) == UsdGeom.Tokens.leftHanded:
        triangles = np.ascontiguousarray(triangles[:, ::-1])
    reach = float(np.abs(positions).max())
    for one in (positions, triangles):
        one.flags.writeable = False
    return Faces(positions, triangles, np.full(len(triangles), 3, np.int32), reach)


def _shell(prim: Prim) -> Shell | None:
    # Cylinder_1 and Capsule_1 may have two radii.
    kind, two_radii = str(prim.GetTypeName()).removesuffix("_1"), str(prim.GetTypeName()).endswith("_1")
    if kind == "Cube":
        half = _size(prim, "size") / 2
        return box((-half, -half, -half), (half, half, half))
    if kind == "Sphere":
        return _revolved(_arc(0, SEGMENTS // 2) * _size(prim, "radius"))
    if kind not in ("Cylinder", "Cone", "Capsule", "Plane"):
        return None
    axis = str(value(prim.GetAttribute("axis")))
    if kind == "Plane":
        sides = _size(prim, "width"), _size(prim, "length")
        return _along(_rectangle(*(sides if axis == "Z" else sides[::-1])), axis)
    half = _size(prim, "height") / 2
    top, bottom = (_size(prim, f"radius{end}" if two_radii else "radius") for end in ("Top", "Bottom"))
    if kind == "Capsule":
        quarter = SEGMENTS // 4
        caps = (_arc(0, quarter) * top + (0.0, half), _arc(quarter, 2 * quarter) * bottom - (0.0, half))
        profile = np.concatenate(caps)
    elif kind == "Cone":
        profile = np.array([(0.0, half), (bottom, -half), (0.0, -half)])
    else:
        profile = np.array([(0.0, half), (top, half), (bottom, -half), (0.0, -half)])
    return _along(_revolved(profile), axis)


def _size(prim: Prim, name: str) -> float:
    attribute = prim.GetAttribute(name)
    size = number(prim, attribute)
    if size <= 0.0:
        raise wrong(prim, attribute, "above 0", size)
    return size


def _arc(first: int, last: int) -> Array:
    """(n, 2) radius and height of the unit circle from its top, by segments."""
    angle = np.arange(first, last + 1) * (2 * np.pi / SEGMENTS)
    return np.round(np.stack([np.sin(angle), np.cos(angle)], axis=1) / _GRID) * _GRID


def _revolved(profile: Array) -> Shell:
    """The closed solid of a profile turned about Z.

    Args:
        profile: (n, 2) radius and height, from the top down; the first and last radius are 0.
    """
    sine, cosine = _arc(0, SEGMENTS - 1).T
    radius, height = profile[1:-1, 0, None], profile[1:-1, 1, None]
    rings = np.stack(
        [radius * cosine, radius * sine, np.broadcast_to(height, (len(height), SEGMENTS))], axis=2
    )
    poles = np.array([(0.0, 0.0, profile[0, 1]), (0.0, 0.0, profile[-1, 1])])
    positions = np.concatenate([rings.reshape(-1, 3), poles])
    here = np.arange(SEGMENTS)
    ahead = (here + 1) % SEGMENTS
    last = (len(height) - 1) * SEGMENTS
    lower = np.arange(1, len(height))[:, None] * SEGMENTS
    upper = lower - SEGMENTS
    sides = [
        np.stack([upper + here, lower + here, lower + ahead], axis=2).reshape(-1, 3),
        np.stack([upper + here, lower + ahead, upper + ahead], axis=2).reshape(-1, 3),
    ]
    top = np.stack([np.full(SEGMENTS, len(positions) - 2), here, ahead], axis=1)
    bottom = np.stack([np.full(SEGMENTS, len(positions) - 1), last + ahead, last + here], axis=1)
    return Shell(positions, np.concatenate([top, *sides, bottom]))


def _rectangle(x: float, y: float) -> Shell:
    """The rectangle in the XY plane that faces along Z."""
    return cards(np.array([[-x / 2, -y / 2, 0.0]]), np.array([[x, 0.0, 0.0]]), np.array([[0.0, y, 0.0]]))


def _along(shell: Shell, axis: str) -> Shell:
    """A shape about the Z axis, turned about the diagonal to another axis."""
    return Shell(np.roll(shell.positions, {"X": 1, "Y": 2}.get(axis, 0), axis=1), shell.triangles)
