"""The corpora by name: lists of specs."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

from scenes.corpus.registry import families
from scenes.corpus.sampler import Sampler
from scenes.corpus.spec import Spec, SpecError
from scenes.thesis.set_ups import set_ups

QUICK_SIZE, STANDARD_SIZE, FURTHER_OF_EACH = 48, 1040, 6
_QUICK_TRIANGLES, _FURTHER_TRIANGLES = 20_000, 100_000
_SEED = 2005


def quick() -> tuple[Spec, ...]:
    """About 48 small instances, every family at least once: for trying things out."""
    count = max(QUICK_SIZE, len(families()))
    return tuple(Sampler(_SEED, most_triangles=_QUICK_TRIANGLES).specs(count))


def standard() -> tuple[Spec, ...]:
    """At least 1,040 instances, the same number of every family: for evidence."""
    each = -(-STANDARD_SIZE // len(families()))
    return tuple(Sampler(_SEED + 1).specs(each * len(families())))


def further() -> tuple[Spec, ...]:
    """Six more instances of every family, of up to 100,000 triangles: more evidence for little time."""
    sampler = Sampler(_SEED + 2, most_triangles=_FURTHER_TRIANGLES)
    return tuple(sampler.specs(FURTHER_OF_EACH * len(families())))


def thesis() -> tuple[Spec, ...]:
    """The set-ups behind the figures of the thesis."""
    return tuple(
        Spec(_FAMILY_OF.get(one.scene, one.scene), set_up=one.name, lights=1, cameras=1) for one in set_ups()
    )


# The thesis' scenes and the families that were made after them.
_FAMILY_OF = {"rocks": "stone_circles", "street": "plain_street", "room": "furnished_room", "tree": "forest"}

CORPORA: dict[str, Callable[[], tuple[Spec, ...]]] = {
    "quick": quick,
    "standard": standard,
    "further": further,
    "thesis": thesis,
}


@cache
def corpus(name: str) -> tuple[Spec, ...]:
    """The specs of a corpus.

    Raises:
        SpecError: There is none of that name.
    """
    if name not in CORPORA:
        raise SpecError(f'There is no corpus "{name}".', known=f"There are {', '.join(CORPORA)}.")
    return CORPORA[name]()
