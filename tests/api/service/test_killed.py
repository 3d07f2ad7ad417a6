"""Kill -9 of the service and of its worker amid ten queued jobs: none is lost, none is done twice."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
import psutil
import pytest

from tests.api.command import ROOT, environment
from tests.api.service.running_service import GLB, PATIENCE_S
from tests.api.service.strange_workers import FINISHES
from tests.small_level import small_level

JOBS = 10

Json = dict[str, Any]


@dataclass
class Ledger:
    """What clients were told.

    Attributes:
        promised: Ids of jobs that were taken.
        done: Id -> what was said of it when it was first said to be done, and its result.
        finished: How often a job was said to have gone from not done to done.
    """

    promised: list[str] = field(default_factory=list)
    done: dict[str, tuple[Json, bytes]] = field(default_factory=dict)
    finished: Counter[str] = field(default_factory=Counter)

    def look(self, client: httpx.Client) -> None:
        """Ask about every job, and hold the answer against what was said before."""
        for job in self.promised:
            found = client.get(f"/v1/jobs/{job}").json()
            assert found["state"] in ("queued", "running", "done"), found
            if job in self.done:
                told, result = self.done[job]
                assert found == told
                assert client.get(told["links"]["result"]).content == result
            elif found["state"] == "done":
                self.finished[job] += 1
                self.done[job] = found, client.get(found["links"]["result"]).content

    @property
    def complete(self) -> bool:
        return len(self.done) == len(self.promised)


@contextmanager
def started(state: Path, model: Path, kind: str) -> Iterator[tuple[subprocess.Popen[str], httpx.Client]]:
    command = [sys.executable, "-m", "tests.api.service.killed_service", str(state), str(model), kind]
    process = subprocess.Popen(
        command, cwd=ROOT, env=environment(LP_NUM_THREADS="1"), stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    try:
        url = process.stdout.readline().strip()
        with httpx.Client(base_url=url, timeout=PATIENCE_S) as client:
            yield process, client
    finally:
        process.kill()
        process.communicate()


def sent(client: httpx.Client, body: bytes) -> str:
    options = {"resolution": "64x48", "rounds": "1", "technique": "SV", "light": "0"}
    response = client.post("/v1/jobs", params=options, content=body, headers={"Content-Type": GLB})
    assert response.status_code == 202, response.text
    return str(response.json()["id"])


def kill_a_child(process: subprocess.Popen[str], dice: random.Random) -> None:
    """The measuring process, a reading one, or the resource tracker of Python."""
    children = psutil.Process(process.pid).children()
    if children:
        os.kill(dice.choice(children).pid, signal.SIGKILL)


def survive(state: Path, model: Path, kind: str, body: bytes, kills: int, most_s: float) -> Ledger:
    ledger, dice = Ledger(), random.Random(7)  # noqa: S311  the same kills each time
    for life in range(kills + 1):
        with started(state, model, kind) as (process, client):
            while len(ledger.promised) < JOBS:
                ledger.promised.append(sent(client, body))
            until = time.monotonic() + (PATIENCE_S if life == kills else dice.uniform(0.1, most_s))
            while not ledger.complete and time.monotonic() < until:
                if life < kills and dice.random() < 0.1:
                    kill_a_child(process, dice)
                ledger.look(client)
                time.sleep(dice.uniform(0.0, 0.1))
            if life < kills:
                process.send_signal(signal.SIGKILL)
                process.wait()
    return ledger


def test_ten_jobs_survive_kills(tmp_path: Path, model: Path) -> None:
    ledger = survive(tmp_path, model, "quick", b"work", kills=2, most_s=2.0)
    assert ledger.complete
    assert set(ledger.finished.values()) == {1}
    # Nor was any of them finished twice behind the scenes.
    finishes = Counter((tmp_path / FINISHES).read_text().split())
    assert set(finishes) <= set(ledger.promised)
    assert set(finishes.values()) == {1}


@pytest.mark.slow
def test_ten_measured_jobs_survive_many_kills(tmp_path: Path, model: Path) -> None:
    level = small_level(tmp_path).read_bytes()
    ledger = survive(tmp_path / "state", model, "real", level, kills=12, most_s=12.0)
    assert ledger.complete
    assert set(ledger.finished.values()) == {1}
    left = {path.name for path in (tmp_path / "state" / "jobs").iterdir()}
    assert left == set(ledger.promised)
