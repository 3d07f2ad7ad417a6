"""Where results may go, checked before minutes are spent on them."""

from __future__ import annotations

import json
import os
import stat
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Protocol

from scenes.atomic_file import output_error
from scenes.errors import LevelError, OutputError
from scenes.formats.registry import LevelFormat, PlacedFormat, annotated_suffix
from scenes.level_file import read_level_file

ANNOTATED = ".annotated"
MEASUREMENT_KEYS = ("level", "digest", "lights")
"""What a file of measurements holds, and no other JSON is likely to."""
PAGE_BEGINNING = b"<!doctype html>\n<!-- gnomon compare -->\n"
"""How a page of a comparison begins, and no other page does."""
PAGE_SUFFIXES = ".html", ".htm"


def default_target(level: Path) -> Path:
    """`NAME.annotated.EXT` beside the level; EXT is that of its format's layers where it has such."""
    stem = level.stem.removesuffix(ANNOTATED)
    return level.with_name(f"{stem}{ANNOTATED}{annotated_suffix(level)}")


def check_target(level: Path, target: Path, level_format: LevelFormat, content: bytes | None = None) -> None:
    """Refuse a level file that would destroy something, or that could not be written.

    Args:
        level: The level.
        target: Where the result goes.
        level_format: Its format.
        content: The result, where it is known already: a file that holds it may stay in its place.

    Raises:
        OutputError: It is the level itself, has another suffix, is another file than an earlier output of
            ours, or the system refuses to write there.
    """
    suffix = annotated_suffix(level)
    if target.suffix.lower() != suffix.lower():
        reason = f"The annotated level keeps its form, so its name must end in {suffix}."
        if isinstance(level_format, PlacedFormat):
            reason = f"The annotation of a {level_format.NAME} level is a layer, ending in {suffix}."
        raise OutputError(reason, where=str(target), remedy=f"Choose a name that ends in {suffix} with -o.")
    if _same(level, target):
        raise OutputError(
            "The result would overwrite the level itself.",
            where=str(target),
            remedy="Choose another name with -o, or say --in-place if you mean it.",
        )
    check_writable(target)
    if target.is_file() and target.stat().st_size and not _is_ours(target, level_format, content):
        raise OutputError(
            "Another file is there, which is no annotated level: it is not overwritten.",
            where=str(target),
            remedy="Choose another name with -o, or move that file away.",
        )


def check_in_place(level: Path, source: bytes, level_format: LevelFormat) -> None:
    """Refuse to annotate a level in place where that is not possible.

    Raises:
        OutputError: Its annotation is a layer beside it and it is no such layer, or the system refuses to
            write there.
    """
    if isinstance(level_format, PlacedFormat) and not level_format.is_layer(source):
        raise OutputError(
            f"A {level_format.NAME} level is never changed: its annotation is a layer of its own.",
            where=str(level),
            remedy="Leave --in-place out, or name the layer.",
        )
    check_writable(level)


class Destined(Protocol):
    """A level that is to be annotated, and where to."""

    @property
    def level(self) -> Path:
        """The level file."""

    @property
    def target(self) -> Path:
        """The annotated level."""

    @property
    def in_place(self) -> bool:
        """Whether that is the level itself."""


def check_output(order: Destined, source: bytes, level_format: LevelFormat) -> None:
    """Refuse an order whose output could not be written.

    Raises:
        OutputError: It could not.
    """
    if order.in_place:
        check_in_place(order.level, source, level_format)
    else:
        check_target(order.level, order.target, level_format)


def check_writable(path: Path, option: str = "-o") -> None:
    """Make sure that a file can be made at `path`, by making one beside it for a moment.

    Args:
        path: Where the file goes.
        option: With which the user chose it.

    Raises:
        OutputError: The system refuses it.
    """
    try:
        mode = _mode(path)
        if stat.S_ISDIR(mode):
            raise OutputError("This is a folder, not a file.", where=str(path), remedy="Name a file in it.")
        if mode and not stat.S_ISREG(mode):
            raise OutputError(
                "This is a device or a pipe, not a file.", where=str(path), remedy="Name a file."
            )
        if mode and not os.access(path, os.W_OK):
            raise OutputError(
                "There is a file, and it may not be overwritten.",
                where=str(path),
                remedy="Choose another name.",
            )
        with tempfile.TemporaryFile(dir=Path(os.path.realpath(path)).parent):
            pass
    except (OSError, ValueError) as error:
        raise _of_option(path, error, option) from error


