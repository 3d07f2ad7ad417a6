"""Numbers with their nouns, and texts that any reader can take."""

from __future__ import annotations

import os
from pathlib import Path

KIB, MIB = 1 << 10, 1 << 20


def counted(number: int, what: str) -> str:
    """`1 light`, `2 lights`."""
    return f"{number:,} {what}" if number == 1 else f"{number:,} {what}s"


def amount(size: int) -> str:
    """`4.0 MiB`, or `1.5 KiB`; what memory and files take."""
    return f"{size / MIB:,.1f} MiB" if size >= MIB else f"{size / KIB:,.1f} KiB"


def path_words(path: Path) -> str:
    """`path` as text that has a UTF-8 form: bytes of a name that are no UTF-8 are replaced."""
    return os.fsencode(path).decode("utf-8", "replace")


def shortened(text: str, longest: int) -> str:
    """`text`, or its beginning and how much more there is of it."""
    more = len(text) - longest
    return text if more <= 0 else f"{text[:longest]}... and {more:,} more characters"
