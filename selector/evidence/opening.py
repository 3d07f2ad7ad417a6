"""A database opened as a store: made where there is none, brought up to date, and refused with a sentence."""

from __future__ import annotations

import os
import sqlite3
from pathlib import Path
from typing import Any

from sqlalchemy import URL, Connection, Engine, create_engine, event, make_url
from sqlalchemy.exc import ArgumentError, NoSuchModuleError

from selector.evidence.schema import SCHEMA_VERSION
from selector.evidence.store_error import StoreError, in_sentences
from selector.evidence.versions import bring_up_to_date, version_of

DATABASES = ("sqlite", "postgresql")
BEGIN = "gnomon_begin"
"""Execution option of a connection: the statement that begins its transactions."""
WRITING = {BEGIN: "BEGIN IMMEDIATE"}
"""SQLite then waits for its turn at the start; in the middle two programs could wait for each other."""

OUTSIDE_TRANSACTIONS = {BEGIN: "", "isolation_level": "AUTOCOMMIT"}


def opened(address: URL, *, write: bool, wait_s: float) -> Engine:
    """The engine of a store that is there and up to date.

    Args:
        address: What `address_of` made of a URL.
        write: Whether it may be made, brought up to date and added to.
        wait_s: How long to wait for another writer.

    Raises:
        StoreError: There is none, it is something else or newer than this program, or it cannot be opened.
    """
    if address.get_backend_name() == "sqlite":
        _require_file(Path(address.database or ""), write=write)
    engine = _engine(address, write=write, wait_s=wait_s)
    try:
        with in_sentences(shown(address)):
            version = version_of(engine)
            if version == SCHEMA_VERSION:
                return engine
            if version is None and not write:
                remedy = "Name another with --store."
                raise StoreError("This database holds no evidence yet.", remedy=remedy)  # noqa: TRY301
            if write:
                bring_up_to_date(engine.execution_options(**WRITING))
                return engine
    except BaseException:
        engine.dispose()
        raise
    engine.dispose()
    opened(address, write=True, wait_s=wait_s).dispose()
    return opened(address, write=False, wait_s=wait_s)


def address_of(url: str) -> URL:
    """A path, which is a SQLite file, or a URL of SQLAlchemy.

    Raises:
        StoreError: It is none, or of a kind of database in which evidence cannot be kept.
    """
    if "://" not in url:
        return _kept(URL.create("sqlite", database=url))
    try:
        address = make_url(url)
    except ArgumentError as error:
        remedy = "Name a file, or a URL such as postgresql+psycopg://host/database."
        raise StoreError("This is no address of an evidence store.", where=url, remedy=remedy) from error
    if address.get_backend_name() not in DATABASES:
        known = f"Stores are databases of the kinds {' and '.join(DATABASES)}."
        raise StoreError("Evidence cannot be kept in such a database.", where=shown(address), known=known)
    return _kept(address)


def _kept(address: URL) -> URL:
    """An address where something stays after the program has ended.

    Raises:
        StoreError: It is empty, or means the computer's memory.
    """
    if address.get_backend_name() == "sqlite" and (address.database or "").strip() in ("", ":memory:"):
        raise StoreError(
            "This address names no file: evidence would be lost with the end of the program.",
            where=f"--store {address.database!r}" if address.database is not None else shown(address),
            remedy="Name a file, or a URL such as postgresql+psycopg://host/database.",
        )
    return address


def shown(address: URL) -> str:
    """A store's address for messages: a file's path, or the URL without its password."""
    if address.get_backend_name() == "sqlite" and address.database:
        return address.database
    return address.render_as_string(hide_password=True)


def _require_file(path: Path, *, write: bool) -> None:
    if path.is_dir():
        what, remedy = "This is a folder, not an evidence store.", "`gnomon evidence import` reads folders."
        raise StoreError(what, where=str(path), remedy=remedy)
    if not path.parent.is_dir():
        raise StoreError("The folder of this evidence store does not exist.", where=str(path))
    if not write and not path.exists():
        remedy = "Name another with --store; `gnomon benchmark` makes one."
        raise StoreError("There is no such evidence store.", where=str(path), remedy=remedy)
    # SQLite puts a log and a lock beside the file.
    if write and not all(os.access(place, os.W_OK) for place in (path, path.parent) if place.exists()):
        remedy = "Copy it to a place where you may write, or name another with --store."
        raise StoreError("This evidence store may not be written.", where=str(path), remedy=remedy)


def _engine(address: URL, *, write: bool, wait_s: float) -> Engine:
    arguments: dict[str, Any] = {}
    if address.get_backend_name() == "sqlite":
        arguments = {"connect_args": {"timeout": wait_s, "check_same_thread": False}}
        if not write:
            file = _read_only(Path(address.database or ""))
            address = URL.create(
                "sqlite", database=f"file:{file.removeprefix('file://')}", query={"uri": "true"}
            )
    try:
        engine = create_engine(address, **arguments)
    except (ImportError, NoSuchModuleError) as error:
        remedy = "Install the driver that the URL names, such as psycopg."
        raise StoreError(
            "The driver of this database is missing.", where=shown(address), known=str(error), remedy=remedy
        ) from error
    if address.get_backend_name() == "sqlite":
        _prepare_sqlite(engine, write=write)
    return engine


def _read_only(path: Path) -> str:
    """SQLite's URI of a file that is only read."""
    uri = f"{path.resolve().as_uri()}?mode=ro"
    log = path.with_name(f"{path.name}-wal")
    # Even a reader makes a lock file beside the store, unless it is told that nobody can be writing.
    alone = not os.access(path.resolve().parent, os.W_OK) and not log.exists()
    return f"{uri}&immutable=1" if alone else uri


def _prepare_sqlite(engine: Engine, *, write: bool) -> None:
    """Transactions that begin when they should, which Python's driver puts off; and settings."""

    @event.listens_for(engine, "connect")
    def _connected(connection: sqlite3.Connection, _record: Any) -> None:
        connection.isolation_level = None
        connection.execute("PRAGMA foreign_keys=ON")
        if write:
            # Readers go on while one writes; a program that is killed leaves whole transactions only.
            connection.execute("PRAGMA journal_mode=WAL")
            connection.execute("PRAGMA synchronous=NORMAL")

    @event.listens_for(engine, "begin")
    def _begun(connection: Connection) -> None:
        if statement := connection.get_execution_options().get(BEGIN, "BEGIN"):
            connection.exec_driver_sql(statement)
