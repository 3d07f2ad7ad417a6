"""The thesis' orderings and scenes: what holds of them on a device, as values; the scenes as level files."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from api.destinations import ready_folder
from renderers.clock import ClockKind, truthful_clock
from renderers.context import Device, Gpu
from scenes.atomic_file import output_error
from scenes.errors import OutputError
from scenes.gltf.writer import glb_bytes
from scenes.scene import Scene
from scenes.thesis.export import write_thesis_scenes
from scenes.thesis.registry import OPEN_SCENES, THESIS_SCENES
from selector.candidate import Candidate
from selector.measurement_record import candidate_record, measurement_record
from selector.ordering_grades import Grade, grades
from selector.ordering_measuring import Thoroughness, measured_trials, set_up_named, trials_of
from selector.ordering_records import Finding, Ordering
from selector.ordering_results import Results, TrialResult
from selector.ordering_trials import Ask, Trial
from selector.thesis_orderings import FASTER

EXPORT = "--export"

Json = dict[str, Any]


@dataclass(frozen=True)
class Order:
    """What to check, and how.

    Attributes:
        orderings: Those that are checked.
        thoroughness: How carefully.
        device: Index or name; the first that works where None.
    """

    orderings: tuple[Ordering, ...]
    thoroughness: Thoroughness
    device: str | None


@dataclass
class Workload:
    """Orderings that are ready to be checked on an open device.

    Attributes:
        order: What was asked.
        asks: What is measured, trial by trial.
        device: Where.
        clock: How time is told there.
        trials: Those that are measured so far.
    """

    order: Order
    asks: tuple[Ask, ...]
    device: Device
    clock: ClockKind
    _gpu: Gpu
    trials: dict[Trial, TrialResult] = field(default_factory=dict)

    @property
    def steps(self) -> list[int]:
        """Steps of each trial."""
        plan = self.order.thoroughness.plan
        return [plan(ask.trial).steps(1, len(ask.contenders)) for ask in self.asks]

    @property
    def results(self) -> Results:
        """What is there so far."""
        return Results(self.trials)

    def measured(self, on_step: Callable[[str], None]) -> Iterator[Trial]:
        """Measures one trial after the other; each is named when it is done.

        Raises:
            DeviceError: The device cannot hold a scene.
        """
        for trial, result in measured_trials(self._gpu, self.asks, self.order.thoroughness, on_step):
            self.trials[trial] = result
            yield trial

    def findings(self) -> tuple[tuple[Ordering, Finding], ...]:
        """Each ordering with whether it holds."""
        results = self.results
        return tuple((ordering, ordering.finding(results)) for ordering in self.order.orderings)

    def grades(self) -> tuple[Grade, ...]:
        """The thesis' grades of the scenes that were measured with all techniques."""
        return grades(self.results)


@contextmanager
def thesis_check(order: Order) -> Iterator[Workload]:
    """Opens the device.

    Raises:
        DeviceError: There is no such device.
    """
    with Gpu(order.device) as gpu:
        yield Workload(order, trials_of(order.orderings), gpu.device, truthful_clock(gpu), gpu)


def result_record(work: Workload) -> Json:
    """All findings with all that was measured, as JSON values."""
    thoroughness = work.order.thoroughness
    return {
        "device": work.device.as_dict(),
        "clock": str(work.clock),
        "resolution": [thoroughness.width, thoroughness.height],
        "rounds": thoroughness.rounds,
        "faster": FASTER,
        "orderings": [
            {
                "id": ordering.id,
                "sentence": ordering.sentence,
                "rule": ordering.rule,
                "holds": finding.holds,
                "reason": finding.reason,
                "evidence": [asdict(one) for one in finding.evidence],
            }
            for ordering, finding in work.findings()
        ],
        "grades": [asdict(grade) for grade in work.grades()],
        "trials": [_trial_record(ask, work.trials[ask.trial]) for ask in work.asks],
    }


def export_scenes(folder: Path) -> list[Path]:
    """Writes the thesis' scenes as GLB files into a folder, which is made if need be; gives their paths.

    Raises:
        OutputError: The system refuses to write there, or another file has the name of one of them.
    """
    ready_folder(folder, EXPORT)
    for key, scene in (THESIS_SCENES | OPEN_SCENES).items():
        _check_spares(folder / f"{key}.glb", scene)
    try:
        return write_thesis_scenes(folder)
    except OutputError as error:
        raise _of_export(error) from error


def _check_spares(path: Path, scene: Callable[[], Scene]) -> None:
    """Refuse to overwrite a file that holds anything else than what would be written."""
    try:
        spared = path.exists() and (not path.is_file() or path.read_bytes() != glb_bytes(scene()))
    except OSError as error:
        raise _of_export(output_error(path, error)) from error
    if spared:
        raise OutputError(
            "Another file is there, which is not this scene of the thesis: it is not overwritten.",
            where=str(path),
            remedy=f"Choose another folder with {EXPORT}, or move that file away.",
        )


def _of_export(error: OutputError) -> OutputError:
    """The same, in the words of this command's option."""
    remedy = error.remedy.replace("-o", EXPORT)
    return OutputError(error.what, where=error.where, known=error.known, remedy=remedy)


def _trial_record(ask: Ask, result: TrialResult) -> Json:
    trial, set_up = ask.trial, set_up_named(ask.trial.set_up)
    return {
        "set_up": trial.set_up,
        "figure": set_up.figure,
        "scene": set_up.scene,
        "halved": trial.halved,
        "moving": trial.moving,
        "contenders": [
            {"name": one.name, **candidate_record(one.candidate), **_halves(result, one.candidate)}
            for one in ask.contenders
        ],
        "measurement": measurement_record(result.measurement),
    }


def _halves(result: TrialResult, candidate: Candidate) -> Json:
    found = result.halves.get(candidate)
    return {
        "near_wrong_share": found.near if found else None,
        "far_wrong_share": found.far if found else None,
    }
