"""The techniques. A new one is a module, its GLSL, and one line here."""

from __future__ import annotations

from renderers.chan_hybrid import ChanHybrid
from renderers.light_space_perspective_shadow_map import LightSpacePerspectiveShadowMap
from renderers.perspective_shadow_map import PerspectiveShadowMap
from renderers.shadow_map import ShadowMap
from renderers.shadow_volume import ShadowVolume
from renderers.technique import Technique
from scenes.errors import GnomonError

TECHNIQUES: tuple[Technique, ...] = (
    ShadowMap(),
    PerspectiveShadowMap(),
    LightSpacePerspectiveShadowMap(),
    ShadowVolume(),
    ChanHybrid(),
)

GROUND_TRUTH = "shadow_volume"
GROUND_TRUTH_SETTINGS = {"variant": "general"}
"""Nothing is taken for granted about meshes where the truth is at stake."""


class UnknownTechniqueError(GnomonError):
    """No technique has this name."""

    exit_code = 2


def technique(name: str) -> Technique:
    """The technique with this id (`shadow_map`) or label (`SM`), in any case.

    Raises:
        UnknownTechniqueError: There is none; the message lists those there are.
    """
    for known in TECHNIQUES:
        if name.lower() in (known.name.lower(), known.label.lower()):
            return known
    names = ", ".join(f"{known.label} ({known.name})" for known in TECHNIQUES)
    raise UnknownTechniqueError(f'There is no technique "{name}".', known=f"Known: {names}.")
