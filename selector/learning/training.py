"""Learns a model from a store of evidence, and judges how good such a model is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from features.extraction import extractor_version
from features.table import NAMES
from models.artifact import Artifact
from models.evaluation import OnFold, Verdict, evaluate
from models.selector_model import SelectorModel
from renderers.context import DeviceLimits
from scenes.scene import Array, Mobility
from selector.evidence.rows import DeviceRow, Role
from selector.evidence.store import Store
from selector.evidence.table import EvidenceTable
from selector.learning.dataset import Dataset, EvidenceError, dataset
from selector.learning.featuring import OnInstance, features_of
from selector.policy import MISS
from selector.virtual_devices import PREFIX, VIRTUAL_DEVICES, virtual_device

USUAL_LIMITS = DeviceLimits(max_texture_side=16_384, max_buffer_bytes=1 << 30)
"""What desktop devices of the last ten years offer: where none is at hand, refusals go by these."""

Json = dict[str, Any]


@dataclass(frozen=True)
class Learning:
    """What there is to learn from.

    Attributes:
        device: Whose times they are.
        dataset: The arrays.
        problems: Why instances have no features -> how many.
        resolutions: Sizes of the views.
    """

    device: DeviceRow
    dataset: Dataset
    problems: Mapping[str, int]
    resolutions: tuple[str, ...]


def learning(
    store: Store,
    device: str | None,
    levels: Path | None,
    on_instance: OnInstance,
    role: Role = Role.TRAINING,
) -> Learning:
    """The training or the test part of a store as arrays, with the times of one device.

    Args:
        store: The evidence.
        device: Part of a device's name, the beginning of its key, or `virtual:NAME`; where None, the first
            that has been timed.
        levels: Folder with the level files that instances come from.
        on_instance: Hears of features that are found anew.
        role: Which part.

    Raises:
        EvidenceError: There is no such device, or too little was measured on it.
        StoreError: The store cannot be read.
    """
    row = _device(store, device)
    table = store.table(_judged_on(store, row), role=role)
    features, problems = features_of(store, table.instances, levels, on_instance)
    counted: dict[str, int] = {}
    for words in problems.values():
        counted[words] = counted.get(words, 0) + 1
    sizes = dict.fromkeys(f"{one.width}x{one.height}" for one in table.instances)
    return Learning(row, dataset(table, _times(row, table), features), counted, tuple(sizes))


def trained(source: Learning, verdicts: tuple[Verdict, ...]) -> Artifact:
    """A model of everything that there is to learn from. The same evidence gives the same model."""
    data = source.dataset
    model = SelectorModel.fit(data.examples, MISS)
    return Artifact(model, NAMES, _card(source, verdicts, model))


def judged(source: Learning, on_fold: OnFold | None = None) -> tuple[Verdict, ...]:
    """One verdict for each policy and mobility, on families that were not learnt from."""
    return evaluate(source.dataset.examples, MISS, on_fold=on_fold)


def verdict_record(verdict: Verdict, labels: tuple[str, ...]) -> Json:
    """A verdict as JSON values; `closed_gap` is None where it is not claimed."""
    gap = verdict.gap
    return {
        "policy": verdict.question,
        "mobility": verdict.time,
        "closed_gap": gap.closed if gap.claimed else None,
        "interval": [gap.low, gap.high] if gap.claimed else None,
        "claimed": gap.claimed,
        "single_over_best": gap.single / gap.best,
        "cost": {"model": gap.model, "single_best": gap.single, "best": gap.best},
        "instances": gap.instances,
        "by_family": {name: asdict(one) for name, one in verdict.by_family.items()},
        "ways": dict(verdict.methods),
        "accuracy": verdict.accuracy,
        "misses": verdict.misses,
        "worse_than_single_best": verdict.worse,
        "regret_ms": verdict.regret_time,
        "regret_px": verdict.regret_error,
        "wins": _counted(verdict.wins, labels),
        "picks": _counted(verdict.picks, labels),
    }


def _counted(counts: Any, labels: tuple[str, ...]) -> dict[str, int]:
    return {label: int(count) for label, count in zip(labels, counts, strict=True) if count}


def _device(store: Store, wanted: str | None) -> DeviceRow:
    if wanted is not None and wanted.startswith(PREFIX):
        return virtual_device(wanted).row
    known = list(store.devices())
    if wanted is None:
        timed = {key for (key, _, _), counts in store.survey().techniques.items() if counts.timings}
        found = [one for one in known if one.key in timed]
    else:
        name = wanted.lower()
        found = [one for one in known if one.key.startswith(name) or name in one.renderer.lower()]
    if not found:
        names = [one.renderer for one in known] + [f"{PREFIX}{one.name}" for one in VIRTUAL_DEVICES]
        what = f'There is no device "{wanted}".' if wanted else "No device was timed yet."
        raise EvidenceError(what, known=f"There are {', '.join(names)}.", remedy="Choose one with --device.")
    return found[0]


def _judged_on(store: Store, device: DeviceRow) -> str:
    """Key of the device whose errors and counters are joined: those of a virtual device are any other's."""
    if not device.virtual:
        return device.key
    judged: dict[str, int] = {}
    for (key, _, _), counts in store.survey().techniques.items():
        judged[key] = judged.get(key, 0) + counts.judgements
    if not judged:
        raise EvidenceError("The store holds no evidence yet.", remedy="Benchmark first: `gnomon benchmark`.")
    return max(sorted(judged), key=lambda key: judged[key])


def _times(device: DeviceRow, table: EvidenceTable) -> dict[Mobility, Array]:
    if device.virtual:
        known = virtual_device(device.virtual)
        return {mobility: known.shadow_ms(table, mobility) for mobility in Mobility}
    return {mobility: table.shadow_ms(mobility) for mobility in Mobility}


def _card(source: Learning, verdicts: tuple[Verdict, ...], model: SelectorModel) -> Json:
    data = source.dataset
    labels = tuple(slot.label for slot in data.slots)
    return {
        # Pairs, since the order of settings counts and a JSON object has none.
        "choices": [{"technique": slot.technique, "settings": list(slot.settings)} for slot in data.slots],
        "settings": list(data.settings),
        "device": asdict(source.device),
        "limits": asdict(USUAL_LIMITS),
        "extractor": extractor_version(),
        "generator": f"gnomon {version('gnomon')}",
        "training": {
            "digest": data.examples.digest,
            "instances": len(data.examples),
            "families": sorted(set(data.examples.families.tolist())),
            "left_out": {name: count for name, count in data.left_out.items() if count},
            "resolutions": list(source.resolutions),
        },
        "ranges": _ranges(data),
        "evaluation": [verdict_record(one, labels) for one in verdicts],
        "chooses_by": model.method,
        "single_best": [labels[index] for index in model.single.tolist()],
        "about": "Chooses a shadow technique for a light from numbers that need no rendering. Judged on "
        "families of scenes that were not learnt from. What lies outside the ranges is a guess.",
    }


def _ranges(data: Dataset) -> dict[str, list[float]]:
    """Lowest, middle and highest value of each feature in training."""
    percentiles = np.percentile(data.examples.features, [0, 50, 100], axis=0)
    return {name: percentiles[:, index].tolist() for index, name in enumerate(NAMES)}
