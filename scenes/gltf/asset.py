"""A glTF file as tables of entries that refer to each other by index."""

from __future__ import annotations

from pathlib import Path

from scenes.entry import Entry
from scenes.errors import LevelError

LIGHTS = "KHR_lights_punctual"

# Table name in the JSON -> what one entry of it is called in messages.
TABLES = {
    "scenes": "scene",
    "nodes": "node",
    "meshes": "mesh",
    "materials": "material",
    "skins": "skin",
    "cameras": "camera",
    "lights": "light",
    "accessors": "accessor",
    "bufferViews": "buffer view",
    "buffers": "buffer",
    "animations": "animation",
}


class Asset:
    """The tables of one file.

    Args:
        root: The root of its JSON.
        binary: Its BIN chunk, if it has one.
        folder: Where the files lie that it names.

    Raises:
        LevelError: A table is not a list.
    """

    def __init__(self, root: Entry, binary: bytes | memoryview | None, folder: Path) -> None:
        self.root = root
        self.binary = binary
        self.folder = folder
        self._tables = {name: self._owner(name).items(name) for name in TABLES}
        self._entries: dict[tuple[str, int], Entry] = {}

    def _owner(self, table: str) -> Entry:
        if table != "lights":
            return self.root
        return self.root.extension(LIGHTS) or Entry({}, LIGHTS)

    def count(self, table: str) -> int:
        """How many entries the table has."""
        return len(self._tables[table])

    def entry(self, table: str, index: int, referrer: str) -> Entry:
        """One entry of a table.

        Raises:
            LevelError: There is none of that index, or it is not an object; `referrer` asked for it.
        """
        found = self._entries.get((table, index))
        if found is None:
            found = self._entries[table, index] = self._checked(table, index, referrer)
        return found

    def _checked(self, table: str, index: int, referrer: str) -> Entry:
        label = TABLES[table]
        if index >= self.count(table):
            raise LevelError(
                f"{label} {index} does not exist.",
                where=referrer,
                known=f"The file has {self.count(table)} of them, counted from 0.",
            )
        values = self._tables[table][index]
        if not isinstance(values, dict):
            raise LevelError("This entry is not a JSON object.", where=f"{label} {index}")
        plain = Entry(values, f"{label} {index}")
        name = plain.text("name")
        return Entry(values, f'{label} {index} "{name}"') if name else plain

    def linked(self, entry: Entry, key: str, table: str) -> tuple[int, Entry]:
        """Index and entry to which a property refers.

        Raises:
            LevelError: The property is missing, no index, or there is no such entry.
        """
        index = entry.integer(key)
        return index, self.entry(table, index, entry.where)
