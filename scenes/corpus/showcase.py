"""One spec of each family that shows what the family is: for exports and pictures."""

from __future__ import annotations

from scenes.corpus.registry import family_named
from scenes.corpus.spec import Rig, Spec
from scenes.scene import LightKind

_TRIANGLES = 30_000


def showcase(family: str, seed: int = 0) -> Spec:
    """The family by daylight, or by a lamp where no sun gets in or lamps suit it better.

    Raises:
        SpecError: There is no such family, or the seed is none.
    """
    found = family_named(family)
    low, high = found.TRIANGLES
    sun = LightKind.DIRECTIONAL in (found.KINDS[:1] if found.INDOOR else found.KINDS)
    return Spec(
        family=family,
        seed=seed,
        triangles=min(max(_TRIANGLES, low), high),
        kind=LightKind.DIRECTIONAL if sun else LightKind.POINT,
        rig=Rig.FROM_THE_SIDE if sun else Rig.BETWEEN,
        cameras=2,
    )
