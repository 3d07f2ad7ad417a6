"""A service that is up, with a small model and one reader, for tests that do no harm; and a browser at it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import Browser, BrowserContext

from api.service.settings import Limits, Settings
from models.artifact import packed
from selector.evidence.store import Store
from selector.learning.training import learning, trained
from tests.api.service.browsing import Visit, browser, served, visit
from tests.api.service.running_service import Running, running
from tests.selector.learning_evidence import filled
from tests.small_level import small_level

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


@pytest.fixture(scope="module")
def address(model: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    with served("--model", model, "--state", tmp_path_factory.mktemp("state")) as url:
        yield url


@pytest.fixture(scope="module")
def chromium() -> Iterator[Browser]:
    with browser() as opened:
        yield opened


@pytest.fixture
def context(chromium: Browser) -> Iterator[BrowserContext]:
    made = chromium.new_context(accept_downloads=True)
    yield made
    made.close()


@pytest.fixture
def at_page(context: BrowserContext, address: str) -> Iterator[Visit]:
    found = visit(context, address)
    yield found
    assert found.complaints == []
    assert found.hosts == {urlsplit(address).netloc}


@pytest.fixture(scope="module")
def level(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return small_level(tmp_path_factory.mktemp("level"))
