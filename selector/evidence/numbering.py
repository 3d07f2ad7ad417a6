"""Keys and the short numbers that stand for them in one store."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from sqlalchemy import Connection, Table, select
from sqlalchemy.dialects import postgresql, sqlite

from selector.evidence.packing import Names, names_of, names_text
from selector.evidence.schema import vocabularies
from selector.evidence.store_error import StoreError

Record = dict[str, Any]

_INSERTS: Mapping[str, Any] = {"sqlite": sqlite.insert, "postgresql": postgresql.insert}
_AT_ONCE = 500


def inserting(connection: Connection, table: Table) -> Any:
    """An INSERT in this database's dialect, which can say what to do about rows that are there already."""
    return _INSERTS[connection.dialect.name](table)


def insert_new(connection: Connection, table: Table, records: Sequence[Record]) -> None:
    """Adds the records that are not there yet."""
    if records:
        connection.execute(inserting(connection, table).on_conflict_do_nothing(), records)


def numbers(connection: Connection, table: Table, keys: Iterable[str]) -> dict[str, int]:
    """Key -> number of rows of a table that is keyed.

    Raises:
        StoreError: A key is not there.
    """
    wanted = list(dict.fromkeys(keys))
    found: dict[str, int] = {}
    for start in range(0, len(wanted), _AT_ONCE):
        some = table.c.key.in_(wanted[start : start + _AT_ONCE])
        found.update(
            (key, number) for key, number in connection.execute(select(table.c.key, table.c.id).where(some))
        )
    if missing := [key for key in wanted if key not in found]:
        known = f"It knows no {missing[0]} among its {table.name}."
        raise StoreError("A measurement names something that this evidence store does not hold.", known=known)
    return found


class Vocabularies:
    """The lists of names of one transaction, by number and by names."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._names: dict[int, Names] = {}
        self._numbers: dict[Names, int] = {}
        self._read()

    def names(self, number: int) -> Names:
        """What a number stands for."""
        return self._names[number]

    def number(self, names: Names) -> int:
        """What stands for these names, from now on if not yet."""
        if names not in self._numbers:
            insert_new(self._connection, vocabularies, [{"names": names_text(names)}])
            self._read()
        return self._numbers[names]

    def _read(self) -> None:
        for number, text in self._connection.execute(select(vocabularies.c.id, vocabularies.c.names)):
            self._names[number] = names_of(text)
            self._numbers[self._names[number]] = number
