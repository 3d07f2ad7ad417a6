"""docs/commands.md names every command and every option, and shows JSON that is what comes out."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from typer.main import get_command

from api.cli.failures import EXIT_MEANINGS
from api.cli.program import app
from scenes.errors import DeviceError, GnomonError, LevelError, OutputError
from scenes.formats.registry import level_formats
from tests.api.command import QUICK, answered
from tests.selector.learning_evidence import filled
from tests.small_level import small_level

PAGE = (Path(__file__).parents[2] / "docs/commands.md").read_text()
COMMANDS = sorted(command.callback.__name__ for command in app.registered_commands if command.callback)
SECTIONS = {
    part.partition("\n")[0].strip("`").removeprefix("gnomon "): part for part in PAGE.split("\n## ")[1:]
}


def options(command: str) -> list[str]:
    group = get_command(app)
    parameters = group.commands[command].params  # type: ignore[attr-defined]
    return [
        name
        for parameter in parameters
        for name in (*parameter.opts, *parameter.secondary_opts)
        if name.startswith("-")
    ]


def shown_json(command: str) -> object:
    """The keys of the first JSON example of a section, comments taken out."""
    (text,) = re.findall(r"```json\n(.*?)```", SECTIONS[command], re.DOTALL)[:1]
    return json.loads(text)


def test_every_command_has_a_section() -> None:
    assert len(COMMANDS) >= 12
    assert set(COMMANDS) <= set(SECTIONS)


@pytest.mark.parametrize("command", COMMANDS)
def test_every_option_is_in_its_section(command: str) -> None:
    assert options(command)
    missing = [name for name in options(command) if not re.search(rf"`[^`]*{name}\b", SECTIONS[command])]
    assert missing == []


@pytest.mark.parametrize("command", COMMANDS)
def test_no_option_is_made_up(command: str) -> None:
    known = {name for one in COMMANDS for name in options(one)} | {"--version", "--help", "-h"}
    named = set(re.findall(r"(?<![\w-])--[a-z][a-z-]+", SECTIONS[command]))
    assert named <= known


@pytest.mark.parametrize("command", COMMANDS)
def test_every_section_has_an_example(command: str) -> None:
    assert f"\ngnomon {command}" in SECTIONS[command]


def test_every_suffix_of_a_level_is_named() -> None:
    bullet = PAGE[PAGE.index("- **LEVEL**") : PAGE.index("- **Lights and cameras**")]
    assert [suffix for suffix in level_formats() if f"`{suffix}`" not in bullet] == []


def test_every_exit_code_is_in_the_table() -> None:
    codes = [
        *EXIT_MEANINGS,
        *(error.exit_code for error in (GnomonError, LevelError, DeviceError, OutputError)),
    ]
    for code in set(codes):
        assert re.search(rf"^\| {code} \|", PAGE, re.MULTILINE), code


@pytest.mark.parametrize("command", [one for one in COMMANDS if "--json" in options(one)])
def test_the_json_that_is_shown_has_the_keys_that_come_out(command: str, tmp_path: Path) -> None:
    level, store, model = small_level(tmp_path), tmp_path / "made.sqlite", tmp_path / "made.model"
    if command in ("train", "evaluate", "recommend"):
        filled(store)
    if command == "recommend":
        answered("train", "--store", store, "--quick", "-o", model)
    arguments = {
        "annotate": [level, *QUICK],
        "compare": [level, "--resolution", "96x64", "--rounds", "1", "-t", "SV", "--light", "Lamp"],
        "recommend": [level, "--model", model, "--light", "Lamp"],
        "features": [level, "--light", "Lamp"],
        "train": ["--store", store, "--quick", "-o", model],
        "evaluate": ["--store", store],
        "inspect": [level],
        "render": [level, "--resolution", "96x64", "-t", "SV", "-o", tmp_path / "p.png"],
        "thesis": ["--only", "O10", "--no-times", "--resolution", "80x64"],
        "corpus": [],
        "benchmark": [
            *("--corpus", level, "--resolution", "96x64", "-t", "SV", "--lights", 1, "--views", 1),
            *("--store", tmp_path / "evidence.sqlite"),
        ],
        "rebenchmark": [
            *("--corpus", level, "--resolution", "96x64", "-t", "SV", "--rounds", 1, "--no-train"),
            *("--store", tmp_path / "nights.sqlite", "-o", tmp_path / "night.html"),
        ],
        "devices": [],
    }
    free = FREE | FREE_TOO.get(command, frozenset())
    assert keys(shown_json(command), free) == keys(answered(command, *arguments[command]), free)


# What differs by technique, and what a reader need not see.
FREE = frozenset({"settings", "counters", "stages_ms", "runner_up", "runner-up", "measurement"})
FREE_TOO = {
    # Keyed by names of choices and families; one policy stands for all.
    "evaluate": frozenset({"by_family", "wins", "picks", "speed", "quality", "static"}),
    "recommend": frozenset({"features", "refused", "decided_by", "outside_training"}),
    "features": frozenset({"values"}),
}


def keys(value: object, free: frozenset[str]) -> object:
    """The shape of a JSON value: keys, and the shape of the first entry of each list."""
    if isinstance(value, dict):
        return {key: None if key in free else keys(entry, free) for key, entry in value.items()}
    if isinstance(value, list):
        return [keys(value[0], free)] if value and isinstance(value[0], dict) else []
    return None
