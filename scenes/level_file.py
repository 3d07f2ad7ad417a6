"""Level files on disk: their bytes, or the reason why there are none."""

from __future__ import annotations

import stat
from pathlib import Path

from scenes.errors import LevelError
from scenes.gltf.json_chunk import MAGIC

# A GLB states its length in 32 bits (glTF 2.0, section 4.4.2), and no level file of another kind is longer.
LONGEST_FILE = 2**32
# Decoded, JSON takes several times its bytes of memory; real files of this length hold their buffers outside.
LONGEST_TEXT = 2**30
LFS_POINTER = b"version https://git-lfs.github.com/spec/"


def is_folder(path: Path) -> bool:
    """Whether a folder has this name; False where the system knows no such name."""
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False


def read_level_file(path: Path, limit: int | None = None) -> bytes:
    """The bytes of a regular file: at most `limit` of them, or else all of a level.

    Raises:
        LevelError: There is no such file, it is a directory, a device or a pipe, it is empty, it may not
            be read, it is a git LFS pointer instead of the file itself, or, without `limit`, longer than
            a level may be: 4 GiB for a GLB, 1 GiB for text.
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
            if limit is None:
                _refuse_long(path, file.read(len(MAGIC)), status.st_size)
                file.seek(0)
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


def _refuse_long(path: Path, start: bytes, size: int) -> None:
    longest = LONGEST_FILE if start == MAGIC else LONGEST_TEXT
    if size > longest:
        raise LevelError(
            "This file is too long for a level.",
            where=str(path),
            known=f"It has {size:,} bytes; at most {longest:,} are read.",
            remedy="Split the level, or keep buffers and images in files of their own.",
        )
