"""Tables in the attribute-relation file format, as ASlib has it (Bischl et al. 2016, appendix)."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

Value = str | float | int

_PLAIN = re.compile(r"[A-Za-z0-9_./=-]+")


@dataclass(frozen=True)
class Attribute:
    """A column.

    Attributes:
        name: In ASCII.
        choices: Words that it may hold; none for numbers and free words.
        text: Whether it holds free words.
    """

    name: str
    choices: tuple[str, ...] = ()
    text: bool = False

    @property
    def kind(self) -> str:
        """As the header has it."""
        if self.choices:
            return "{" + ",".join(self.choices) + "}"
        return "STRING" if self.text else "NUMERIC"


def arff(relation: str, attributes: Sequence[Attribute], rows: Iterable[Sequence[Value]]) -> bytes:
    """A whole file; what is not a number is `?`."""
    header = [f"@ATTRIBUTE {_quoted(one.name)} {one.kind}" for one in attributes]
    lines = [",".join(map(_written, row)) for row in rows]
    return "\n".join([f"@RELATION {relation}", "", *header, "", "@DATA", *lines, ""]).encode("ascii")


def plain_name(text: str) -> str:
    """A text of letters, digits and `_./=-` only, which no reader needs quotes for."""
    return re.sub(r"[^A-Za-z0-9_./=-]+", "_", text) or "_"


def _written(value: Value) -> str:
    if isinstance(value, str):
        return _quoted(value)
    return "?" if math.isnan(value) else repr(value)


def _quoted(text: str) -> str:
    assert _PLAIN.fullmatch(text), text
    return text
