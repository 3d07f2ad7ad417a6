"""Features of how much geometry casts the light's shadows."""

from __future__ import annotations

from math import log2

from features.light_view import LightView


def casting_triangles(one: LightView) -> float:
    """How many triangles cast within the light's cone and range, by their boxes.

    Unit: log2(1 + count). Range: 0 to 31. Source: thesis, section 8.1 (polygon count); it is what a map pass
    draws and what caps are made of.
    """
    return log2(1 + int(one.casting.sum()))


def casting_meshes(one: LightView) -> float:
    """How many casting meshes, as drawn, the light may reach.

    Unit: log2(1 + count). Range: 0 to 31. Source: DESIGN of the corpus: many small or few large casters.
    """
    return log2(1 + one.casting_meshes)


def silhouette_edges(one: LightView) -> float:
    """How many edges need a side of a shadow volume.

    Unit: log2(1 + count). Range: 0 to 33. Source: Crow 1977; Kim, Kim and Turk 2008 for triangle sets that
    bound nothing. Sides are what a volume pass extrudes.
    """
    return log2(1 + len(one.silhouette))


def silhouette_length(one: LightView) -> float:
    """How long these edges are, all together, in diagonals of the scene.

    Unit: log2(1 + length / extent). Range: 0 to about 30. Source: as for `silhouette_edges`; sides fill the
    screen in proportion to their length.
    """
    return log2(1 + float(one.silhouette.sum()) / one.level.extent_m)


def closed_share(one: LightView) -> float:
    """Of all casting triangles, those in closed shells, whose volumes need half the pieces.

    Unit: share. Range: 0 to 1. Source: Crow 1977; docs/techniques.md, shadow volumes, `mixed`.
    """
    return one.level.closed_share
