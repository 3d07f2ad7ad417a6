"""Levels written to disk, together with the files that they need beside them."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from pathlib import Path

from scenes.atomic_file import output_error, write_atomically
from scenes.errors import LevelError, OutputError
from scenes.formats.registry import LevelFormat

_ELSEWHERE = "Write the level into another folder with -o, or move that file away."


@dataclass(frozen=True)
class Luggage:
    """The files that a level names, as seen from the place that it goes to. Paths as the level names them.

    Attributes:
        missing: Those of its folder that have to be copied.
        left_behind: Those outside its folder that would have to be put there by hand: only what lies beside
            a level goes with it.
    """

    missing: tuple[Path, ...]
    left_behind: tuple[Path, ...]


def luggage(source_path: Path, target: Path, data: bytes, level_format: LevelFormat) -> Luggage:
    """What a level at `target` needs beside it; what stands in the way there is found without writing.

    Args:
        source_path: Where the level was read; the files that it names lie in its folder.
        target: Where it goes.
        data: The level.
        level_format: Its format.

    Raises:
        LevelError: The level is broken, or a file that it names cannot be read.
        OutputError: Another file of that name is there, or the level itself would take its place.
    """
    named = level_format.companions(data, source_path)
    _refuse_own_file(source_path, target, named)
    outside = {name for name in named if os.pardir in name.parts}
    missing = [
        name
        for name in named
        if name not in outside and _is_missing(source_path.parent / name, target.parent / name)
    ]
    for folder in _folders(missing):
        _refuse_file_for_folder(target.parent / folder)
    left_behind = (
        name for name in outside if not _same_place(source_path.parent / name, target.parent / name)
    )
    return Luggage(tuple(missing), tuple(sorted(left_behind)))


def write_level(source_path: Path, target: Path, data: bytes, level_format: LevelFormat) -> tuple[Path, ...]:
    """Writes a level, and into another folder first the files that it names; gives all that it wrote.

    Args:
        source_path: Where the level was read; the files that it names lie in its folder.
        target: Where it goes; a level there already gives way.
        data: The level.
        level_format: Its format.

    Returns:
        The files written, the level last; files already there with the same content are not among them.

    Raises:
        LevelError: The level is broken, or a file that it names cannot be read.
        OutputError: Something cannot be written, or another file of that name is there. Nothing was
            overwritten, and what was written before the failure is gone again.
    """
    missing = luggage(source_path, target, data, level_format).missing
    with ExitStack() as undo:
        for folder in _folders(missing):
            _make_folder(target.parent / folder, undo)
        for name in missing:
            _on_failure(undo, (target.parent / name).unlink)
            write_atomically(target.parent / name, _content(source_path.parent / name))
        write_atomically(target, data)
        undo.pop_all()
    return (*(target.parent / name for name in missing), target)


def _refuse_own_file(source_path: Path, target: Path, named: Iterable[Path]) -> None:
    for name in named:
        if any(_same_place(target, folder / name) for folder in (source_path.parent, target.parent)):
            raise OutputError(
                "The level would overwrite a file that it names itself.",
                where=str(target),
                known=f"It is {name} of {source_path}.",
                remedy="Choose another name with -o.",
            )


def _is_missing(source: Path, target: Path) -> bool:
    """Whether a file has to be copied: it does not if it is there already.

    Raises:
        OutputError: Something else is there under its name.
    """
    try:
        if _same_place(source, target):
            return False
        if target.is_file() and target.stat().st_size == source.stat().st_size:
            same = target.read_bytes() == _content(source)
        elif target.exists() or target.is_symlink():
            same = False
        else:
            return True
    except OSError as error:
        raise output_error(target, error) from error
    if same:
        return False
    raise OutputError(
        "A different file of this name is there, and the level needs its own.",
        where=str(target),
        known=f"The level names {source}.",
        remedy=_ELSEWHERE,
    )


def _same_place(one: Path, other: Path) -> bool:
    # `Path.resolve` would trip over links that run in a circle.
    return os.path.realpath(one) == os.path.realpath(other)


def _folders(names: Iterable[Path]) -> list[Path]:
    """The folders in which the files lie, outer ones first, without the level's own."""
    return sorted({folder for name in names for folder in name.parents} - {Path()})


def _refuse_file_for_folder(folder: Path) -> None:
    if os.path.lexists(folder) and not folder.is_dir():
        raise OutputError(
            "This is a file, and the level needs a folder of this name.", where=str(folder), remedy=_ELSEWHERE
        )


def _make_folder(folder: Path, undo: ExitStack) -> None:
    if folder.is_dir():
        return
    try:
        folder.mkdir()
    except OSError as error:
        raise output_error(folder, error) from error
    _on_failure(undo, folder.rmdir)


def _content(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise LevelError(
            "A file that the level names cannot be read.",
            where=str(path),
            known=f"The system says: {error.strerror or error}.",
            remedy="Make it readable, or write the level into its own folder with -o.",
        ) from error


def _on_failure(undo: ExitStack, clean: Callable[[], None]) -> None:
    def clean_quietly() -> None:
        # The failure that led here is the one to tell.
        with suppress(OSError):
            clean()

    undo.callback(clean_quietly)
