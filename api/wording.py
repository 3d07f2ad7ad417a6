"""Numbers with their nouns."""

from __future__ import annotations


def counted(number: int, what: str) -> str:
    """`1 light`, `2 lights`."""
    return f"{number:,} {what}" if number == 1 else f"{number:,} {what}s"
