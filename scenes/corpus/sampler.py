"""Draws specs so that every axis is covered: each axis is a deck of its bins, dealt evenly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

from scenes.corpus.draws import Draws
from scenes.corpus.registry import Family, families
from scenes.corpus.rigs import RIGS
from scenes.corpus.spec import MOST_CAMERAS, STEPS, Closure, Spec, Standpoint
from scenes.scene import LightKind

Value = TypeVar("Value")

# Four to a decade from 10^2 to 10^6, and two below.
TRIANGLE_BINS = (
    *(24, 56),
    *(mantissa * 10**power // 100 for power in (2, 3, 4, 5) for mantissa in (100, 178, 316, 562)),
    1_000_000,
)
CUT_OFF_BINS_DEG = (
    (2.0, 5.0),
    (5.0, 10.0),
    (10.0, 20.0),
    (20.0, 35.0),
    (35.0, 50.0),
    (50.0, 65.0),
    (65.0, 80.0),
)
REACHES = (None, None, None, 0.02, 0.04, 0.07, 0.15, 0.3, 0.6, 1.2, 1.8)
LIGHTS = (1, 1, 1, 2, 3, 5, 12, 40, 64)
# Most views are from where people stand.
STANDPOINTS_INDOORS = (*2 * (Standpoint.VISTA, Standpoint.NEAR, Standpoint.FAR), Standpoint.CLOSE)
STANDPOINTS = (*STANDPOINTS_INDOORS, Standpoint.REMOTE)
MERGED = (False, False, False, False, True)
CLOSURES = (Closure.AS_BUILT, Closure.AS_BUILT, Closure.AS_BUILT, Closure.BOTTOMLESS, Closure.FLIPPED)
_DEGREE_STEPS = 4
_SMALL, _SMALL_AGAIN = 200, 4


@dataclass
class _Deck:
    """Values dealt in random order, all of them before any comes again."""

    values: Sequence[object]
    draws: Draws
    hand: list[object]

    def dealt(self) -> object:
        if not self.hand:
            self.hand = [self.values[index] for index in self.draws.order(len(self.values)).tolist()]
        return self.hand.pop()


class Sampler:
    """Deals specs, family by family in turn.

    Args:
        seed: Of everything that is drawn.
        names: The families; all where None.
        most_triangles: No spec asks for more.
    """

    def __init__(
        self, seed: int, names: Sequence[str] | None = None, most_triangles: int = 1_000_000
    ) -> None:
        self._draws = Draws("sampler", seed)
        self._names = sorted(families()) if names is None else list(names)
        self._most = most_triangles
        self._decks: dict[str, _Deck] = {}
        self._dealt = 0

    def specs(self, count: int) -> list[Spec]:
        """The next so many."""
        return [self._next() for _ in range(count)]

    def _next(self) -> Spec:
        name = self._names[self._dealt % len(self._names)]
        self._dealt += 1
        family = families()[name]
        kind = self._deal(f"kind of {name}", family.KINDS)
        low, high = self._deal("cut-off", CUT_OFF_BINS_DEG)
        steps = round((high - low) * _DEGREE_STEPS)
        return Spec(
            family=name,
            seed=self._draws.one_below(2**31),
            triangles=self._triangles(name, family),
            crowding=self._deal(f"crowding of {name}", range(STEPS)),
            grain=self._deal(f"grain of {name}", range(STEPS)),
            closure=self._deal("closure", CLOSURES),
            kind=kind,
            cut_off_deg=low + self._draws.one_below(steps + 1) / _DEGREE_STEPS,
            reach=None if kind is LightKind.DIRECTIONAL else self._deal("reach", REACHES),
            rig=self._deal(f"rig of {kind}", RIGS[kind]),
            standpoint=self._deal(
                f"standpoint of {name}", STANDPOINTS_INDOORS if family.INDOOR else STANDPOINTS
            ),
            merged=self._deal("merged", MERGED),
            lights=self._deal("lights", LIGHTS),
            cameras=self._deal("cameras", range(1, MOST_CAMERAS)),
        )

    def _triangles(self, name: str, family: Family) -> int:
        """One of the family's own bins, so that each family is stretched over all that it can be."""
        low, high = family.TRIANGLES
        mine = [count for count in TRIANGLE_BINS if low <= count <= min(high, self._most)]
        # Few families can be so small: those that can are so more often.
        mine += _SMALL_AGAIN * [count for count in mine if count < _SMALL]
        return self._deal(f"triangles of {name}", mine or [low])

    def _deal(self, axis: str, values: Sequence[Value]) -> Value:
        if axis not in self._decks:
            self._decks[axis] = _Deck(values, self._draws.of(axis), [])
        value: Value = self._decks[axis].dealt()  # type: ignore[assignment]
        return value
