from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from api.service.application import Entries
from api.service.guard import is_loopback
from api.service.settings import Settings
from tests.api.service import strange_workers
from tests.api.service.running_service import Running, problem, running

TOKEN = "nobody-guesses-this-one"  # noqa: S105  of a service that lives for a test
ANYWHERE = "0.0.0.0"  # noqa: S104  what it is told; tests bind to this machine
STRANGE = Entries(strange_workers.read, strange_workers.measure)


@pytest.fixture(scope="module")
def locked(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Running]:
    state = tmp_path_factory.mktemp("state")
    settings = Settings(state, token=TOKEN, host=ANYWHERE, names=("render-box",))
    with running(settings, STRANGE) as up:
        yield up


@pytest.mark.parametrize(
    "host",
    [
        "evil.example",
        "evil.example:8420",
        "localhost.evil.example",
        "127.0.0.1.evil.example",
        "localhost@evil.example",
        "evil.example@localhost",
        "localhost:80:80",
        "localhost:x",
        "127.0.0.1 evil.example",
        "192.168.1.7",
        "[::2]",
        "[::1",
        "",
        "/",
        "2130706433",
    ],
)
def test_a_name_that_was_let_point_here_is_refused(service: Running, host: str) -> None:
    for path in ("/", "/v1/policies", "/healthz", "/page/page.js"):
        response = service.client.get(path, headers={"Host": host})
        assert response.status_code in (400, 421), (host, path)
        assert response.headers["content-type"] == "application/problem+json"


@pytest.mark.parametrize(
    "host", ["localhost", "LOCALHOST:1", "127.0.0.1:8420", "127.1.2.3", "[::1]:8420", "localhost."]
)
def test_this_machine_may_be_called_in_several_ways(service: Running, host: str) -> None:
    assert service.client.get("/v1/policies", headers={"Host": host}).status_code == 200


@pytest.mark.parametrize(
    "origin",
    [
        "http://evil.example",
        "null",
        "http://127.0.0.1",
        "http://127.0.0.1:1",
        "http://localhost:{port}",
        "file://",
        "",
        "http://127.0.0.1:{port}.evil.example",
        "http://127.0.0.1:{port}/",
    ],
)
def test_pages_of_other_sites_are_refused(service: Running, origin: str) -> None:
    headers = {"Origin": origin.format(port=service.port)}
    problem(service.client.get("/v1/policies", headers=headers), 403, "foreign-origin")
    problem(service.client.post("/v1/jobs", headers=headers), 403, "foreign-origin")
    # No permission is given ahead of a request either.
    asked = {**headers, "Access-Control-Request-Method": "POST"}
    problem(service.client.options("/v1/jobs", headers=asked), 403, "foreign-origin")


def test_its_own_page_may_ask(service: Running) -> None:
    headers = {"Origin": f"http://127.0.0.1:{service.port}"}
    assert service.client.get("/v1/policies", headers=headers).status_code == 200


def test_two_hosts_are_none(service: Running) -> None:
    with service.connected() as made:
        made.sendall(b"GET /v1/policies HTTP/1.1\r\nHost: 127.0.0.1\r\nHost: evil.example\r\n\r\n")
        assert made.recv(100).split()[1] in (b"400", b"421")


@pytest.mark.parametrize(
    "header",
    [
        "",
        "Bearer",
        f"Bearer {TOKEN}x",
        f"Bearer {TOKEN[:-1]}",
        f"Basic {TOKEN}",
        TOKEN,
        f"Bearer {TOKEN.upper()}",
    ],
)
def test_a_wrong_token_opens_nothing(locked: Running, header: str) -> None:
    headers = {"Authorization": header}
    for method, path in (
        ("GET", "/v1/policies"),
        ("GET", "/metrics"),
        ("GET", "/openapi.json"),
        ("POST", "/v1/jobs"),
        ("GET", "/v1/jobs/x"),
        ("GET", "/nothing"),
        ("GET", "/page"),
    ):
        response = locked.client.request(method, path, headers=headers)
        found = problem(response, 401, "no-token")
        assert response.headers["www-authenticate"].startswith("Bearer")
        assert TOKEN not in str(found)


def test_a_token_that_is_not_ascii_is_wrong(locked: Running) -> None:
    headers = {"Authorization": "Bearer schlüssel".encode("latin-1")}
    problem(locked.client.get("/v1/policies", headers=headers), 401, "no-token")


def test_the_right_token_opens_everything(locked: Running) -> None:
    assert locked.client.get("/v1/policies").status_code == 200
    assert locked.client.get("/v1/policies", headers={"Authorization": f"bearer {TOKEN}"}).status_code == 200


def test_the_page_and_health_need_no_token(locked: Running) -> None:
    for path in ("/", "/page/page.js", "/healthz"):
        assert locked.client.get(path, headers={"Authorization": ""}).status_code == 200


def test_beyond_this_machine_addresses_and_known_names_are_right(locked: Running) -> None:
    for host in ("192.168.1.7:8420", "render-box", "127.0.0.1"):
        assert locked.client.get("/v1/policies", headers={"Host": host}).status_code == 200
    problem(locked.client.get("/v1/policies", headers={"Host": "evil.example"}), 421, "foreign-host")


def test_what_is_this_machine() -> None:
    assert all(map(is_loopback, ("127.0.0.1", "127.9.9.9", "::1", "[::1]", "localhost", "LocalHost")))
    assert not any(map(is_loopback, (ANYWHERE, "::", "192.168.0.1", "localhost.example", "", "example.org")))


def test_an_id_cannot_be_guessed(tmp_path: Path, model: Path) -> None:
    with running(Settings(state=tmp_path, model=model, readers=1), STRANGE) as up:
        ids = [up.job(b"work")["id"] for _ in range(5)]
        assert len(set(ids)) == 5
        # 192 random bits.
        assert all(len(one) == 32 for one in ids)
        for guess in (
            ids[0][:-1],
            ids[0] + "A",
            ids[0].swapcase(),
            "1",
            "%",
            "..",
            "' OR 1=1 --",
            "\ud7ff" * 9,
        ):
            for part in ("", "/events", "/result", "/annotated", "/report"):
                problem(up.client.get(f"/v1/jobs/{guess}{part}"), 404, "not-found")
        # Nor are they listed anywhere.
        problem(up.client.get("/v1/jobs"), 405, "bad-method")
