"""Exact byte spans in raw JSON text, and insertions and removals that leave every other byte as it is.

Grammar: RFC 8259. The text is walked segment by segment, from one bracket to the next: the regular
expressions do the work inside a segment, a list of open brackets replaces recursion.
"""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Sequence
from typing import Any, NamedTuple

from scenes.errors import LevelError

_SPACE = rb"[ \t\n\r]*"
# Written so that no text can be matched in two ways: a match that fails costs linear time.
_STRING = rb'"[^"\\\x00-\x1f]*(?:\\(?:["\\/bfnrt]|u[0-9a-fA-F]{4})[^"\\\x00-\x1f]*)*"'
_NUMBER = rb"-?(?:0|[1-9][0-9]*)(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?"
_SCALAR = rb"(?:" + _STRING + rb"|" + _NUMBER + rb"|true|false|null)"
_KEY = _STRING + _SPACE + rb":" + _SPACE

_BLANKS = b" \t\n\r"
_COMMA, _OPENING_BRACKETS = ord(","), b"{["
_LONGEST_SEPARATOR = 256


class _Segments(NamedTuple):
    """What may follow an opening bracket, a comma and a nested container, up to the next bracket."""

    first: re.Pattern[bytes]
    following: re.Pattern[bytes]
    after_nested: re.Pattern[bytes]
    item: re.Pattern[bytes]


def _segments(key: bytes, closing: bytes) -> _Segments:
    one = _SPACE + key + _SCALAR + _SPACE
    # At most 256 items at once: `re` remembers every repetition until the match ends.
    body = b"(?:%b,){0,256}(?:%b%b|%b%b[{[]|(?<=,))" % (one, one, closing, _SPACE, key)
    return _Segments(
        first=re.compile(b"%b%b|%b" % (_SPACE, closing, body)),
        following=re.compile(body),
        after_nested=re.compile(b"%b(?:%b|,%b)" % (_SPACE, closing, body)),
        item=re.compile(
            b"%b,?%b(?P<start>)%b(?:(?P<scalar>%b)|(?P<nested>[{[]))" % (_SPACE, _SPACE, key, _SCALAR)
        ),
    )


_IN_OBJECT = _segments(_KEY, rb"\}")
_IN_ARRAY = _segments(b"", rb"\]")
_ROOT = re.compile(rb"(?:\xef\xbb\xbf)?" + _SPACE + rb"(?=\{)")
_NAME = re.compile(_STRING)


class Span(NamedTuple):
    """Bytes from `start` up to but not including `end`."""

    start: int
    end: int


class Item(NamedTuple):
    """A member of an object, with its key, or an element of an array, without one.

    Attributes:
        start: First byte of the key, or of the element.
        value: Span of the value.
        name: The member's decoded key; empty for an element.
    """

    start: int
    value: Span
    name: str

    @property
    def end(self) -> int:
        """First byte after the value."""
        return self.value.end


class Edit(NamedTuple):
    """Bytes `start` to `end` give way to `replacement`."""

    start: int
    end: int
    replacement: bytes


