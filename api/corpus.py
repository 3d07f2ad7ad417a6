"""The corpus from outside: its families, what it covers beside real levels, and its scenes as files."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from api.wording import path_words
from scenes.atomic_file import output_error
from scenes.corpus.axes import Axes, Surveyed
from scenes.corpus.bins import AXES, AxisBins
from scenes.corpus.registry import families
from scenes.corpus.showcase import showcase
from scenes.corpus.spec import Spec
from scenes.corpus.staging import instance
from scenes.errors import LevelError
from scenes.formats.registry import level_formats, read_level
from scenes.gltf.writer import write_glb
from scenes.scene import Camera, Light, Scene
from scenes.viewpoints import viewpoints

Json = dict[str, Any]
Advance = Callable[[str], None]

MOST_VIEWS = 2
"""Of each light of a level: more tell little that is new."""


@dataclass(frozen=True)
class LevelRows:
    """What the lights of a level are like, or why it could not be read."""

    path: Path
    rows: tuple[Axes, ...]
    failure: str = ""


@dataclass(frozen=True)
class Coverage:
    """What a corpus covers, and where levels lie beside it.

    Attributes:
        corpus: Its name.
        rows: One for each of its instances.
        levels: The levels that were compared.
    """

    corpus: str
    rows: tuple[Axes, ...]
    levels: tuple[LevelRows, ...]

    def counts(self, axis: AxisBins) -> tuple[list[int], list[int]]:
        """How many instances, and how many lights of levels, are in each bin of an axis."""
        return axis.counts(list(self.rows)), axis.counts([row for level in self.levels for row in level.rows])

    def outside(self, axis: AxisBins) -> dict[str, int]:
        """Level -> how many of its rows are in bins of an axis that no instance is in."""
        covered = axis.counts(list(self.rows))
        missed = {
            path_words(level.path): sum(covered[axis.bin_of(row)] == 0 for row in level.rows)
            for level in self.levels
        }
        return {name: count for name, count in missed.items() if count}

    def record(self) -> Json:
        """As JSON values."""
        axes = []
        for axis in AXES:
            corpus, levels = self.counts(axis)
            bins = [
                {"bin": label, "corpus": ours, "levels": theirs}
                for label, ours, theirs in zip(axis.labels, corpus, levels, strict=True)
            ]
            axes.append({"axis": axis.name, "title": axis.title, "bins": bins, "outside": self.outside(axis)})
        return {
            "corpus": self.corpus,
            "instances": len(self.rows),
            "levels": [
                {"level": path_words(one.path), "rows": len(one.rows), "failure": one.failure}
                for one in self.levels
            ],
            "axes": axes,
        }


def family_records() -> list[Json]:
    """Every family as JSON values, in the order of names."""
    return [
        {
            "family": name,
            "summary": family.SUMMARY,
            "indoor": family.INDOOR,
            "triangles": list(family.TRIANGLES),
            "kinds": [str(kind) for kind in family.KINDS],
        }
        for name, family in families().items()
    ]


def surveyed(specs: tuple[Spec, ...], advance: Advance) -> tuple[Axes, ...]:
    """The first light of each instance in its first camera; `advance` hears of each before it begins."""
    rows = []
    for spec in specs:
        advance(spec.set_up or spec.family)
        scene = instance(spec)
        rows.append(Surveyed.of(scene).axes(scene.lights[0], scene.cameras[0]))
    return tuple(rows)


def level_files(folder: Path) -> list[Path]:
    """The level files in a folder and all folders in it, in order.

    Raises:
        LevelError: There is no such folder, or it holds none.
    """
    found = sorted(path for path in folder.rglob("*") if path.suffix.lower() in level_formats())
    if not found:
        what = "There is no level file in this folder." if folder.is_dir() else "This is no folder."
        known = f"Level files end in {', '.join(sorted(level_formats()))}."
        raise LevelError(what, where=str(folder), known=known)
    return found


def surveyed_levels(paths: list[Path], advance: Advance) -> tuple[LevelRows, ...]:
    """Every light of every level in at most two of its views; what cannot be read is said so."""
    found = []
    for path in paths:
        advance(path.name)
        try:
            scene = read_level(path).scene
        except LevelError as error:
            found.append(LevelRows(path, (), error.what))
            continue
        found.append(LevelRows(path, tuple(_rows(scene)) if scene.triangle_count and scene.lights else ()))
    return tuple(found)


def export(folder: Path, names: tuple[str, ...], seed: int) -> Iterator[tuple[Spec, Path]]:
    """Writes the showcase of each family into a folder, which is made if need be: `FAMILY-SEED.glb`.

    Raises:
        SpecError: There is no such family.
        OutputError: A file or the folder cannot be written.
    """
    specs = [showcase(name, seed) for name in names or families()]
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise output_error(folder, error) from error
    for spec in specs:
        path = folder / f"{spec.family}-{spec.seed}.glb"
        write_glb(instance(spec), path)
        yield spec, path


def _rows(scene: Scene) -> Iterator[Axes]:
    survey = Surveyed.of(scene)
    for light in scene.lights:
        for camera in _views(scene, light, survey):
            yield survey.axes(light, camera)


def _views(scene: Scene, light: Light, survey: Surveyed) -> tuple[Camera, ...]:
    if scene.cameras:
        return scene.cameras[:MOST_VIEWS]
    made = viewpoints(scene, light, survey.seen)
    return (made[0], made[-1]) if made else ()
