"""How `gnomon serve` goes: it says where it is, and what it answers."""

from __future__ import annotations

import logging

from rich.console import Console
from rich.text import Text

from api.cli.terminal import errors, printable
from api.service.listening import serve
from api.service.settings import Settings

LONGEST_LINE = 2000


class _Lines(logging.Handler):
    """Log lines on stderr, in which nothing that a client sent can move the cursor."""

    def __init__(self, console: Console) -> None:
        super().__init__()
        self._console = console

    def emit(self, record: logging.LogRecord) -> None:
        for line in self.format(record).splitlines():
            self._console.print(Text(printable(line, LONGEST_LINE)), soft_wrap=True)


def run_serve(settings: Settings, *, quiet: bool) -> None:
    """Serves until Ctrl-C.

    Raises:
        GnomonError: It cannot be started as it was asked for.
    """
    console = errors()
    handler = _Lines(console)
    handler.setFormatter(logging.Formatter("%(asctime)s %(message)s", "%Y-%m-%d %H:%M:%S"))
    ours = logging.getLogger("api.service")
    ours.addHandler(handler)
    ours.setLevel(logging.WARNING if quiet else logging.INFO)

    def announce(url: str) -> None:
        console.print(Text(f"Gnomon is at {url} - open it in a browser. Ctrl-C ends it."), soft_wrap=True)

    try:
        serve(settings, announce)
    finally:
        ours.removeHandler(handler)
