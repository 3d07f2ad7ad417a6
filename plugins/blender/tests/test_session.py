"""Asking in the background: nothing blocks, everything can be cancelled and undone, nothing stays behind."""

from __future__ import annotations

import sys
import tempfile
import threading
from pathlib import Path
from types import ModuleType
from typing import Any

import bpy

# isort: split
import addon_utils  # bpy brings it along

# isort: split
import pytest
from node_service import node_service
from small_scenes import NAME, activate, add_light, add_room, answered, module, preferences, told
from tests.api.client.scripted_service import answer, problem, scripted, silent


@pytest.fixture
def lamp(gnomon: ModuleType) -> bpy.types.Object:  # noqa: ARG001  a fixture of a fixture
    add_room()
    found = add_light("Lamp")
    activate(found)
    return found


def test_asking_returns_before_the_answer_and_can_be_cancelled(lamp: bpy.types.Object) -> None:
    with scripted(silent) as service:
        preferences().url = service.url
        assert bpy.ops.gnomon.recommend_scene() == {"FINISHED"}
        session = module("session").SESSION
        assert session.question is not None
        assert session.status == f"Asking {service.url} ..."
        assert module("session").poll() == module("session").POLL_S
        assert not bpy.ops.gnomon.recommend_scene.poll()
        assert not bpy.ops.gnomon.recommend_light.poll()
        assert bpy.ops.gnomon.cancel() == {"FINISHED"}
        assert answered() == "Cancelled."
        assert not session.failed
    assert told(lamp) == {}
    assert not bpy.ops.gnomon.cancel.poll()
    assert bpy.ops.gnomon.recommend_scene.poll()


@pytest.mark.parametrize(
    ("script", "words"),
    [
        (b"", "cannot be reached"),
        (b"garbage\r\n\r\n", "does not speak HTTP"),
        (answer("<html>", kind="text/html"), "is that the service?"),
        (answer("{}"), "The answer has no level."),
        (problem(422, "It has no triangles."), "It has no triangles."),
        (problem(401, "A token is needed."), "A token is needed. Set the token in the add-on's preferences."),
    ],
)
def test_what_is_no_answer_is_a_sentence(script: bytes, words: str, lamp: bpy.types.Object) -> None:
    with scripted(script) as service:
        preferences().url = service.url
        bpy.ops.gnomon.recommend_scene()
        assert words in answered()
    assert module("session").SESSION.failed
    assert told(lamp) == {}


def test_a_service_that_is_not_there_is_a_sentence(lamp: bpy.types.Object) -> None:
    preferences().url = "http://127.0.0.1:9"
    bpy.ops.gnomon.recommend_light()
    assert answered() == "Nobody answers at http://127.0.0.1:9. Start it with `gnomon serve`."
    with pytest.raises(RuntimeError, match="Nobody answers"):
        bpy.ops.gnomon.recommend_light(wait=True)
    assert told(lamp) == {}


def test_an_answer_that_takes_too_long_is_a_sentence(lamp: bpy.types.Object) -> None:
    with scripted(silent) as service:
        preferences().url, preferences().timeout_s = service.url, 1
        bpy.ops.gnomon.recommend_light()
        assert "1 s" in answered() or "too long" in module("session").SESSION.status
    assert told(lamp) == {}


def test_only_this_machine_is_asked_without_online_access(lamp: bpy.types.Object) -> None:
    assert not bpy.app.online_access
    preferences().url = "http://gnomon.example.org:8420"
    with pytest.raises(
        RuntimeError, match=r"gnomon\.example\.org is not this machine, and Blender may not go"
    ):
        bpy.ops.gnomon.recommend_scene()
    assert module("session").SESSION.question is None
    preferences().url = "nonsense"
    with pytest.raises(RuntimeError, match="The address nonsense is none like"):
        bpy.ops.gnomon.recommend_scene()
    assert told(lamp) == {}


def test_the_token_is_sent(lamp: bpy.types.Object) -> None:
    with node_service() as service:
        preferences().url, preferences().token = service.url, "s3cret"
        assert bpy.ops.gnomon.recommend_scene(wait=True) == {"FINISHED"}
    assert service.asked[0].headers["authorization"] == "Bearer s3cret"
    assert told(lamp)
    preferences().token = "two words"  # noqa: S105  no secret
    with pytest.raises(RuntimeError, match="token holds characters"):
        bpy.ops.gnomon.recommend_scene()


def test_it_can_be_undone_and_done_again(lamp: bpy.types.Object) -> None:
    uid = lamp.session_uid
    bpy.ops.ed.undo_push(message="before")
    with node_service() as service:
        preferences().url = service.url
        bpy.ops.gnomon.recommend_scene(wait=True)
    # After an undo, Blender's data is new: the light is looked up again.
    find = module("scene_lights").light_by_uid
    assert told(find(uid))["gnomon_technique"] == "SM"
    bpy.ops.ed.undo()
    assert told(find(uid)) == {}
    bpy.ops.ed.redo()
    assert told(find(uid))["gnomon_technique"] == "SM"
    bpy.ops.gnomon.clear()
    bpy.ops.ed.undo_push(message="cleared")
    assert told(find(uid)) == {}
    bpy.ops.ed.undo()
    assert told(find(uid))["gnomon_technique"] == "SM"


