from __future__ import annotations

import asyncio
import os
import signal
import socket
import subprocess
import time
from pathlib import Path

import httpx
import pytest

from api.service.listening import ServeError, check, listening, serve, token_of, url_of
from api.service.settings import Settings, default_state
from tests.api.command import ROOT, environment, gnomon, program, running, started, wait_for_line

TOKEN = "0123456789abcdef"  # noqa: S105  of a test


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.168.1.2", "example.org"])  # noqa: S104  refused
def test_beyond_this_machine_a_token_is_needed(host: str) -> None:
    with pytest.raises(ServeError, match="asks for a token"):
        check(Settings(host=host))
    check(Settings(host=host, token=TOKEN))
    found = gnomon("serve", "--host", host, "--port", 0)
    assert found.exit_code == 2
    assert "token" in found.stderr


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost", "::1"])
def test_on_this_machine_none_is(host: str) -> None:
    check(Settings(host=host))


def test_a_token_comes_from_a_file_or_the_environment(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("GNOMON_TOKEN", raising=False)
    assert token_of(None) == ""
    file = tmp_path / "token"
    file.write_text(f"{TOKEN}\n")
    assert token_of(file) == TOKEN
    monkeypatch.setenv("GNOMON_TOKEN", TOKEN * 2)
    assert token_of(None) == TOKEN * 2
    assert token_of(file) == TOKEN


@pytest.mark.parametrize(
    "content", [b"", b"short", b"two words that are long", b"x" * 2000, b"\xff\xfe" * 20]
)
def test_what_is_no_token_is_refused(tmp_path: Path, content: bytes) -> None:
    file = tmp_path / "token"
    file.write_bytes(content)
    with pytest.raises(ServeError, match="token"):
        token_of(file)
    with pytest.raises(ServeError, match="cannot be read"):
        token_of(tmp_path / "none")


def test_the_state_lies_in_the_users_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.delenv("XDG_STATE_HOME", raising=False)
    assert default_state() == tmp_path / ".local" / "state" / "gnomon"
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "states"))
    assert default_state() == tmp_path / "states" / "gnomon"
    monkeypatch.setenv("XDG_STATE_HOME", "relative")
    assert default_state() == tmp_path / ".local" / "state" / "gnomon"


def test_an_address_is_what_a_browser_opens() -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port = listener.getsockname()[1]
        assert url_of("127.0.0.1", listener) == f"http://127.0.0.1:{port}"
        assert url_of("::1", listener) == f"http://[::1]:{port}"
        assert url_of("0.0.0.0", listener) == f"http://127.0.0.1:{port}"  # noqa: S104  as it is named


def test_small_answers_do_not_wait_for_an_acknowledgement(tmp_path: Path) -> None:
    async def nodelay() -> int:
        found: asyncio.Future[int] = asyncio.get_running_loop().create_future()

        async def accepted(_: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            made = writer.get_extra_info("socket")
            found.set_result(made.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY))
            writer.close()

        async with await asyncio.start_server(accepted, sock=listener):
            _, writer = await asyncio.open_connection(*listener.getsockname())
            writer.close()
            return await asyncio.wait_for(found, 30)

    with listening(Settings(port=0, state=tmp_path)) as listener:
        assert asyncio.run(nodelay())


def test_a_port_that_is_taken_is_told(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        found = started("serve", "--port", listener.getsockname()[1], "--state", tmp_path)
    assert found.returncode == 2
    assert "--port" in found.stderr
    assert "Traceback" not in found.stderr


def test_it_serves_until_it_is_told_to_stop(tmp_path: Path, model: Path) -> None:
    arguments = ("serve", "--port", 0, "--state", tmp_path / "state", "--model", model, "--readers", 1)
    with running(*arguments) as process:
        url = wait_for_line(process, "Gnomon is at").split()[3]
        assert httpx.get(f"{url}/healthz").status_code == 200
        assert httpx.get(f"{url}/healthz", headers={"Host": "evil.example"}).status_code == 421
        # Another one may not use its folder.
        other = started("serve", "--port", 0, "--state", tmp_path / "state")
        assert other.returncode == 7
        assert "Another service" in other.stderr
        assert "Traceback" not in other.stderr
        process.send_signal(signal.SIGINT)
        assert process.wait(60) == 0


@pytest.mark.parametrize("wait_s", [0.0, 0.2, 0.6, 1.2])
def test_ctrl_c_in_a_terminal_is_quiet_however_early(tmp_path: Path, model: Path, wait_s: float) -> None:
    """It reaches the whole group: the processes that read, too, while they still start."""
    command = program("serve", "--port", 0, "--state", tmp_path / "state", "--model", model, "--readers", 2)
    with subprocess.Popen(
        command, cwd=ROOT, env=environment(), stderr=subprocess.PIPE, text=True, start_new_session=True
    ) as process:
        try:
            wait_for_line(process, "Gnomon is at")
            time.sleep(wait_s)
            os.killpg(process.pid, signal.SIGINT)
            _, said = process.communicate(timeout=60)
        finally:
            process.kill()
    assert process.returncode == 0, said
    assert "Traceback" not in said
    assert "interrupted" not in said


def test_ctrl_c_before_it_listens_is_how_it_ends_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("api.service.listening.create_app", interrupted)
    serve(Settings(state=tmp_path, port=0), lambda _: None)
