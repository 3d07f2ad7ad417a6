"""Techniques by what users call them, those that are still to come among them."""

from __future__ import annotations

from renderers.registry import UnknownTechniqueError, technique
from renderers.technique import Technique

PLANNED_TECHNIQUES = {
    "psm": "Perspective shadow maps (PSM)",
    "perspective_shadow_map": "Perspective shadow maps (PSM)",
    "chan": "Hybrid shadows (Chan)",
    "chan_hybrid": "Hybrid shadows (Chan)",
}


def chosen_technique(name: str) -> Technique:
    """The technique of that id or label.

    Raises:
        UnknownTechniqueError: There is none, or none yet.
    """
    try:
        return technique(name)
    except UnknownTechniqueError as error:
        planned = PLANNED_TECHNIQUES.get(name.lower())
        if planned is None:
            raise
        raise UnknownTechniqueError(f"{planned} are not in this version yet.", known=error.known) from None