def test_clearing_takes_away_what_is_gnomon_s(lamp: bpy.types.Object) -> None:
    other = add_light("Other")
    lamp["gnomon_mobility"] = "static"
    with node_service() as service:
        preferences().url = service.url
        bpy.ops.gnomon.recommend_scene(wait=True)
    assert bpy.ops.gnomon.clear(only_active=True) == {"FINISHED"}
    assert told(lamp) == {"gnomon_mobility": "static"}
    assert told(other)
    assert bpy.ops.gnomon.clear() == {"FINISHED"}
    assert told(other) == {}
    assert bpy.ops.gnomon.clear() == {"CANCELLED"}


def test_nothing_stays_behind(lamp: bpy.types.Object) -> None:
    def files() -> set[Path]:
        places = {Path(tempfile.gettempdir()), Path(bpy.app.tempdir or tempfile.gettempdir())}
        return {path for place in places for path in place.glob("gnomon-*.glb")} | {
            path for place in places for path in place.glob("gnomon-*/level.glb")
        }

    before = files()
    with node_service() as service:
        preferences().url = service.url
        bpy.ops.gnomon.recommend_scene(wait=True)
    values = told(lamp)
    with scripted(silent) as service:
        preferences().url = service.url
        bpy.ops.gnomon.recommend_scene()
        poll = module("session").poll
        assert [one for one in threading.enumerate() if one.name == "gnomon"]
        addon_utils.disable(NAME, default_set=True)
        assert [one for one in threading.enumerate() if one.name == "gnomon"] == []
    assert not bpy.app.timers.is_registered(poll)
    assert files() == before
    assert [name for name in dir(bpy.types) if "gnomon" in name.lower()] == []
    assert [name for name in dir(bpy.ops.gnomon) if not name.startswith("_")] == []
    assert NAME not in bpy.context.preferences.addons
    # What lights were told is the user's.
    assert told(lamp) == values
    addon_utils.enable(NAME, default_set=True)
    assert bpy.ops.gnomon.recommend_scene.poll()


class Recorder:
    """A layout that remembers what is drawn."""

    def __init__(self, words: list[str]) -> None:
        self.words = words

    def label(self, *, text: str = "", icon: str = "NONE") -> None:
        assert icon in bpy.types.UILayout.bl_rna.functions["label"].parameters["icon"].enum_items
        self.words.append(text)

    def operator(self, name: str, *, text: str = "", icon: str = "NONE") -> Any:
        assert icon in bpy.types.UILayout.bl_rna.functions["label"].parameters["icon"].enum_items
        operator = getattr(bpy.ops.gnomon, name.partition(".")[2])
        self.words.append(f"[{text or operator.get_rna_type().name}]")
        return type("Properties", (), {})()

    def prop(self, owner: Any, name: str) -> None:
        assert name in owner.bl_rna.properties
        self.words.append(f"<{name}>")

    def column(self, *, align: bool = False) -> Recorder:  # noqa: ARG002  Blender's signature
        return self

    def split(self, *, factor: float = 0.0) -> Recorder:  # noqa: ARG002  Blender's signature
        return self

    def box(self) -> Recorder:
        return self


def drawn(*, scene: bool) -> list[str]:
    words: list[str] = []
    module("panels").draw(Recorder(words), bpy.context, scene=scene)
    return words


def test_the_panels_tell_what_lights_were_told(lamp: bpy.types.Object) -> None:
    assert drawn(scene=True) == [
        *("<policy>", "[Recommend This Light]", "[Recommend the Scene]", "Lamp", "[Clear the Scene]")
    ]
    with node_service() as service:
        preferences().url = service.url
        bpy.ops.gnomon.recommend_scene(wait=True)
    time = f"{lamp['gnomon_shadow_ms']} ms"
    assert drawn(scene=False) == [
        *("<policy>", "[Recommend This Light]", "1 light recommended for", "balanced.", "Lamp"),
        *("Technique", "SM", "Map", "512 2x2 light", "Time", time, "Error", "0.75 px"),
        *("Confidence", "80%", "Source", "predicted", "This is Lamp.", "[Clear]"),
    ]
    lamp["gnomon_technique"] = "SV"
    assert "Ask again to see why." in drawn(scene=True)
    # Anybody may write anything into a custom property.
    lamp["gnomon_confidence"], lamp["gnomon_shadow_ms"] = "high", [1, 2]
    assert "Technique" in drawn(scene=True)
    bpy.context.view_layer.objects.active = None
    assert "Technique" not in drawn(scene=True)


def test_the_panels_tell_what_is_in_the_way(lamp: bpy.types.Object) -> None:
    with scripted(silent) as service:
        preferences().url = service.url
        bpy.ops.gnomon.recommend_scene()
        assert "[Cancel]" in drawn(scene=True)
        bpy.ops.gnomon.cancel()
        answered()
    lamp.data.type = "AREA"
    assert "glTF has no area lights." in " ".join(drawn(scene=False))


def test_a_tool_tip_says_why_a_button_is_grey(lamp: bpy.types.Object) -> None:
    assert bpy.ops.gnomon.recommend_light.poll()
    bpy.context.view_layer.objects.active = bpy.data.objects["Cube"]
    assert not bpy.ops.gnomon.recommend_light.poll()
    bpy.ops.object.mode_set(mode="EDIT")
    assert not bpy.ops.gnomon.recommend_scene.poll()
    bpy.ops.object.mode_set(mode="OBJECT")
    assert bpy.ops.gnomon.recommend_scene.poll()
    assert lamp.name in bpy.data.objects


def test_modules_are_those_that_were_installed(gnomon: ModuleType) -> None:
    assert gnomon.__file__ is not None
    assert Path(gnomon.__file__).parent.name == "gnomon"
    assert f"{NAME}.client.service" in sys.modules
    assert "api" not in sys.modules or not hasattr(sys.modules["api"], "service")
