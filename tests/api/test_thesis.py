from __future__ import annotations

import signal
from pathlib import Path

import pytest

from scenes.formats.registry import read_level
from scenes.thesis.registry import OPEN_SCENES, THESIS_SCENES
from selector.thesis_orderings import ORDERINGS
from tests.api.command import answered, files, gnomon, running, succeeded, wait_for_line

SMALL = ("--resolution", "80x64")
QUICK = ("--only", "O10", "--no-times", *SMALL)


def test_the_json_holds_findings_and_everything_behind_them() -> None:
    record = answered("thesis", *QUICK)
    (ordering,) = record["orderings"]
    assert ordering["id"] == "O10"
    assert ordering["holds"] in (True, False)
    assert ordering["evidence"][0]["where"] == "Tower, thin braces"
    (trial,) = record["trials"]
    assert (trial["figure"], trial["scene"]) == ("56", "water_tower")
    sizes = [one["settings"]["map_size"] for one in trial["contenders"]]
    assert sizes == [256, 512, 1024, 2048]
    candidates = trial["measurement"]["candidates"]
    assert [one["settings"]["map_size"] for one in candidates] == sizes
    assert all(one["views"][0]["counters"]["silhouette_pixels"] for one in candidates)
    lost = [one["views"][0]["figures"]["false_lit"] for one in candidates]
    assert lost[0] > lost[-1]
    assert record["grades"] == []
    assert record["rounds"] == 0


def test_timed_orderings_bring_samples_and_grades() -> None:
    record = answered("thesis", "--only", "o4,O1", "--rounds", 1, *SMALL)
    assert [one["id"] for one in record["orderings"]] == ["O1", "O4"]
    assert all(one["holds"] is not None for one in record["orderings"])
    assert [one["scene"] for one in record["trials"]] == list(THESIS_SCENES)
    for trial in record["trials"]:
        assert [len(one["views"][0]["samples"]) for one in trial["measurement"]["candidates"]] == [2] * 4
    assert len(record["grades"]) == 20
    for scene in range(5):
        relative = [one["relative"] for one in record["grades"][4 * scene : 4 * scene + 4]]
        assert min(relative) == 1.0


@pytest.mark.parametrize("width", [100, 160])
def test_the_table_says_what_holds_and_by_which_rule(width: int) -> None:
    result = succeeded("thesis", *QUICK, width=width)
    shown = " ".join(result.stdout.split())
    for words in ("O10", "holds", "Tower, thin braces", "silhouette pixels", "1 ordering;", "O10 holds if:"):
        assert words in shown
    assert "Faster:" not in shown, "nothing is timed"
    assert "Checking 1 ordering by 1 set-up at 80x64, no times" in result.stderr


@pytest.mark.parametrize("names", ["O13", "O1,volumes"])
def test_an_unknown_ordering_is_exit_2_and_lists_the_known(names: str) -> None:
    result = gnomon("thesis", "--only", names)
    assert result.exit_code == 2
    assert f'There is no ordering "{names.rsplit(",", maxsplit=1)[-1]}".' in result.stderr
    assert ", ".join(one.id for one in ORDERINGS) in result.stderr


@pytest.mark.parametrize(
    "arguments",
    [("--only", ","), ("--rounds", "0"), ("--resolution", "8x8"), ("--export", "x", "--no-times")],
)
def test_wrong_usage_is_exit_2(arguments: tuple[str, ...]) -> None:
    result = gnomon("thesis", *arguments)
    assert result.exit_code == 2
    assert result.stdout == ""


def test_a_device_that_is_not_there_is_exit_4() -> None:
    assert gnomon("thesis", *QUICK, "--device", "no such device").exit_code == 4


def test_export_makes_the_folder_and_writes_every_scene(tmp_path: Path) -> None:
    folder = tmp_path / "made" / "scenes"
    result = succeeded("thesis", "--export", folder, width=200)
    assert files(folder) == {f"{key}.glb" for key in THESIS_SCENES | OPEN_SCENES}
    assert f"Wrote {folder / 'street.glb'}." in result.stdout
    assert read_level(folder / "street.glb").scene.digest
    before = {path: path.read_bytes() for path in folder.iterdir()}
    again = answered("thesis", "--export", folder)
    assert again == {"written": [str(folder / f"{key}.glb") for key in THESIS_SCENES | OPEN_SCENES]}
    assert {path: path.read_bytes() for path in folder.iterdir()} == before


def test_export_spares_other_files(tmp_path: Path) -> None:
    (tmp_path / "tree.glb").write_bytes(b"mine")
    result = gnomon("thesis", "--export", tmp_path, width=200)
    assert result.exit_code == 5
    assert "it is not overwritten" in result.stderr
    assert files(tmp_path) == {"tree.glb"}
    assert (tmp_path / "tree.glb").read_bytes() == b"mine"


@pytest.mark.parametrize("place", ["/proc/none", "/dev/null"])
def test_a_folder_that_cannot_be_is_exit_5_and_names_its_option(place: str) -> None:
    result = gnomon("thesis", "--export", place, width=200)
    assert result.exit_code == 5
    assert "--export" in result.stderr
    assert " -o" not in result.stderr


def test_ctrl_c_says_how_far_it_came() -> None:
    with running("thesis", "--no-times", *SMALL) as process:
        wait_for_line(process, "set-up 1 of")
        process.send_signal(signal.SIGINT)
        stdout, stderr = process.communicate(timeout=60)
    assert process.returncode == 130
    assert stdout == ""
    assert "were measured" in stderr
    assert "Traceback" not in stderr
