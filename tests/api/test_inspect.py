from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from api.inspection import Inspection
from scenes.formats.registry import read_level
from scenes.scene import Mesh, Scene
from scenes.shells import Shells
from tests.api.command import answered, gnomon, started
from tests.small_level import LEAF, POINT, small_level, small_scene
from tests.solids import box, floor

LEVELS = Path(__file__).parents[2] / "../shared/levels"
HEAVY = ("scipy", "moderngl", "OpenGL", "OpenImageIO", "embreex")


def test_it_shows_what_is_in_a_level(tmp_path: Path) -> None:
    result = gnomon("inspect", small_level(tmp_path))
    assert result.exit_code == 0
    for words in ("glTF 2.0", "15 in 3 meshes", "3 lights", "Torch", "1 camera", "Eye", "86°", "static"):
        assert words in result.stdout, words
    assert small_scene().digest in result.stdout


@pytest.mark.parametrize("width", [40, 60, 80, 100])
def test_numbers_nodes_and_names_are_on_every_screen(tmp_path: Path, width: int) -> None:
    result = gnomon("inspect", small_level(tmp_path), width=width)
    rows = [line.split()[:3] for line in result.stdout.splitlines()]
    for row in (["#", "node", "name"], ["0", "3", "Lamp"], ["1", "4", "Torch"], ["2", "5", "Sun"]):
        assert row in rows
    assert all(len(line) <= width for line in result.stdout.splitlines())


def test_columns_that_say_nothing_are_left_out(tmp_path: Path) -> None:
    shown = gnomon("inspect", small_level(tmp_path)).stdout
    assert "full cone" in shown
    assert "mobility" in shown
    shown = gnomon("inspect", small_level(tmp_path, scene=small_scene((POINT,)))).stdout
    assert "cone" not in shown
    assert "mobility" not in shown


def test_json_holds_everything(tmp_path: Path) -> None:
    path = small_level(tmp_path)
    record = answered("inspect", path)
    assert record["level"] == str(path)
    assert record["digest"] == small_scene().digest
    assert record["triangles"] == record["casting_triangles"] == 15
    assert record["casters"] == {"closed": 12, "balanced": 0, "open": 3}
    assert record["bounds_m"] == [[-8.0, 0.0, -8.0], [8.0, 2.0, 8.0]]
    assert [(light["index"], light["name"], light["kind"]) for light in record["lights"]] == [
        (0, "Lamp", "spot"),
        (1, "Torch", "point"),
        (2, "Sun", "directional"),
    ]
    assert record["lights"][0]["outer_cone_rad"] == 0.75
    assert "range_m" not in record["lights"][2]
    assert record["cameras"][0]["name"] == "Eye"


@pytest.mark.parametrize(
    ("scene", "words"),
    [
        (small_scene(lights=()), "No lights: annotate has nothing to do"),
        (small_scene(cameras=()), "judged from four viewpoints"),
        (Scene("Empty", (), (POINT,)), "No triangles"),
        (small_scene((POINT, POINT)), "Of 2 lights the name is another's too"),
        (small_scene((replace(POINT, range_m=float("inf")),)), "1 light of 1 without a range"),
        (small_scene((replace(POINT, intensity=0.0),)), "1 light without intensity"),
        (small_scene(), "20 % of the casting triangles are in open shells"),
        (Scene("Glass", (floor(5.0, casts=False),), (POINT,)), "Nothing casts a shadow"),
        (Scene("Planet", (floor(1e6),), (POINT,)), "is it modelled in metres?"),
    ],
    ids=lambda value: value.name if isinstance(value, Scene) else "",
)
def test_it_says_what_to_expect(tmp_path: Path, scene: Scene, words: str) -> None:
    record = answered("inspect", small_level(tmp_path, scene=scene))
    assert any(words in remark for remark in record["remarks"]), record["remarks"]


def test_a_promise_of_closed_geometry_that_is_not_kept_is_told(tmp_path: Path) -> None:
    level = read_level(small_level(tmp_path))
    promised = tuple(replace(mesh, promised_closed=True) for mesh in level.scene.meshes)
    remarks = Inspection.of(replace(level, scene=replace(level.scene, meshes=promised))).remarks
    assert any(remark.startswith("3 triangles in open shells, of meshes that") for remark in remarks)
    assert not any("promise" in remark for remark in Inspection.of(level).remarks)


def test_names_cannot_write_on_the_terminal(tmp_path: Path) -> None:
    evil = replace(POINT, name="\x1b[2Jgone [bold]not markup[/bold]\r")
    result = gnomon("inspect", small_level(tmp_path, scene=small_scene((evil,))), width=160)
    assert "\x1b" not in result.stdout
    assert "\r" not in result.stdout
    assert "\\x1b[2Jgone [bold]not markup[/bold]\\x0d" in result.stdout


