"""Rows as the records that tables hold, and back."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from renderers.settings import Setting
from scenes.scene import Mobility
from selector.evidence.numbering import Record
from selector.evidence.rows import CandidateRow, DeviceRow, InstanceRow, Purpose, Role, RunRow

Found = Mapping[Any, Any]
"""A record as the database gives it: by column's name, or by column."""
MOBILITIES = (Mobility.DYNAMIC, Mobility.STATIC)
"""In the order of the numbers that stand for them."""


def json_text(value: Mapping[str, Any]) -> str:
    """One text for one value."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False)


def instance_record(row: InstanceRow) -> Record:
    """With its key."""
    return {
        "key": row.key,
        "scene_digest": row.scene_digest,
        "scene": row.scene,
        "family": row.family,
        "origin": row.origin,
        "role": str(row.role),
        "light": json_text(row.light),
        "camera": json_text(row.camera),
        "width": row.width,
        "height": row.height,
    }


def instance_row(record: Found) -> InstanceRow:
    """What was recorded."""
    return InstanceRow(
        scene_digest=record["scene_digest"],
        scene=record["scene"],
        family=record["family"],
        origin=record["origin"],
        role=Role(record["role"]),
        light=json.loads(record["light"]),
        camera=json.loads(record["camera"]),
        width=record["width"],
        height=record["height"],
    )


def candidate_record(row: CandidateRow) -> Record:
    """With its key; settings keep their order, which is the technique's own."""
    settings = json.dumps(dict(row.settings), separators=(",", ":"), allow_nan=False)
    return {"key": row.key, "technique": row.technique, "settings": settings}


def candidate_row(record: Found) -> CandidateRow:
    """What was recorded."""
    settings: dict[str, Setting] = json.loads(record["settings"])
    return CandidateRow(record["technique"], settings)


def device_record(row: DeviceRow) -> Record:
    """With its key."""
    return {
        "key": row.key,
        "renderer": row.renderer,
        "vendor": row.vendor,
        "gl_version": row.gl_version,
        "clock": row.clock,
        "processor": row.processor,
        "threads": row.threads,
        "virtual": row.virtual,
    }


def device_row(record: Found) -> DeviceRow:
    """What was recorded."""
    names = ("renderer", "vendor", "gl_version", "clock", "processor", "threads", "virtual")
    return DeviceRow(**{name: record[name] for name in names})


def run_record(row: RunRow) -> Record:
    """With its key."""
    return {
        "key": row.key,
        "started": row.started,
        "commit": row.commit,
        "purpose": str(row.purpose),
        "seed": row.seed,
        "remarks": json.dumps(row.remarks, separators=(",", ":")),
    }


def run_row(record: Found) -> RunRow:
    """What was recorded."""
    return RunRow(
        key=record["key"],
        started=record["started"],
        commit=record["commit"],
        purpose=Purpose(record["purpose"]),
        seed=record["seed"],
        remarks=tuple(json.loads(record["remarks"])),
    )
