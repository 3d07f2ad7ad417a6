"""How `gnomon recommend` and `gnomon annotate --mode predict` go: a model is asked about a level's lights."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import typer
from rich.console import Console
from rich.text import Text

from api.added_lights import level_with_lights
from api.choosing import require_file
from api.cli.failures import EXIT_INCOMPLETE
from api.cli.learning_tables import print_predictions
from api.cli.level_warnings import print_left_behind, print_warnings
from api.cli.progress import MeasuringProgress
from api.cli.terminal import errors, flush_results, print_json, printable, results
from api.predicted_annotating import Order, annotating
from api.predicting import Outline, Predicted, Wish, predicted
from api.prediction_records import level_record
from api.wording import path_words
from models.artifact import Artifact, load
from models.shipped import SHIPPED_MODEL
from scenes.level import Level

LONGEST_LINE = 4200
"""A path is never shortened, and Linux takes 4096 bytes of it."""


@dataclass(frozen=True)
class Asked:
    """What `gnomon recommend` is asked.

    Attributes:
        level: The level file.
        scene: Which of its scenes; the default one where None.
        added_lights: Lights in words, which come after the level's own.
        model: The model's file; the one that comes with Gnomon where None.
        wish: What is asked about the lights.
    """

    level: Path
    scene: str | None
    added_lights: Sequence[str]
    model: Path | None
    wish: Wish


def run_recommend(asked: Asked, *, as_json: bool) -> None:
    """Predicts, and prints the answers.

    Raises:
        Exit: Some lights have no recommendation.
    """
    artifact = load(asked.model or SHIPPED_MODEL)
    require_file(asked.level)
    level = level_with_lights(asked.level, asked.scene, asked.added_lights)
    print_warnings(errors(), level)
    found = _answers(level, artifact, asked.wish)
    _print(level, artifact, asked.wish, found, as_json=as_json)


def run_predicted_annotate(order: Order, model: Path | None, *, as_json: bool) -> None:
    """Predicts, writes the answers into the level, and says what came out.

    Raises:
        Exit: Some lights have no recommendation.
    """
    artifact = load(model or SHIPPED_MODEL)
    ready = annotating(order)
    print_warnings(errors(), ready.level)
    print_left_behind(errors(), ready.left_behind)
    found = _answers(ready.level, artifact, order.wish)
    written = ready.write(found, artifact)
    files = [*filter(None, [ready.lights_file]), *written]

    def say(console: Console) -> None:
        for path in files:
            console.print(Text(printable(f"Wrote {path}.", LONGEST_LINE)), soft_wrap=True)
        if not written:
            console.print(Text("No level was written: there is nothing to annotate it with."), soft_wrap=True)

    output = path_words(written[-1]) if written else None
    more: dict[str, Any] = {"output": output, "written": [path_words(path) for path in files]}
    _print(ready.level, artifact, order.wish, found, as_json=as_json, more=more, say=say)


def _answers(level: Level, artifact: Artifact, wish: Wish) -> list[Predicted]:
    """All answers, with progress where it takes long."""
    count = len(wish.lights) or len(level.scene.lights)
    found = []
    with MeasuringProgress(errors(), [1] * max(count, 1), patient=True) as progress:
        for one in predicted(level, artifact, wish):
            found.append(one)
            progress.step(level.scene.lights[one.light].name)
            progress.light_done()
    return found


def _print(
    level: Level,
    artifact: Artifact,
    wish: Wish,
    found: Sequence[Predicted],
    *,
    as_json: bool,
    more: dict[str, Any] | None = None,
    say: Callable[[Console], None] | None = None,
) -> None:
    if as_json:
        print_json(
            level_record(path_words(level.path), Outline.of(level), artifact, wish, found) | (more or {})
        )
    else:
        print_predictions(results(), level, found)
        if say:
            say(results())
    flush_results()
    if any(one.prediction is None for one in found):
        raise typer.Exit(EXIT_INCOMPLETE)
