"""The evidence from outside: what is in a store, as JSON values, and how it comes in and goes out."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from enum import StrEnum
from pathlib import Path
from typing import Any

from api.wording import path_words
from scenes.atomic_file import output_error, write_atomically
from selector.benchmark.code_version import code_versions
from selector.evidence.aslib import Measure, Scenario, scenario_files
from selector.evidence.exporting import FileFormat, export
from selector.evidence.rows import DeviceRow, InstanceRow, Judgement, Role, RunRow, Timing
from selector.evidence.store import Store, StoreError
from selector.evidence.surveying import Counts
from selector.measurement import Status

Json = dict[str, Any]

FEWEST_KEY_DIGITS = 4
"""Of a key that may be cut short."""


class ExportFormat(StrEnum):
    """What evidence can be written as."""

    PARQUET = "parquet"
    CSV = "csv"
    ASLIB = "aslib"


def listed(store: Store) -> Json:
    """What is in a store, by device and technique, by family, and by run."""
    survey, current = store.survey(), code_versions()
    devices = {device.key: device for device in store.devices()}
    runs = {run.key: run for run in store.runs()}
    return {
        "devices": [{"key": key, **asdict(device)} for key, device in devices.items()],
        "techniques": [
            {
                "device": device,
                "technique": technique,
                "code": code,
                "fresh": current.get(technique) == code,
                **asdict(counts),
            }
            for (device, technique, code), counts in survey.techniques.items()
        ],
        "families": [
            {
                "family": family,
                "role": role,
                "instances": count,
                **asdict(survey.families.get((family, role), Counts())),
            }
            for (family, role), count in survey.instances.items()
        ],
        "runs": [{**_run(run), **asdict(survey.runs.get(key, Counts()))} for key, run in runs.items()],
        "extractors": [{"name": name, "instances": len(store.features(name))} for name in store.extractors()],
    }


def shown(store: Store, key: str) -> Json:
    """Everything about one instance or one run.

    Args:
        store: Where it is.
        key: Its key, or as much of its beginning as nothing else has.

    Raises:
        StoreError: There is none, or there are several.
    """
    rows: list[InstanceRow | RunRow] = [*store.instances(), *store.runs()]
    every = {one.key: one for one in rows}
    found = [one for name, one in every.items() if name.startswith(key)]
    if len(key) < FEWEST_KEY_DIGITS or not found:
        known = f"There are {len(every)} instances and runs; `gnomon evidence ls --json` lists runs."
        raise StoreError(f'There is no instance or run "{key}".', known=known)
    if len(found) > 1:
        raise StoreError(f'"{key}" is the beginning of several keys.', known=f"They are {_some_keys(found)}.")
    (one,) = found
    return _shown_instance(store, one) if isinstance(one, InstanceRow) else _shown_run(store, one)


def exported(
    store: Store, folder: Path, form: ExportFormat, device: str | None, extractor: str | None
) -> list[str]:
    """Writes a store into a folder; the files that were written.

    Args:
        store: What is written.
        folder: Where to; it is made if need be.
        form: As what. ASlib makes one folder a measure.
        device: Of an ASlib scenario; a part of its key or name. The only one where None.
        extractor: Whose features an ASlib scenario has. The only one where None.

    Raises:
        OutputError: A file cannot be written.
        StoreError: The store cannot be read, or holds too little for a scenario.
    """
    if form is not ExportFormat.ASLIB:
        return [path_words(path) for path in export(store, folder, FileFormat(form))]
    row = device_of(store, device)
    return [
        path_words(path) for measure in Measure for path in _scenario(store, folder, measure, row, extractor)
    ]


def device_of(store: Store, named: str | None) -> DeviceRow:
    """The one device whose key begins so or whose name holds this; the only one where None.

    Raises:
        StoreError: There is none, or there are several.
    """
    every = list(store.devices())
    found = [
        one
        for one in every
        if named is None or one.key.startswith(named) or named.lower() in words(one).lower()
    ]
    if len(found) == 1:
        return found[0]
    what = "There is no such device." if not found else "Several devices are meant."
    known = "; ".join(f"{one.key[:8]} is {words(one)}" for one in every) or "The store knows none"
    raise StoreError(what, known=f"{known}.", remedy="Name one with --device, by its key.")


def words(device: DeviceRow) -> str:
    """How people call a device."""
    if device.virtual:
        return f"{device.virtual} (virtual)"
    processor = f", {device.processor}, {device.threads} threads" if device.threads else ""
    return f"{device.renderer}{processor}"


def _scenario(
    store: Store, folder: Path, measure: Measure, device: DeviceRow, extractor: str | None
) -> Iterator[Path]:
    known = store.extractors()
    if (extractor is None and len(known) != 1) or (extractor is not None and extractor not in known):
        what = "A scenario needs features, and it is not clear which."
        listed_words = ", ".join(known) or "none"
        raise StoreError(what, known=f"The store holds {listed_words}.", remedy="Name one with --extractor.")
    name = extractor or known[0]
    table = store.table(device.key, role=Role.TRAINING)
    identity = f"GNOMON-{measure.replace('_', '-').upper()}-{device.key[:8]}"
    scenario = Scenario(
        identity, measure, table, name, store.features(name), store.feature_costs(name), words(device)
    )
    if not scenario.rows:
        known_words = "No training instance has both features and a measurement on this device."
        raise StoreError("There is nothing for a scenario.", known=known_words)
    place = folder / identity
    try:
        place.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise output_error(place, error) from error
    for file, data in scenario_files(scenario).items():
        write_atomically(place / file, data)
        yield place / file


def _shown_instance(store: Store, row: InstanceRow) -> Json:
    named = {one.key: one for one in store.candidates()}
    devices = {one.key: words(one) for one in store.devices()}
    current = code_versions()

    def about(fact: Judgement | Timing) -> Json:
        candidate = named[fact.asked.candidate]
        return {
            "technique": candidate.technique,
            "settings": dict(candidate.settings),
            "device": devices[fact.asked.device],
            "fresh": current.get(candidate.technique) == fact.asked.code,
            "run": fact.run,
            "status": str(fact.status),
            "reason": fact.reason,
        }

    judged = [
        {
            **about(one),
            "memory_bytes": one.memory_bytes,
            "truth": str(one.truth),
            "fallback": one.fallback or None,
            "figures": dict(one.figures),
            "counters": dict(one.counters),
        }
        for one in store.judgements(instance=row.key)
    ]
    timed = [
        {
            **about(one),
            "samples": [
                {**asdict(sample), "mobility": str(sample.mobility), "stages_ms": dict(sample.stages_ms)}
                for sample in one.samples
            ],
        }
        for one in store.timings(instance=row.key)
    ]
    instance = {"key": row.key, **asdict(row), "role": str(row.role)}
    features = {name: _finite(store.features(name).get(row.key, {})) for name in store.extractors()}
    return {"instance": instance, "judgements": judged, "timings": timed, "features": features}


def _shown_run(store: Store, run: RunRow) -> Json:
    named = {one.key: one for one in store.candidates()}
    devices = {one.key: words(one) for one in store.devices()}
    facts: list[Judgement | Timing] = [*store.judgements(run=run.key), *store.timings(run=run.key)]
    failed = [
        {
            "instance": one.asked.instance,
            "technique": named[one.asked.candidate].technique,
            "settings": dict(named[one.asked.candidate].settings),
            "status": str(one.status),
            "reason": one.reason,
        }
        for one in facts
        if one.status is not Status.OK
    ]
    return {
        "run": _run(run),
        "devices": sorted({devices[one.asked.device] for one in facts}),
        "instances": len({one.asked.instance for one in facts}),
        "facts": len(facts),
        "failed": failed,
    }


def _finite(values: Mapping[str, float]) -> dict[str, float | None]:
    # JSON knows finite numbers only.
    return {name: value if math.isfinite(value) else None for name, value in values.items()}


def _run(run: RunRow) -> Json:
    return {**asdict(run), "purpose": str(run.purpose), "remarks": list(run.remarks)}


def _some_keys(found: list[InstanceRow | RunRow]) -> str:
    return ", ".join(one.key for one in found[:4]) + (" and more" if len(found) > 4 else "")