@pytest.mark.parametrize(
    ("content", "words"),
    [(b"hello", "GLB"), (b"", "empty"), (b"version https://git-lfs.github.com/spec/v1\n", "LFS")],
    ids=["text", "empty", "pointer"],
)
def test_a_level_that_cannot_be_read_is_exit_3(tmp_path: Path, content: bytes, words: str) -> None:
    path = tmp_path / "level.glb"
    path.write_bytes(content)
    result = gnomon("inspect", path)
    assert result.exit_code == 3
    assert result.stdout == ""
    assert result.stderr.startswith("error: ")
    assert words in result.stderr
    assert str(path) in result.stderr


def test_an_unknown_scene_is_exit_3(tmp_path: Path) -> None:
    assert gnomon("inspect", small_level(tmp_path), "--scene", "Other").exit_code == 3


def test_neither_help_nor_inspect_loads_what_it_does_not_need(tmp_path: Path) -> None:
    path = small_level(tmp_path)
    code = (
        "import sys; from api.cli.program import app; "
        "app(sys.argv[1:], standalone_mode=False); "
        f"print([name for name in {(*HEAVY, 'numpy')!r} if name in sys.modules], file=sys.stderr)"
    )
    for arguments, loaded in ((["--help"], []), (["inspect", str(path)], ["numpy"])):
        result = _python(code, arguments)
        assert result.splitlines()[-1] == str(loaded), arguments


def _python(code: str, arguments: list[str]) -> str:
    import subprocess  # noqa: PLC0415

    from tests.api.command import ROOT, environment  # noqa: PLC0415

    done = subprocess.run(
        [sys.executable, "-c", code, *arguments],
        cwd=ROOT,
        env=environment(),
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stderr


def test_shells_count_every_placement() -> None:
    crate = box((0, 0, 0), (1, 1, 1))
    places = np.tile(np.eye(4), (3, 1, 1))
    mesh = Mesh("crates", crate.positions, crate.triangles, places)
    assert Shells.of(Scene("", (mesh, LEAF, floor(1.0, casts=False)))) == Shells(36, 0, 1)


def test_shells_that_touch_along_an_edge_are_balanced() -> None:
    first, second = box((0, 0, 0), (1, 1, 1)), box((2, 2, 0), (1, 1, 1))
    positions = np.concatenate([first.positions, second.positions])
    triangles = np.concatenate([first.triangles, second.triangles + len(first.positions)])
    assert Shells.of(Scene("", (Mesh("bricks", positions, triangles),))) == Shells(0, 24, 0)


def test_one_hole_opens_its_own_shell_only() -> None:
    first, second = box((0, 0, 0), (1, 1, 1)), box((5, 0, 0), (1, 1, 1))
    positions = np.concatenate([first.positions, second.positions])
    triangles = np.concatenate([first.triangles[1:], second.triangles + len(first.positions)])
    order = np.random.default_rng(3).permutation(len(triangles))
    assert Shells.of(Scene("", (Mesh("boxes", positions, triangles[order]),))) == Shells(12, 0, 11)


def test_a_long_strip_is_one_shell() -> None:
    corners = np.array([[x // 2, x % 2, 0] for x in range(4002)], np.float32)
    start = np.arange(4000)
    flip = start % 2 == 1
    triangles = np.stack([start, start + 1 + flip, start + 2 - flip], axis=1)
    triangles = np.concatenate([triangles, triangles[:, [0, 2, 1]]])
    assert Shells.of(Scene("", (Mesh("ribbon", corners, triangles),))) == Shells(0, 8000, 0)


def test_a_real_level() -> None:
    path = LEVELS / "quake/e1m1.glb"
    if not path.exists():
        pytest.skip("the real levels are not here")
    result = started("inspect", path, "--json")
    assert result.returncode == 0
    assert result.stderr == ""
    record = json.loads(result.stdout)
    assert (record["triangles"], len(record["lights"]), record["cameras"]) == (14542, 198, [])
    assert sum(record["casters"].values()) == 14542
    assert record["casters"]["open"] < 0.02 * 14542


def test_of_very_many_lights_the_first_are_shown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("api.cli.inspection_tables.MOST_ROWS", 1)
    shown = gnomon("inspect", small_level(tmp_path)).stdout
    assert "3 lights" in shown
    assert "Lamp" in shown
    assert "Torch" not in shown
    assert "... and 2 more lights: --json tells all." in shown
    assert len(answered("inspect", small_level(tmp_path))["lights"]) == 3


def test_meshes_that_share_their_arrays_are_looked_through_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[int] = []

    def spied(scene: Scene) -> Shells:
        seen.append(len(scene.meshes))
        return counted_shells(scene)

    counted_shells = Shells.of
    scene = small_scene()
    twice = replace(scene, meshes=scene.meshes + scene.meshes)
    level = replace(read_level(small_level(tmp_path)), scene=twice)
    monkeypatch.setattr(Shells, "of", spied)
    assert Inspection.of(level).shells == counted_shells(twice)
    assert seen == [len(scene.meshes)]
