"""A finished model asked about evidence that it was not learnt from."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from features.extraction import extractor_version
from features.table import NAMES
from models.artifact import Artifact, ModelError
from models.contesting import ABSENT
from models.evaluation import Verdict, evaluate_as_is
from models.examples import Numbers
from selector.learning.dataset import EvidenceError, Slot
from selector.learning.training import Learning
from selector.policy import MISS


def tested(artifact: Artifact, source: Learning) -> tuple[Verdict, ...]:
    """One verdict for each policy and mobility; its single best choice is that of its own training.

    Raises:
        ModelError: It was learnt from other features than this program has.
        EvidenceError: It knows choices that were not measured, so that nobody knows what they cost.
    """
    require_same_features(artifact)
    columns = columns_of(slots_of(artifact), source.dataset.slots)
    if (columns == ABSENT).any():
        missing = [one.label for one, at in zip(slots_of(artifact), columns, strict=True) if at == ABSENT]
        raise EvidenceError(
            "This evidence lacks choices that the model knows.",
            known=f"It lacks {', '.join(missing[:3])}{' and others' if len(missing) > 3 else ''}.",
            remedy="Benchmark them: `gnomon benchmark` without --technique.",
        )
    return evaluate_as_is(artifact.model, source.dataset.examples, columns, MISS)


def require_same_features(artifact: Artifact) -> None:
    """Checks that a model can be asked here.

    Raises:
        ModelError: It was learnt from other features than this program has.
    """
    if artifact.features != NAMES or artifact.card.get("extractor") != extractor_version():
        raise ModelError(
            "This model was learnt from other features than this version of Gnomon has.",
            known=f"It was made by {str(artifact.card.get('generator', 'another program'))[:80]}.",
            remedy="Train it again: `gnomon train`.",
        )


def slots_of(artifact: Artifact) -> tuple[Slot, ...]:
    """What a model chooses from."""
    return tuple(Slot.of(str(one["technique"]), dict(one["settings"])) for one in artifact.card["choices"])


def columns_of(old: Sequence[Slot], new: Sequence[Slot]) -> Numbers:
    """(k_old,) which of the new slots each old one is, or `ABSENT`."""
    places = {slot: index for index, slot in enumerate(new)}
    return np.array([places.get(slot, ABSENT) for slot in old], np.int64)
