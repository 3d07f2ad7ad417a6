"""What the textures of a brush say about it: whether it is there for light at all, and whether it casts.

Sources: qbsp of id Software (1996) for sky, liquids and clip; ericw-tools and TrenchBroom for the names of
tool textures. All of them give a brush as a whole one kind.
"""

from __future__ import annotations

from collections.abc import Collection
from enum import StrEnum


class BrushKind(StrEnum):
    """What a brush is for light."""

    SOLID = "solid"
    SKY = "sky"
    LIQUID = "liquid"
    TOOL = "tool"


# Linear RGB, for pictures only.
COLORS = {
    BrushKind.SOLID: (0.8, 0.8, 0.8),
    BrushKind.SKY: (0.3, 0.42, 0.6),
    BrushKind.LIQUID: (0.2, 0.4, 0.4),
}

# Read by compilers and the game, and never drawn.
TOOLS = frozenset(
    {"clip", "playerclip", "monsterclip", "trigger", "aaatrigger", "skip", "hint", "hintskip", "origin"}
    | {"areaportal", "waterskip", "lavaskip", "slimeskip"}
)
# Quake's liquids and portals, and Half-Life's liquids.
_LIQUID_SIGNS = ("*", "!")
CUT_OUT_SIGN = "{"


def short_name(texture: str) -> str:
    """The name without its folders, as `common/clip` has them since Quake 2."""
    return texture.rpartition("/")[2]


def brush_kind(textures: Collection[str]) -> BrushKind:
    """The kind of a brush by the textures of its faces, in lower case.

    One face of sky or liquid makes the brush one: authors who save work paint only the side that is seen.
    A brush is a tool only if all its faces say so: solid walls have `skip` on faces that nobody sees.
    """
    names = {short_name(texture) for texture in textures}
    if any(name.startswith("sky") for name in names):
        return BrushKind.SKY
    if any(name.startswith(_LIQUID_SIGNS) for name in names):
        return BrushKind.LIQUID
    return BrushKind.TOOL if names and names <= TOOLS else BrushKind.SOLID
