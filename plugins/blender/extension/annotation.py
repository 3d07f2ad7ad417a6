"""Recommendations as custom properties of lights, by the same names as in a level file."""

from __future__ import annotations

from typing import Any

import bpy

from .client.records import Recommendation

TECHNIQUE = "gnomon_technique"
SHADOW_MS = "gnomon_shadow_ms"
EDGE_ERROR_PX = "gnomon_edge_error_px"
CONFIDENCE = "gnomon_confidence"
SOURCE = "gnomon_source"
OF_MAPS = {"map_size": "gnomon_map_size", "filter": "gnomon_filter", "focus": "gnomon_focus"}
# `gnomon_mobility` is the user's own and no part of it.
KEYS = (TECHNIQUE, *OF_MAPS.values(), SHADOW_MS, EDGE_ERROR_PX, CONFIDENCE, SOURCE)


def properties(found: Recommendation) -> dict[str, Any]:
    """The custom properties that say the same as a recommendation."""
    return {
        TECHNIQUE: found.technique,
        **{key: found.settings[name] for name, key in OF_MAPS.items() if name in found.settings},
        SHADOW_MS: _short(found.shadow_ms),
        EDGE_ERROR_PX: _short(found.edge_error_px),
        CONFIDENCE: _short(found.confidence),
        SOURCE: found.source,
    }


def annotate(light: bpy.types.Object, values: dict[str, Any]) -> None:
    """Gives a light these properties, and takes away what an earlier answer left."""
    clear(light)
    for key, value in values.items():
        light[key] = value


def clear(light: bpy.types.Object) -> bool:
    """Takes the properties away; whether there were any."""
    found = [key for key in KEYS if key in light]
    for key in found:
        del light[key]
    return bool(found)


def standing(light: bpy.types.Object) -> dict[str, Any]:
    """The properties that a light has now."""
    return {key: light[key] for key in KEYS if key in light}


def _short(value: float) -> float:
    return float(f"{value:.4g}")
