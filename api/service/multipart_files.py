"""The files of a multipart body, written as they come; their names are words, not places."""

from __future__ import annotations

from pathlib import Path
from typing import IO

from python_multipart.exceptions import FormParserError
from python_multipart.multipart import MultipartParser, parse_options_header

from api.service.level_folder import PARTS, Part
from api.service.level_names import SUFFIXES
from api.service.problems import ProblemError

LONGEST_BOUNDARY = 70
"""RFC 2046, section 5.1.1."""
LONGEST_HEADERS = 16_384
DISPOSITION, TYPE = b"content-disposition", b"content-type"


class MultipartFiles:
    """Takes a body piece by piece.

    Args:
        content_type: Of the request; it names the boundary.
        folder: Where the files go.
        most: How many there may be.

    Raises:
        ProblemError: There is no boundary.
    """

    def __init__(self, content_type: str, folder: Path, most: int) -> None:
        _, parameters = parse_options_header(content_type)
        boundary = parameters.get(b"boundary", b"")
        if not 0 < len(boundary) <= LONGEST_BOUNDARY:
            raise _malformed(f"The boundary has {len(boundary)} signs; it may have 1 to {LONGEST_BOUNDARY}.")
        self._folder, self._most = folder, most
        self._parts: list[Part] = []
        self._file: IO[bytes] | None = None
        self._ended = False
        self._begin()
        self._parser = MultipartParser(
            boundary,
            {
                "on_part_begin": self._begin,
                "on_header_field": self._take_field,
                "on_header_value": self._take_value,
                "on_header_end": self._end_header,
                "on_headers_finished": self._open,
                "on_part_data": self._take_data,
                "on_part_end": self.close,
                "on_end": self._end,
            },
        )

    def write(self, data: bytes) -> None:
        """Takes a piece.

        Raises:
            ProblemError: It is no multipart, or holds too much or something that is no file.
        """
        try:
            self._parser.write(data)
        except FormParserError as error:
            raise _malformed(f"{error}.") from None

    def finish(self) -> tuple[Part, ...]:
        """All of them.

        Raises:
            ProblemError: The body ended too early, or there are none.
        """
        if not self._ended:
            raise _malformed("It ends before its last boundary.")
        if not self._parts:
            raise ProblemError("bad-level", "The upload has no files: there is no level in it.")
        return tuple(self._parts)

    def close(self) -> None:
        """Takes no more of the file that is being written."""
        if self._file is not None:
            self._file.close()
        self._file = None

    def _begin(self) -> None:
        self._headers: dict[bytes, bytes] = {}
        self._field = self._value = b""
        self._header_bytes = 0

    def _take_field(self, data: bytes, start: int, end: int) -> None:
        self._count(end - start)
        self._field += data[start:end]

    def _take_value(self, data: bytes, start: int, end: int) -> None:
        self._count(end - start)
        self._value += data[start:end]

    def _count(self, more: int) -> None:
        self._header_bytes += more
        if self._header_bytes > LONGEST_HEADERS:
            raise ProblemError(
                "too-large", f"The headers of a part have more than {LONGEST_HEADERS:,} bytes."
            )

    def _end_header(self) -> None:
        self._headers[self._field.lower()] = self._value
        self._field = self._value = b""

    def _open(self) -> None:
        _, options = parse_options_header(self._headers.get(DISPOSITION))
        if b"filename" not in options:
            raise _malformed("It has a part without a file name.")
        if len(self._parts) >= self._most:
            raise ProblemError("too-large", f"The upload has more than {self._most} files.")
        place = f"{PARTS}/{len(self._parts)}"
        kind = self._headers.get(TYPE, b"").decode("ascii", "replace").partition(";")[0].strip().lower()
        name = options[b"filename"].decode(errors="replace")
        self._parts.append(Part(place, name, kind if kind in SUFFIXES else ""))
        self._file = (self._folder / place).open("wb")

    def _take_data(self, data: bytes, start: int, end: int) -> None:
        assert self._file is not None, "data follow headers"
        self._file.write(data[start:end])

    def _end(self) -> None:
        self._ended = True


def _malformed(words: str) -> ProblemError:
    return ProblemError(
        "bad-request",
        "The body is no valid multipart/form-data.",
        known=words,
        remedy="Every part needs a file name, and the body the boundary that its Content-Type names.",
    )
