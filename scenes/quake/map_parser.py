"""The text of a Quake .map file, read in one pass.

Grammar: id Software's qbsp (map.c, 1996); Valve 220 texture axes; Quake 3's `brushDef`, whose faces are
planes by three points as well. Curved patches and Doom 3's `brushDef3` are stepped over and counted.
"""

from __future__ import annotations

import re
from array import array
from collections import Counter

import numpy as np

from scenes.errors import LevelError
from scenes.quake.map_text import Comment, Entity, MapText, Pair

# More would be more triangles than a level may draw: a face makes two as a rule, and keeps 72 bytes.
MOST_FACES = 4_000_000
# Far beyond any map (Quake's end at 4,096, those of its heirs at 131,072), and exact to 1e-9 when clipped.
FARTHEST_UNITS = 2.0**20

_NUMBER = rb"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_POINT = rb"\(\s*(%b)\s+(%b)\s+(%b)\s*\)" % (_NUMBER, _NUMBER, _NUMBER)
_ROW = rb"\(\s*%b\s+%b\s+%b\s*\)" % (_NUMBER, _NUMBER, _NUMBER)
_FACE = re.compile(
    rb"%b\s*%b\s*%b\s*(?:\(\s*%b\s*%b\s*\)\s*)?" % (_POINT, _POINT, _POINT, _ROW, _ROW)
    # The texture's placement may hold anything that stands in numbers' stead: shadows do not need it.
    + rb'(?:"(?P<quoted>[^"\r\n]*)"|(?P<plain>[^\s(}"][^\s]*))[-+.\w\[\] \t]*'
)
_TOKEN = re.compile(
    rb"\s*(?:(?P<comment>//[^\r\n]*)|(?P<open>\{)|(?P<close>\})|(?P<face>\()"
    rb'|"(?P<text>[^"\r\n]*)"|(?P<unclosed>")|(?P<word>[^\s"{}()\0]+)|(?P<other>\S))'
)
_BRACES = re.compile(rb'//[^\r\n]*|"[^"\r\n]*"|(?P<open>\{)|(?P<close>\})')
_PLANES = frozenset({b"brushDef"})
_UTF16 = re.compile(rb"\xff\xfe|\xfe\xff|(?:[^\0]\0){2}|(?:\0[^\0]){2}")
_UTF8_BOM = b"\xef\xbb\xbf"


def parse_map(source: bytes) -> MapText:
    """The entities and brush faces of a .map file.

    Raises:
        LevelError: The text is no map: it says which line, entity and brush.
    """
    if _UTF16.match(source):
        raise LevelError(
            "This file is UTF-16 text; a .map has one byte to a character.",
            where="line 1",
            remedy="Save it as UTF-8 or as plain ASCII.",
        )
    parser = _Parser(source)
    parser.run()
    coordinates = np.frombuffer(parser.coordinates, np.float64) if parser.coordinates else np.zeros(0)
    text = MapText(
        source,
        parser.entities,
        coordinates.reshape(-1, 3, 3),
        parser.textures,
        np.array([*parser.face_offsets, len(parser.textures)], np.int64),
        parser.brush_lines,
        parser.skipped,
    )
    _require_near(text)
    return text


def decoded(text: bytes) -> str:
    """Text of a map: UTF-8 as modern editors write it, or one byte to a character as Quake itself has it."""
    try:
        return text.decode()
    except UnicodeDecodeError:
        return text.decode("latin-1")


