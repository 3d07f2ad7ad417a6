"""Features of how the light's shadows overlap and how much edge they show."""

from __future__ import annotations

from math import log2

import numpy as np

from features.light_view import LightView


def depth_complexity(one: LightView) -> float:
    """Mean number of casting surfaces along rays spread evenly over cone, sphere or cross-section.

    Unit: surfaces. Range: 0 to 32. Source: thesis, section 8.1 (shadow complexity): overlapping volumes.
    """
    return float(one.layers.mean())


def crowding(one: LightView) -> float:
    """95th percentile of the number of casting surfaces along the light's rays.

    Unit: surfaces. Range: 0 to 32. Source: as for `depth_complexity`; the worst places fill most.
    """
    return float(np.percentile(one.layers, 95))


def shadow_share(one: LightView) -> float:
    """Of what the view shows in reach and facing the light, what is in shadow; 0 where it shows nothing.

    Unit: share. Range: 0 to 1. Source: Chan and Durand 2004, section 5; corpus axis `shadow_share`.
    """
    found = one.receivers
    return float((found.asked & ~found.lit).sum()) / max(int(found.asked.sum()), 1)


def casters_before_shadow(one: LightView) -> float:
    """Mean number of casting surfaces between a shadowed place in view and the light; 0 without any.

    Unit: surfaces. Range: 0 to 32. Source: corpus axis `overlap`; volumes that are counted there.
    """
    return float(one.shadowed_layers.mean()) if len(one.shadowed_layers) else 0.0


def edge_density(one: LightView) -> float:
    """How many pairs of neighbours, 1/128 of the view's height apart, a shadow's edge parts.

    Unit: share of the pairs of which both are receivers; 0 without any. Range: 0 to 1. Source: Chan and
    Durand 2004, section 3: silhouette pixels lie along these edges.
    """
    both, crossed = one.crossings
    return float(crossed.sum()) / max(int(both.sum()), 1)


def receiver_pixels(one: LightView) -> float:
    """How many pixels of the view lie in reach and face the light.

    Unit: log2(1 + pixels). Range: 0 to 26. Source: what a comparison with a map is made for.
    """
    return log2(1 + one.asked_share * one.view.width * one.view.height)
