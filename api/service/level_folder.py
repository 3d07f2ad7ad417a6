"""An upload becomes a folder that a level is read from, out of which nothing leads.

The upload's files come as `parts/0`, `parts/1` and so on. The level gets a name that is safe; the others go
where the level's uris say, inside the folder and nowhere else. What no uri names is not looked at.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from api.service.level_names import GLB, GLTF, media_type_of, safe_name, suffix_of
from api.service.problems import ProblemError
from scenes.entry import Entry
from scenes.errors import LevelError
from scenes.gltf.companions import local_path
from scenes.gltf.container import parse_json
from scenes.gltf.json_chunk import MAGIC, find_json
from scenes.level_file import read_level_file

PARTS, LEVEL = "parts", "level"
DATA = "data:"
MOST_NAMED = 10
LONGEST_PATH, DEEPEST_FOLDER = 1000, 16
MOST_FILES = 256
"""That a level names and an upload brings, and folders that they lie in: each is made on disk."""


@dataclass(frozen=True)
class Part:
    """One file of an upload.

    Attributes:
        place: Where it was put, in the upload's folder.
        name: What the client calls it; no more than a word.
        media_type: What the client says it is; empty where it says nothing.
    """

    place: str
    name: str
    media_type: str


@dataclass(frozen=True)
class ReadyLevel:
    """A level that can be read.

    Attributes:
        path: Its file, whose name is fit to be shown.
        media_type: What it holds.
    """

    path: Path
    media_type: str


def arranged(
    upload: Path,
    parts: Sequence[Part],
    name: str,
    check: Callable[[Entry], None] | None = None,
    most_files: int = MOST_FILES,
) -> ReadyLevel:
    """Puts all files where they belong.

    Args:
        upload: The folder with `parts`.
        parts: Its files.
        name: What the level is to be called; what its part is called where empty.
        check: Told the level's JSON before anything is made of it; raises LevelError where it is refused.
        most_files: That the level may name, of those that were sent along.

    Raises:
        ProblemError: No file is a level, or several are.
        LevelError: The level is none or is refused, or a uri leads out of the upload or to what was not sent
            along.
    """
    level, others = _told_apart(parts)
    folder = upload / LEVEL
    folder.mkdir()
    path = folder / safe_name(name or level.name, level.media_type)
    (upload / level.place).rename(path)
    # All that a message says of the level's place is the level's name.
    with shown_as_name(path):
        root = _opened(path, level.media_type)
        if check is not None:
            check(root)
        _place(upload, path, others, _named(root), most_files)
    return ReadyLevel(path, level.media_type)


@contextmanager
def shown_as_name(path: Path) -> Iterator[None]:
    """In the block, what is said of a level's errors names its file, and no folder of this machine.

    Raises:
        LevelError: The block does.
    """

    def plain(text: str) -> str:
        return text.replace(f"{path.parent}{os.sep}", "").replace(str(path.parent), "the upload")

    try:
        yield
    except LevelError as error:
        where = plain(error.where)
        if not where.startswith(path.name):
            where = f"{path.name}, {where}" if where else path.name
        raise LevelError(
            plain(error.what), where=where, known=plain(error.known), remedy=plain(error.remedy)
        ) from error


def _told_apart(parts: Sequence[Part]) -> tuple[Part, list[Part]]:
    levels = [part for part in parts if part.media_type or suffix_of(part.name)]
    if len(levels) != 1:
        known = f"The upload holds {len(parts)} files, of which {len(levels)} are levels."
        remedy = "Send one .gltf or .glb, with the files that it names."
        raise ProblemError("bad-level", "An upload has to hold one level.", known=known, remedy=remedy)
    level = levels[0]
    media_type = level.media_type or media_type_of(level.name)
    return Part(level.place, level.name, media_type), [part for part in parts if part is not level]


def _opened(path: Path, media_type: str) -> Entry:
    source = read_level_file(path)
    chunk = find_json(source)
    if media_type == GLB and not chunk.binary:
        json_follows = source.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"{")
        raise LevelError(
            "This is no GLB.",
            where=path.name,
            known=f"It begins with {source[: len(MAGIC)]!r}, a GLB with {MAGIC!r}.",
            remedy=f"It looks like JSON: send it as {GLTF}." if json_follows else "Export the level again.",
        )
    return parse_json(chunk.text)


def _place(
    upload: Path, path: Path, others: Sequence[Part], named: dict[Path, bool], most_files: int
) -> None:
    by_name = {part.name.replace("\\", "/"): part for part in others}
    by_last = {name.rpartition("/")[2]: part for name, part in by_name.items()}
    missing: list[str] = []
    meant: dict[Path, Part] = {}
    for relative, needed in named.items():
        part = by_name.get(relative.as_posix()) or by_last.get(relative.name)
        if part is not None:
            meant[relative] = part
        elif needed:
            missing.append(relative.as_posix())
    _refuse_many(meant, most_files)
    if missing:
        more = f" and {len(missing) - MOST_NAMED} more" if len(missing) > MOST_NAMED else ""
        raise LevelError(
            "This level names files that were not sent along.",
            where=path.name,
            known=f"It names {', '.join(missing[:MOST_NAMED])}{more}.",
            remedy="Send the level and its files as multipart/form-data, or export it as a .glb.",
        )
    for relative, part in meant.items():
        _link(upload / part.place, path.parent / relative)


def _refuse_many(meant: dict[Path, Part], most: int) -> None:
    """Few bytes name many paths, each of which would be made on disk."""
    folders = {folder for relative in meant for folder in relative.parents}
    for count, what in ((len(meant), "files"), (len(folders) - 1, "folders")):
        if count > most:
            raise LevelError(
                f"This level names {count:,} {what}; the service takes {most:,}.",
                remedy="Name each file once, in few folders, or export the level as a .glb.",
            )


def _named(root: Entry) -> dict[Path, bool]:
    """The paths that the level's uris stand for, and whether the level cannot be read without."""
    found: dict[Path, bool] = {}
    for table, needed in (("buffers", True), ("images", False)):
        for index, entry in enumerate(root.items(table)):
            uri = entry.get("uri") if isinstance(entry, dict) else None
            if not isinstance(uri, str) or not uri or uri.startswith(DATA):
                continue
            where = f"{table[:-1]} {index}"
            try:
                relative = _inside(uri, where)
            except LevelError:
                # Pictures are never looked at: where one is said to be does not matter.
                if needed:
                    raise
                continue
            found[relative] = found.get(relative, False) or needed
    return found


def _inside(uri: str, where: str) -> Path:
    relative = local_path(uri, where)
    text = str(relative)
    long = len(text) > LONGEST_PATH or len(relative.parts) > DEEPEST_FOLDER
    if relative == Path() or "\\" in text or not text.isprintable() or long:
        raise LevelError(
            f"The uri {uri[:80]!r} is no name of a file beside the level.",
            where=where,
            remedy="Name the file by letters, digits and /, and not at length.",
        )
    return relative


def _link(part: Path, target: Path) -> None:
    """Gives a part its name; one that several uris mean has several."""
    try:
        if target.exists():
            return
        target.parent.mkdir(parents=True, exist_ok=True)
        os.link(part, target)
    except (OSError, ValueError) as error:
        raise LevelError(
            f"No file can be called {str(target.name)[:80]!r} here.",
            known=f"The system says: {getattr(error, 'strerror', None) or error}.",
            remedy="Give the file a shorter name, and its folders other names than its files.",
        ) from error