class _Parser:
    """One pass over the bytes, with what it has found so far."""

    def __init__(self, source: bytes) -> None:
        self.source = source
        self.position = len(_UTF8_BOM) if source.startswith(_UTF8_BOM) else 0
        # What is copied out of a compiled level ends with a zero.
        self.end = len(source.rstrip(b"\0"))
        self.entities: list[Entity] = []
        self.coordinates = array("d")
        self.textures: list[str] = []
        self.face_offsets: list[int] = []
        self.brush_lines: list[int] = []
        self.skipped: Counter[str] = Counter()
        self._names: dict[bytes, str] = {}
        self._line, self._counted = 1, 0

    def run(self) -> None:
        while token := self._token():
            kind = token.lastgroup
            if kind == "open":
                self._entity(token.start("open"))
            elif kind != "comment":
                raise self._broken(token.start(kind or 0), 'An entity must begin here, with "{".')
        if not self.entities:
            raise self._broken(self.position, "This file holds no entity.")

    def _token(self) -> re.Match[bytes] | None:
        token = _TOKEN.match(self.source, self.position, self.end)
        if token:
            self.position = token.end()
        return token

    def _entity(self, start: int) -> None:
        entity = Entity(len(self.entities), self.line_of(start))
        self.entities.append(entity)
        first = len(self.brush_lines)
        key: re.Match[bytes] | None = None
        while token := self._token():
            kind = token.lastgroup
            at = token.start(kind or 0)
            if kind == "comment":
                entity.comments.append(Comment(token["comment"][2:], at, token.end()))
                entity.items.append((at, token.end()))
            elif kind == "text":
                key = self._pair(entity, key, token)
            elif kind in ("open", "close") and key is None:
                if kind == "close":
                    entity.brushes, entity.end = (first, len(self.brush_lines)), at
                    return
                self._brush(at)
                entity.items.append((at, self.position))
            else:
                raise self._misplaced(at, kind or "", key)
        raise self._unclosed("entity", entity.line)

    def _pair(
        self, entity: Entity, key: re.Match[bytes] | None, token: re.Match[bytes]
    ) -> re.Match[bytes] | None:
        if key is None:
            return token
        start = key.start("text") - 1
        entity.pairs.append(Pair(decoded(key["text"]), decoded(token["text"]), start, token.end()))
        entity.items.append((start, token.end()))
        return None

    def _brush(self, start: int) -> None:
        self.brush_lines.append(self.line_of(start))
        self.face_offsets.append(len(self.textures))
        depth = 1
        while token := self._token():
            kind = token.lastgroup
            at = token.start(kind or 0)
            if kind == "face":
                self._face(at)
            elif kind == "close":
                depth -= 1
                if depth == 0:
                    return
            elif kind == "word" and depth == 1:
                depth += self._opened(token["word"], at)
            elif kind != "comment":
                raise self._broken(
                    at, 'A face "( x y z ) ( x y z ) ( x y z ) TEXTURE ..." or "}" must be here.'
                )
        raise self._unclosed("brush", self.brush_lines[-1])

    def _opened(self, word: bytes, at: int) -> int:
        """Steps into `brushDef`, or over what another word announces; the braces that are open then."""
        brace = self._token()
        while brace and brace.lastgroup == "comment":
            brace = self._token()
        if brace is None or brace.lastgroup != "open":
            raise self._broken(at, 'A face "( x y z ) ( x y z ) ( x y z ) TEXTURE ..." or "}" must be here.')
        if word in _PLANES:
            return 1
        self.skipped[decoded(word)] += 1
        depth = 1
        for found in _BRACES.finditer(self.source, self.position):
            depth += {"open": 1, "close": -1}.get(found.lastgroup or "", 0)
            if depth == 0:
                self.position = found.end()
                return 0
        raise self._unclosed(decoded(word)[:40], self.line_of(at))

    def _face(self, start: int) -> None:
        face = _FACE.match(self.source, start)
        if face is None:
            raise self._broken(start, "This is no face: three points of three numbers each, then a texture.")
        if len(self.textures) == MOST_FACES:
            raise LevelError(
                f"This level has more than {MOST_FACES:,} brush faces.",
                where=self._place(start),
                remedy="Split it into several maps.",
            )
        self.position = face.end()
        self.coordinates.extend(map(float, face.groups()[:9]))
        name = face["quoted"] if face["plain"] is None else face["plain"]
        if name not in self._names:
            self._names[name] = decoded(name).lower()
        self.textures.append(self._names[name])

    def line_of(self, position: int) -> int:
        """The line of a byte; asked for in the order of the file, so that each byte is looked at once."""
        self._line += self.source.count(b"\n", self._counted, position)
        self._counted = max(self._counted, position)
        return self._line

    def _place(self, position: int) -> str:
        line = self.source.count(b"\n", 0, position) + 1
        return f"line {line}, {self.entities[-1].where}" if self.entities else f"line {line}"

    def _misplaced(self, at: int, kind: str, key: re.Match[bytes] | None) -> LevelError:
        if kind == "unclosed":
            return self._broken(at, "This quote is not closed on its line.")
        if key is not None:
            return self._broken(key.start("text") - 1, "This key has no value.")
        return self._broken(at, 'A key in quotes, a brush "{" or the end of the entity "}" must be here.')

    def _unclosed(self, what: str, line: int) -> LevelError:
        return LevelError(
            f'The file ends inside this {what}: its "}}" is missing.',
            where=f"line {line}, {self.entities[-1].where}",
            remedy="The file was cut off, or a brace was lost: copy it again, or add the brace.",
        )

    def _broken(self, position: int, what: str) -> LevelError:
        found = self.source[position : position + 40].splitlines()
        return LevelError(
            what,
            where=self._place(position),
            known=f"Found {found[0]!r}." if found and found[0] else "The line ends there.",
            remedy="Open the map in its editor and save it again, or mend that line.",
        )


def _require_near(text: MapText) -> None:
    # Written so that infinity, which a number of 400 digits becomes, is far as well.
    far = ~(np.abs(text.points) <= FARTHEST_UNITS).all(axis=(1, 2))
    if far.any():
        face = int(np.argmax(far))
        brush = int(np.searchsorted(text.face_offsets, face, side="right")) - 1
        owner = next(one for one in text.entities if one.brushes[0] <= brush < one.brushes[1])
        raise LevelError(
            f"A face of this brush lies farther than {FARTHEST_UNITS:,.0f} units from the origin.",
            where=f"line {text.brush_lines[brush]}, {owner.where}",
            known=f"Its points are {text.points[face].tolist()}.",
            remedy="Move it back into the map, or delete it.",
        )
