"""One question to the service, asked in a thread of its own. Nothing here touches Blender's data."""

from __future__ import annotations

from dataclasses import dataclass
from threading import Thread

from .client.asking import Ask
from .client.cancellation import Cancellation
from .client.errors import CancelledRequestError, ClientError, ProblemError
from .client.records import LevelAnswer
from .client.service import Service


@dataclass(frozen=True)
class Outcome:
    """What came of it: an answer, or a sentence that says why there is none."""

    answer: LevelAnswer | None = None
    problem: str = ""
    cancelled: bool = False


class Question:
    """A level that the service is being asked about.

    Args:
        service: Whom to ask.
        cancellation: The service's.
        level: A GLB.
        ask: What to ask.
    """

    def __init__(self, service: Service, cancellation: Cancellation, level: bytes, ask: Ask) -> None:
        self._service, self._cancellation, self._level, self._ask = service, cancellation, level, ask
        self._outcome = Outcome(problem="The question was not answered.")
        # A daemon: Blender can be closed while it waits.
        self._thread = Thread(target=self._run, name="gnomon", daemon=True)
        self._thread.start()

    @property
    def outcome(self) -> Outcome | None:
        """What came of it; None while it is being asked."""
        return None if self._thread.is_alive() else self._outcome

    def cancel(self) -> None:
        """Ends it at once."""
        self._cancellation.cancel()

    def join(self, seconds: float) -> None:
        """Waits until it has ended, at most so long."""
        self._thread.join(seconds)

    def _run(self) -> None:
        try:
            self._outcome = Outcome(self._service.level(self._level, self._ask))
        except CancelledRequestError:
            self._outcome = Outcome(problem="Cancelled.", cancelled=True)
        except ProblemError as error:
            needs_token = " Set the token in the add-on's preferences." if error.status == 401 else ""
            self._outcome = Outcome(problem=f"{error}{needs_token}")
        except ClientError as error:
            self._outcome = Outcome(problem=str(error))
