"""Which version a store's schema has, and how it becomes today's."""

from __future__ import annotations

from sqlalchemy import Connection, Engine, inspect, select, update

from selector.evidence.migrations import MIGRATIONS
from selector.evidence.schema import SCHEMA_VERSION, meta, metadata
from selector.evidence.store_error import StoreError

_VERSION = "schema_version"


def version_of(engine: Engine) -> int | None:
    """The version of a store's schema; None where the database is empty.

    Raises:
        StoreError: The database is something else, or newer than this program.
    """
    with engine.connect() as connection:
        return _version(connection)


def bring_up_to_date(engine: Engine) -> None:
    """Makes the tables, or goes through the versions one by one: all in one transaction, or nothing.

    Raises:
        StoreError: As above.
    """
    with engine.begin() as connection:
        version = _version(connection)
        if version is None:
            metadata.create_all(connection)
            connection.execute(meta.insert().values(name=_VERSION, value=str(SCHEMA_VERSION)))
            return
        for number in range(version, SCHEMA_VERSION):
            MIGRATIONS[number](connection)
        connection.execute(update(meta).where(meta.c.name == _VERSION).values(value=str(SCHEMA_VERSION)))


def _version(connection: Connection) -> int | None:
    """None where the database is empty."""
    tables = inspect(connection).get_table_names()
    if not tables:
        return None
    if meta.name not in tables:
        raise StoreError(
            "This database is something else, and no evidence store.",
            known=f"It has a table {min(tables)}.",
            remedy="Name another with --store.",
        )
    found = connection.scalar(select(meta.c.value).where(meta.c.name == _VERSION))
    if found is None or not found.isdecimal():
        raise StoreError(
            "This evidence store does not say of which version it is.", known=f"It says {found}."
        )
    if int(found) > SCHEMA_VERSION:
        raise StoreError(
            "This evidence store was made by a newer Gnomon.",
            known=f"Its schema is version {found}; this program knows versions up to {SCHEMA_VERSION}.",
            remedy="Update Gnomon, or export the evidence with the newer one and import it here.",
        )
    return int(found)
