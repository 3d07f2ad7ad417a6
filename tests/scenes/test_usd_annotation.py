"""Layers over USD levels: the level stays as it is, and what others wrote into a layer stays too."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from pxr import Sdf, Usd

from api.annotating import clear_level, target_of
from api.destinations import check_in_place, check_target
from scenes.errors import LevelError, OutputError
from scenes.formats.registry import format_of, read_level
from scenes.level_output import luggage, write_level
from scenes.light_annotation import LightAnnotation
from tests.scenes.usd_samples import written

SAMPLES = Path(__file__).parent / "samples"
MAP = LightAnnotation({"gnomon_technique": "SM", "gnomon_map_size": 1024}, {"reason": 'é "x"\n'})
VOLUME = LightAnnotation({"gnomon_technique": "SV"}, {"settings": {}, "alternatives": [1.5, None]})


@pytest.fixture
def level(tmp_path: Path) -> Path:
    return Path(shutil.copy(SAMPLES / "yard.usda", tmp_path / "yard.usda"))


def annotated(level: Path, what: dict[int, LightAnnotation], name: str = "yard.annotated.usda") -> Path:
    target = level.with_name(name)
    target.write_bytes(format_of(level).annotate(level.read_bytes(), what))
    return target


def test_a_layer_speaks_to_any_reader_of_usd(level: Path) -> None:
    layer = annotated(level, {2: MAP, 0: VOLUME})
    stage = Usd.Stage.Open(str(layer))
    sun = stage.GetPrimAtPath("/Yard/Sun")
    assert sun.GetAttribute("gnomon:technique").Get() == "SM"
    assert sun.GetAttribute("gnomon:mapSize").Get() == 1024
    assert sun.GetAttribute("gnomon:technique").IsCustom()
    assert sun.GetTypeName() == "DistantLight"
    assert stage.GetPrimAtPath("/Yard/PostLeft").GetAttribute("gnomon:Bulb:technique").Get() == "SV"
    assert stage.GetDefaultPrim().GetName() == "Yard"
    assert list(Sdf.Layer.FindOrOpen(str(layer)).subLayerPaths) == ["./yard.usda"]
    assert read_level(layer).scene.digest == read_level(level).scene.digest
    assert read_level(layer).format == "USD"


def test_a_layer_is_annotated_in_its_turn(level: Path) -> None:
    layer = annotated(level, {2: MAP, 0: VOLUME})
    other = format_of(layer)
    assert other.read_annotations(layer.read_bytes()) == {0: VOLUME, 2: MAP}
    again = other.annotate(layer.read_bytes(), {2: VOLUME})
    assert again == format_of(level).annotate(level.read_bytes(), {2: VOLUME})
    assert other.companions(layer.read_bytes(), layer) == (Path("yard.usda"),)
    assert format_of(level).companions(level.read_bytes(), level) == ()


def test_the_order_of_annotations_does_not_matter(level: Path) -> None:
    one, other = ({0: MAP, 3: VOLUME}, {3: VOLUME, 0: MAP})
    do = format_of(level).annotate
    assert do(level.read_bytes(), one) == do(level.read_bytes(), other)


def test_what_others_wrote_into_a_layer_stays(level: Path) -> None:
    layer = annotated(level, {2: MAP})
    stage = Usd.Stage.Open(str(layer))
    stage.GetPrimAtPath("/Yard/Sun").GetAttribute("inputs:intensity").Set(7.0)
    stage.GetRootLayer().Save()
    do = format_of(layer)
    for data in (do.annotate(layer.read_bytes(), {0: MAP}), do.clear(layer.read_bytes()).data):
        layer.write_bytes(data)
        assert next(one for one in read_level(layer).scene.lights if one.name == "Sun").intensity == 7.0
        assert 2 not in do.read_annotations(data)


def test_a_flattened_level_hides_nothing_stale(level: Path, tmp_path: Path) -> None:
    flat = tmp_path / "flat.usda"
    Usd.Stage.Open(str(annotated(level, {2: MAP, 4: MAP}))).Flatten().Export(str(flat))
    do = format_of(flat)
    assert do.read_annotations(flat.read_bytes()) == {2: MAP, 4: MAP}
    layer = do.annotate(flat.read_bytes(), {2: VOLUME})
    assert do.read_annotations(layer) == {2: VOLUME}
    cleared = do.clear(flat.read_bytes())
    assert do.read_annotations(cleared.data) == {}
    assert not cleared.restored
    assert "flat.usda" in cleared.note


def test_lights_in_references_are_annotated_over_the_level(tmp_path: Path) -> None:
    written(tmp_path, 'def Xform "Rig" { def SphereLight "L" { } }', name="rig.usda")
    path = written(
        tmp_path,
        'def "A" (references = @./rig.usda@</Rig>) { } def "B" (references = @./rig.usda@</Rig>) { }',
    )
    do, source = format_of(path), path.read_bytes()
    layer = do.annotate(source, {0: MAP, 1: VOLUME})
    assert do.read_annotations(layer) == {0: MAP, 1: VOLUME}
    assert do.companions(source, path) == (Path("rig.usda"),)
    assert do.companions(layer, path) == (Path("level.usda"), Path("rig.usda"))


def test_another_folder_gets_the_level_and_its_layers(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "out").mkdir()
    written(tmp_path, 'def SphereLight "L" { }', name="outside.usda")
    path = written(tmp_path / "in", 'def "A" (references = @../outside.usda@</L>) { }')
    do = format_of(path)
    layer = do.annotate(path.read_bytes(), {0: MAP})
    target = tmp_path / "out" / "done.usda"
    assert write_level(path, target, layer, do) == (tmp_path / "out/level.usda", target)
    assert read_level(target).scene.digest == read_level(path).scene.digest
    assert luggage(path, tmp_path / "out/deep.usda", layer, do).left_behind == ()
    (note,) = (note for note in read_level(path).notes if "outside its folder" in note.text)
    assert "outside.usda" in note.text


def test_a_layer_without_its_level_is_refused(level: Path) -> None:
    layer = annotated(level, {2: MAP})
    level.unlink()
    with pytest.raises(LevelError, match=r"yard\.usda"):
        read_level(layer)


def test_the_level_itself_is_never_written(level: Path) -> None:
    before = level.read_bytes()
    assert target_of(level.with_suffix(".usdc"), None, in_place=False) == level.with_name(
        "yard.annotated.usda"
    )
    with pytest.raises(OutputError, match="never changed"):
        check_in_place(level, before, format_of(level))
    with pytest.raises(OutputError, match=r"ending in \.usda"):
        check_target(level, level.with_name("out.usdc"), format_of(level))
    other = written(level.parent, "", name="other.usda")
    with pytest.raises(OutputError, match="no annotated level"):
        check_target(level, other, format_of(level))
    layer = annotated(level, {2: MAP})
    check_target(level, layer, format_of(level))
    check_in_place(layer, layer.read_bytes(), format_of(layer))
    with pytest.raises(OutputError, match="never changed"):
        clear_level(level, level, in_place=True)
    done = clear_level(layer, layer, in_place=True)
    assert done.restored
    assert done.written
    assert format_of(layer).read_annotations(layer.read_bytes()) == {}
    assert not clear_level(layer, layer, in_place=True).written
    assert level.read_bytes() == before


def test_names_need_no_care(tmp_path: Path) -> None:
    path = Path(shutil.copy(SAMPLES / "yard.usdc", tmp_path / "höf @ 'x' (1).usdc"))
    layer = path.with_name("höf.annotated.usda")
    layer.write_bytes(format_of(path).annotate(path.read_bytes(), {2: MAP}))
    assert format_of(layer).read_annotations(layer.read_bytes()) == {2: MAP}
