from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import OpenImageIO
import pytest

from api.canvas import Canvas
from api.cli import options
from api.showing import VIEW_NAMES
from api.view_caption import NARROWEST, captioned
from api.vocabulary import choices, help_words, labels, pairs
from renderers.debug_picture import DebugPicture, Legend, Panel, Scale
from renderers.registry import TECHNIQUES
from tests.api.command import answered, gnomon, succeeded
from tests.small_level import small_level

SMALL = ("--resolution", "96x64")
OF_TECHNIQUE = {
    "SM": ("map", "light", "texels"),
    "SV": ("counter", "edges", "volumes"),
    "Chan": ("silhouettes",),
}


def pixels(path: Path) -> np.ndarray:
    return OpenImageIO.ImageBuf(str(path)).get_pixels(OpenImageIO.UINT8)


@pytest.fixture
def level(tmp_path: Path) -> Path:
    return small_level(tmp_path)


@pytest.mark.parametrize(
    ("label", "view"), [(label, view) for label, views in OF_TECHNIQUE.items() for view in views]
)
def test_a_view_takes_the_place_of_the_picture(level: Path, tmp_path: Path, label: str, view: str) -> None:
    picture = tmp_path / "out.png"
    size = () if label == "SV" else ("--map-size", 128)
    record = answered("render", level, "-t", label, *SMALL, *size, "--show", view, "-o", picture)
    assert (record["view"], record["picture"], record["label"]) == (view, str(picture), label)
    assert record["figures"]["pixels"] > 0
    shown = pixels(picture)
    assert shown.shape[1] >= (720 if view in {"map", "light"} else NARROWEST)
    assert shown.std() > 0


def test_the_error_view_is_the_error_map(level: Path, tmp_path: Path) -> None:
    coarse, exact = tmp_path / "coarse.png", tmp_path / "exact.png"
    assert (
        answered("render", level, *SMALL, "--map-size", 32, "--show", "error", "-o", coarse)["view"]
        == "error"
    )
    succeeded("render", level, *SMALL, "-t", "SV", "--show", "error", "-o", exact)

    def colored(path: Path) -> int:
        scene = pixels(path)[:64].astype(int)
        return int((np.ptp(scene, axis=2) > 40).sum())

    assert colored(coarse) > 20
    assert colored(exact) == 0


def test_without_a_view_the_record_says_so(level: Path, tmp_path: Path) -> None:
    picture = tmp_path / "p.png"
    assert answered("render", level, *SMALL, "-o", picture)["view"] is None
    assert pixels(picture).shape == (64, 96, 3)


