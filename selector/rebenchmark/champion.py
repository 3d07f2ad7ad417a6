"""The model in force, and the evidence that it was learnt from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from models.artifact import Artifact
from scenes.scene import Mobility
from selector.evidence.rows import DeviceRow, Role
from selector.evidence.store import Store
from selector.learning.dataset import Dataset, EvidenceError, dataset

MOST_TRIES = 60
"""Each gathers the whole table once, which takes a second for a thousand instances."""

Values = Mapping[str, Mapping[str, float]]


def dataset_then(store: Store, device: DeviceRow, features: Values, before: str | None = None) -> Dataset:
    """What there was to learn from before a moment, or is now.

    Args:
        store: The evidence.
        device: Whose times.
        features: Instance's key -> name -> value.
        before: UTC, ISO 8601; what began later is left out.

    Raises:
        EvidenceError: It was too little.
    """
    table = (
        store.table(device.key, role=Role.TRAINING)
        if before is None
        else store.table(device.key, role=Role.TRAINING, before=before)
    )
    return dataset(table, {one: table.shadow_ms(one) for one in Mobility}, features)


def learnt_from(
    artifact: Artifact, store: Store, devices: Sequence[DeviceRow], features: Values
) -> Dataset | None:
    """The very evidence that a model was learnt from, found by its digest; None where it is not in the store.

    The store never forgets, so the evidence of any day is what began before that day's end.
    """
    wanted = artifact.card.get("training", {}).get("digest")
    moments = sorted({row.started for row in store.runs()}, reverse=True)
    for before in [None, *moments][:MOST_TRIES]:
        for device in devices:
            try:
                found = dataset_then(store, device, features, before)
            except EvidenceError:
                continue
            if found.examples.digest == wanted:
                return found
    return None
