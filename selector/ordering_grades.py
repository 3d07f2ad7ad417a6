"""The thesis' own grades of speed and quality, beside what is measured."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from selector.ordering_contenders import SV
from selector.ordering_results import Results, Run, UnmeasuredError
from selector.ordering_timed import CHAN, PSM, SM, TIMED, trial

# Table 2 of the thesis, scenes in the order of figure 46: speed, quality; 5 is best.
_GRADES = {
    SM: ((5, 2), (5, 3), (5, 2), (5, 4), (5, 1)),
    PSM: ((4, 3), (3, 3), (5, 2), (4, 2), (4, 3)),
    SV: ((1, 5), (2, 5), (5, 5), (3, 5), (3, 5)),
    CHAN: ((2, 4), (1, 5), (5, 5), (2, 4), (2, 3)),
}


@dataclass(frozen=True)
class Grade:
    """One technique in one scene: the author's opinion in 2005, and figures of this device.

    Attributes:
        scene: The scene.
        technique: The technique's label.
        speed: The thesis' grade from 1 to 5, which is best.
        quality: The same.
        shadow_ms: Measured time; None where none was measured.
        relative: That time over the fastest technique's in the scene.
        edge_error_px: Mean displacement of the edge; None where it could not be measured.
    """

    scene: str
    technique: str
    speed: int
    quality: int
    shadow_ms: float | None
    relative: float | None
    edge_error_px: float | None


def grades(results: Results) -> tuple[Grade, ...]:
    """All of them, scene by scene, of the scenes that were measured with all four techniques."""
    return tuple(_grades(results))


def _grades(results: Results) -> Iterator[Grade]:
    for index, set_up in enumerate(TIMED):
        where = trial(set_up)
        if any(results.measurement(where, one) is None for one in _GRADES):
            continue
        runs: dict[str, Run | None] = {}
        for one in _GRADES:
            try:
                runs[one.name] = results.run(where, one)
            except UnmeasuredError:
                runs[one.name] = None
        fastest = min((run.ms for run in runs.values() if run and run.samples), default=None)
        for one, of_scenes in _GRADES.items():
            run = runs[one.name]
            ms = run.ms if run and run.samples else None
            yield Grade(
                scene=set_up.name,
                technique=one.candidate.method.label,
                speed=of_scenes[index][0],
                quality=of_scenes[index][1],
                shadow_ms=ms,
                relative=ms / fastest if ms is not None and fastest else None,
                edge_error_px=run.view.figures.edge_error_px if run and run.view.figures else None,
            )
