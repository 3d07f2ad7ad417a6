"""Hypothesis strategies: JSON and glTF files with every freedom of spelling that JSON leaves."""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass
from typing import Any

from hypothesis import strategies as st

Draw = Any

BLANKS = st.sampled_from(["", "", "", " ", "\n", "\r\n\t", "\n    ", "  \t"])
NUMBERS = st.sampled_from(
    ["0", "-0", "1e-05", "1.0E-7", "1.500", "-12.00e+3", "123456789012345678901234567890"]
)
STRINGS = st.sampled_from(
    ['""', '"a\\/b"', '"\\u00e9é"', '"\\"}]"', '"\\\\"', '"{[,:"', '"\\ud83d\\ude00😀"', '"gnomon_technique"']
)
SCALARS = st.one_of(NUMBERS, STRINGS, st.sampled_from(["true", "false", "null"]))
NAMES = st.sampled_from(["a", "b", "name", "gnomon_mobility", "gnomon_technique", "é", "{", ""])


@st.composite
def keys(draw: Draw, name: str) -> str:
    """A JSON key that decodes to `name`, with some of its characters spelt as escapes."""
    if not draw(st.booleans()):
        return json.dumps(name, ensure_ascii=draw(st.booleans()))
    at = draw(st.integers(0, max(len(name) - 1, 0)))
    escaped = "".join(f"\\u{ord(letter):04x}" for letter in name[at : at + 1])
    return json.dumps(name[:at])[:-1] + escaped + json.dumps(name[at + 1 :])[1:]


@st.composite
def containers(draw: Draw, parts: list[str], brackets: str) -> str:
    """The parts between brackets, with commas and any white space."""
    spaced = [draw(BLANKS) + part + draw(BLANKS) for part in parts]
    return brackets[0] + (",".join(spaced) or draw(BLANKS)) + brackets[1]


@st.composite
def objects(draw: Draw, members: list[tuple[str, str]]) -> str:
    """An object with these names and value texts."""
    texts = [draw(keys(name)) + draw(BLANKS) + ":" + draw(BLANKS) + value for name, value in members]
    return draw(containers(texts, "{}"))


@st.composite
def values(draw: Draw, depth: int = 2) -> str:
    """Any JSON value."""
    choice = draw(st.integers(0, 3)) if depth else 0
    if choice < 2:
        return draw(SCALARS)
    parts = [draw(values(depth - 1)) for _ in range(draw(st.integers(0, 3)))]
    if choice == 2:
        return draw(containers(parts, "[]"))
    return draw(objects([(draw(NAMES), part) for part in parts]))


@st.composite
def nodes(draw: Draw) -> str:
    """A node: with or without extensions, and extras of every kind."""
    members = [(draw(NAMES), draw(values())) for _ in range(draw(st.integers(0, 2)))]
    if draw(st.booleans()):
        members.append(("extras", draw(values())))
    if draw(st.booleans()):
        punctual = draw(objects([("light", "0")]))
        others = [("EXT_other", draw(values()))] if draw(st.booleans()) else []
        both = draw(st.permutations([("KHR_lights_punctual", punctual), *others]))
        members.append(("extensions", draw(objects(both[draw(st.integers(0, 1)) :]))))
    return draw(objects(draw(st.permutations(members))))


@dataclass(frozen=True)
class GltfText:
    """A glTF file and how many nodes it has."""

    text: bytes
    nodes: int


@st.composite
def gltf_texts(draw: Draw) -> GltfText:
    """A file of glTF shape, as raw JSON."""
    count = draw(st.integers(1, 4))
    texts = [draw(nodes()) for _ in range(count)]
    members = [("asset", draw(objects([("version", '"2.0"')]))), ("nodes", draw(containers(texts, "[]")))]
    used = draw(
        st.sampled_from([None, [], ['"KHR_lights_punctual"'], ['"A"', '"GNOMON_lights_shadow_technique"']])
    )
    if used is not None:
        members.append(("extensionsUsed", draw(containers(used, "[]"))))
    members += [(draw(NAMES), draw(values())) for _ in range(draw(st.integers(0, 2)))]
    text = draw(BLANKS) + draw(objects(draw(st.permutations(members)))) + draw(BLANKS)
    mark = draw(st.sampled_from([b"", b"", b"\xef\xbb\xbf"]))
    return GltfText(mark + text.encode(), count)


def glb(text: bytes, *after: tuple[bytes, bytes]) -> bytes:
    """A GLB with this JSON chunk, padding and all as given, and these chunks behind it."""
    chunks = b"".join(struct.pack("<I4s", len(data), kind) + data for kind, data in ((b"JSON", text), *after))
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


@st.composite
def gltf_files(draw: Draw) -> tuple[bytes, int]:
    """A glTF or GLB file of any layout, and its number of nodes."""
    made = draw(gltf_texts())
    if draw(st.booleans()):
        return made.text, made.nodes
    padding = draw(st.sampled_from([b"", b" ", b" " * 7, b"\n  ", b"\0\0", None]))
    if padding is None:
        padding = b" " * (-len(made.text) % 4)
    after = [(b"BIN\0", draw(st.binary(max_size=9)))] if draw(st.booleans()) else []
    after += [(b"XTRA", b"unknown")] if draw(st.booleans()) else []
    trailing = draw(st.sampled_from([b"", b"\n"]))
    return glb(made.text + padding, *after) + trailing, made.nodes