def check_spares_level(path: Path, level: Path, named: Iterable[Path], option: str) -> None:
    """Refuse a result that would take the place of the level or of a file that it names.

    Args:
        path: Where the result goes.
        level: The level.
        named: The files that it names, as seen from its folder.
        option: With which the user chose `path`.

    Raises:
        OutputError: It would.
    """
    for own in (level, *(level.parent / name for name in named)):
        if _same(path, own) or os.path.realpath(path) == os.path.realpath(own):
            what = "the level" if own == level else "a file that the level needs"
            raise OutputError(
                f"The result would overwrite {what}.",
                where=str(path),
                remedy=f"Choose another name with {option}.",
            )


def check_measurements(path: Path) -> None:
    """Refuse a file of measurements that would destroy something, or that could not be written.

    Raises:
        OutputError: There is another file than an earlier one of ours, or the system refuses to write there.
    """
    check_writable(path)
    try:
        spared = path.exists() and path.stat().st_size and not _holds_measurements(path)
    except OSError as error:
        raise output_error(path, error) from error
    if spared:
        raise OutputError(
            "Another file is there, which holds no measurements of Gnomon: it is not overwritten.",
            where=str(path),
            remedy="Choose another name with --measurements, or move that file away.",
        )


def check_page(path: Path, beginning: bytes = PAGE_BEGINNING) -> None:
    """Refuse a page that would destroy something, or that could not be written.

    Args:
        path: Where it goes.
        beginning: How an earlier page begins, which may be overwritten.

    Raises:
        OutputError: Its name is no page's, there is another file than an earlier page of ours, or the system
            refuses to write there.
    """
    if path.suffix.lower() not in PAGE_SUFFIXES:
        raise OutputError(
            "The result is a page, so its name must end in .html.",
            where=str(path),
            remedy="Choose a name that ends in .html with -o.",
        )
    check_writable(path)
    try:
        spared = path.exists() and path.stat().st_size and not _begins(path, beginning)
    except OSError as error:
        raise output_error(path, error) from error
    if spared:
        raise OutputError(
            "Another file is there, which is no page of Gnomon: it is not overwritten.",
            where=str(path),
            remedy="Choose another name with -o, or move that file away.",
        )


def ready_folder(folder: Path, option: str = "--pictures") -> None:
    """Make the folder unless it is there, and make sure that files can be made in it.

    Args:
        folder: Where files will go.
        option: With which the user chose it.

    Raises:
        OutputError: The system refuses it.
    """
    try:
        if folder.exists() and not folder.is_dir():
            raise OutputError(
                "This is a file, not a folder.", where=str(folder), remedy=f"Name a folder with {option}."
            )
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except (OSError, ValueError) as error:
        raise _of_option(folder, error, option) from error


def _of_option(path: Path, error: OSError | ValueError, option: str) -> OutputError:
    """What the system refuses, in the words of the option that named the place."""
    failure = output_error(path, error if isinstance(error, OSError) else OSError(str(error)))
    remedy = failure.remedy.replace("-o", option)
    return OutputError(failure.what, where=failure.where, known=failure.known, remedy=remedy)


def _mode(path: Path) -> int:
    """Kind and permissions of what is at `path`, behind all links; 0 where there is nothing."""
    try:
        return path.stat().st_mode
    except FileNotFoundError:
        return 0


def _holds_measurements(path: Path) -> bool:
    with path.open("rb") as file:
        # Files of other programs can be huge: their first byte is enough.
        if file.read(1) != b"{":
            return False
        try:
            record = json.loads(b"{" + file.read())
        except (ValueError, RecursionError):
            return False
    return tuple(record) == MEASUREMENT_KEYS and isinstance(record["lights"], list)


def _begins(path: Path, beginning: bytes) -> bool:
    with path.open("rb") as file:
        return file.read(len(beginning)) == beginning


def _same(first: Path, second: Path) -> bool:
    try:
        return first.samefile(second)
    except (OSError, ValueError):
        return False


def _is_ours(target: Path, level_format: LevelFormat, content: bytes | None) -> bool:
    try:
        source = read_level_file(target)
        if isinstance(level_format, PlacedFormat):
            return level_format.is_layer(source)
        return source == content or level_format.clear(source).data != source
    except LevelError:
        return False
