from __future__ import annotations

import pytest

from renderers.context import devices
from tests.api.command import answered, gnomon


def test_it_lists_every_device_with_its_clock() -> None:
    listed = answered("devices")
    assert [one["renderer"] for one in listed] == [one.renderer for one in devices()]
    assert all(one["clock"] in ("query", "wall") for one in listed)
    assert all(one["clock"] == "wall" for one in listed if one["software"])


def test_the_table_says_what_the_json_says() -> None:
    shown = gnomon("devices", width=200).stdout
    for device in devices():
        assert device.renderer in shown
        assert str(device.limits.max_texture_side) in shown


def test_no_device_is_exit_4(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("api.device_list.devices", lambda: iter(()))
    result = gnomon("devices")
    assert result.exit_code == 4
    assert "make setup" in result.stderr
