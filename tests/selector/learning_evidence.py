"""A store of made-up evidence about real candidates: smooth times and errors, of families that differ."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from features.table import NAMES
from renderers.context import DeviceLimits
from scenes.scene import LightKind, Mobility
from selector.candidate import Candidate, candidates
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
from selector.measurement import Status

DEVICE = DeviceRow("made-up renderer", "nobody", "4.5", "wall", "A processor", 2)
RUN = RunRow("a" * 32, "2030-01-02T03:04:05Z", "abc123", Purpose.TIMES, 1)
LIMITS = DeviceLimits(16_384, 1 << 30)
CODE = "c" * 32
FAMILIES, OF_EACH = 5, 9
PIXELS = 640 * 512


def fill(store: Store, role: Role = Role.TRAINING, seed: int = 8, without: str = "") -> None:
    """Adds 45 instances of five families, all judged and timed but for one technique, with features."""
    random = np.random.default_rng(seed)
    kinds = list(LightKind)
    store.begin(RUN, DEVICE)
    values = {}
    for index in range(FAMILIES * OF_EACH):
        kind, family = kinds[index % 3], index % FAMILIES
        instance = _instance(index, f"family {family}", kind, role)
        features = dict(zip(NAMES, random.uniform(0, 1, len(NAMES)).tolist(), strict=True))
        features |= {f"is_{one}": float(one is kind) for one in kinds}
        features |= {"map_texel": random.uniform(-2, 4), "depth_complexity": random.uniform(0, 4)}
        values[instance.key] = features
        wanted = [one for one in candidates(kind, LIMITS) if one.technique != without]
        rows = [CandidateRow(one.technique, dict(one.settings)) for one in wanted]
        judgements, timings = [], []
        for one, row in zip(wanted, rows, strict=True):
            about = Asked(instance.key, row.key, DEVICE.key, CODE)
            judgements.append(_judgement(about, one, features))
            timings.append(_timing(about, _ms(one, features, family)))
        store.add_batch(Batch(instances=[instance], candidates=rows, judgements=judgements, timings=timings))
    store.add_features(extractor(), values)


def filled(path: Path, role: Role = Role.TRAINING, seed: int = 8, without: str = "") -> Path:
    """A store with all that, in a file."""
    with Store.open(str(path)) as store:
        fill(store, role, seed, without)
    return path


def _instance(index: int, family: str, kind: LightKind, role: Role) -> InstanceRow:
    light = {"name": "Lamp", "kind": str(kind), "index": 0, "position": [float(index), 0.0, 0.0]}
    origin = f"level {index}.glb"
    return InstanceRow(f"{index:064x}", origin, family, origin, role, light, {"name": "Eye"}, 640, 512)


def _side(one: Candidate) -> float:
    return float(dict(one.settings).get("map_size", 1024))


def _ms(one: Candidate, features: dict[str, float], family: int) -> float:
    effect = 1 + 0.05 * family
    if one.technique == "shadow_volume":
        return effect * (1.0 + 3.0 * features["depth_complexity"])
    warped = 1.3 if "perspective" in one.technique else 1.0
    hybrid = 2.0 + features["depth_complexity"] if one.technique == "chan_hybrid" else 0.0
    return effect * (warped * (0.5 + _side(one) ** 2 / 2e6) + hybrid)


def _judgement(about: Asked, one: Candidate, features: dict[str, float]) -> Judgement:
    if "perspective" in one.technique and features["warp_gain"] < 0.4:
        return Judgement(about, RUN.key, Status.REFUSED, "the warp would not help")
    exact = one.technique in ("shadow_volume", "chan_hybrid")
    error = 0.001 if exact else 2 ** features["map_texel"] * 1024 / _side(one) / 2
    figures = {"edge_error_px": error, "wrong_share": 0.01, "pixels": 1e5}
    side = _side(one)
    counters = {
        "map_triangles": 5000,
        "map_texels_cleared": int(side * side),
        "map_texels_written": int(side * side),
    }
    if exact:
        counters = {
            "cap_triangles": 5000,
            "silhouette_edges": 900,
            "volume_fragments": int(2 * PIXELS * features["depth_complexity"]),
            "volume_fragments_counted": int(PIXELS * features["depth_complexity"]),
        }
    return Judgement(about, RUN.key, Status.OK, "", 4 << 20, figures=figures, counters=counters)


def _timing(about: Asked, ms: float) -> Timing:
    samples = [
        SampleRow(index, mobility, ms * share, ms + 1, 2.0)
        for index in range(3)
        for mobility, share in ((Mobility.DYNAMIC, 1.0), (Mobility.STATIC, 0.5))
    ]
    return Timing(about, RUN.key, Status.OK, "", tuple(samples))
