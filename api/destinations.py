"""Where results may go, checked before minutes are spent on them."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from scenes.atomic_file import output_error
from scenes.errors import LevelError, OutputError
from scenes.formats.registry import LevelFormat
from scenes.level_file import read_level_file

ANNOTATED = ".annotated"


def default_target(level: Path) -> Path:
    """`NAME.annotated.EXT` beside the level."""
    stem = level.stem.removesuffix(ANNOTATED)
    return level.with_name(f"{stem}{ANNOTATED}{level.suffix}")


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
    if target.suffix.lower() != level.suffix.lower():
        raise OutputError(
            f"The annotated level keeps its form, so its name must end in {level.suffix}.",
            where=str(target),
            remedy=f"Choose a name that ends in {level.suffix} with -o.",
        )
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


def check_writable(path: Path) -> None:
    """Make sure that a file can be made at `path`, by making one beside it for a moment.

    Raises:
        OutputError: The system refuses it.
    """
    try:
        if path.is_dir():
            raise OutputError("This is a folder, not a file.", where=str(path), remedy="Name a file in it.")
        if path.exists() and not os.access(path, os.W_OK):
            raise OutputError(
                "There is a file, and it may not be overwritten.",
                where=str(path),
                remedy="Choose another name.",
            )
        with tempfile.TemporaryFile(dir=Path(os.path.realpath(path)).parent):
            pass
    except (OSError, ValueError) as error:
        known = error if isinstance(error, OSError) else OSError(str(error))
        raise output_error(path, known) from error


def ready_folder(folder: Path) -> None:
    """Make the folder unless it is there, and make sure that files can be made in it.

    Raises:
        OutputError: The system refuses it.
    """
    try:
        if folder.exists() and not folder.is_dir():
            raise OutputError(
                "This is a file, not a folder.", where=str(folder), remedy="Name a folder with --pictures."
            )
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except (OSError, ValueError) as error:
        known = error if isinstance(error, OSError) else OSError(str(error))
        failure = output_error(folder, known)
        raise OutputError(
            failure.what,
            where=failure.where,
            known=failure.known,
            remedy=failure.remedy.replace("-o", "--pictures"),
        ) from error


def _same(first: Path, second: Path) -> bool:
    try:
        return first.samefile(second)
    except (OSError, ValueError):
        return False


def _is_ours(target: Path, level_format: LevelFormat, content: bytes | None) -> bool:
    try:
        source = read_level_file(target)
        return source == content or level_format.clear(source).data != source
    except LevelError:
        return False
