"""What a job found, as plain data: the page and the JSON say the same."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from models.contesting import Contest
from renderers.registry import technique
from selector.evidence.rows import CandidateRow, DeviceRow, InstanceRow
from selector.rebenchmark.drift import ALPHA, FEWEST, FLOOR, Shift
from selector.rebenchmark.pairing import Difference
from selector.rebenchmark.promotion import RULE, Decision
from selector.rebenchmark.watching import Move

Json = dict[str, Any]
MOST_DIFFERENCES = 50
FORMAT, VERSION = "gnomon rebenchmark", 1


@dataclass(frozen=True)
class Sampled:
    """What the sample says.

    Attributes:
        seed: Of the drawing.
        wanted: Instances that were drawn.
        measured: Instances that bear witness: they have calm times, old and new.
        disturbed: Instances that do not, since other programs were at work.
        canary_ratio: New over old calm canary; None where there is no old one.
        families: How many families they are of.
        shifts: Times by technique and mobility.
        compared: Judgements of unchanged code whose figures were compared.
        differences: Those that differ.
        failed: Instances that could not be measured, with the reason.
        remarks: What may have disturbed the times.
    """

    seed: int
    wanted: int
    measured: int
    disturbed: int
    canary_ratio: float | None
    families: int
    shifts: tuple[Shift, ...] = ()
    compared: int = 0
    differences: tuple[Difference, ...] = ()
    failed: tuple[tuple[str, str], ...] = ()
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True)
class Judged:
    """What became of the model.

    Attributes:
        decision: Whether the new one is in force.
        contest: Both on the same folds; None where there was nothing to be compared with.
        as_is: Whether the old model was asked as it is, since what it was learnt from is not in the store.
        chooses_by: How the new model chooses; empty where none was learnt.
        digest: Of what the new model was learnt from; empty likewise.
        instances: How many that were.
        champion: Whether there was an old model.
    """

    decision: Decision
    contest: Contest | None = None
    as_is: bool = False
    chooses_by: str = ""
    digest: str = ""
    instances: int = 0
    champion: bool = True


@dataclass(frozen=True)
class Watched:
    """What became of the lights of watched levels.

    Attributes:
        levels: How many were read.
        lights: How many lights they have that strike anything.
        policy: Under which.
        moves: Lights whose answer has moved, or would if the new model were promoted.
        in_force: Whether the moves are: the new model was promoted.
        problems: Levels that could not be asked about, with the reason.
        asked: Whether there was a model before, whose answers could have moved.
    """

    levels: int
    lights: int
    policy: str
    moves: tuple[Move, ...]
    in_force: bool
    problems: tuple[tuple[str, str], ...]
    asked: bool = True


@dataclass(frozen=True)
class Report:
    """A whole job.

    Attributes:
        started: UTC, ISO 8601.
        elapsed_s: How long it took so far.
        finished: Whether this is the end; a report is written as soon as drift is known, and again.
        store: Path or URL.
        commit: Of the code.
        device: Where.
        former: The same hardware under the driver of before, whose times were compared with; None where the
            driver is the same.
        baseline: Whether there was nothing to compare with, so that this job made a beginning.
        stale: Technique -> reason, or `fresh` -> instances.
        unreachable: Why instances cannot be measured again -> how many.
        causes: Why a new model was learnt; none where there was no reason to.
        sampled: What the sample says; None in a baseline.
        remeasured: Instances by purpose that were measured again beyond the sample.
        left: Stale instances and techniques that the time limit left for the next job.
        judged: The models.
        judged_digest: Of the evidence whose model was compared last, by this job or an earlier one.
        watched: The lights.
    """

    started: str
    elapsed_s: float
    finished: bool
    store: str
    commit: str
    device: DeviceRow
    former: DeviceRow | None = None
    baseline: bool = False
    stale: Mapping[str, Mapping[str, int]] = field(default_factory=dict)
    unreachable: Mapping[str, int] = field(default_factory=dict)
    causes: tuple[str, ...] = ()
    sampled: Sampled | None = None
    remeasured: Mapping[str, int] = field(default_factory=dict)
    left: int = 0
    judged: Judged | None = None
    judged_digest: str = ""
    watched: Watched | None = None

    @property
    def drifted(self) -> tuple[Shift, ...]:
        """Times that have moved."""
        return tuple(one for one in self.sampled.shifts if one.alarm) if self.sampled else ()

    @property
    def differs(self) -> bool:
        """Whether errors or counters of unchanged code are not what they were."""
        return bool(self.sampled and self.sampled.differences)

    @property
    def moved(self) -> tuple[Move, ...]:
        """Lights whose answer has moved for good."""
        return self.watched.moves if self.watched and self.watched.in_force else ()

    @property
    def blind(self) -> bool:
        """Whether the sample could be held against nothing."""
        return self.sampled is not None and not self.sampled.measured and not self.sampled.compared

    @property
    def calls(self) -> bool:
        """Whether somebody should look; a busy machine is no reason."""
        disturbed = self.sampled is not None and self.sampled.disturbed > 0
        return bool(self.drifted or self.differs or self.moved or (self.blind and not disturbed))


def record(report: Report, instances: Mapping[str, InstanceRow], known: Mapping[str, CandidateRow]) -> Json:
    """The report as JSON values.

    Args:
        report: The report.
        instances: By key, to say what differences are about.
        known: Candidates by key, likewise.
    """
    return {
        "format": FORMAT,
        "version": VERSION,
        "started": report.started,
        "elapsed_s": round(report.elapsed_s, 1),
        "finished": report.finished,
        "verdict": verdict(report),
        "alarm": report.calls,
        "store": report.store,
        "commit": report.commit,
        "device": asdict(report.device),
        "former_device": asdict(report.former) if report.former else None,
        "baseline": report.baseline,
        "stale": {name: dict(counts) for name, counts in report.stale.items()},
        "unreachable": dict(report.unreachable),
        "causes": list(report.causes),
        "sample": _sample_record(report.sampled, instances, known) if report.sampled else None,
        "remeasured": dict(report.remeasured),
        "left": report.left,
        "model": _model_record(report.judged) if report.judged else None,
        "judged_digest": report.judged_digest,
        "watched": _watched_record(report.watched) if report.watched else None,
    }


def verdict(report: Report) -> str:
    """The whole report in a sentence or two."""
    if report.baseline:
        return "There was nothing to compare with, so a baseline was measured."
    words = []
    if report.drifted:
        names = dict.fromkeys(technique(one.technique).label for one in report.drifted)
        words.append(f"Times have drifted: {', '.join(names)}.")
    if report.differs:
        words.append("Errors or counters differ although the code is the same.")
    if report.moved:
        count = len(report.moved)
        words.append(f"The answer has moved for {count} watched {'light' if count == 1 else 'lights'}.")
    if report.blind:
        words.append("Nothing could be compared with before.")
    return " ".join(words) if words else "Nothing has moved."


def _sample_record(
    found: Sampled, instances: Mapping[str, InstanceRow], known: Mapping[str, CandidateRow]
) -> Json:
    return {
        "seed": found.seed,
        "wanted": found.wanted,
        "measured": found.measured,
        "disturbed": found.disturbed,
        "canary_ratio": found.canary_ratio,
        "families": found.families,
        "alpha": ALPHA,
        "floor": FLOOR,
        "fewest": FEWEST,
        "drift": [_shift_record(one) for one in found.shifts],
        "compared": found.compared,
        "differences": [
            _difference_record(one, instances, known) for one in found.differences[:MOST_DIFFERENCES]
        ],
        "differences_in_all": len(found.differences),
        "failed": [{"origin": origin, "reason": reason} for origin, reason in found.failed],
        "remarks": list(found.remarks),
    }


def _shift_record(one: Shift) -> Json:
    return {
        "technique": one.technique,
        "label": technique(one.technique).label,
        "mobility": str(one.mobility),
        "instances": one.instances,
        "ratio": one.ratio,
        "interval": [one.low, one.high],
        "p_value": one.p_value,
        "alarm": one.alarm,
        "ratios": list(one.ratios),
    }


def _difference_record(
    one: Difference, instances: Mapping[str, InstanceRow], known: Mapping[str, CandidateRow]
) -> Json:
    candidate = known[one.candidate]
    return {
        "instance": one.instance,
        "scene": instances[one.instance].scene,
        "technique": candidate.technique,
        "settings": dict(candidate.settings),
        "what": one.what,
        "old": one.old,
        "new": one.new,
    }


def _model_record(found: Judged) -> Json:
    decision = found.decision
    return {
        "promoted": decision.promoted,
        "champion": found.champion,
        "why": decision.why,
        "rule": RULE,
        "kept": str(decision.kept) if decision.kept else None,
        "chooses_by": found.chooses_by,
        "digest": found.digest,
        "instances": found.instances,
        "as_is": found.as_is,
        "contest": _contest_record(found.contest) if found.contest else None,
    }


def _contest_record(found: Contest) -> Json:
    champion, challenger, best = (
        found.by_family(costs).mean(axis=1).tolist()
        for costs in (found.champion, found.challenger, found.best)
    )
    mean, low, high = found.difference()
    rows = []
    for index, one in enumerate(found.questions):
        change, least, most = found.difference(index)
        rows.append(
            {
                "policy": one.name,
                "mobility": one.time,
                "champion": champion[index],
                "challenger": challenger[index],
                "best": best[index],
                "difference": change,
                "interval": [least, most],
            }
        )
    families = Counter(found.families.tolist())
    return {
        "difference": mean,
        "interval": [low, high],
        "families": len(families),
        "instances": len(found.families),
        "questions": rows,
    }


def _watched_record(found: Watched) -> Json:
    return {
        "levels": found.levels,
        "lights": found.lights,
        "policy": found.policy,
        "in_force": found.in_force,
        "asked": found.asked,
        "moves": [_move_record(one) for one in found.moves],
        "problems": [{"level": level, "reason": reason} for level, reason in found.problems],
    }


def _move_record(one: Move) -> Json:
    return {
        "level": one.level,
        "light": one.light,
        "index": one.index,
        "mobility": str(one.mobility),
        "from": asdict(one.old) if one.old else None,
        "to": asdict(one.new),
        "why": one.why,
    }
