"""What is broken is refused with a place and a remedy, and USD prints nothing of its own."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from scenes.errors import LevelError
from scenes.formats.registry import format_of, read_level
from scenes.usd import lamps
from scenes.usd.reader import read_scene
from tests.scenes.usd_samples import METRES, TRIANGLE, instancer, mesh, read, written, xform

SAMPLES = Path(__file__).parent / "samples"
CORNERS = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)]
CUBE = 'def Cube "C" { }'
CROWD = [0] * 3000, [(0.0, 0.0, 0.0)] * 3000

BROKEN = {
    "counts beyond indices": (mesh([3, 3], [0, 1, 2], CORNERS), "/M", "adds up to 6"),
    "negative count": (mesh([-1, 4], [0, 1, 2], CORNERS), "/M", "faceVertexCounts"),
    "index beyond points": (mesh([3], [0, 1, 3], CORNERS), "/M", "corner 3"),
    "negative index": (mesh([3], [0, 1, -3], CORNERS), "/M", "corner -3"),
    "point that is none": (mesh([3], [0, 1, 2], CORNERS).replace("(1.0", "(nan"), "/M", "Point 1"),
    "infinite point": (mesh([3], [0, 1, 2], CORNERS).replace("(1.0", "(inf"), "/M", "Point 1"),
    "hole beyond faces": (mesh([3], [0, 1, 2], CORNERS, "int[] holeIndices = [7]"), "/M", "face 7"),
    "text for points": (
        'def Mesh "M" { string points = "x"; int[] faceVertexCounts = [3]; int[] faceVertexIndices = [0] }',
        "/M",
        "points",
    ),
    "transform that is none": (xform(CUBE, "translate", value="(nan, 0, 0)"), "/X", "not finite"),
    "far away": (xform(CUBE, "scale", value="(1e35, 1, 1)"), "/X/C", "farther than"),
    "cube without size": ('def Cube "C" { double size = 0 }', "/C", "size must be above 0"),
    "light that is no number": (
        'def SphereLight "L" { float inputs:intensity = inf }',
        "/L",
        "inputs:intensity",
    ),
    "negative radius": ('def SphereLight "L" { float inputs:radius = -1 }', "/L", "inputs:radius"),
    "no colour": (
        'def SphereLight "L" { color3f inputs:color = (nan, 0, 0) }',
        "/L",
        "inputs:color",
    ),
    "prototype beyond them": (instancer([1], [(0, 0, 0)], CUBE), "/P", "prototype 1"),
    "fewer positions": (instancer([0, 0], [(0, 0, 0)], CUBE), "/P", "do not fit together"),
    "position that is none": (instancer([0], [(float("nan"), 0, 0)], CUBE), "/P", "not finite"),
    "instancer of itself": (
        instancer([0], [(0, 0, 0)], instancer([0], [(0, 0, 0)], "").replace('"P"', '"C"')),
        "/P/C",
        "places itself",
    ),
    "crowd of crowds": (
        instancer(*CROWD, instancer(*CROWD, CUBE).replace('"P"', '"C"').replace("</P/C>", "</P/C/C>")),
        "/P/C/C",
        "108,000,000 triangles",
    ),
    "reference to itself": ('def "A" (references = </A>) { }', "/A", "contains itself"),
    "no syntax": ('def Cube "C" { double size = }', "", ":7:"),
}


@pytest.mark.parametrize("case", BROKEN)
def test_broken_stages_are_refused_by_place(tmp_path: Path, case: str) -> None:
    body, where, said = BROKEN[case]
    path = written(tmp_path, body)
    with pytest.raises(LevelError) as caught:
        read_level(path)
    assert caught.value.where == (f"{path}, {where}" if where else str(path))
    assert said in f"{caught.value.what} {caught.value.known}"
    assert caught.value.remedy
    assert "pxr" not in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("head", "said"),
    [
        ("metersPerUnit = 0", "metersPerUnit"),
        ("metersPerUnit = nan", "metersPerUnit"),
        ("subLayers = [@./missing.usda@]", "missing.usda"),
        ("subLayers = [@./level.usda@]", "contains itself"),
    ],
)
def test_broken_heads_are_refused(tmp_path: Path, head: str, said: str) -> None:
    with pytest.raises(LevelError) as caught:
        read(tmp_path, CUBE, head)
    assert said in str(caught.value)
    assert str(tmp_path) in caught.value.where


def test_binary_files_that_end_early_are_refused(tmp_path: Path) -> None:
    source = (SAMPLES / "yard.usdc").read_bytes()
    for length in range(0, len(source), 97):
        path = tmp_path / f"cut{length}.usdc"
        path.write_bytes(source[:length])
        with pytest.raises(LevelError) as caught:
            read_level(path)
        assert str(path) in caught.value.where


def test_texts_that_are_no_utf8_are_refused(tmp_path: Path) -> None:
    path = written(tmp_path, CUBE)
    path.write_bytes(path.read_bytes().replace(b'"C"', b'"\xff"'))
    with pytest.raises(LevelError):
        read_level(path)


def test_what_can_be_left_out_is_noted(tmp_path: Path) -> None:
    body = f'def "A" (references = @./nowhere.usda@) {{ }} {mesh([3], [0, 1, 2], CORNERS)}'
    level = read(tmp_path, body)
    assert level.scene.triangle_count == 1
    assert any(note.where == "/A" and "nowhere.usda" in note.text for note in level.notes)


def test_an_empty_stage_and_a_deep_one_are_read(tmp_path: Path) -> None:
    notes = [note.text for note in read(tmp_path, "").notes]
    assert any("no triangles" in note for note in notes)
    assert any("no lights" in note for note in notes)
    deep = (
        "".join(f'def Xform "a{index}" {{ ' for index in range(300))
        + f'def Mesh "M" {{ {TRIANGLE} }}'
        + "}" * 300
    )
    assert read(tmp_path, deep, METRES).scene.triangle_count == 1


def test_too_many_lights_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lamps, "MOST_LIGHTS", 1)
    with pytest.raises(LevelError, match="more than 1 lights"):
        read_scene(written(tmp_path, 'def SphereLight "A" { } def SphereLight "B" { }'), None)


def test_usd_prints_nothing(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    path = written(tmp_path, f'def "A" (references = @./nowhere.usda@) {{ }} {CUBE}')
    level_format = format_of(path)
    read_level(path)
    level_format.companions(path.read_bytes(), path)
    level_format.annotate(path.read_bytes(), {})
    with pytest.raises(LevelError):
        read_level(written(tmp_path, "def {", name="broken.usda"))
    assert capfd.readouterr() == ("", "")


def test_without_usd_core_the_extra_is_named(tmp_path: Path) -> None:
    path = written(tmp_path, CUBE)
    program = (
        "import sys; sys.modules['pxr'] = None\n"
        "from pathlib import Path\n"
        "from scenes.errors import LevelError\n"
        "from scenes.formats.registry import format_of, read_level\n"
        f"path = Path({str(path)!r})\n"
        "actions = [lambda: read_level(path), lambda: format_of(path).annotate(b'', {}),\n"
        "    lambda: format_of(path).clear(b''), lambda: format_of(path).companions(b'', path)]\n"
        "for action in actions:\n"
        "    try: action()\n"
        "    except LevelError as error: assert 'gnomon[usd]' in error.remedy and str(path) == error.where\n"
        "    else: raise SystemExit('no error')\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True, cwd=SAMPLES.parents[2])


def test_nothing_else_imports_usd() -> None:
    program = (
        "import sys, api.cli.program\n"
        "from scenes.formats.registry import level_formats\n"
        "assert '.usda' in level_formats() and 'pxr' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", program], check=True, cwd=SAMPLES.parents[2])


def test_a_name_that_is_no_utf8_is_refused(tmp_path: Path) -> None:
    folder = tmp_path / "\udcff"
    try:
        folder.mkdir()
    except OSError:
        pytest.skip("this file system knows UTF-8 names only")
    with pytest.raises(LevelError, match="no UTF-8") as caught:
        read(folder, CUBE)
    assert caught.value.remedy == "Rename it."
