"""The same questions for every level format: a new one gets them by being in the folder."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from scenes.errors import LevelError
from scenes.formats.registry import PlacedFormat, annotated_suffix, format_of, level_formats, read_level
from scenes.level_output import write_level
from scenes.light_annotation import LightAnnotation

SAMPLES = Path(__file__).parent / "samples"
SUFFIXES = sorted(level_formats())
EVERY_KEY: dict[str, str | float | int | bool] = {
    "gnomon_technique": "SM",
    "gnomon_map_size": 1024,
    "gnomon_filter": "2x2",
    "gnomon_shadow_ms": 0.25,
    "gnomon_edge_error_px": 1.5,
    "gnomon_confidence": 0.9,
    "gnomon_source": "measured",
}
ADVICE = LightAnnotation(EVERY_KEY, {"technique": "SM", "reason": 'the "cheapest" é', "alternatives": []})
OTHER = LightAnnotation({"gnomon_technique": "SV"}, {"technique": "SV"})


@pytest.fixture(params=SUFFIXES)
def sample(request: pytest.FixtureRequest) -> Path:
    """A level with triangles, lights and cameras in every format."""
    path = SAMPLES / f"yard{request.param}"
    assert path.is_file(), f"Put a level with lights and a camera there: {path}."
    return path


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_files_that_are_none_are_refused(tmp_path: Path, suffix: str) -> None:
    (tmp_path / f"folder{suffix}").mkdir()
    (tmp_path / f"empty{suffix}").touch()
    (tmp_path / f"noise{suffix}").write_bytes(bytes(range(256)))
    level_format = format_of(tmp_path / f"noise{suffix}")
    for read in (read_level, level_format.read):
        for name in ("folder", "empty", "noise", "missing"):
            with pytest.raises(LevelError) as caught:
                read(tmp_path / f"{name}{suffix}")
            assert str(tmp_path / name) in caught.value.where
    for source in (b"", bytes(range(256))):
        for do in (
            level_format.clear,
            level_format.read_annotations,
            lambda source: level_format.annotate(source, {0: ADVICE}),
            lambda source: level_format.companions(source, tmp_path / f"level{suffix}"),
        ):
            with pytest.raises(LevelError):
                do(source)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_format_has_a_name_and_writes_its_suffixes_in_lower_case(suffix: str) -> None:
    assert level_formats()[suffix].NAME
    assert suffix.startswith(".")
    assert suffix == suffix.lower()


def test_the_sample_says_where_it_came_from(sample: Path) -> None:
    level = read_level(sample)
    assert level.path == sample
    assert level.format == level_formats()[sample.suffix].NAME
    assert level.scene.triangle_count
    assert level.scene.cameras
    nodes = [light.node for light in level.scene.lights]
    assert nodes
    assert None not in nodes
    assert len(set(nodes)) == len(nodes)


def test_a_level_is_annotated_and_restored(sample: Path, tmp_path: Path) -> None:
    level_format = format_of(sample)
    before = read_level(sample)
    lights = [light.node for light in before.scene.lights if light.node is not None]
    source = sample.read_bytes()
    annotated = level_format.annotate(source, dict.fromkeys(lights, ADVICE))
    assert annotated != source
    assert level_format.annotate(source, dict.fromkeys(lights, ADVICE)) == annotated
    assert level_format.annotate(annotated, dict.fromkeys(lights, ADVICE)) == annotated

    path = tmp_path / f"annotated{annotated_suffix(sample)}"
    assert path in write_level(sample, path, annotated, level_format)
    after = read_level(path)
    assert after.scene.digest == before.scene.digest
    assert [light.node for light in after.scene.lights] == lights

    # What is left of a layer says nothing; the level below it was never changed.
    layered = isinstance(level_format, PlacedFormat)
    original = level_format.annotate(source, {}) if layered else source
    cleared = level_format.clear(annotated)
    assert (cleared.data, cleared.restored) == (original, True)
    assert cleared.note
    assert level_format.clear(source).data == original
    assert sample.read_bytes() == source
    one = {lights[0]: OTHER}
    assert level_format.annotate(annotated, one) == level_format.annotate(source, one)


def test_what_is_annotated_can_be_read_and_carried_over(sample: Path) -> None:
    level_format = format_of(sample)
    source = sample.read_bytes()
    first, *others = (light.node for light in read_level(sample).scene.lights if light.node is not None)
    assert level_format.read_annotations(source) == {}
    earlier = {first: ADVICE, **dict.fromkeys(others, OTHER)}
    annotated = level_format.annotate(source, earlier)
    assert level_format.read_annotations(annotated) == earlier
    later = {**level_format.read_annotations(annotated), first: OTHER}
    assert level_format.annotate(annotated, later) == level_format.annotate(source, {**earlier, first: OTHER})
    assert level_format.read_annotations(level_format.clear(annotated).data) == {}


def test_every_key_is_written_for_every_light(sample: Path) -> None:
    level_format = format_of(sample)
    lights = [light.node for light in read_level(sample).scene.lights if light.node is not None]
    one = level_format.annotate(sample.read_bytes(), {lights[0]: ADVICE})
    every = level_format.annotate(sample.read_bytes(), dict.fromkeys(lights, ADVICE))
    for key in EVERY_KEY:
        # Formats spell keys in their own way: gnomon_map_size, gnomon:mapSize, gnomon:Bulb:mapSize.
        words = key.removeprefix("gnomon_").replace("_", "_?")
        spelled = re.compile(rf"gnomon[_:](?:\w+:)?{words}".encode(), re.IGNORECASE)
        assert len(spelled.findall(every)) == len(lights) * len(spelled.findall(one)) > 0


def test_a_node_that_is_not_there_is_refused(sample: Path) -> None:
    with pytest.raises(LevelError, match="no node 1000000"):
        format_of(sample).annotate(sample.read_bytes(), {1_000_000: ADVICE})


def test_another_scene_of_the_file_is_refused_by_name(sample: Path) -> None:
    with pytest.raises(LevelError) as caught:
        read_level(sample, "there is no such scene")
    assert "there is no such scene" in str(caught.value)