def test_the_report_names_the_view_and_so_does_the_file(
    level: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "here"
    folder.mkdir()
    monkeypatch.chdir(folder)
    said = succeeded("render", level, *SMALL, "-t", "SV", "--show", "edges", width=200)
    assert "shows the view edges" in said.stdout
    assert [path.name for path in folder.iterdir()] == ["small.Lamp.SV.edges.png"]


def test_any_setting_can_be_set(level: Path, tmp_path: Path) -> None:
    out = ("-o", tmp_path / "p.png")
    record = answered(
        "render", level, "-t", "PSM", *SMALL, "--set", "depth=kozlov", "--set", "map_size=96", *out
    )
    assert record["settings"] == {"map_size": 96, "filter": "2x2", "depth": "kozlov"}
    record = answered("render", level, "-t", "SV", *SMALL, "--set", "variant=mixed", *out)
    assert record["settings"] == {"variant": "mixed"}
    record = answered("render", level, *SMALL, "--set", "bias_slope=2.5", "--filter", "4x4", *out)
    assert record["settings"]["bias_slope"] == 2.5
    assert record["settings"]["filter"] == "4x4"


def test_the_label_names_what_was_set(level: Path, tmp_path: Path) -> None:
    said = succeeded(
        "render", level, "-t", "PSM", *SMALL, "--set", "depth=kozlov", "-o", tmp_path / "p.png", width=160
    )
    assert "PSM 1024 2x2 depth=kozlov" in said.stdout


def test_a_setting_changes_the_picture(level: Path, tmp_path: Path) -> None:
    pictures = []
    for slope in ("0", "auto"):
        path = tmp_path / f"{slope}.png"
        settings = ("--set", f"bias_slope={slope}", "--set", "bias_normal=0", "--set", "bias_units=0")
        succeeded("render", level, *SMALL, "--map-size", "64", *settings, "-o", path)
        pictures.append(pixels(path).astype(int))
    assert np.abs(pictures[0] - pictures[1]).sum() > 0


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (("--show", "mirror"), 2, 'no view "mirror".'),
        (("--show", "mirror"), 2, f"Known: {', '.join(VIEW_NAMES)}."),
        (("--show", "counter"), 2, 'SM has no view "counter".'),
        (("--show", "counter"), 2, "It has map, light, texels, error."),
        (("-t", "SV", "--show", "map"), 2, "It has light, counter, edges, volumes, error."),
        (("-t", "SV", "--show", "silhouettes"), 2, 'SV has no view "silhouettes".'),
        (("--set", "depth=kozlov"), 2, 'SM has no setting "depth".'),
        (("-t", "SV", "--filter", "2x2"), 2, 'SV has no setting "filter".'),
        (("-t", "PSM", "--set", "depth=deep"), 2, "It may be universal, kozlov."),
        (("--map-size", "8"), 2, "It may be 16 to 8192."),
        (("--map-size", "1e99"), 2, "It may be 16 to 8192."),
        (("--set", "map_size=nan"), 2, "It may be 16 to 8192."),
        (("--filter", "5x5"), 2, "It may be 1x1, 2x2, 3x3, 4x4."),
        (("--set", "depth"), 2, '"depth" is not NAME=VALUE'),
        (("--set", "=1"), 2, "is not NAME=VALUE"),
        (("--set", "filter=1x1", "--filter", "2x2"), 2, '"filter" is set twice'),
        (("--set", "filter=1x1", "--set", "filter=1x1"), 2, '"filter" is set twice'),
        (("--set", f"{'x' * 500}=1"), 2, "and 440 more characters"),
        (("-t", "SV", "--show", "edges", "--set", "variant=crow"), 1, "crow refuses Lamp: it needs closed"),
    ],
    ids=lambda value: "_".join(value)[:40] if isinstance(value, tuple) else "",
)
def test_what_cannot_be_shown_or_set_is_said(
    level: Path, arguments: tuple[str, ...], code: int, words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(level.parent)
    result = gnomon("render", level, *SMALL, *arguments, width=200)
    assert result.exit_code == code, result.stderr
    assert words in re.sub(r"\s+", " ", result.stderr.replace("│", " "))
    assert "Traceback" not in result.stderr
    assert result.stdout == ""
    assert [path.name for path in level.parent.iterdir()] == ["small.glb"]


def test_help_lists_what_the_registry_holds() -> None:
    page = re.sub(r"[\s│]+", " ", succeeded("render", "--help", width=120).stdout)
    assert help_words()["techniques"] in page
    for word in (*labels(), *VIEW_NAMES, *choices("filter")):
        assert word in page, word
    assert "{" not in page


def test_shells_complete_techniques_views_and_settings() -> None:
    assert options.known_techniques() == [one.label for one in TECHNIQUES]
    assert options.known_views() == list(VIEW_NAMES)
    assert options.known_choices("filter")() == ["1x1", "2x2", "3x3", "4x4"]
    assert {"depth=kozlov", "map_size="} <= set(pairs("PSM"))
    assert "unchecked=false" in pairs("shadow_volume")


@pytest.mark.parametrize(("side", "expected"), [(16, 1024), (500, 1000), (720, 720), (1024, 1024)])
def test_faces_of_a_map_come_in_a_handy_size(side: int, expected: int) -> None:
    face = Canvas(side, side, (200, 30, 30)).picture
    shown = captioned(DebugPicture((Panel(face),), Legend(), of_screen=False), "Map", "of a test")
    assert (shown == (200, 30, 30)).all(axis=2).sum() == expected**2


def test_a_legend_takes_as_many_rows_as_it_needs() -> None:
    scene = Canvas(480, 40, (0, 90, 0)).picture
    heights = []
    for count in (1, 40):
        swatches = tuple(((10 * index % 250, 7, 9), f"class {index}") for index in range(count))
        shown = captioned(DebugPicture((Panel(scene),), Legend(swatches)), "Counter", "of a test")
        assert all((shown == color).all(axis=2).any() for color, _ in swatches)
        assert (shown[:40] == scene).all()
        heights.append(len(shown))
    assert heights[1] > heights[0] + 60


def test_a_scale_is_drawn_from_left_to_right() -> None:
    scene = Canvas(480, 40, (0, 90, 0)).picture
    colors = tuple((value, 0, 255 - value) for value in range(0, 256, 15))
    legend = Legend(scale=Scale(colors, ((0.0, "1"), (1.0, "9"))), unit="metres")
    shown = captioned(DebugPicture((Panel(scene),), legend), "Map", "of a test")
    columns = [np.nonzero((shown == color).all(axis=2))[1].mean() for color in colors]
    assert columns == sorted(columns)


def test_a_picture_of_sixteen_pixels_keeps_them() -> None:
    scene = Canvas(16, 16, (0, 90, 0)).picture
    shown = captioned(DebugPicture((Panel(scene),), Legend()), "Silhouette pixels", "x\n" * 500)
    assert shown.shape[1] == NARROWEST
    assert (shown == (0, 90, 0)).all(axis=2).sum() == 256
