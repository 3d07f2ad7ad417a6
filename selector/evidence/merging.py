"""One store's evidence added to another's. Nothing is doubled, so it can be done again at any time."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import islice
from typing import TypeVar

from selector.evidence.store import Store
from selector.evidence.writing import Batch

_FACTS_AT_ONCE = 2000

_Row = TypeVar("_Row")


def merge(into: Store, other: Store) -> None:
    """Adds all that another store holds.

    Raises:
        StoreError: One cannot be read or the other not written. What was added by then stays.
    """
    into.add_batch(
        Batch(
            runs=list(other.runs()),
            devices=list(other.devices()),
            instances=list(other.instances()),
            candidates=list(other.candidates()),
        )
    )
    for judged in _chunks(other.judgements()):
        into.add_batch(Batch(judgements=judged))
    for timed in _chunks(other.timings()):
        into.add_batch(Batch(timings=timed))
    for extractor in other.extractors():
        known = into.features(extractor)
        new = {key: values for key, values in other.features(extractor).items() if key not in known}
        into.add_features(extractor, new, other.feature_costs(extractor))


def _chunks(rows: Iterable[_Row]) -> Iterator[list[_Row]]:
    each = iter(rows)
    while chunk := list(islice(each, _FACTS_AT_ONCE)):
        yield chunk
