"""`make flip-agreement`: how well the error figures rank candidates as FLIP does, measured on many views.

Shadow volumes are the truth and therefore left out: a figure that is 0 by construction agrees with itself.
Random scenes of every class under every kind of light, the example street, and real levels where
`../shared/levels` is there. Errors do not depend on the machine, nor on what else runs on it.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
from rich.console import Console
from rich.table import Table
from scipy.stats import kendalltau, spearmanr

from renderers.context import Gpu
from renderers.error_figures import ErrorFigures
from renderers.registry import GROUND_TRUTH
from scenes.formats.registry import read_level
from scenes.ray_caster import RayCaster
from scenes.scene import Camera, Light, LightKind, Scene
from scenes.street import street
from scenes.viewpoints import viewpoints
from selector.candidate import candidates
from selector.measurement import Measurement, Status, ViewRun
from selector.measuring import Bench, Plan
from tests.random_scenes import CLASSES, random_camera, random_light, random_scene

LEVELS = Path(__file__).parents[3] / "shared" / "levels"
LEVEL_FILES = (
    "gltf/blenvy_start_level.glb",
    "gltf/kenney_fps.glb",
    "gltf/kenney_platformer.glb",
    "gltf/godot_lights_and_shadows.glb",
    "gltf/playcanvas_lights.glb",
    "quake/dm6.glb",
    "quake/e1m1.glb",
)
LIGHTS_PER_LEVEL = 4
SIZE = (320, 240)
FIGURES = ("edge_error_px", "wrong_share", "edge_error_p95_px")
DRAWS = 300

Values = npt.NDArray[np.float64]
Group = tuple[Scene, Light, tuple[Camera, ...]]


@dataclass(frozen=True)
class Row:
    """One candidate in one view.

    Attributes:
        source: The class of random scene, or the level.
        view: Number of the view, unique over all sources.
        candidate: Its label.
        boundary_px: Length of the true shadow edge.
    """

    source: str
    kind: str
    view: int
    candidate: str
    technique: str
    flip: float
    boundary_px: float
    wrong_share: float
    edge_error_px: float
    edge_error_p95_px: float

    @property
    def flip_of_edge(self) -> float:
        """FLIP summed over the picture, for each pixel of the true edge: however much edge a view shows."""
        return self.flip * SIZE[0] * SIZE[1] / self.boundary_px


@dataclass(frozen=True)
class Agreement:
    """How well one figure agrees with FLIP; intervals are 95 %, by drawing views anew.

    Attributes:
        quartiles: Of Kendall's tau between the candidates of one view, over the views.
        better: Share of pairs of candidates in one view that both order alike, ties counting half.
        tau: Kendall's, over all candidates of all views at once, with its interval.
        rho: Spearman's, the same.
        tau_of_edge: Kendall's with FLIP per pixel of edge, over all views at once.
        rho_of_edge: Spearman's, the same.
    """

    figure: str
    views: int
    rows: int
    quartiles: tuple[float, float, float]
    better: float
    tau: tuple[float, float, float]
    rho: tuple[float, float, float]
    tau_of_edge: tuple[float, float, float]
    rho_of_edge: tuple[float, float, float]


def random_groups(seeds: int) -> Iterator[tuple[str, Group]]:
    """A view of every class of random scene under every kind of light, for each seed."""
    for seed in range(seeds):
        for geometry in CLASSES:
            scene = random_scene(geometry, seed)
            for kind in LightKind:
                yield geometry, (scene, random_light(kind, seed), (random_camera(seed),))


def level_groups() -> Iterator[tuple[str, Group]]:
    """The example street, and what there is of the real levels, a few lights of each."""
    scene = street()
    for light in scene.lights:
        yield "street", (scene, light, scene.cameras)
    for name in LEVEL_FILES:
        if not (LEVELS / name).is_file():
            continue
        scene = read_level(LEVELS / name).scene
        seen = RayCaster(scene, casters_only=False)
        for light in scene.lights[:: max(1, -(-len(scene.lights) // LIGHTS_PER_LEVEL))]:
            yield Path(name).stem, (scene, light, scene.cameras or viewpoints(scene, light, seen))


def rows_of(gpu: Gpu, source: str, group: Group, first_view: int) -> list[Row]:
    """Every candidate of the device in every view of one light; views with too short an edge have none."""
    scene, light, cameras = group
    wanted = [one for one in candidates(light.kind, gpu.device.limits) if one.technique != GROUND_TRUTH]
    named = [replace(camera, name=str(first_view + index)) for index, camera in enumerate(cameras)]
    with Bench(gpu, scene, Plan(*SIZE, rounds=0)) as bench:
        measured = bench.measure(light, named, wanted)
    return [
        _row(
            source, light, one.candidate.label, one.candidate.technique, view.camera, view.flip, view.figures
        )
        for one in measured.measurements
        for view in _drawn_by_itself(one)
        if view.figures and view.figures.edge_error_px is not None and view.flip is not None
    ]


def _drawn_by_itself(one: Measurement) -> Sequence[ViewRun]:
    """The views of a candidate, but for the last one where another technique was drawn in its place."""
    return one.views[:-1] if one.status is Status.REFUSED else one.views


def _row(
    source: str, light: Light, label: str, technique: str, view: str, flip: float, figures: ErrorFigures
) -> Row:
    kept = {name: getattr(figures, name) for name in ("boundary_px", *FIGURES)}
    return Row(source, str(light.kind), int(view), label, technique, flip, **kept)


def agreement(rows: Sequence[Row], figure: str, random: np.random.Generator) -> Agreement:
    """How well `figure` ranks the candidates as FLIP does."""
    views: dict[int, list[Row]] = defaultdict(list)
    for row in rows:
        views[row.view].append(row)
    tables = [
        np.array([[getattr(row, figure), row.flip, row.flip_of_edge] for row in some])
        for some in views.values()
        if len(some) > 1
    ]
    whole, of_edge = ([table[:, [0, column]] for table in tables] for column in (1, 2))
    taus = [_kendall(*pair.T) for pair in whole]
    low, middle, high = np.percentile([tau for tau in taus if np.isfinite(tau)], [25, 50, 75])
    return Agreement(
        figure,
        len(tables),
        sum(map(len, tables)),
        (float(low), float(middle), float(high)),
        _alike(whole),
        _interval(whole, _kendall, random),
        _interval(whole, _spearman, random),
        _interval(of_edge, _kendall, random),
        _interval(of_edge, _spearman, random),
    )


def _kendall(one: Values, other: Values) -> float:
    return float(kendalltau(one, other).statistic)


def _spearman(one: Values, other: Values) -> float:
    return float(spearmanr(one, other).statistic)


def _alike(pairs: Sequence[Values]) -> float:
    agree = total = 0.0
    for pair in pairs:
        one, other = (np.sign(values[:, None] - values) for values in pair.T)
        upper = np.triu_indices(len(pair), 1)
        product = (one * other)[upper]
        agree += np.count_nonzero(product > 0) + np.count_nonzero(product == 0) / 2
        total += len(product)
    return float(agree / total)


def _interval(
    pairs: Sequence[Values], measure: Callable[[Values, Values], float], random: np.random.Generator
) -> tuple[float, float, float]:
    """The value, and 2.5 % and 97.5 % of what it is when views are drawn anew."""
    drawn = [
        measure(*np.concatenate([pairs[index] for index in random.integers(0, len(pairs), len(pairs))]).T)
        for _ in range(DRAWS)
    ]
    low, high = np.percentile(drawn, [2.5, 97.5])
    return measure(*np.concatenate(pairs).T), float(low), float(high)


def _table(console: Console, title: str, found: Sequence[tuple[str, Agreement]]) -> None:
    table = Table(title=title)
    for heading in ("", "figure", "views", "rows", "tau in a view: quartiles", "pairs ordered alike"):
        table.add_column(heading)
    for heading in ("pooled tau", "Spearman", "tau, FLIP per px of edge", "Spearman, the same"):
        table.add_column(heading)
    for name, one in found:
        table.add_row(
            name,
            one.figure,
            str(one.views),
            str(one.rows),
            " ".join(f"{value:.2f}" for value in one.quartiles),
            f"{one.better:.1%}",
            *(
                "{:.2f} [{:.2f}, {:.2f}]".format(*value)
                for value in (one.tau, one.rho, one.tau_of_edge, one.rho_of_edge)
            ),
        )
    console.print(table)


def _groups_of(rows: Sequence[Row]) -> dict[str, list[Row]]:
    """The rows by source, by kind of light and by technique."""
    found: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        for name in (row.source, row.kind, row.technique):
            found[name].append(row)
    return dict(found)


def main() -> None:
    """Render, compare and print; with --json all rows as well."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=13, help="random scenes of each class and kind of light")
    parser.add_argument("--device")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    rows: list[Row] = []
    views, start = 0, time.perf_counter()
    console = Console(stderr=True)
    with Gpu(arguments.device) as gpu, console.status("rendering") as status:
        for groups in (level_groups(), random_groups(arguments.seeds)):
            for source, group in groups:
                rows += rows_of(gpu, source, group, views)
                views += len(group[2])
                status.update(f"{views} views, {time.perf_counter() - start:.0f} s: {source}")
        device = gpu.device
    random = np.random.default_rng(1)
    whole = [("all", agreement(rows, figure, random)) for figure in FIGURES]
    parts = [
        (name, agreement(some, figure, random))
        for name, some in _groups_of(rows).items()
        for figure in FIGURES[:2]
    ]
    if arguments.json:
        found = [{"part": name, **asdict(one)} for name, one in (*whole, *parts)]
        record = {"device": device.as_dict(), "views": views, "agreement": found}
        json.dump({**record, "rows": [asdict(row) for row in rows]}, sys.stdout)
        return
    console = Console(width=200)
    short = views - len({row.view for row in rows})
    seconds = time.perf_counter() - start
    _table(console, f"{views} views of {SIZE[0]}x{SIZE[1]}, {short} with too short an edge", whole)
    _table(console, "the same by source, kind of light and technique", parts)
    console.print(f"{seconds:.0f} s on {device.renderer}")


if __name__ == "__main__":
    main()
