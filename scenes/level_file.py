"""Level files on disk: their bytes, or the reason why there are none."""

from __future__ import annotations

import stat
from pathlib import Path

from scenes.errors import LevelError

LFS_POINTER = b"version https://git-lfs.github.com/spec/"


def is_folder(path: Path) -> bool:
    """Whether a folder has this name; False where the system knows no such name."""
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False


def read_level_file(path: Path, limit: int | None = None) -> bytes:
    """The bytes of a regular file, at most `limit` of them.

    Raises:
        LevelError: There is no such file, it is a directory, a device or a pipe, it is empty, it may not
            be read, or it is a git LFS pointer instead of the file itself.
    """
    try:
        status = path.stat()
        if stat.S_ISDIR(status.st_mode):
            raise LevelError("This is a folder, not a file.", where=str(path), remedy="Name a file in it.")
        if not stat.S_ISREG(status.st_mode):
            raise LevelError(
                "This is a device or a pipe, not a file.",
                where=str(path),
                remedy="Save it as a file first.",
            )
        with path.open("rb") as file:
            # The size on disk bounds what is allocated, whatever length a level claims.
            content = file.read(status.st_size if limit is None else min(limit, status.st_size))
    except (FileNotFoundError, NotADirectoryError):
        raise LevelError(
            "There is no such file.", where=str(path), remedy="Check its name and its folder."
        ) from None
    except PermissionError:
        raise LevelError(
            "This file may not be read.", where=str(path), remedy="Give yourself read permission."
        ) from None
    except (OSError, ValueError) as error:
        raise LevelError(
            "This file cannot be read.", where=str(path), known=f"The system says: {error}."
        ) from error
    if status.st_size == 0:
        raise LevelError("This file is empty.", where=str(path), remedy="Export or copy it again.")
    if content.startswith(LFS_POINTER):
        raise LevelError(
            "This is a git LFS pointer, not the file itself.",
            where=str(path),
            remedy="Run `git lfs pull` in its repository.",
        )
    return content
