"""How long the evidence store takes for a million timed frames, beside plain sqlite3 and a plain numpy file.

    .venv/bin/python tests/bench/store.py [--samples N] [--repeats N]

5,000 instances with 20 candidates each are judged once and timed in 5 rounds, as a dynamic and as a
static light. They are added as a benchmark adds them, an instance a transaction, and then a hundred at once,
as a merge does. Plain sqlite3 writes the same facts with executemany into two flat tables, with keys as text
and names as JSON. The training join is held against numpy.load of the arrays that it gives. Ours and theirs
alternate; each figure is a median.
"""

from __future__ import annotations

import argparse
import json
import sqlite3
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from statistics import median

import numpy as np
from rich.console import Console
from rich.table import Table

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
from selector.evidence.writing import Batch
from selector.measurement import Status

CANDIDATES, ROUNDS = 20, 5
BATCH = 100
DEVICE = DeviceRow("made up", "nobody", "4.5", "wall")
RUN = RunRow("a" * 32, "2030-01-01T00:00:00Z", "0" * 40, Purpose.TIMES, 1)
CODE = "c" * 64
FIGURES = ("acne_share", "boundary_px", "edge_error_p95_px", "edge_error_px", "false_lit", "false_shadow")
FIGURES += ("flip", "leak_share", "pixels", "wrong_share")

Facts = tuple[InstanceRow, list[Judgement], list[Timing]]


def candidates() -> list[CandidateRow]:
    return [CandidateRow(f"technique_{index % 5}", {"map_size": 2**index}) for index in range(CANDIDATES)]


def facts(instances: int) -> list[Facts]:
    """The same at each call."""
    random = np.random.default_rng(1)
    known = candidates()
    return [_facts_of(index, known, random) for index in range(instances)]


def _facts_of(index: int, known: list[CandidateRow], random: np.random.Generator) -> Facts:
    light, camera = {"kind": "spot", "index": 0, "position": [0.0, index, 1.0]}, {"fov_rad": 0.8}
    row = InstanceRow(
        f"{index:064x}",
        f"scene {index}",
        f"family {index % 26}",
        "{}",
        Role.TRAINING,
        light,
        camera,
        640,
        512,
    )
    judged, timed = [], []
    for candidate in known:
        asked = Asked(row.key, candidate.key, DEVICE.key, CODE)
        figures = dict(zip(FIGURES, random.random(len(FIGURES)).tolist(), strict=True))
        counters = {"triangles": int(random.integers(10**6)), "volume_fragments": int(random.integers(10**8))}
        judged.append(Judgement(asked, RUN.key, Status.OK, "", 4 << 20, figures=figures, counters=counters))
        samples = tuple(
            SampleRow(turn, mobility, a + b, a + b + c, 10 + d, {"map": a, "visibility": b, "volumes": d})
            for turn in range(ROUNDS)
            for mobility in (Mobility.DYNAMIC, Mobility.STATIC)
            for a, b, c, d in [random.random(4).tolist()]
        )
        timed.append(Timing(asked, RUN.key, Status.OK, "", samples))
    return row, judged, timed


def add_by_instance(path: Path, rows: list[Facts]) -> None:
    known = candidates()
    with Store.open(str(path)) as store:
        store.begin(RUN, DEVICE)
        for row, judged, timed in rows:
            store.add(row, known, judged, timed)


def add_at_once(path: Path, rows: list[Facts]) -> None:
    with Store.open(str(path)) as store:
        store.add_batch(Batch(runs=(RUN,), devices=(DEVICE,), candidates=candidates()))
        for start in range(0, len(rows), BATCH):
            some = rows[start : start + BATCH]
            judged = [one for _, these, _ in some for one in these]
            timed = [one for *_, these in some for one in these]
            store.add_batch(Batch(instances=[row for row, *_ in some], judgements=judged, timings=timed))


KEY = "instance TEXT, candidate TEXT, device TEXT, code TEXT, run TEXT"
FLAT_JUDGEMENTS = f"CREATE TABLE judgements ({KEY}, status TEXT, memory INTEGER, figures TEXT, counters TEXT)"
TIMES = "shadow REAL, frame REAL, canary REAL"
FLAT_SAMPLES = f"CREATE TABLE samples ({KEY}, round INTEGER, mobility TEXT, {TIMES}, stages TEXT)"
INSERT_JUDGEMENTS = "INSERT INTO judgements VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)"
INSERT_SAMPLES = "INSERT INTO samples VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)"


