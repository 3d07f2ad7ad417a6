"""Predictions are written into a level file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from api.added_lights import check_place, write_lights_beside
from api.choosing import require_file, require_triangles
from api.destinations import check_output
from api.predicting import Predicted, Wish
from models.artifact import Artifact
from scenes.errors import OutputError
from scenes.formats.registry import LevelFormat, format_of, read_level
from scenes.level import Level
from scenes.level_file import read_level_file
from scenes.level_output import luggage, write_level
from selector.learning.advice import annotation


@dataclass(frozen=True)
class Order:
    """What to annotate with predictions.

    Attributes:
        level: The level file.
        scene: Which of its scenes; the default one where None.
        target: The annotated level.
        in_place: Whether the level itself is overwritten; the target is the level then.
        wish: What is asked about its lights.
        added_lights: Lights in words, to be written beside plain geometry that has none.
    """

    level: Path
    scene: str | None
    target: Path
    in_place: bool
    wish: Wish
    added_lights: Sequence[str] = ()


@dataclass(frozen=True)
class Annotating:
    """A level that is ready to be annotated: everything that can be checked before has been.

    Attributes:
        order: What was asked.
        level: The level.
        left_behind: Files outside the level's folder that it names, and that do not go with it.
        lights_file: That was written with the lights added, if any were.
    """

    order: Order
    level: Level
    left_behind: tuple[Path, ...]
    lights_file: Path | None
    _source: bytes
    _format: LevelFormat

    def write(self, found: Sequence[Predicted], artifact: Artifact) -> tuple[Path, ...]:
        """Writes the annotated level, unless no light has an answer; gives all that was written.

        Raises:
            OutputError: It cannot be written, or the level has changed since.
        """
        order = self.order
        nodes = [light.node for light in self.level.scene.lights]
        data = annotated(self._format, self._source, nodes, found, artifact)
        if data is None:
            return ()
        if order.in_place and read_level_file(order.level) != self._source:
            raise OutputError(
                "The level has changed meanwhile, so it was left as it is.",
                where=str(order.level),
                remedy="Run the command again.",
            )
        return write_level(order.level, order.target, data, self._format)


def annotating(order: Order) -> Annotating:
    """Reads the level, and checks all that can be checked before anything is asked.

    Raises:
        LevelError: The level cannot be read.
        AddedLightError: There is no place for the lights added.
        OutputError: The output could not be written.
    """
    require_file(order.level)
    level_format = format_of(order.level)
    source = read_level_file(order.level)
    lights_file = None
    if order.added_lights:
        check_place(order.level, order.added_lights)
        check_output(order, source, level_format)
        lights_file = write_lights_beside(order.level, order.scene, order.added_lights)
    level = read_level(order.level, order.scene)
    require_triangles(level)
    check_output(order, source, level_format)
    left_behind = luggage(order.level, order.target, source, level_format).left_behind
    return Annotating(order, level, left_behind, lights_file, source, level_format)


def annotated(
    level_format: LevelFormat,
    source: bytes,
    nodes: Sequence[int | None],
    found: Sequence[Predicted],
    artifact: Artifact,
) -> bytes | None:
    """The level file with predictions, and what it said of other lights; None where there are none."""
    advice = {
        _node(nodes[one.light]): annotation(one.prediction, one.views, artifact.card)
        for one in found
        if one.prediction
    }
    if not advice:
        return None
    standing = level_format.read_annotations(source)
    return level_format.annotate(source, {**standing, **advice})


def _node(node: int | None) -> int:
    assert node is not None, "every level format says which node carries a light"
    return node
