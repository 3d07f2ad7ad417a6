"""The whole chain: a scene in Blender, `gnomon serve`, and properties on lights."""

from __future__ import annotations

import os
import socket
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import bpy
import pytest
from small_scenes import activate, add_light, add_room, answered, module, preferences, told

ROOT = Path(__file__).parents[3]
TOKEN = "t0ken-of-a-test-that-is-long"  # noqa: S105  no secret
TECHNIQUES = {"SM", "PSM", "SV", "Chan"}

pytestmark = pytest.mark.usefixtures("gnomon")


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The shipped model, or one that is trained from made-up evidence where there is none yet."""
    code = "from models.shipped import SHIPPED_MODEL; print(SHIPPED_MODEL)"
    shipped = Path(gnomon_python("-c", code))
    if shipped.exists():
        return shipped
    folder = tmp_path_factory.mktemp("model")
    gnomon_python(
        "-c",
        "import sys; from pathlib import Path; from tests.selector.learning_evidence import filled; "
        "filled(Path(sys.argv[1]))",
        str(folder / "store.sqlite"),
    )
    path = folder / "made.model"
    gnomon_python(
        "-m", "api.cli.main", "train", "--store", str(folder / "store.sqlite"), "--quick", "-o", str(path)
    )
    return path


def gnomon_python(*arguments: str) -> str:
    """Runs Gnomon's own Python; what it printed."""
    command = [ROOT / ".venv/bin/python", *arguments]
    done = subprocess.run(command, cwd=ROOT, env=environment(), check=True, capture_output=True, text=True)
    return done.stdout.strip()


def environment() -> dict[str, str]:
    return {**os.environ, "PYTHONPATH": str(ROOT), "GNOMON_TOKEN": TOKEN}


@pytest.fixture(scope="module")
def service(model: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The address of a service that runs."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port = listener.getsockname()[1]
    folder = tmp_path_factory.mktemp("service")
    command = [
        *(ROOT / ".venv/bin/python", "-m", "api.cli.main", "serve", "--port", str(port)),
        *("--model", str(model), "--state", str(folder / "state")),
    ]
    with (
        (folder / "log").open("w") as log,
        subprocess.Popen(command, cwd=ROOT, env=environment(), stdout=log, stderr=log) as process,
    ):
        try:
            wait_until_ready(f"http://127.0.0.1:{port}", process, folder / "log")
            yield f"http://127.0.0.1:{port}"
        finally:
            process.terminate()
            process.wait(timeout=60)


def wait_until_ready(url: str, process: subprocess.Popen[bytes], log: Path) -> None:
    asking, errors = module("client.service"), module("client.errors")
    end = time.monotonic() + 120
    while True:
        try:
            asking.Service(url, token=TOKEN).ready()
        except errors.ClientError:
            assert process.poll() is None, log.read_text()
            assert time.monotonic() < end, log.read_text()
            time.sleep(0.2)
        else:
            return


def test_every_light_is_told(service: str) -> None:
    add_room()
    lights = [
        add_light("Lamp", "POINT", at=(2, -2, 4)),
        add_light("Spot", "SPOT", at=(-1, 0, 5)),
        add_light("Sun", "SUN", at=(0, 0, 9)),
    ]
    add_light("Softbox", "AREA")
    preferences().url, preferences().token, preferences().policy = service, TOKEN, "speed"
    bpy.ops.gnomon.recommend_scene()
    words = answered()
    assert words.startswith("3 lights recommended for speed."), words
    assert "glTF has no area lights: Softbox" in words
    for light in lights:
        found = told(light)
        assert found["gnomon_technique"] in TECHNIQUES
        assert found["gnomon_shadow_ms"] > 0
        assert 0 <= found["gnomon_confidence"] <= 1
        assert found["gnomon_source"] == "predicted"
        assert module("session").SESSION.details[light.session_uid].words


def test_one_light_is_told_alone(service: str) -> None:
    add_room()
    lamp, other = add_light("Lamp", at=(2, -2, 4)), add_light("Other", at=(-2, -2, 4))
    activate(lamp)
    preferences().url, preferences().token = service, TOKEN
    assert bpy.ops.gnomon.recommend_light(wait=True) == {"FINISHED"}
    assert told(lamp)
    assert told(other) == {}


def test_an_answer_survives_the_way_into_a_level(service: str, tmp_path: Path) -> None:
    add_room()
    lamp = add_light("Lamp", at=(2, -2, 4))
    preferences().url, preferences().token = service, TOKEN
    bpy.ops.gnomon.recommend_scene(wait=True)
    values = told(lamp)
    path = str(tmp_path / "level.glb")
    bpy.ops.export_scene.gltf(filepath=path, export_lights=True, export_extras=True)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    bpy.ops.import_scene.gltf(filepath=path)
    assert told(bpy.data.objects["Lamp"]) == values


def test_a_wrong_token_and_a_scene_without_triangles_are_sentences(service: str) -> None:
    add_light("Lamp")
    preferences().url = service
    with pytest.raises(RuntimeError, match="Set the token in the add-on's preferences"):
        bpy.ops.gnomon.recommend_scene(wait=True)
    preferences().token = TOKEN
    with pytest.raises(RuntimeError, match="no triangles"):
        bpy.ops.gnomon.recommend_scene(wait=True)
