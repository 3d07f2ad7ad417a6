"""The orderings that the thesis found among its four techniques, each checked on the device at hand.

Source: J. Sindholt, A comparison of Shadow Algorithms, IMM-Thesis-2005-37 (DTU 2005), sections 7 and 8.1. Its
times are bars in a picture and cannot be recovered, nor would they say much twenty years later: what can be
asked of another device is whether the same technique wins.
"""

from __future__ import annotations

from collections.abc import Sequence

from scenes.errors import GnomonError
from selector.ordering_contenders import CROW, SV, chan, psm, sm
from selector.ordering_errors import (
    BRACES,
    EXACT,
    JAGGED_PX,
    MOVES,
    STEADY,
    TOWERS,
    TREE,
    flicker,
    flickering,
    open_geometry,
    texels_and_cones,
    thin_objects,
)
from selector.ordering_hybrid import growth, hybrid_beats_volumes, hybrid_loss, hybrid_volume_stage
from selector.ordering_records import Ordering
from selector.ordering_results import ABOUT_EQUAL, CLEARLY, MARGIN
from selector.ordering_timed import CHAN, PSM, SM, SM_FIT, TIMED, asks, trial
from selector.ordering_times import map_fastest, set_up_only, volumes_beat_psm
from selector.ordering_trials import Ask, Trial
from selector.ordering_warps import (
    BEHIND,
    CLOSER,
    FIT_ROCKS,
    FRONT,
    GOOD_PX,
    RIGHT,
    SM_ROCKS,
    UNCLIPPED,
    WARPS,
    warp_quality,
)

FASTER = f"Faster: a ratio of more than {MARGIN:g} in more than half of the rounds; anything less is a tie."
"""What the rules mean by faster."""


ORDERINGS: tuple[Ordering, ...] = (
    Ordering(
        "O1",
        "SM is the fastest in all five scenes.",
        "No other is faster than SM in any of them.",
        asks(SM, PSM, SV, CHAN),
        map_fastest,
    ),
    Ordering(
        "O2",
        "PSM is slower than SM in all five scenes, by its set-up alone: map and shading cost the same.",
        "SM is faster in each; PSM's visibility stage is no slower, and its map has no more than "
        f"{MARGIN:g} times the texels to clear and write.",
        asks(SM, SM_FIT, PSM),
        set_up_only,
    ),
    Ordering(
        "O3",
        "SV is faster than PSM on the street alone.",
        "Faster there, and in no other scene.",
        asks(PSM, SV),
        volumes_beat_psm,
    ),
    Ordering(
        "O4",
        "Chan is faster than SV in total on the box grid alone.",
        "Faster there, and in no other scene.",
        asks(SV, CHAN),
        hybrid_beats_volumes,
    ),
    Ordering(
        "O5",
        "Chan's volumes cost less than SV's on the box grid and the water tower, about as much elsewhere.",
        "Edges, computation mask and volumes together; faster on these two, elsewhere no slower and at most "
        f"{ABOUT_EQUAL:g} times as fast. Without times, volume fragments.",
        asks(SV, CHAN),
        hybrid_volume_stage,
    ),
    Ordering(
        "O6",
        "Where Chan loses against SV, it is by map and silhouette pixels.",
        "Wherever SV is faster, it is no longer so once these two stages are taken off Chan.",
        asks(SV, CHAN),
        hybrid_loss,
    ),
    Ordering(
        "O7",
        "With the resolution SV's cost grows, Chan's less, and that of the maps of SM and PSM not at all.",
        "By counters, from half the width and height to the whole: SV's volume fragments grow, Chan's by "
        f"fewer, the texels of the maps by no more than a factor of {MARGIN:g}. Times are shown beside them.",
        (
            *asks(SM, PSM, SV, CHAN),
            *(Ask(trial(set_up, halved=True), (SM, PSM, SV, CHAN)) for set_up in TIMED),
        ),
        growth,
    ),
    Ordering(
        "O8",
        "SM's error falls with the map's size and grows with the cone; a wide cone stays jagged at 2048.",
        f"Mean displacement of the edge, by a factor of more than {MARGIN:g} at every doubling of the map "
        f"and for every wider cone; with the widest, 95 % of the edge are not within {JAGGED_PX:g} px.",
        tuple(Ask(Trial(one.name), tuple(sm(size) for size in one.map_sizes)) for one in TOWERS),
        texels_and_cones,
    ),
    Ordering(
        "O9",
        "PSM against SM on the rocks at 512: light on the right better near and worse far, in front equal, "
        "behind both nearly perfect, closer than the camera clearly worse.",
        f"Near and far: wrong pixels of the nearer and the farther half, by a factor of more than "
        f"{MARGIN:g}. Equal: within {ABOUT_EQUAL:g}. Nearly perfect: {GOOD_PX:g} px at most. Clearly: more "
        f"than {CLEARLY:g}. All of it with the camera moved back as in the thesis, or all of it without.",
        (
            *(Ask(Trial(name), (SM_ROCKS, FIT_ROCKS, *WARPS)) for name in (RIGHT, FRONT, BEHIND, CLOSER)),
            Ask(Trial(CLOSER), (UNCLIPPED,)),
        ),
        warp_quality,
    ),
    Ordering(
        "O10",
        "Chan drops thin objects if its map is small.",
        f"The falsely lit share is more than {100 * EXACT:g} % with the smallest map, and falls by a factor "
        f"of more than {MARGIN:g} at every doubling.",
        (Ask(Trial(BRACES.name), tuple(chan(size) for size in BRACES.map_sizes)),),
        thin_objects,
    ),
    Ordering(
        "O11",
        "On a tree of open geometry SM and PSM are right, volumes that need closed meshes are wrong; "
        "general ones, and Chan on these, are right.",
        f"Maps are right if twice the side leaves less than 1/{CLEARLY:g} of the wrong pixels; Crow's "
        f"variant is wrong if it has more than {CLEARLY:g} times as many as they; right volumes differ from "
        f"ray casting, and Chan from them, in at most {100 * EXACT:g} % of the pixels.",
        (Ask(Trial(TREE.name), (sm(1024), sm(2048), psm(1024), psm(2048), SV, CROW, chan())),),
        open_geometry,
    ),
    Ordering(
        "O12",
        "PSM flickers when the camera moves, the others do not.",
        f"The error of PSM changes between frames in more than {100 * STEADY:g} % of the pixels, that of SM, "
        "SV and Chan in no more.",
        tuple(Ask(trial, flickering(trial)) for trial in MOVES),
        flicker,
    ),
)


class UnknownOrderingError(GnomonError):
    """No ordering has this name."""

    exit_code = 2


def orderings_named(names: Sequence[str]) -> tuple[Ordering, ...]:
    """Those with these ids, in any case, in the order of the thesis; all where there are no names.

    Raises:
        UnknownOrderingError: There is none of that name; the message lists those there are.
    """
    known = {one.id: one for one in ORDERINGS}
    for name in names:
        if name.upper() not in known:
            raise UnknownOrderingError(f'There is no ordering "{name}".', known=f"Known: {', '.join(known)}.")
    wanted = {name.upper() for name in names} or set(known)
    return tuple(one for one in ORDERINGS if one.id in wanted)
