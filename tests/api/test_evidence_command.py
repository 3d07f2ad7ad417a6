"""`gnomon evidence` lists, shows, brings in and out, and prunes."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from typer.main import get_command

from api.cli.evidence import evidence
from selector.benchmark.code_version import code_versions
from selector.evidence.store import Store, StoreError
from selector.measurement import Status
from tests.api.command import answered, gnomon, succeeded
from tests.selector.evidence_rows import (
    DEVICE,
    ERRORS,
    SM,
    SV,
    TIMES,
    asked,
    everything,
    filled,
    instance,
    judgement,
)

PAGE = (Path(__file__).parents[2] / "docs/evidence.md").read_text()


@pytest.fixture
def store(tmp_path: Path) -> Path:
    """Stale facts of four instances, and a fresh one of the first."""
    path = tmp_path / "evidence.sqlite"
    with Store.open(str(path)) as made:
        filled(made)
        fresh = asked(instance(0), SM, code=code_versions()[SM.technique])
        made.add(instance(0), [], [judgement(fresh)], [])
        values = {row.key: {"triangles": 3.0, "odd": float("nan")} for row in made.instances()}
        made.add_features("first 1", values)
    return path


def test_ls_counts_by_device_technique_family_and_run(store: Path) -> None:
    found = answered("evidence", "ls", "--store", store)
    assert found["bytes"] >= store.stat().st_size
    assert [one["key"] for one in found["devices"]] == [DEVICE.key]
    told = {
        (one["technique"], one["fresh"]): (one["judgements"], one["samples"]) for one in found["techniques"]
    }
    assert told == {
        ("shadow_map", True): (1, 0),
        ("shadow_map", False): (4, 24),
        ("shadow_volume", False): (4, 24),
    }
    families = {(one["family"], one["role"]): one["instances"] for one in found["families"]}
    assert families == {("cave", "test"): 1, ("cave", "training"): 1, ("forest", "training"): 2}
    assert [(one["key"], one["judgements"], one["timings"]) for one in found["runs"]] == [
        (ERRORS.key, 9, 0),
        (TIMES.key, 0, 8),
    ]
    assert found["extractors"] == [{"name": "first 1", "instances": 4}]
    text = succeeded("evidence", "ls", "--store", store, width=160).stdout
    for words in ("fresh", "stale", "forest", "softpipe", ERRORS.key[:8]):
        assert words in text


def test_show_tells_everything_about_an_instance_or_a_run(store: Path) -> None:
    key = instance(2).key
    found = answered("evidence", "show", key[:12], "--store", store)
    assert found["instance"]["key"] == key
    assert {one["technique"]: one["figures"]["edge_error_px"] for one in found["judgements"]} == {
        "shadow_map": None,
        "shadow_volume": 0.0,
    }
    assert [len(one["samples"]) for one in found["timings"]] == [6, 6]
    assert found["features"] == {"first 1": {"triangles": 3.0, "odd": None}}
    assert "shadow_volume" in succeeded("evidence", "show", key, "--store", store, width=160).stdout
    with Store.open(str(store)) as opened:
        failed = judgement(asked(instance(2), SV, code="new"), status=Status.CRASHED)
        opened.add(instance(2), [], [failed], [])
    run = answered("evidence", "show", ERRORS.key[:4], "--store", store)
    assert run["run"]["remarks"] == list(ERRORS.remarks)
    assert (run["instances"], run["facts"], len(run["failed"])) == (4, 10, 1)
    assert "crashed" in succeeded("evidence", "show", ERRORS.key, "--store", store, width=160).stdout
    for unknown in ("0", "zzzzzz"):
        result = gnomon("evidence", "show", unknown, "--store", store)
        assert result.exit_code == StoreError.exit_code
        assert "no instance or run" in result.stderr


def test_evidence_goes_out_and_comes_in_once(store: Path, tmp_path: Path) -> None:
    files = answered("evidence", "export", tmp_path / "files", "--store", store)
    assert all(Path(one).is_file() for one in files)
    other = tmp_path / "other.sqlite"
    new = {"instances": 4, "runs": 2, "judgements": 9, "timings": 8, "samples": 48}
    assert answered("evidence", "import", tmp_path / "files", "--store", other) == new
    assert answered("evidence", "merge", store, "--store", other) == dict.fromkeys(new, 0)
    assert "New: 4 instances" in succeeded("evidence", "merge", store, "--store", tmp_path / "third").stdout
    with Store.open(str(store)) as one, Store.open(str(other)) as two:
        assert everything(one) == everything(two)
    result = gnomon("evidence", "merge", tmp_path / "missing", "--store", other)
    assert result.exit_code == StoreError.exit_code
    assert "no such evidence store" in result.stderr


def test_scenarios_are_written_a_folder_each(store: Path, tmp_path: Path) -> None:
    files = answered("evidence", "export", tmp_path / "out", "--format", "aslib", "--store", store)
    folders = {Path(one).parent.name for one in files}
    assert folders == {f"GNOMON-{measure}-{DEVICE.key[:8]}" for measure in ("SHADOW-MS", "EDGE-ERROR-PX")}
    assert all(Path(one).read_bytes().isascii() for one in files)
    for option, words in (("--device", "no such device"), ("--extractor", "not clear which")):
        arguments = ("--format", "aslib", option, "nobody", "--store", store)
        result = gnomon("evidence", "export", tmp_path / "x", *arguments)
        assert result.exit_code == StoreError.exit_code
        assert words in result.stderr


def test_prune_says_what_goes_and_takes_it_only_when_told(store: Path) -> None:
    gone = {"judgements": 8, "timings": 8, "samples": 48, "instances": 3, "runs": 1, "devices": 0}
    dry = answered("evidence", "prune", "--stale", "--dry-run", "--store", store)
    assert dry == {"dry_run": True, **gone}
    result = gnomon("evidence", "prune", "--stale", "--store", store)
    assert result.exit_code == 2
    assert "8 judgements" in result.stdout
    assert "Nobody can be asked" in result.stderr
    assert answered("evidence", "prune", "--stale", "--yes", "--json", "--store", store) == {
        "dry_run": False,
        **gone,
    }
    assert "nothing" in succeeded("evidence", "prune", "--stale", "--yes", "--store", store).stdout
    assert (
        answered("evidence", "prune", "--older-than", "2030-01-02", "--yes", "--store", store)["judgements"]
        == 0
    )
    assert answered("evidence", "prune", "--device", "softpipe", "--yes", "--store", store)["judgements"] == 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("prune",), "Say what is to go"),
        (("prune", "--stale", "--json"), "nobody can be asked"),
        (("prune", "--older-than", "20301231", "--yes"), "no day"),
        (("prune", "--older-than", "2030-02-30", "--yes"), "no day"),
        (("export", "x", "--device", "y"), "go with --format aslib"),
        (("export", "x", "--format", "xml"), "xml"),
        (("import",), "Missing argument"),
    ],
)
def test_options_that_make_no_sense_are_refused(store: Path, arguments: tuple[str, ...], words: str) -> None:
    result = gnomon("evidence", *arguments, "--store", store, width=200)
    assert result.exit_code == 2
    assert words in result.stderr


def test_what_is_no_store_is_a_sentence_and_an_exit_code(tmp_path: Path) -> None:
    for arguments in (("ls",), ("show", "abcd"), ("export", tmp_path / "x")):
        result = gnomon("evidence", *arguments, "--store", tmp_path / "missing")
        assert result.exit_code == StoreError.exit_code == 7
        assert "There is no such evidence store" in result.stderr
    assert not (tmp_path / "missing").exists()


def test_the_page_names_every_command_and_option() -> None:
    commands = get_command(evidence).commands  # type: ignore[attr-defined]
    for name, command in commands.items():
        assert f"gnomon evidence {name}" in PAGE
        for parameter in command.params:
            for option in parameter.opts:
                if option.startswith("--"):
                    assert re.search(rf"`[^`]*{option}\b", PAGE), option
    known = {option for command in commands.values() for one in command.params for option in one.opts}
    assert set(re.findall(r"(?<![\w-])--[a-z][a-z-]+", PAGE)) <= known | {"--help"}
