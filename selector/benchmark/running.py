"""A benchmark from its plan to the store: who is asked what, and what becomes of those that are lost."""

from __future__ import annotations

import time
from collections import Counter, defaultdict, deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from selector.benchmark.crew import Bounds, Crew, Entry, Lost, Member
from selector.benchmark.messages import Asks, Failed, Finished, Job, Judged, Part, Ready, Task, Timed, Word
from selector.benchmark.notary import Notary
from selector.benchmark.questions import Question
from selector.benchmark.resuming import Known
from selector.benchmark.tally import Tally
from selector.benchmark.worker import enter
from selector.evidence.rows import CandidateRow, DeviceRow, InstanceRow, Purpose
from selector.evidence.store import Store
from selector.measurement import Status

FRAME_TIMEOUT_S = 4.0
UNTIMED_FACTOR = 4.0
"""Where no times are asked for a frame may take so many times longer: on a busy core it does."""


@dataclass(frozen=True)
class Order:
    """What a benchmark does.

    Attributes:
        job: How each question is answered.
        questions: The most informative first.
        codes: Technique's id -> hash of its code.
        workers: How many processes answer.
        deadline: On the monotonic clock: after that no further question is asked; None for no limit.
        resume: Whether what is fresh in the store is left out.
        bounds: When a worker is given up; None for the usual.
        entry: What runs in a worker's process.
    """

    job: Job
    questions: Sequence[Question]
    codes: Mapping[str, str]
    workers: int = 1
    deadline: float | None = None
    resume: bool = True
    bounds: Bounds | None = None
    entry: Entry = enter


@dataclass
class _Case:
    """A question that a worker is at.

    Attributes:
        task: The question.
        row: It, as the store has it, once the worker has told.
        barred: What failed when it was judged and is not timed. Kept last: how idle the machine was is asked
            with the first result, over the time since the instance began.
    """

    task: Task
    row: InstanceRow | None = None
    barred: list[Timed] = field(default_factory=list)


@dataclass
class Score:
    """How far a benchmark is.

    Attributes:
        total: Questions of the plan.
        fresh: Questions that the store had all answers to.
        done: Questions that were answered, or failed, since.
        failed: Origins of those that nobody could answer, with the reason.
        statuses: How the candidates of this run ended.
        seconds: Where the workers' time went.
        lost: How many workers had to be replaced.
    """

    total: int = 0
    fresh: int = 0
    done: int = 0
    failed: list[tuple[str, str]] = field(default_factory=list)
    statuses: Counter[Status] = field(default_factory=Counter)
    seconds: dict[str, float] = field(default_factory=lambda: defaultdict(float))
    lost: int = 0


