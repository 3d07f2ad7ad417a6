"""A service of its own process, which a test may kill. Its port is the first line that it says."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

from api.service.application import Entries
from api.service.listening import serve
from api.service.settings import Limits, Settings
from tests.api.service import strange_workers


def main() -> None:
    state, model, real = sys.argv[1:]
    limits = replace(Limits(), attempts=1000, starts=1000, queue=100)
    settings = Settings(Path(state), Path(model), port=0, readers=1, limits=limits)
    entries = None if real == "real" else Entries(strange_workers.read, strange_workers.measure)
    serve(settings, say, entries)


def say(url: str) -> None:
    sys.stdout.write(f"{url}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
