"""docs/client.md: its examples run, and it names every field."""

from __future__ import annotations

import re
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import pytest

from api.client import errors, records
from tests.api.client.route_service import route_service

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs/client.md").read_text()
EXAMPLES = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
RECORDS = [one for one in vars(records).values() if isinstance(one, type) and is_dataclass(one)]
ERRORS = [name for name in vars(errors) if name.endswith("Error")]


def run_examples(service: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Runs them one after the other, as a reader who types them does, with another service."""
    monkeypatch.chdir(ROOT)
    names: dict[str, Any] = {}
    for example in EXAMPLES:
        exec(compile(example.replace("Service()", service), "client.md", "exec"), names)  # noqa: S102


def test_the_examples_run(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    assert len(EXAMPLES) >= 5
    with route_service() as service:
        run_examples(f"Service({service.url!r})", monkeypatch)
    said = capsys.readouterr().out
    assert "done 10 of 10 measuring" in said
    assert "Nobody answers at http://127.0.0.1:9." in said
    assert [one.target for one in service.asked if "/jobs?" in one.target] == [
        "/v1/jobs?resolution=96x64&rounds=1&name=street.glb&light=Lantern"
    ]


@pytest.mark.parametrize("kind", RECORDS, ids=lambda kind: kind.__name__)
def test_every_field_is_named(kind: Any) -> None:
    assert [field.name for field in fields(kind) if f"`{field.name}`" not in PAGE] == []


@pytest.mark.parametrize("name", ERRORS)
def test_every_error_is_named(name: str) -> None:
    assert f"`{name}`" in PAGE
