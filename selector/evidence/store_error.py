"""What goes wrong with a store, in sentences: the database's own codes say too little to act on."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager

from sqlalchemy import exc

from scenes.errors import GnomonError

_OURS = (exc.IntegrityError, exc.ProgrammingError, exc.DataError, exc.NotSupportedError, exc.InternalError)
"""Errors of a database that only a bug of ours can cause."""

_WHOLE = "All that was stored before is whole."
_SENTENCES = {
    sqlite3.SQLITE_BUSY: (
        "Another program is writing to this evidence store.",
        "Wait for it to end, or write to another store and merge the two with `gnomon evidence merge`.",
    ),
    sqlite3.SQLITE_LOCKED: (
        "Another program is writing to this evidence store.",
        "Wait for it to end, and try again.",
    ),
    sqlite3.SQLITE_FULL: (
        "The disk is full, and this evidence store can take no more.",
        f"{_WHOLE} Free some space and run the command again.",
    ),
    sqlite3.SQLITE_IOERR: (
        "The disk failed while this evidence store was read or written.",
        f"{_WHOLE} Check the disk, and that it is not full.",
    ),
    sqlite3.SQLITE_NOTADB: (
        "This file is no evidence store.",
        "Name another with --store; `gnomon evidence import` reads Parquet and CSV.",
    ),
    sqlite3.SQLITE_CORRUPT: (
        "This evidence store is damaged.",
        "Make a new one, and bring in what can still be read with `gnomon evidence merge`.",
    ),
    sqlite3.SQLITE_READONLY: (
        "This evidence store may not be written.",
        "Copy it to a place where you may write, or name another with --store.",
    ),
    sqlite3.SQLITE_PERM: (
        "There is no permission to open this evidence store.",
        "Name another with --store.",
    ),
    sqlite3.SQLITE_CANTOPEN: (
        "This evidence store cannot be opened.",
        "Check that the folder exists and that you may write to it, or name another with --store.",
    ),
}


class StoreError(GnomonError):
    """A store of evidence that cannot be read or written; what was stored before is whole."""

    exit_code = 7


@contextmanager
def in_sentences(where: str) -> Iterator[None]:
    """Failures of the database in the block, as sentences.

    Raises:
        StoreError: The database cannot do it. Our own bugs pass as they are.
    """
    try:
        yield
    except StoreError as error:
        error.where = error.where or where
        raise
    except exc.DBAPIError as error:
        if isinstance(error, _OURS):
            raise
        raise _sentence(error, where) from error


def _sentence(error: exc.DBAPIError, where: str) -> StoreError:
    cause = error.orig
    # The lower byte is the kind; the upper ones are details of the same.
    code = (getattr(cause, "sqlite_errorcode", None) or -1) & 0xFF
    what, remedy = _SENTENCES.get(
        code, ("The database cannot do it.", "Check the URL, and that the database runs.")
    )
    return StoreError(what, where=where, known=f"The database says: {cause}.", remedy=remedy)
