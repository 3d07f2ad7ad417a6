"""Each light gets the answer that was given for its own node."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import bpy
import pytest
from node_service import light_nodes, node_service
from small_scenes import activate, add_light, add_room, answered, module, preferences, told

pytestmark = pytest.mark.usefixtures("gnomon")


def reasons() -> dict[str, str]:
    """What was said of each light that has an answer."""
    found = {}
    for uid, detail in module("session").SESSION.details.items():
        light = module("scene_lights").light_by_uid(uid)
        found[light.name] = detail.words
    return found


def recommended() -> str:
    assert bpy.ops.gnomon.recommend_scene() == {"FINISHED"}
    return answered()


def test_the_properties_are_those_of_a_level_file() -> None:
    add_room()
    lamp = add_light("Lamp")
    lamp["gnomon_mobility"], lamp["mine"] = "static", 1
    with node_service() as service:
        preferences().url = service.url
        words = recommended()
    (node,) = light_nodes(service.asked[0].body).values()
    assert node["extras"]["gnomon_mobility"] == "static"
    time = lamp["gnomon_shadow_ms"]
    assert told(lamp) == {
        "gnomon_mobility": "static",
        "gnomon_technique": "SM",
        "gnomon_map_size": 512,
        "gnomon_filter": "2x2",
        "gnomon_focus": "light",
        "gnomon_shadow_ms": time,
        "gnomon_edge_error_px": 0.75,
        "gnomon_confidence": 0.8,
        "gnomon_source": "predicted",
    }
    assert lamp["mine"] == 1
    assert words == "1 light recommended for balanced."


def test_names_that_the_exporter_may_change() -> None:
    add_room()
    names = ["Lamp", "Lamp.001", "Lämp/\"'", "x" * 63, "Lamp_Orientation"]
    for index, name in enumerate(names):
        add_light(name, ("POINT", "SPOT", "SUN")[index % 3])
    with node_service() as service:
        preferences().url = service.url
        recommended()
    assert reasons() == {name: f"This is {name}." for name in names}


def test_lights_that_share_their_data_and_lights_with_parents() -> None:
    add_room()
    first, second = add_light("First"), add_light("Second")
    second.data = first.data
    second.parent = first
    bone_like = bpy.data.objects.new("Post", None)
    bpy.context.scene.collection.objects.link(bone_like)
    first.parent = bone_like
    with node_service() as service:
        preferences().url = service.url
        recommended()
    assert reasons() == {"First": "This is First.", "Second": "This is Second."}


def test_a_light_that_is_asked_about_alone_leaves_the_others_as_they_are() -> None:
    add_room()
    first, second = add_light("First"), add_light("Second")
    activate(second)
    with node_service() as service:
        preferences().url = service.url
        preferences().policy = "quality"
        assert bpy.ops.gnomon.recommend_light() == {"FINISHED"}
        answered()
    assert told(first) == {}
    assert told(second)["gnomon_technique"] == "SM"
    node = next(
        index for index, node in light_nodes(service.asked[0].body).items() if node["name"] == "Second"
    )
    assert f"light=node%3A{node}" in service.asked[0].target
    assert "policy=quality" in service.asked[0].target


def test_instances_of_a_light_share_its_answer() -> None:
    add_room()
    collection = bpy.data.collections.new("Lantern")
    lamp = add_light("Lamp", collection=collection)
    for index in range(3):
        instance = bpy.data.objects.new(f"Instance {index}", None)
        instance.instance_type, instance.instance_collection = "COLLECTION", collection
        instance.location = (index, 0, 0)
        bpy.context.scene.collection.objects.link(instance)
    bpy.context.view_layer.update()
    with node_service() as service:
        preferences().url = service.url
        recommended()
    nodes = light_nodes(service.asked[0].body)
    assert len(nodes) == 3
    assert lamp["gnomon_shadow_ms"] == max(nodes) + 1
    assert reasons() == {"Lamp": "This is Lamp. The light has 3 instances; all alike."}


def test_lights_that_do_not_go_into_a_level_are_named() -> None:
    add_room()
    add_light("Lamp")
    add_light("Hidden while working").hide_viewport = True
    add_light("Off").hide_render = True
    add_light("Softbox", "AREA")
    off = bpy.data.collections.new("Helpers")
    bpy.context.scene.collection.children.link(off)
    off.hide_render = True
    add_light("Helper", collection=off)
    with node_service() as service:
        preferences().url = service.url
        words = recommended()
    assert set(reasons()) == {"Lamp", "Hidden while working"}
    assert words == (
        "2 lights recommended for balanced. Left out, as glTF has no area lights: Softbox. "
        "Left out, as they are switched off in renders: Off, Helper."
    )
    for name in ("Off", "Softbox", "Helper"):
        activate(bpy.data.objects[name])
        assert not bpy.ops.gnomon.recommend_light.poll()


def test_a_light_of_another_scene_is_told() -> None:
    add_room()
    add_light("Lamp")
    away = add_light("Away", collection=bpy.data.scenes.new("Elsewhere").collection)
    with (
        bpy.context.temp_override(object=away),
        pytest.raises(RuntimeError, match="Away is not in this scene"),
    ):
        bpy.ops.gnomon.recommend_light()


def test_excluded_collections_are_part_of_a_level_as_in_blender_s_own_export() -> None:
    add_room()
    collection = bpy.data.collections.new("Variant")
    bpy.context.scene.collection.children.link(collection)
    add_light("Away", collection=collection)
    bpy.context.view_layer.layer_collection.children["Variant"].exclude = True
    with node_service() as service:
        preferences().url = service.url
        recommended()
    assert reasons() == {"Away": "This is Away."}


def test_a_scene_without_lights_is_told() -> None:
    add_room()
    add_light("Softbox", "AREA")
    with pytest.raises(RuntimeError, match="no light that glTF can hold"):
        bpy.ops.gnomon.recommend_scene()


def test_a_library_s_light_of_the_same_name_is_another_light(tmp_path: Path) -> None:
    lamp = add_light("Lamp", at=(5, 5, 5))
    library = tmp_path / "library.blend"
    bpy.data.libraries.write(str(library), {lamp})
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    add_room()
    own = add_light("Lamp")
    with bpy.data.libraries.load(str(library), link=True) as (source, target):
        target.objects = source.objects
    (linked,) = target.objects
    bpy.context.scene.collection.objects.link(linked)
    bpy.context.view_layer.update()
    with node_service() as service:
        preferences().url = service.url
        words = recommended()
    assert [node["name"] for node in light_nodes(service.asked[0].body).values()] == ["Lamp", "Lamp"]
    assert told(own)["gnomon_technique"] == "SM"
    assert told(linked) == {}
    assert "Lamp is linked from a library and cannot be changed here." in words


def test_lights_are_found_again_by_whatever_name_they_have_then() -> None:
    add_room()
    first, second, third = add_light("First"), add_light("Second"), add_light("Third")
    with node_service() as service:
        preferences().url = service.url
        bpy.ops.gnomon.recommend_scene()
        first.name, second.name = "Second", "First"
        bpy.data.objects.remove(third)
        words = answered()
    assert {module("scene_lights").light_by_uid(one.session_uid) for one in (first, second)} == {
        first,
        second,
    }
    assert sorted(reasons().values()) == ["This is First.", "This is Second."]
    assert module("session").SESSION.details[first.session_uid].words == "This is First."
    assert words == "2 lights recommended for balanced. A light is gone meanwhile."


def test_an_answer_for_a_file_that_was_closed_changes_nothing() -> None:
    add_room()
    add_light("Lamp")
    with node_service() as service:
        preferences().url = service.url
        bpy.ops.gnomon.recommend_scene()
        bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
        other = add_light("Lamp")
        words = answered()
    assert told(other) == {}
    assert words == "No light has a recommendation. A light is gone meanwhile."


def test_a_light_without_an_answer_loses_the_old_one() -> None:
    add_room()
    lamp = add_light("Lamp")
    with node_service() as service:
        preferences().url = service.url
        recommended()
    assert told(lamp)
    with node_service(problem="It lights nothing.") as service:
        preferences().url = service.url
        words = recommended()
    assert told(lamp) == {}
    assert words == "No light has a recommendation. Lamp: It lights nothing."


def test_nobody_else_s_export_is_marked(tmp_path: Path, gnomon: ModuleType) -> None:
    add_light("Lamp")
    path = tmp_path / "mine.glb"
    bpy.ops.export_scene.gltf(filepath=str(path), export_lights=True, export_extras=True)
    (node,) = light_nodes(path.read_bytes()).values()
    assert "extras" not in node
    assert hasattr(gnomon, "glTF2ExportUserExtension")
