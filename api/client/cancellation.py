"""A way to end a request from another thread."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Event, Lock


class Cancellation:
    """Ends the request that it was handed to, at once, whatever that is waiting for."""

    def __init__(self) -> None:
        self._event = Event()
        self._lock = Lock()
        self._actions: list[Callable[[], None]] = []

    @property
    def cancelled(self) -> bool:
        """Whether it has been cancelled."""
        return self._event.is_set()

    def cancel(self) -> None:
        """Ends what is going on, and everything that is asked with it later."""
        with self._lock:
            self._event.set()
            actions = tuple(self._actions)
        for action in actions:
            action()

    def wait(self, seconds: float) -> bool:
        """Sleeps, unless it is cancelled; whether it is."""
        return self._event.wait(max(seconds, 0.0))

    @contextmanager
    def interrupting(self, action: Callable[[], None]) -> Iterator[None]:
        """Within the block, cancelling calls the action, from the thread that cancels."""
        with self._lock:
            self._actions.append(action)
        if self.cancelled:
            action()
        try:
            yield
        finally:
            with self._lock:
                self._actions.remove(action)
