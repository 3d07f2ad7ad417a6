"""Files that are there whole or not at all: a temporary name in the same folder, synced, then renamed."""

from __future__ import annotations

import errno
import os
import secrets
import stat
from pathlib import Path

from scenes.errors import OutputError

_FREE_SPACE = "Free some space and run the command again."
_OTHER_PLACE = "Choose a place where you may write, with -o."
_CAUSES = {
    errno.ENOENT: ("The folder does not exist.", "Create it, or choose another with -o."),
    errno.ENOTDIR: ("A part of the path is not a folder.", "Choose another path with -o."),
    errno.EISDIR: ("This is a folder, not a file.", "Name a file in it with -o."),
    errno.EACCES: ("There is no permission to write here.", _OTHER_PLACE),
    errno.EPERM: ("There is no permission to write here.", _OTHER_PLACE),
    errno.EROFS: ("The file system is read-only.", _OTHER_PLACE),
    errno.ENOSPC: ("The disk is full.", _FREE_SPACE),
    errno.EDQUOT: ("Your disk quota is used up.", _FREE_SPACE),
    errno.EFBIG: ("The file is too big for this file system.", _OTHER_PLACE),
    errno.ENAMETOOLONG: ("The name is too long for this file system.", "Choose a shorter name with -o."),
    errno.ELOOP: ("The symbolic links of this path run in a circle.", "Choose another path with -o."),
}


def write_atomically(path: Path, data: bytes) -> None:
    """Puts `data` at `path`: at every moment, even in a power cut, the old or the new file is there whole.

    An existing file keeps its permission bits, and its owner where the writer is root. A symbolic link
    stays, and the file it points to is replaced. Killed with SIGKILL, the writer may leave a hidden
    `.gnomon-*.partial` beside the target.

    Raises:
        OutputError: The file could not be written. What was at `path` is untouched and no temporary file
            is left; only where syncing the folder fails is the new file there already, as the error says.
    """
    try:
        target = Path(os.path.realpath(path))
        _replace(target, data, _existing(target))
    except OSError as error:
        raise output_error(path, error) from error
    try:
        _sync_folder(target.parent)
    except OSError as error:
        raise OutputError(
            "The file was written whole, but it may not survive a power cut.",
            where=str(path),
            known=_system_says(error),
            remedy="Check the disk.",
        ) from error


def output_error(path: Path, error: OSError) -> OutputError:
    """What to tell the user where the system refuses to write at `path`."""
    what, remedy = _CAUSES.get(error.errno or 0, ("The file could not be written.", _OTHER_PLACE))
    return OutputError(what, where=str(path), known=_system_says(error), remedy=remedy)


def _existing(target: Path) -> os.stat_result | None:
    try:
        status = target.stat()
    except FileNotFoundError:
        return None
    if stat.S_ISDIR(status.st_mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    if not stat.S_ISREG(status.st_mode):
        # Renaming over /dev/null would replace the device for the whole machine.
        raise OutputError(
            "This is a device or a pipe, not a file.", where=str(target), remedy="Name a file with -o."
        )
    if not os.access(target, os.W_OK, effective_ids=True):
        # A rename asks the folder alone; whoever made the file read-only meant it.
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    return status


def _replace(target: Path, data: bytes, existing: os.stat_result | None) -> None:
    temporary = target.parent / f".gnomon-{secrets.token_hex(8)}.partial"
    descriptor = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666)
    try:
        try:
            _write_synced(descriptor, data, existing)
        finally:
            os.close(descriptor)
        temporary.replace(target)
    except BaseException:
        # An interrupt may come when the file has its name already.
        temporary.unlink(missing_ok=True)
        raise


def _write_synced(descriptor: int, data: bytes, existing: os.stat_result | None) -> None:
    if existing:
        if os.geteuid() == 0:
            os.fchown(descriptor, existing.st_uid, existing.st_gid)
        os.fchmod(descriptor, stat.S_IMODE(existing.st_mode))
    rest = memoryview(data)
    while rest:
        rest = rest[os.write(descriptor, rest) :]
    os.fsync(descriptor)


def _sync_folder(folder: Path) -> None:
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _system_says(error: OSError) -> str:
    return f"The system says: {error.strerror or error}."
