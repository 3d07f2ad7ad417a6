"""Broken .map files: each is refused with its place and a remedy, or read with a note."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenes.errors import LevelError
from scenes.formats import quake_map
from scenes.light_annotation import LightAnnotation
from scenes.quake import map_parser, meshes
from tests.scenes.quake_samples import CUBE, WORLD, box, entity, face, read

GOOD = "( 0 0 0 ) ( 0 1 0 ) ( 1 0 0 ) wall 0 0 0 1 1"


def world(line: str) -> str:
    return f'{{\n"classname" "worldspawn"\n{{\n{GOOD}\n{line}\n}}\n}}\n'


# Text, line and part of the message.
TEXTS = {
    "nothing but blanks": (" \n\n ", 1, "holds no entity"),
    "only a comment": ("// a map\n", 1, "holds no entity"),
    "a pointer to a file": ("oid sha256:123\n", 1, "must begin here"),
    "a closing brace first": ("}\n", 1, "must begin here"),
    "a key outside": ('"classname" "light"\n', 1, "must begin here"),
    "a face outside": (GOOD, 1, "must begin here"),
    "an entity without end": ('{\n"classname" "light"\n', 1, "ends inside this entity"),
    "only a brace": ("{", 1, "ends inside this entity"),
    "a brush without end": (WORLD + '{\n"a" "b"\n{\n' + GOOD, 14, "ends inside this brush"),
    "a brace too many": (WORLD + "}\n", 12, "must begin here"),
    "a patch without end": ("{\n{\npatchDef2\n{\n( 1 2 3 )\n", 3, "ends inside this patchDef2"),
    "a quote that is open": ('{\n"classname" "light\n}\n', 2, "not closed on its line"),
    "a key that is open": ('{\n"classname\n}\n', 2, "not closed on its line"),
    "a key without value": ('{\n"classname"\n}\n', 2, "has no value"),
    "a key before a brush": (f'{{\n"classname"\n{{\n{GOOD}\n}}\n}}\n', 2, "has no value"),
    "a word for a key": ("{\nclassname light\n}\n", 2, "A key in quotes"),
    "a face in an entity": (f"{{\n{GOOD}\n}}\n", 2, "A key in quotes"),
    "a stray parenthesis": ("{\n)\n}\n", 2, "A key in quotes"),
    "a key in a brush": (world('"a" "b"'), 5, "must be here"),
    "a brush in a brush": (world("{"), 5, "must be here"),
    "a word in a brush": (world("nonsense"), 5, "must be here"),
    "NaN in a plane": (world(GOOD.replace("1", "nan", 1)), 5, "no face"),
    "infinity in a plane": (world(GOOD.replace("1", "inf", 1)), 5, "no face"),
    "hexadecimal": (world(GOOD.replace("1", "0x10", 1)), 5, "no face"),
    "a comma": (world(GOOD.replace("1", "1,5", 1)), 5, "no face"),
    "two numbers": (world("( 0 0 ) ( 0 1 0 ) ( 1 0 0 ) wall 0 0 0 1 1"), 5, "no face"),
    "four numbers": (world("( 0 0 0 0 ) ( 0 1 0 ) ( 1 0 0 ) wall 0 0 0 1 1"), 5, "no face"),
    "two points": (world("( 0 0 0 ) ( 0 1 0 ) wall 0 0 0 1 1"), 5, "no face"),
    "four points": (world("( 0 0 0 ) ( 0 1 0 ) ( 1 0 0 ) ( 1 1 1 ) wall"), 5, "no face"),
    "no texture": (world("( 0 0 0 ) ( 0 1 0 ) ( 1 0 0 )"), 5, "no face"),
    "an open texture": (world('( 0 0 0 ) ( 0 1 0 ) ( 1 0 0 ) "wall 0 0'), 5, "no face"),
    "an open point": (world("( 0 0 0 "), 5, "no face"),
    "a huge number": (world(GOOD.replace("1", "1e300", 1)), 3, "farther than"),
    "a number beyond floats": (world(GOOD.replace("1", "9" * 400, 1)), 3, "farther than"),
    "no brush with a volume": (world(""), 3, "No brush of this level has a volume"),
    "a brush of 600 faces": (world("\n".join([GOOD] * 600)), 3, "601 faces"),
    "an origin of two numbers": (WORLD + entity(classname="light", origin="0 0"), 12, '"origin" must hold 3'),
    "an origin of words": (WORLD + entity(classname="light", origin="a b c"), 12, '"origin" must hold 3'),
    "an origin of NaN": (WORLD + entity(classname="light", origin="0 0 nan"), 12, '"origin" must hold 3'),
    "an origin far away": (WORLD + entity(classname="light", origin="0 0 1e99"), 12, '"origin" must hold 3'),
    "an endless origin": (WORLD + entity(classname="light", origin="0 0 1e999"), 12, '"origin" must hold 3'),
    "brightness in words": (WORLD + entity(classname="light", light="bright"), 12, "1 or 3 or 4 numbers"),
    "brightness of two": (WORLD + entity(classname="light", light="1 2"), 12, "1 or 3 or 4 numbers"),
    "a wait of NaN": (WORLD + entity(classname="light", wait="nan"), 12, '"wait" must hold 1 number'),
    "a mangle of one": (WORLD + entity(classname="light", mangle="90"), 12, '"mangle" must hold 3'),
    "a color of one": (WORLD + entity(classname="light", _color="red"), 12, '"_color" must hold 3'),
    "a start of words": (WORLD + entity(classname="info_player_start", origin="here"), 12, '"origin" must'),
    "an angle of words": (
        WORLD + entity(classname="info_player_start", origin="0 0 0", angle="up"),
        12,
        '"angle" must hold 1',
    ),
}


@pytest.mark.parametrize("name", TEXTS)
def test_broken_text_is_refused_with_its_line(tmp_path: Path, name: str) -> None:
    text, line, words = TEXTS[name]
    with pytest.raises(LevelError) as caught:
        read(tmp_path, text)
    assert words in caught.value.what
    assert caught.value.where.split(", ")[0] == str(tmp_path / "level.map")
    assert caught.value.where.split(", ")[1] == f"line {line}"
    assert caught.value.known or "ends inside" in caught.value.what
    assert caught.value.remedy
    assert len(str(caught.value)) < 700


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"\x7fELF\2\1\1" + bytes(100), "must begin here"),
        (b"PK\3\4" + bytes(range(256)), "must begin here"),
        (b"glTF\2\0\0\0", "must begin here"),
        (b"IBSP\x2e\0\0\0" + bytes(64), "must begin here"),
        (WORLD.encode("utf-16"), "UTF-16"),
        (("\ufeff" + WORLD).encode("utf-16-be"), "UTF-16"),
        (WORLD.encode("utf-16-le"), "UTF-16"),
        (b"{\0\0\0", "ends inside this entity"),
        (WORLD.encode() + b"{\0}", "A key in quotes"),
        (b"version https://git-lfs.github.com/spec/v1\n", "git LFS pointer"),
    ],
)
def test_other_files_are_refused(tmp_path: Path, content: bytes, words: str) -> None:
    with pytest.raises(LevelError) as caught:
        read(tmp_path, content)
    assert words in caught.value.what
    assert str(tmp_path) in caught.value.where


def test_text_of_one_byte_to_a_character_is_read_as_quake_has_it(tmp_path: Path) -> None:
    text = WORLD + entity(classname="light", origin="0 0 0", message="\xd1\xec\xe9")
    latin = read(tmp_path, text.encode("latin-1"))
    assert latin.scene.digest == read(tmp_path, text).scene.digest


def test_more_faces_than_can_be_drawn_are_refused_where_they_begin(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(map_parser, "MOST_FACES", 8)
    with pytest.raises(LevelError, match="more than 8 brush faces") as caught:
        read(tmp_path, entity(CUBE + CUBE, classname="worldspawn"))
    assert "line 14, entity 0" in caught.value.where


def test_the_entity_is_named(tmp_path: Path) -> None:
    with pytest.raises(LevelError) as caught:
        read(tmp_path, WORLD + '{\n"classname" "func_door"\n{\nnonsense\n}\n}\n')
    assert caught.value.where.endswith('line 15, entity 1 "func_door"')


@pytest.mark.parametrize("text", ["", "{", "nonsense", '{\n"a"\n}'])
def test_what_annotates_refuses_broken_text_too(text: str) -> None:
    advice = {0: LightAnnotation({"gnomon_technique": "SM"}, {})}
    for do in (
        quake_map.clear,
        quake_map.read_annotations,
        lambda source: quake_map.annotate(source, advice),
        lambda source: quake_map.companions(source, Path("level.map")),
    ):
        with pytest.raises(LevelError) as caught:
            do(text.encode())
        assert caught.value.where.startswith("line ")


@pytest.mark.parametrize("scene", ["1", "other", ""])
def test_a_map_holds_one_scene(tmp_path: Path, scene: str) -> None:
    (tmp_path / "level.map").write_text(WORLD)
    assert quake_map.read(tmp_path / "level.map", "level").scene.name == "level"
    assert quake_map.read(tmp_path / "level.map", "0").scene.name == "level"
    with pytest.raises(LevelError, match="no scene"):
        quake_map.read(tmp_path / "level.map", scene)


def test_a_map_without_anything_drawn_is_read_with_warnings(tmp_path: Path) -> None:
    level = read(tmp_path, entity(classname="worldspawn"))
    assert [note.where for note in level.notes] == ["brushes", "entities"]
    hidden = read(tmp_path, entity(box((0, 0, 0), (8, 8, 8), "clip"), classname="worldspawn"))
    assert not hidden.scene.triangle_count


def test_deep_and_long_texts_are_refused_quickly(tmp_path: Path) -> None:
    for text in ("{" * 100_000, "{\n" * 3 + "(" * 100_000, '{"' + "a" * 1_000_000, "(" + " 1" * 500_000):
        with pytest.raises(LevelError):
            read(tmp_path, text)
    many = "{\n" + face([(0, 0, 0), (0, 1, 0), (1, 0, 0)]) * 100 + "}\n"
    with pytest.raises(LevelError, match="No brush"):
        read(tmp_path, entity(many * 20, classname="worldspawn"))


def test_brushes_that_take_too_long_to_cut_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = entity(CUBE + CUBE, classname="worldspawn")
    monkeypatch.setattr(meshes, "MOST_WORK", 2 * 6**3)
    assert read(tmp_path, text).scene.triangle_count == 24
    monkeypatch.setattr(meshes, "MOST_WORK", 2 * 6**3 - 1)
    with pytest.raises(LevelError, match="takes too long") as caught:
        read(tmp_path, text)
    assert "2 brushes have 12 faces, one of them 6" in caught.value.known
    assert caught.value.remedy