def plain(path: Path, rows: list[Facts], at_once: int) -> None:
    connection = sqlite3.connect(path)
    for statement in ("PRAGMA journal_mode=WAL", "PRAGMA synchronous=NORMAL", FLAT_JUDGEMENTS, FLAT_SAMPLES):
        connection.execute(statement)
    for start in range(0, len(rows), at_once):
        some = rows[start : start + at_once]
        with connection:
            connection.executemany(INSERT_JUDGEMENTS, _plain_judgements(some))
            connection.executemany(INSERT_SAMPLES, _plain_samples(some))
    connection.close()


def _plain_key(asked: Asked) -> tuple[str, ...]:
    return asked.instance, asked.candidate, asked.device, asked.code, RUN.key


def _plain_judgements(rows: list[Facts]) -> Iterator[tuple[object, ...]]:
    for _, judged, _ in rows:
        for one in judged:
            texts = json.dumps(one.figures), json.dumps(one.counters)
            yield (*_plain_key(one.asked), str(one.status), one.memory_bytes, *texts)


def _plain_samples(rows: list[Facts]) -> Iterator[tuple[object, ...]]:
    for _, _, timed in rows:
        for one in timed:
            key = _plain_key(one.asked)
            for sample in one.samples:
                times = sample.shadow_ms, sample.frame_ms, sample.canary_ms
                yield (*key, sample.round, str(sample.mobility), *times, json.dumps(sample.stages_ms))


def join(path: Path) -> None:
    with Store.open(str(path), write=False) as store:
        table = store.table(DEVICE.key, codes=[CODE])
    assert np.isfinite(table.shadow_ms(Mobility.STATIC)).all()


def save_arrays(path: Path, store: Path) -> None:
    with Store.open(str(store), write=False) as opened:
        table = opened.table(DEVICE.key)
    np.savez(
        path,
        *(table.shadow_ms(mobility) for mobility in Mobility),
        table.status,
        *table.figures.values(),
        *table.counters.values(),
    )


def load_arrays(path: Path) -> None:
    with np.load(path) as arrays:
        for name in arrays.files:
            assert arrays[name].size


def seconds(action: Callable[[], None]) -> float:
    start = time.perf_counter()
    action()
    return time.perf_counter() - start


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--samples", type=int, default=1_000_000)
    parser.add_argument("--repeats", type=int, default=3)
    arguments = parser.parse_args()
    rows = facts(arguments.samples // (CANDIDATES * ROUNDS * 2))
    taken: dict[str, list[float]] = {}
    with tempfile.TemporaryDirectory() as name:
        for repeat in range(arguments.repeats):
            for what, some in measured(Path(name) / str(repeat), rows).items():
                taken.setdefault(what, []).append(some)
    report(taken, arguments.samples)


def measured(folder: Path, rows: list[Facts]) -> dict[str, float]:
    """Seconds, and bytes, by what took them."""
    folder.mkdir()
    paths = {name: folder / f"{name}.sqlite" for name in ("ours", "theirs", "ours_at_once", "theirs_at_once")}
    found = {
        "add": seconds(lambda: add_by_instance(paths["ours"], rows)),
        "plain add": seconds(lambda: plain(paths["theirs"], rows, 1)),
        "merge": seconds(lambda: add_at_once(paths["ours_at_once"], rows)),
        "plain merge": seconds(lambda: plain(paths["theirs_at_once"], rows, BATCH)),
        "bytes": float(paths["ours"].stat().st_size),
        "plain bytes": float(paths["theirs"].stat().st_size),
        "again": seconds(lambda: add_at_once(paths["ours_at_once"], rows)),
    }
    arrays = folder / "arrays.npz"
    save_arrays(arrays, paths["ours"])
    found["join"] = seconds(lambda: join(paths["ours"]))
    found["plain join"] = seconds(lambda: load_arrays(arrays))
    return found


def report(taken: dict[str, list[float]], samples: int) -> None:
    middle = {what: median(some) for what, some in taken.items()}
    table = Table("what", "ours", "plain", "ratio", "a second", title=f"{samples:,} timed frames")
    for name, ours, theirs in (
        ("added, an instance a transaction", "add", "plain add"),
        (f"added, {BATCH} instances a transaction", "merge", "plain merge"),
        ("added again, all known", "again", "plain merge"),
        ("training join; numpy.load of what it gives", "join", "plain join"),
    ):
        a, b = middle[ours], middle[theirs]
        table.add_row(name, f"{a:.2f} s", f"{b:.3f} s", f"{a / b:.2f}", f"{samples / a:,.0f}")
    a, b = middle["bytes"], middle["plain bytes"]
    table.add_row("file", f"{a / 1e6:.0f} MB", f"{b / 1e6:.0f} MB", f"{a / b:.2f}", "")
    Console(width=110).print(table)


if __name__ == "__main__":
    main()
