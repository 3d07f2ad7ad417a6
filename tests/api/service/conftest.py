"""A service that is up, with a small model and one reader, for all tests that do it no harm."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from api.service.settings import Limits, Settings
from models.artifact import packed
from selector.evidence.store import Store
from selector.learning.training import learning, trained
from tests.api.service.running_service import Running, running
from tests.selector.learning_evidence import filled

# Short enough to be waited for, long enough for a busy machine.
LIMITS = replace(
    Limits(),
    upload_bytes=4 << 20,
    header_s=2.0,
    body_idle_s=2.0,
    body_s=6.0,
    waiting_s=200.0,
    triangles=2_000,
)


@pytest.fixture(scope="session")
def model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("model")
    with Store.open(str(filled(folder / "e.sqlite"))) as store:
        artifact = trained(learning(store, None, None, lambda *_: None), ())
    path = folder / "made.model"
    path.write_bytes(packed(artifact))
    return path


@pytest.fixture(scope="session")
def service(model: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    settings = Settings(state=tmp_path_factory.mktemp("state"), model=model, readers=1, limits=LIMITS)
    with running(settings) as up:
        yield up
