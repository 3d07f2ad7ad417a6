"""Ctrl-C that cannot get lost."""

from __future__ import annotations

import signal
import threading
from contextlib import AbstractContextManager
from types import FrameType, TracebackType
from typing import Self


class Interruption(AbstractContextManager["Interruption"]):
    """Remembers Ctrl-C for as long as it is entered.

    Python raises KeyboardInterrupt wherever it happens to be. In a destructor or a callback from C it is
    printed and dropped, and an error raised while it unwinds takes its place: a measurement of hours would
    then go on although its user has ended it.
    """

    def __init__(self) -> None:
        self._pressed = False
        self._before: signal._HANDLER = None

    def __enter__(self) -> Self:
        """Begin to listen, where Python lets this thread."""
        if threading.current_thread() is threading.main_thread():
            self._before = signal.signal(signal.SIGINT, self._remember)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Listen no more; what was lost until now is raised."""
        if self._before is not None:
            signal.signal(signal.SIGINT, self._before)
        if error is None:
            self.check()

    def check(self) -> None:
        """Raise KeyboardInterrupt if Ctrl-C was pressed."""
        if self._pressed:
            raise KeyboardInterrupt

    def forget(self) -> None:
        """What was pressed has been answered."""
        self._pressed = False

    def _remember(self, number: int, frame: FrameType | None) -> None:
        del number, frame
        self._pressed = True
        raise KeyboardInterrupt
