"""The debug views: what each shows, which passes have it, and what draws it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from renderers.debug_map_views import light_view, map_view, texels_view
from renderers.debug_picture import DebugPicture
from renderers.debug_volume_views import counter_view, edges_view, silhouettes_view, volumes_view
from renderers.frame import Frame
from renderers.internals import Internals


@dataclass(frozen=True)
class DebugView:
    """A way to look at a pass that has just rendered.

    Attributes:
        name: What users call it.
        title: What its picture is called.
        has: Whether a pass has what it shows.
        draw: Draws it into the frame in which the pass has rendered, which must be shaded.
    """

    name: str
    title: str
    has: Callable[[Internals], bool]
    draw: Callable[[Frame, Internals], DebugPicture]


def _map(internals: Internals) -> bool:
    return internals.map is not None


def _volumes(internals: Internals) -> bool:
    return internals.volumes is not None


def _silhouette_pixels(internals: Internals) -> bool:
    return internals.silhouette_pixels is not None


def _always(internals: Internals) -> bool:
    del internals
    return True


DEBUG_VIEWS: tuple[DebugView, ...] = (
    DebugView("map", "Shadow map", _map, map_view),
    DebugView("light", "View from the light", _always, light_view),
    DebugView("texels", "Texels on the screen", _map, texels_view),
    DebugView("counter", "Volume counter", _volumes, counter_view),
    DebugView("edges", "Silhouette edges", _volumes, edges_view),
    DebugView("volumes", "Shadow volumes", _volumes, volumes_view),
    DebugView("silhouettes", "Silhouette pixels", _silhouette_pixels, silhouettes_view),
)
