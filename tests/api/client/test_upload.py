from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import pytest

from api.client.errors import LevelFileError
from api.client.upload import level_upload
from tests.api.client.scripted_service import Asked


def gltf(folder: Path, *uris: Any) -> Path:
    path = folder / 'my "level".gltf'
    path.write_text(json.dumps({"buffers": [{"uri": uri} for uri in uris]}))
    return path


def parts(level: Path) -> list[tuple[str, str, bytes]]:
    upload = level_upload(level)
    body = b"".join(upload.chunks())
    assert len(body) == upload.length
    count = body.count(b"Content-Disposition")
    asked = Asked("POST", "/", {"content-type": upload.media_type}, body)
    return [asked.part(index) for index in range(count)]


def test_a_glb_goes_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "a.glb"
    path.write_bytes(b"glTF" + bytes(3_000_000))
    upload = level_upload(path)
    assert upload.media_type == "model/gltf-binary"
    assert b"".join(upload.chunks()) == path.read_bytes()
    assert upload.length == 3_000_004


def test_bytes_tell_what_they_are() -> None:
    assert level_upload(b"glTF...").media_type == "model/gltf-binary"
    assert level_upload(b"{}").media_type == "model/gltf+json"


def test_a_gltf_that_stands_alone_goes_alone(tmp_path: Path) -> None:
    upload = level_upload(gltf(tmp_path, "data:application/octet-stream;base64,AAAA"))
    assert upload.media_type == "model/gltf+json"


def test_a_gltf_takes_the_files_that_it_names_along(tmp_path: Path) -> None:
    (tmp_path / "data").mkdir()
    (tmp_path / "data/a b.bin").write_bytes(b"\r\n--x\0")
    (tmp_path / "c.bin").write_bytes(b"c" * 2_000_000)
    level = gltf(tmp_path, "data/a%20b.bin", "c.bin", "c.bin")
    first, second, third = parts(level)
    assert first == ("my %22level%22.gltf", "model/gltf+json", level.read_bytes())
    assert second == ("data/a b.bin", "application/octet-stream", b"\r\n--x\0")
    assert third[0] == "c.bin"
    assert third[2] == b"c" * 2_000_000


@pytest.mark.parametrize(
    "uri",
    [
        "../secret.bin",
        "%2e%2e/secret.bin",
        "a/../../secret.bin",
        "/etc/passwd",
        "file:///etc/passwd",
        "http://example.org/a.bin",
        "\\\\host\\share",
        "C:/a.bin",
        "a%00.bin",
        "missing.bin",
        "\ud800.bin",
        "",
    ],
)
def test_nothing_outside_the_level_s_folder_is_sent(uri: str, tmp_path: Path) -> None:
    (tmp_path / "secret.bin").write_bytes(b"secret")
    (tmp_path / "level").mkdir()
    with pytest.raises(LevelFileError):
        level_upload(gltf(tmp_path / "level", uri))


@pytest.mark.parametrize("text", ["", "[]", "{", '{"buffers": 3}', '{"buffers": [3]}', "[" * 100_000])
def test_what_is_no_gltf_is_told(text: str, tmp_path: Path) -> None:
    path = tmp_path / "a.gltf"
    path.write_text(text)
    with pytest.raises(LevelFileError, match="is not a glTF file"):
        level_upload(path)


@pytest.mark.parametrize("name", ["missing.glb", "missing.gltf", "."])
def test_a_file_that_is_not_there_is_told(name: str, tmp_path: Path) -> None:
    with pytest.raises(LevelFileError):
        level_upload(tmp_path / name)


def test_a_file_that_shrinks_meanwhile_is_told(tmp_path: Path) -> None:
    path = tmp_path / "a.glb"
    path.write_bytes(bytes(100))
    upload = level_upload(path)
    os.truncate(path, 50)
    with pytest.raises(LevelFileError, match="changed while"):
        list(upload.chunks())
