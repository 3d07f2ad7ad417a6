"""Times of 24 small instances, taken 21 times over by code that did not change, and stores made from them.

The file holds JSON (`facts`: instances, candidates, device, judgements, features, runs) and one entry a timed
frame in each of `run`, `instance`, `candidate`, `round`, `mobility`, `shadow_ms`, `canary_ms`.
`record_repeats.py` wrote it.
"""

from __future__ import annotations

import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cache
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np

from selector.evidence.records import MOBILITIES
from selector.evidence.rows import (
    Asked,
    CandidateRow,
    DeviceRow,
    InstanceRow,
    Judgement,
    Purpose,
    Role,
    RunRow,
    SampleRow,
    Timing,
)
from selector.evidence.store import Store
from selector.evidence.writing import Batch
from selector.learning.featuring import extractor
from selector.measurement import Status, Truth

PATH = Path(__file__).with_name("repeats.npz")
COLUMNS = ("run", "instance", "candidate", "round", "mobility", "shadow_ms", "canary_ms")
SHORT = {"shadow_ms": np.float32, "canary_ms": np.float32, "instance": np.int16, "candidate": np.int16}


@dataclass(frozen=True)
class Repeats:
    """The file's content; `samples` has one entry a timed frame in each column."""

    instances: tuple[InstanceRow, ...]
    candidates: tuple[CandidateRow, ...]
    device: DeviceRow
    judgements: tuple[Judgement, ...]
    features: Mapping[str, Mapping[str, float]]
    runs: tuple[RunRow, ...]
    samples: Mapping[str, np.ndarray]


def pack(store: Store) -> bytes:
    """What a store holds of one device, as the file's bytes."""
    instances, known = list(store.instances()), list(store.candidates())
    timed = [row for row in store.runs() if row.purpose is Purpose.TIMES]
    row_of = {row.key: index for index, row in enumerate(instances)}
    column_of = {row.key: index for index, row in enumerate(known)}
    # The machine's remarks begin runs of their own; all of one seed are one repetition.
    number_of = {row.key: row.seed for row in timed}
    columns: dict[str, list[float]] = {name: [] for name in COLUMNS}
    for timing in store.timings():
        about = (number_of[timing.run], row_of[timing.asked.instance], column_of[timing.asked.candidate])
        for one in timing.samples:
            values = (*about, one.round, MOBILITIES.index(one.mobility), one.shadow_ms, one.canary_ms)
            for name, value in zip(COLUMNS, values, strict=True):
                columns[name].append(value)
    seeds = sorted({row.seed for row in timed})
    facts = {
        "instances": [asdict(row) for row in instances],
        "candidates": [{"technique": row.technique, "settings": dict(row.settings)} for row in known],
        "device": asdict(next(iter(store.devices()))),
        "judgements": [asdict(row) for row in store.judgements()],
        "features": store.features(extractor()),
        "runs": len(seeds),
    }
    arrays = {name: np.array(values, SHORT.get(name, np.int8)) for name, values in columns.items()}
    text = np.frombuffer(json.dumps(facts).encode(), np.uint8)
    buffer = io.BytesIO()
    np.savez_compressed(buffer, facts=text, **arrays)
    return buffer.getvalue()


@cache
def repeats() -> Repeats:
    """The file."""
    with np.load(PATH) as file:
        facts = json.loads(file["facts"].tobytes())
        samples = {name: file[name] for name in COLUMNS}
    return Repeats(
        tuple(InstanceRow(**{**row, "role": Role(row["role"])}) for row in facts["instances"]),
        tuple(CandidateRow(**row) for row in facts["candidates"]),
        DeviceRow(**facts["device"]),
        tuple(_judgement(row) for row in facts["judgements"]),
        facts["features"],
        tuple(_run(number) for number in range(facts["runs"])),
        samples,
    )


def fill(
    store: Store,
    numbers: Sequence[int],
    slowed: Mapping[str, float] | None = None,
    codes: Mapping[str, str] | None = None,
) -> None:
    """Adds some of the runs, with errors and features; times of a technique may be multiplied.

    Args:
        store: Where to.
        numbers: Which runs.
        slowed: Technique's id -> factor of its times.
        codes: Technique's id -> hash of its code, in place of those recorded.
    """
    found = repeats()
    codes = codes or {}
    store.add_batch(
        Batch(
            runs=[found.runs[number] for number in numbers],
            devices=[found.device],
            instances=found.instances,
            candidates=found.candidates,
        )
    )
    technique_of = techniques()
    first = found.runs[numbers[0]].key
    judged = [
        replace(row, run=first, asked=_asked(row.asked, codes, technique_of)) for row in found.judgements
    ]
    store.add_batch(Batch(judgements=judged, timings=timings(numbers, slowed, codes)))
    store.add_features(extractor(), found.features)


def techniques() -> dict[str, str]:
    """Candidate's key -> id of its technique."""
    return {row.key: row.technique for row in repeats().candidates}


def codes() -> dict[str, str]:
    """Technique's id -> hash of the code that was recorded."""
    technique_of = techniques()
    return {technique_of[row.asked.candidate]: row.asked.code for row in repeats().judgements}


@cache
def _rows() -> list[tuple[float, ...]]:
    """One entry a timed frame, in the order of runs, instances, candidates, rounds."""
    columns = [repeats().samples[name].tolist() for name in COLUMNS]
    return sorted(zip(*columns, strict=True))


def timings(
    numbers: Sequence[int], slowed: Mapping[str, float] | None = None, codes: Mapping[str, str] | None = None
) -> list[Timing]:
    """What some of the runs have timed; as in `fill`."""
    slowed, codes = slowed or {}, codes or {}
    found = repeats()
    technique_of = techniques()
    code_of = {(row.asked.instance, row.asked.candidate): row.asked for row in found.judgements}
    wanted = set(numbers)
    rows = [row for row in _rows() if row[0] in wanted]
    rows_of = []
    for (run, instance, candidate), group in groupby(rows, key=lambda row: row[:3]):
        key = found.instances[instance].key, found.candidates[candidate].key
        factor = slowed.get(technique_of[key[1]], 1.0)
        taken = tuple(
            SampleRow(index, MOBILITIES[mobility], ms * factor, ms * factor + 1.0, canary_ms)
            for *_, index, mobility, ms, canary_ms in group
        )
        about = _asked(code_of[key], codes, technique_of)
        rows_of.append(Timing(about, found.runs[run].key, Status.OK, "", taken))
    return rows_of


def _asked(asked: Asked, codes: Mapping[str, str], technique_of: Mapping[str, str]) -> Asked:
    return replace(asked, code=codes.get(technique_of[asked.candidate], asked.code))


def _judgement(row: dict[str, Any]) -> Judgement:
    words = {"asked": Asked(**row["asked"]), "status": Status(row["status"]), "truth": Truth(row["truth"])}
    return Judgement(**{**row, **words})


def _run(number: int) -> RunRow:
    started = f"2030-01-{number + 1:02}T03:00:00+00:00"
    return RunRow(f"{number:032x}", started, "abc123", Purpose.TIMES, number)
