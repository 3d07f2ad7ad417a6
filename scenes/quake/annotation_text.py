"""What an annotation looks like in a .map: keys with short values, and one comment with the whole story.

    // gnomon {"technique": "SM", ..., "original": {"sha256": "..."}}
    "_gnomon_technique" "SM"
    "_gnomon_map_size" "1024"

Compilers and games ignore keys that begin with an underscore, editors keep and show them. The story is a
comment because a value has a limit: 1,023 characters in the game itself, 127 in the first compilers.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any
from urllib.parse import quote, unquote

from scenes.light_annotation import OWN_KEYS, Scalar
from scenes.quake.map_text import Comment, Pair

MARK = b" gnomon {"
OWN_PAIRS = frozenset(f"_{key}" for key in OWN_KEYS)

# All else is percent-encoded: a map knows no way to write a quote, and games read `\\n` as a new line.
_SAFE = " ,;:()+"


def pair_text(key: str, value: Scalar) -> bytes:
    """A key with its value, as a map holds them."""
    return f'"_{key}" "{_written(value)}"'.encode("ascii")


def comment_text(extension: Mapping[str, Any], original: Mapping[str, Any]) -> bytes:
    """The comment with the whole story, in one line of ASCII."""
    story = json.dumps({**extension, "original": dict(original)}, allow_nan=False)
    return b"//" + MARK[:-1] + story.encode("ascii")


def is_ours(comment: Comment) -> bool:
    """Whether a comment is a story of ours."""
    return comment.text.startswith(MARK)


def story(comments: Iterable[Comment]) -> dict[str, Any]:
    """What the last comment of ours says; empty where it says nothing that was written here."""
    texts = [comment.text[len(MARK) - 1 :] for comment in comments if is_ours(comment)]
    if not texts:
        return {}
    try:
        value = json.loads(texts[-1])
        json.dumps(value, allow_nan=False)
    except (RecursionError, ValueError):
        return {}
    return value if isinstance(value, dict) else {}


def scalars(pairs: Iterable[Pair]) -> dict[str, Scalar]:
    """Our keys among those of an entity, without their underscores, with their values."""
    return {pair.key[1:]: _read(pair.value) for pair in pairs if pair.key in OWN_PAIRS}


def _written(value: Scalar) -> str:
    if not isinstance(value, str):
        return json.dumps(value)
    text = quote(value, safe=_SAFE, errors="surrogatepass")
    # What would be read as a number or a truth value has its first character spelt out.
    return text if isinstance(_read(text), str) else f"%{ord(text[0]):02X}{text[1:]}"


def _read(text: str) -> Scalar:
    try:
        value = json.loads(text)
        json.dumps(value, allow_nan=False)
    except (RecursionError, ValueError):
        return unquote(text, errors="surrogatepass")
    return value if isinstance(value, Scalar) else unquote(text, errors="surrogatepass")
