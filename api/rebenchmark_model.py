"""The models of a re-benchmark job: one is learnt, and held against the one in force."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Protocol

from features.extraction import extractor_version
from features.table import NAMES
from models.artifact import Artifact, ModelError, load, packed
from models.contesting import Contest, contest, contest_as_is, contestable
from models.evaluation import evaluate
from selector.evidence.rows import DeviceRow
from selector.evidence.store import Store
from selector.learning.dataset import EvidenceError
from selector.learning.featuring import features_of
from selector.learning.testing import columns_of, slots_of
from selector.learning.training import Learning, learning, trained
from selector.policy import MISS
from selector.rebenchmark.champion import Values, learnt_from
from selector.rebenchmark.promotion import Decision, decide, put_in_force
from selector.rebenchmark.report import Judged

Models = tuple[Judged | None, Artifact | None, Artifact | None]
"""What became of the model; the one in force before; the new one. None where there is none."""


TOO_FEW_FAMILIES = "Two models cannot be compared by families that they have not seen: there are too few."


class OnStep(Protocol):
    """Hears how far a step is."""

    def __call__(self, done: int, total: int, words: str = "") -> None:
        """So much is done."""


@dataclass(frozen=True)
class Fitting:
    """What a new model is learnt from and compared with.

    Attributes:
        store: The evidence.
        device: Whose times.
        former: The same hardware under the driver of before, if any.
        places: Files and folders with the levels that instances come from.
        target: The model in force.
        now: The moment, for the name of the model that is kept.
        causes: Why evidence has changed; none where the job has found no reason.
        folds: In which two models are compared.
        judged_before: Digest of the evidence whose model an earlier job has compared already; may be empty.
    """

    store: Store
    device: DeviceRow
    former: DeviceRow | None
    places: Sequence[Path]
    target: Path
    now: datetime
    causes: Sequence[str]
    folds: int
    judged_before: str


def judged_model(fitting: Fitting, on_words: Callable[[str], None], on_step: OnStep) -> Models:
    """Learns, compares, decides, and writes.

    Raises:
        OutputError: The model cannot be written; the old one is still in force.
    """
    champion, problem = _champion(fitting.target)
    on_words("Gathering what there is to learn from")
    try:
        source, features = _learning(fitting, on_step)
    except EvidenceError as error:
        decision = Decision(promoted=False, why=" ".join(filter(None, [problem, str(error)])))
        return Judged(decision, champion=champion is not None), champion, None
    digest = source.dataset.examples.digest
    if champion and champion.card.get("training", {}).get("digest") == digest:
        return None, champion, None
    if champion and digest == fitting.judged_before and not fitting.causes:
        return None, champion, None
    found, as_is = None, False
    if champion and not contestable(source.dataset.examples, fitting.folds):
        decision = Decision(promoted=False, why=TOO_FEW_FAMILIES)
    elif champion:
        on_words("Comparing the new model with the old one, fold by fold")
        found, as_is = _contest(fitting, champion, source, features, on_step)
        decision = decide(found)
    else:
        decision = Decision(promoted=True, why=problem)
    challenger = _challenger(fitting, source, on_words, on_step, promoted=decision.promoted)
    if decision.promoted:
        kept = put_in_force(fitting.target, packed(challenger), fitting.now)
        decision = Decision(promoted=True, why=decision.why, kept=kept)
    method = challenger.model.method
    size = len(source.dataset.examples)
    return Judged(decision, found, as_is, method, digest, size, champion is not None), champion, challenger


def previous_digest(report: Path) -> str:
    """Digest of the evidence whose model the last report has judged; empty where there is no report."""
    try:
        values = json.loads(report.read_bytes())
        return str(values.get("judged_digest") or "")
    except (OSError, ValueError, AttributeError):
        return ""


def _champion(target: Path) -> tuple[Artifact | None, str]:
    """The model in force, or why it counts for nothing."""
    if not target.exists():
        return None, "There was no model before."
    try:
        found = load(target)
    except ModelError as error:
        return None, f"The model of before cannot be used: {error.what}"
    if found.features != NAMES or found.card.get("extractor") != extractor_version():
        return None, "The model of before was learnt from other features than this version of Gnomon has."
    return found, ""


def _learning(fitting: Fitting, on_step: OnStep) -> tuple[Learning, Values]:
    rows = list(fitting.store.instances())
    features: Values = {}
    # Each place may know other levels; what one has found is kept in the store.
    for place in [*(one if one.is_dir() else one.parent for one in fitting.places), None]:
        features, _ = features_of(fitting.store, rows, place, on_step)
    return learning(fitting.store, fitting.device.key, None, on_step), features


def _contest(
    fitting: Fitting, champion: Artifact, source: Learning, features: Values, on_step: OnStep
) -> tuple[Contest, bool]:
    new = source.dataset
    devices = [one for one in (fitting.device, fitting.former) if one]
    old = learnt_from(champion, fitting.store, devices, features)
    if old is not None and contestable(new.examples, fitting.folds, old.examples):
        columns = columns_of(old.slots, new.slots)
        return contest(old.examples, new.examples, columns, MISS, fitting.folds, on_step), False
    columns = columns_of(slots_of(champion), new.slots)
    return contest_as_is(champion.model, new.examples, columns, MISS, fitting.folds, on_step), True


def _challenger(
    fitting: Fitting,
    source: Learning,
    on_words: Callable[[str], None],
    on_step: OnStep,
    *,
    promoted: bool,
) -> Artifact:
    """The new model; its card says how good it is where it is to be used."""
    if promoted and contestable(source.dataset.examples, fitting.folds):
        on_words("Judging the new model for its card")
        verdicts = evaluate(source.dataset.examples, MISS, fitting.folds, on_step)
    else:
        verdicts = ()
    on_words("Learning from everything")
    return trained(source, verdicts)
