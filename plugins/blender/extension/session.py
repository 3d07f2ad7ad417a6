"""What is being asked, and what was said last: the only state of the extension."""

from __future__ import annotations

from dataclasses import dataclass, field

import bpy

from .applying import Applied, Detail, apply
from .client.asking import Ask
from .client.cancellation import Cancellation
from .client.records import LevelAnswer
from .client.service import Service
from .level_export import ExportedLevel
from .question import Outcome, Question

POLL_S = 0.1
SECONDS_TO_END = 5.0
MOST_PATIENCE_S = 60.0
"""So long a service is asked again that is too busy."""
UNDO_NAME = "Recommend shadow techniques"
DRAWN_IN = ("VIEW_3D", "PROPERTIES")


@dataclass
class Session:
    """The one session of a Blender.

    Attributes:
        question: What is being asked; None if nothing is.
        nodes: Which node of the level in question is which light.
        note: A sentence about lights that were not asked about.
        status: What to tell the user.
        failed: Whether that is bad news.
        details: `session_uid` of a light to what was said of it, as long as Blender runs.
    """

    question: Question | None = None
    nodes: dict[int, int | None] = field(default_factory=dict)
    note: str = ""
    status: str = ""
    failed: bool = False
    details: dict[int, Detail] = field(default_factory=dict)


SESSION = Session()


def ask(level: ExportedLevel, wanted: Ask, url: str, token: str, seconds: float, note: str = "") -> None:
    """Begins to ask the service; the answer is taken by a timer, in the main thread.

    Raises:
        AddressError: The address or the token is none.
    """
    cancellation = Cancellation()
    service = Service(
        url,
        token=token,
        level_timeout_s=seconds,
        patience_s=min(seconds, MOST_PATIENCE_S),
        cancellation=cancellation,
    )
    SESSION.nodes, SESSION.note = level.lights, note
    SESSION.status, SESSION.failed = f"Asking {service.address} ...", False
    SESSION.question = Question(service, cancellation, level.data, wanted)
    _stop_timer()
    # Persistent: opening another file must not leave the answer waiting for ever.
    bpy.app.timers.register(poll, first_interval=POLL_S, persistent=True)


def poll() -> float | None:
    """Takes the answer if it is there; else the seconds until the next look. Blender's timer calls it."""
    question = SESSION.question
    if question is None:
        return None
    outcome = question.outcome
    if outcome is None:
        return POLL_S
    SESSION.question = None
    _take(outcome)
    redraw()
    return None


def finish(seconds: float) -> None:
    """Waits for the answer and takes it: for scripts, which have no timers."""
    _stop_timer()
    question = SESSION.question
    if question is None:
        return
    question.join(seconds)
    if question.outcome is None:
        question.cancel()
        question.join(SECONDS_TO_END)
    SESSION.question = None
    _take(question.outcome or Outcome(problem="The service has not answered in time."))


def tell(words: str, *, failed: bool) -> None:
    """Shows a sentence in the panels."""
    SESSION.status, SESSION.failed = words, failed
    redraw()


def shut_down() -> None:
    """Ends what is being asked, and forgets everything."""
    _stop_timer()
    if SESSION.question:
        SESSION.question.cancel()
        SESSION.question.join(SECONDS_TO_END)
    vars(SESSION).update(vars(Session()))


def redraw() -> None:
    """Has the panels drawn anew."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type in DRAWN_IN:
                area.tag_redraw()


def _stop_timer() -> None:
    if bpy.app.timers.is_registered(poll):
        bpy.app.timers.unregister(poll)


def _take(outcome: Outcome) -> None:
    if outcome.answer is None:
        tell(outcome.problem, failed=not outcome.cancelled)
        return
    done = apply(outcome.answer, SESSION.nodes)
    SESSION.details |= done.details
    if done.details:
        bpy.ops.ed.undo_push(message=UNDO_NAME)
    tell(_words(outcome.answer, done), failed=not done.told)


def _words(answer: LevelAnswer, done: Applied) -> str:
    told = f"{len(done.told)} light" + ("" if len(done.told) == 1 else "s")
    first = f"{told} recommended for {answer.policy}." if done.told else "No light has a recommendation."
    return " ".join([first, *done.problems[:3], SESSION.note]).strip()