class Benchmark:
    """One run for one purpose.

    Attributes:
        order: What is asked for.
        score: How far it is.
        tally: Who wins, with what the store held before.
        device: Where; None before the first worker is ready.
        notary: Writes everything down.
    """

    def __init__(self, store: Store, order: Order) -> None:
        self.order, self._store = order, store
        self.score = Score(total=len(order.questions))
        self.tally = Tally()
        self.device: DeviceRow | None = None
        self.notary = Notary(store, order.job, order.codes)
        self._started = time.monotonic()
        self._waiting: deque[Task] = deque()
        self._cases: dict[int, _Case] = {}
        self._candidates: dict[str, CandidateRow] = {}
        self._done: set[tuple[str, str]] = set()
        self._barred: Mapping[tuple[str, str], tuple[Status, str]] = {}
        self._second_chances: set[object] = set()

    @property
    def elapsed_s(self) -> float:
        """Since it was set up."""
        return time.monotonic() - self._started

    @property
    def remaining_s(self) -> float | None:
        """Estimate from what is done so far; None where nothing is."""
        left = self.score.total - self.score.fresh - self.score.done
        if not self.score.done:
            return None
        estimate_s = self.elapsed_s / self.score.done * left
        if self.order.deadline is None:
            return estimate_s
        return min(estimate_s, max(self.order.deadline - time.monotonic(), 0.0))

    def run(self) -> Iterator[str]:
        """Goes on until all is asked; gives a few words, or none, several times a second.

        Raises:
            DeviceError: There is no device.
            StoreError: The store takes no more. What it has taken stays.
        """
        order = self.order
        size = max(1, min(order.workers, len(order.questions)))
        bounds = order.bounds or Bounds.of(FRAME_TIMEOUT_S, size)
        with Crew(order.job, size, bounds, order.entry) as crew:
            while self.device is None or self._goes_on():
                for member, word in crew.events():
                    yield self._hear(crew, member, word)
                self._ask(crew)
                yield ""

    def _goes_on(self) -> bool:
        return bool(self._waiting or self._cases)

    def _ask(self, crew: Crew) -> None:
        if self.order.deadline is not None and time.monotonic() >= self.order.deadline:
            self._waiting.clear()
        for member in crew.members:
            if member.ready and self._waiting:
                task = self._waiting.popleft()
                self._cases[id(member)] = _Case(task)
                crew.give(member, task)

    def _hear(self, crew: Crew, member: Member, word: Word | Lost) -> str:
        if isinstance(word, Lost):
            return self._lose(self._cases.pop(id(member), None), word)
        if isinstance(word, Ready) and self.device is None:
            self._begin(word)
        elif isinstance(word, Asks):
            crew.reply(member, self._pose(self._cases[id(member)], word))
            return f"{word.instance.scene} ({word.instance.family})"
        elif isinstance(word, (Judged, Timed)):
            self._keep(self._cases[id(member)], word)
        elif isinstance(word, (Finished, Failed)):
            self._close(self._cases.pop(id(member)), word)
        return ""

    def _begin(self, ready: Ready) -> None:
        """Now the device is known, and with it what is fresh."""
        self.device = ready.device
        self.notary.begin(ready.device)
        questions = list(self.order.questions)
        known = Known(self._store, self.order.job, self.order.codes, ready.device.key, ready.limits)
        self.tally.techniques.update(known.techniques)
        known.fill(self.tally)
        self._barred = known.barred
        if self.order.resume:
            self._done |= known.done
            questions = known.unanswered(questions)
        self.score.fresh = self.score.total - len(questions)
        self._waiting.extend(Task(question) for question in questions)

    def _pose(self, case: _Case, word: Asks) -> frozenset[str]:
        """Which candidates are wanted."""
        case.row = word.instance
        self.notary.attend()
        rows = {row.key: row for row in word.candidates}
        self._candidates.update(rows)
        self.tally.techniques.update({key: row.technique for key, row in rows.items()})
        wanted = {key for key in rows if (word.instance.key, key) not in self._done}
        if self.order.job.purpose is Purpose.TIMES:
            for key in sorted(wanted):
                if failure := self._barred.get((word.instance.key, key)):
                    case.barred.append(Timed(key, *failure))
                    wanted.remove(key)
        return frozenset(wanted)

    def _keep(self, case: _Case, word: Judged | Timed) -> None:
        assert case.row is not None
        start = time.perf_counter()
        if isinstance(word, Judged):
            self.tally.judge(self.notary.judgement(case.row, self._candidates[word.candidate], word))
        else:
            self.tally.time(self.notary.timing(case.row, self._candidates[word.candidate], word))
        self.score.seconds["store"] += time.perf_counter() - start
        self.score.statuses[word.status] += 1
        self._done.add((case.row.key, word.candidate))

    def _close(self, case: _Case, word: Finished | Failed) -> None:
        self.score.done += 1
        if isinstance(word, Failed):
            self.score.failed.append((case.task.question.origin, word.reason))
            return
        assert case.row is not None
        for word_of_barred in case.barred:
            self._keep(case, word_of_barred)
        for part, seconds in word.seconds.items():
            self.score.seconds[part] += seconds
        if self.order.job.purpose is Purpose.TIMES:
            self.tally.close(case.row.key, surely=True)

    def _lose(self, case: _Case | None, lost: Lost) -> str:
        """Blames the candidate that the worker was at, and asks the rest again."""
        self.score.lost += 1
        if case is None:
            return "a worker was replaced"
        task = case.task
        if lost.candidate:
            assert case.row is not None
            if not (lost.killed and self._first((case.row.key, lost.candidate))):
                self._blame(case, lost)
        elif lost.part is Part.SCENE or not self._first(task.question):
            self._close(case, Failed(f"{lost.status} while at the {lost.part}: {lost.reason}"))
            return f"{task.question.origin} failed"
        elif lost.part is Part.TRUTH:
            task = replace(task, rays=True)
        self._waiting.appendleft(task)
        return f"a worker was lost: {lost.reason}"

    def _first(self, what: object) -> bool:
        """Whether this is asked for the first time; a second chance is the last."""
        first = what not in self._second_chances
        self._second_chances.add(what)
        return first

    def _blame(self, case: _Case, lost: Lost) -> None:
        status, reason = lost.status, lost.reason
        if lost.killed:
            status, reason = Status.OUT_OF_MEMORY, f"{reason} twice, as by a system that runs out of memory"
        if self.order.job.purpose is Purpose.ERRORS:
            self._keep(case, Judged(lost.candidate, status, reason))
        else:
            self._keep(case, Timed(lost.candidate, status, reason))
