"""The features of stored instances: from the store where they are kept, else from scenes made again."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

from features.extraction import extract, extractor_version
from features.level_survey import LevelSurvey
from scenes.corpus.spec import Spec
from scenes.corpus.staging import instance
from scenes.errors import GnomonError
from scenes.formats.registry import read_level
from scenes.scene import Camera, Scene, View
from selector.evidence.rows import InstanceRow
from selector.evidence.store import Store

Values = dict[str, dict[str, float]]
OnInstance = Callable[[int, int, str], None]
"""Hears of how many of how many features are found next, and of what."""

AT_ONCE = 50
"""Instances whose features are kept together, so that little is lost when a run is ended."""


def extractor() -> str:
    """Name and version under which a store keeps features."""
    return f"gnomon-{extractor_version()}"


def features_of(
    store: Store, rows: Sequence[InstanceRow], levels: Path | None, on_instance: OnInstance
) -> tuple[Values, dict[str, str]]:
    """Features by instance key, and why some have none.

    What is found anew is kept in the store.

    Args:
        store: Where they may be kept.
        rows: The instances.
        levels: Folder with the level files that instances come from; None where there are none.
        on_instance: Hears of what is looked at next.
    """
    kept = store.features(extractor())
    found: Values = {row.key: kept[row.key] for row in rows if row.key in kept}
    waiting = [row for row in rows if row.key not in kept]
    problems: dict[str, str] = {}
    fresh: Values = {}
    costs: Values = {}
    done = 0
    for origin, some in groupby(sorted(waiting, key=lambda row: row.origin), key=lambda row: row.origin):
        of_scene = list(some)
        on_instance(done, len(waiting), of_scene[0].family)
        done += len(of_scene)
        try:
            scene = _scene(origin, levels)
        except GnomonError as error:
            problems |= {row.key: str(error) for row in of_scene}
            continue
        for key, values, cost in _extracted(scene, of_scene, problems):
            fresh[key], costs[key] = values, cost
        if len(fresh) >= AT_ONCE:
            store.add_features(extractor(), fresh, costs)
            found, fresh, costs = found | fresh, {}, {}
    if fresh:
        store.add_features(extractor(), fresh, costs)
    return found | fresh, problems


def _scene(origin: str, levels: Path | None) -> Scene:
    if origin.startswith("{"):
        return instance(Spec.from_text(origin))
    places = sorted(levels.rglob(origin)) if levels else []
    if not places:
        remedy = "Name the folder that holds it with --levels."
        raise GnomonError(f"The level {origin} is not there.", remedy=remedy)
    return read_level(places[0]).scene


def _extracted(
    scene: Scene, rows: Sequence[InstanceRow], problems: dict[str, str]
) -> Iterator[tuple[str, dict[str, float], dict[str, float]]]:
    """Key, features and costs in milliseconds of each instance whose scene is still the same."""
    if not scene.triangle_count:
        problems |= {row.key: "Its scene is empty." for row in rows}
        return
    survey = LevelSurvey.of(scene)
    for row in rows:
        if row.scene_digest != scene.digest:
            problems[row.key] = "Its scene is made or read differently today."
            continue
        view = View(camera_of(row.camera), row.width, row.height)
        found = extract(survey, scene.lights[int(row.light["index"])], view)
        costs = {"level_ms": 1e3 * survey.seconds / len(rows), "light_ms": 1e3 * found.seconds}
        yield row.key, dict(found.values), costs


def camera_of(record: Mapping[str, Any]) -> Camera:
    """The camera that a row tells of."""
    position, forward, up = (_vector(record[name]) for name in ("position", "forward", "up"))
    fov, near = float(record["yfov_rad"]), float(record["near_m"])
    node = record.get("node")
    name = str(record.get("name", ""))
    return Camera(name, position, forward, up, fov, near, None if node is None else int(node))


def _vector(values: Sequence[float]) -> tuple[float, float, float]:
    x, y, z = (float(one) for one in values)
    return x, y, z
