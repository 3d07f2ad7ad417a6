"""The thesis' techniques as candidates: the settings that do what the thesis did."""

from __future__ import annotations

from renderers.settings import Setting
from selector.candidate import Candidate
from selector.ordering_trials import Contender

TIMED_SIZE = 1024
"""Side of the maps in the thesis' timings."""


def sm(size: int = TIMED_SIZE) -> Contender:
    """The thesis' shadow map: it covers the whole cone and the whole scene's depth."""
    return _map("SM", "shadow_map", size, frusta="thesis")


def sm_fit(size: int = TIMED_SIZE) -> Contender:
    """A shadow map that fits what the camera sees, as every PSM does: what is left is the warp."""
    return _map("SM-fit", "shadow_map", size, focus="view")


def psm(size: int = TIMED_SIZE) -> Contender:
    """The thesis' perspective shadow map: it always warps, and moves back by a rule of its own."""
    return _map("PSM", "perspective_shadow_map", size, slide_back="thesis", fall_back="never")


def psm_unslid(size: int = TIMED_SIZE) -> Contender:
    """One whose virtual camera stays at the eye: the strongest warp. The thesis switched between both."""
    return _map("PSM-unslid", "perspective_shadow_map", size, slide_back=0, fall_back="never")


def psm_unclipped(size: int = TIMED_SIZE) -> Contender:
    """One that is not fitted to the receivers, the thesis' form before its cube clipping."""
    return _map(
        "PSM-unclipped",
        "perspective_shadow_map",
        size,
        slide_back="thesis",
        cube_clipping="off",
        fall_back="never",
    )


def chan(size: int = TIMED_SIZE) -> Contender:
    """Chan and Durand's hybrid."""
    candidate = Candidate("chan_hybrid", (("map_size", size),))
    return Contender(f"Chan {size}", candidate)


SV = Contender("SV", Candidate("shadow_volume"))
CROW = Contender("Crow", Candidate("shadow_volume", (("variant", "crow"), ("unchecked", True))))
"""The thesis' volumes, of lit faces alone, drawn where they are wrong as well."""


def _map(name: str, technique: str, size: int, **settings: Setting) -> Contender:
    chosen: dict[str, Setting] = {"map_size": size, "filter": "2x2", **settings}
    return Contender(f"{name} {size}", Candidate(technique, tuple(chosen.items())))
