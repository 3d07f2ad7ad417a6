"""Evidence made up for tests: every field filled, and each instance unlike the others."""

from __future__ import annotations

from dataclasses import dataclass

from scenes.scene import Mobility
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
from selector.measurement import Status, Truth

CODE, OLD_CODE = "c" * 64, "d" * 64
DEVICE = DeviceRow("softpipe 1", "nobody", "4.5", "wall", "A processor", 2)
CARD = DeviceRow("softpipe 1", "nobody", "4.5", "none", virtual="card of 2005")
ERRORS = RunRow("e" * 32, "2030-01-02T03:04:05Z", "abc123+", Purpose.ERRORS, 7, ("busy", 'a "remark"\n'))
TIMES = RunRow("f" * 32, "2030-01-03T03:04:05Z", "abc123", Purpose.TIMES, 2**40)
SM = CandidateRow("shadow_map", {"map_size": 1024, "filter": "2x2", "bias": 0.5, "flip": True})
SV = CandidateRow("shadow_volume", {})


def instance(index: int, family: str = "cave", role: Role = Role.TRAINING) -> InstanceRow:
    light = {"name": f"Lamp {index}", "kind": "spot", "index": 0, "position": [0.1, float(index), -1.0]}
    camera = {"name": "Eye, mit Umlaut ä", "fov_rad": 0.7}
    return InstanceRow(
        f"{index:064x}", f"{family} {index}", family, '{"seed":3}', role, light, camera, 640, 512
    )


def asked(of: InstanceRow, candidate: CandidateRow, device: DeviceRow = DEVICE, code: str = CODE) -> Asked:
    return Asked(of.key, candidate.key, device.key, code)


def judgement(
    about: Asked,
    edge_error_px: float | None = 0.75,
    *,
    status: Status = Status.OK,
    run: RunRow = ERRORS,
) -> Judgement:
    if status is not Status.OK:
        return Judgement(about, run.key, status, f"it is {status}, says 'the driver'\n")
    figures = {"edge_error_px": edge_error_px, "wrong_share": 0.01, "pixels": 6400.0, "flip": None}
    counters = {"map_texels": 2**40, "triangles": 12}
    return Judgement(about, run.key, status, "", 4 << 20, Truth.EMBREE, "", figures, counters)


def sample(index: int, mobility: Mobility, ms: float, canary_ms: float = 2.0) -> SampleRow:
    return SampleRow(index, mobility, ms, ms + 1 / 3, canary_ms, {"map": ms * 0.75, "visibility": ms * 0.25})


def timing(
    about: Asked,
    *times: float,
    canaries: tuple[float, ...] = (),
    run: RunRow = TIMES,
    status: Status = Status.OK,
    first: int = 0,
) -> Timing:
    """Dynamic samples as given, static ones in half the time."""
    taken = [
        sample(first + index, mobility, ms * share, (canaries or (2.0,) * len(times))[index])
        for index, ms in enumerate(times)
        for mobility, share in ((Mobility.DYNAMIC, 1.0), (Mobility.STATIC, 0.5))
    ]
    return Timing(about, run.key, status, "" if status is Status.OK else f"it is {status}", tuple(taken))


@dataclass(frozen=True)
class Everything:
    """All that a store holds, as values that can be compared."""

    instances: tuple[InstanceRow, ...]
    candidates: tuple[CandidateRow, ...]
    devices: tuple[DeviceRow, ...]
    runs: tuple[RunRow, ...]
    judgements: tuple[Judgement, ...]
    timings: tuple[Timing, ...]


def everything(store: Store) -> Everything:
    return Everything(
        tuple(store.instances()),
        tuple(store.candidates()),
        tuple(store.devices()),
        tuple(store.runs()),
        tuple(store.judgements()),
        tuple(store.timings()),
    )


def filled(store: Store, instances: int = 4, first: int = 0) -> None:
    """Instances of two families, one of them for testing; SM and SV judged and timed."""
    store.begin(ERRORS, DEVICE)
    store.begin(TIMES, DEVICE)
    for index in range(first, first + instances):
        row = instance(
            index, "cave" if index % 2 else "forest", Role.TEST if index % 4 == 3 else Role.TRAINING
        )
        sm, sv = asked(row, SM), asked(row, SV)
        judged = [judgement(sm, None if index % 3 == 2 else 0.5 + index), judgement(sv, 0.0)]
        store.add(row, [SM, SV], judged, [timing(sm, 2.0, 4.0, 3.0), timing(sv, 8.0, 9.0, 7.0)])