class RawJson:
    """JSON text whose root is an object, with the byte span of every container in it.

    Args:
        text: UTF-8, with or without a byte order mark; `trailing` bytes may follow the root.
        where: Name of the file, for errors.
        offset: Byte of the file at which `text` starts, for errors.
        trailing: Bytes that may follow the root object.

    Raises:
        LevelError: The text is not UTF-8, not JSON, or its root is not an object.
    """

    def __init__(self, text: bytes, *, where: str = "", offset: int = 0, trailing: bytes = _BLANKS) -> None:
        self.text = text
        self._where = where
        self._offset = offset
        try:
            text.decode()
        except UnicodeDecodeError as error:
            raise self._broken(error.start, "The JSON text is not UTF-8.") from error
        start = _ROOT.match(text)
        if not start:
            raise self._broken(0, "The text does not start with a JSON object.")
        self._ends: dict[int, int] = {}
        self._walk(start.end())
        self.root = Span(start.end(), self._ends[start.end()])
        rest = text[self.root.end :].lstrip(trailing)
        if rest:
            raise self._broken(len(text) - len(rest), "Something follows the JSON text.")

    def items(self, container: Span) -> list[Item]:
        """The members of an object or the elements of an array, in the order of the text."""
        is_object = self.kind(container) == "{"
        pattern = (_IN_OBJECT if is_object else _IN_ARRAY).item
        items = []
        position = container.start + 1
        while match := pattern.match(self.text, position, container.end):
            nested = match.start("nested")
            value = Span(nested, self._ends[nested]) if nested >= 0 else Span(*match.span("scalar"))
            start = match.start("start")
            items.append(Item(start, value, self._name_at(start) if is_object else ""))
            position = value.end
        return items

    def member(self, container: Span, name: str) -> Item | None:
        """The member of an object with this key: the last one, as for `json.loads`, or None."""
        found = [item for item in self.items(container) if item.name == name]
        return found[-1] if found else None

    def kind(self, value: Span) -> str:
        """First character of a value: `{` an object, `[` an array, `"` a string, else another scalar."""
        return chr(self.text[value.start])

    def value(self, span: Span) -> Any:
        """The decoded value.

        Raises:
            RecursionError: It is nested deeper than `json.loads` follows.
            ValueError: It holds an integer longer than Python reads.
        """
        return json.loads(self.text[span.start : span.end])

    def separator(self, container: Span) -> bytes:
        """The white space before the last item of a container; empty where there is no item."""
        items = self.items(container)
        if not items:
            return b""
        before = self.text[max(container.start + 1, items[-1].start - _LONGEST_SEPARATOR) : items[-1].start]
        return before[len(before.rstrip(_BLANKS)) :]

    def appending(self, container: Span, additions: Sequence[bytes]) -> Edit:
        """The edit that puts items behind the last one, spaced like it: one contiguous insertion."""
        items = self.items(container)
        separator = self.separator(container)
        text = b"".join(b"," + separator + addition for addition in additions)
        if items:
            return Edit(items[-1].end, items[-1].end, text)
        return Edit(container.start + 1, container.start + 1, text[1:])

    def removing(self, container: Span, drop: Collection[Item]) -> list[Edit]:
        """The edits that take items out with their commas; undoes `appending` byte for byte."""
        items, dropped = self.items(container), set(drop)
        edits = []
        index = 0
        while index < len(items):
            run = index
            while run < len(items) and items[run] in dropped:
                run += 1
            if run > index:
                if index > 0 or run == len(items):
                    start = items[index - 1].end if index else container.start + 1
                    edits.append(Edit(start, items[run - 1].end, b""))
                else:
                    edits.append(Edit(items[index].start, items[run].start, b""))
            index = run + 1
        return edits

    def _name_at(self, start: int) -> str:
        match = _NAME.match(self.text, start)
        assert match
        return str(json.loads(match.group()))

    def _walk(self, root: int) -> None:
        text, ends, unclosed = self.text, self._ends, [root]
        position = root + 1
        segments = _IN_OBJECT
        pattern = segments.first
        while unclosed:
            match = pattern.match(text, position)
            if match is None or match.end() == position:
                raise self._broken(position, "The JSON text is not valid.")
            position = match.end()
            last = text[position - 1]
            if last == _COMMA:
                pattern = segments.following
                continue
            if last in _OPENING_BRACKETS:
                unclosed.append(position - 1)
            else:
                ends[unclosed.pop()] = position
                if not unclosed:
                    return
            segments = _IN_OBJECT if text[unclosed[-1]] == _OPENING_BRACKETS[0] else _IN_ARRAY
            pattern = segments.first if last in _OPENING_BRACKETS else segments.after_nested

    def _broken(self, position: int, what: str) -> LevelError:
        rest = self.text[position:]
        position += len(rest) - len(rest.lstrip(_BLANKS))
        excerpt = self.text[position : position + 24]
        byte = f"byte {self._offset + position}"
        return LevelError(
            what,
            where=f"{self._where}, {byte}" if self._where else byte,
            known=f"Found {excerpt!r} there." if excerpt else "The text ends there.",
            remedy="Export the level again, or repair the text at that place.",
        )


def spliced(text: bytes, edits: Sequence[Edit]) -> bytes:
    """`text` with all edits made at once; edits must not overlap."""
    parts = []
    position = 0
    for edit in sorted(edits):
        assert edit.start >= position, "edits overlap"
        parts += [text[position : edit.start], edit.replacement]
        position = edit.end
    return b"".join([*parts, text[position:]])
