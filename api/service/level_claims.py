"""What a level claims to hold, counted from its JSON: what is too much is refused before anything is built.

Whatever is malformed counts nothing here. Whoever reads the level says what is wrong with it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from scenes.entry import Entry
from scenes.errors import LevelError

LONGEST_NAME, SHOWN = 4096, 80
LIGHTS, INSTANCING = "KHR_lights_punctual", "EXT_mesh_gpu_instancing"
MOST_PER_ASKED = 20
"""A level may hold so many times the lights that may be asked about at once."""
TRIANGLES, STRIPS = 4, (5, 6)
_NAMED = ("nodes", "cameras", "scenes", "meshes", "materials")

Json = dict[str, Any]


def check_names(root: Entry) -> None:
    """Refuse names that are no words: they are repeated in every answer, record and event.

    Raises:
        LevelError: One is too long.
    """
    tables = {table: _list(root.values.get(table)) for table in _NAMED}
    tables["lights"] = _list(_dict(_dict(root.values.get("extensions")).get(LIGHTS)).get("lights"))
    for table, entries in tables.items():
        for index, entry in enumerate(entries):
            name = _dict(entry).get("name")
            if isinstance(name, str) and len(name.encode(errors="replace")) > LONGEST_NAME:
                raise LevelError(
                    "This name is too long.",
                    where=f"{table[:-1].replace('meshe', 'mesh')} {index}",
                    known=f"It has {len(name):,} characters and begins with {name[:SHOWN]!a}; "
                    f"the service takes {LONGEST_NAME:,} bytes.",
                    remedy="Give it a shorter one.",
                )


def check_size(root: Entry, scene: str | None, *, some_lights: bool, lights: int, triangles: int) -> None:
    """Refuse what would be refused in the end, after minutes of work.

    Args:
        root: The level's JSON.
        scene: The one that is asked for, by name or number; the level's own choice where None.
        some_lights: Whether lights are asked for by name, and not all of them.
        lights: That may be asked about at once.
        triangles: That may be drawn.

    Raises:
        LevelError: There are more.
    """
    found_lights = found_triangles = 0
    drawn: dict[int, int] = {}
    for node in _nodes(root, scene):
        extensions = _dict(node.get("extensions"))
        found_lights += _number(_dict(extensions.get(LIGHTS)).get("light")) is not None
        mesh = _number(node.get("mesh"))
        if mesh is not None:
            if mesh not in drawn:
                drawn[mesh] = _triangles(root, mesh)
            found_triangles += drawn[mesh] * _copies(root, extensions)
    most_lights = lights * MOST_PER_ASKED if some_lights else lights
    remedy = "Ask about some of them, with light=NAME."
    if found_lights > lights * MOST_PER_ASKED:
        remedy = "Split the level."
    refuse_more(found_lights, "lights", most_lights, remedy)
    refuse_more(found_triangles, "triangles", triangles, "Split the level, or simplify its meshes.")


def refuse_more(count: int, what: str, most: int, remedy: str, where: str = "") -> None:
    """Refuse more of something than the service takes.

    Raises:
        LevelError: There is more.
    """
    if count > most:
        raise LevelError(
            f"This level has {count:,} {what}; the service takes {most:,}.", where=where, remedy=remedy
        )


def _nodes(root: Entry, scene: str | None) -> Iterator[Json]:
    """The nodes of the scene that will be read, each once."""
    nodes = _list(root.values.get("nodes"))
    waiting, seen = _roots(root, scene, len(nodes)), set[int]()
    while waiting:
        index = _number(waiting.pop())
        if index is None or index >= len(nodes) or index in seen:
            continue
        seen.add(index)
        node = _dict(nodes[index])
        yield node
        waiting += _list(node.get("children"))


def _roots(root: Entry, scene: str | None, nodes: int) -> list[Any]:
    scenes = [_dict(one) for one in _list(root.values.get("scenes"))]
    if scene is None:
        if not scenes:
            return list(range(nodes))
        chosen = _number(root.values.get("scene")) or 0
    else:
        names = [one.get("name", "") for one in scenes]
        chosen = names.index(scene) if scene in names else -1
        if chosen < 0 and scene.isdecimal() and len(scene) < len(str(len(scenes))) + 1:
            chosen = int(scene)
    return list(_list(scenes[chosen].get("nodes"))) if 0 <= chosen < len(scenes) else []


def _triangles(root: Entry, mesh: int) -> int:
    return sum(_of_primitive(root, _dict(one)) for one in _list(_at(root, "meshes", mesh).get("primitives")))


def _of_primitive(root: Entry, primitive: Json) -> int:
    corners = primitive.get("indices", _dict(primitive.get("attributes")).get("POSITION"))
    count = _count(root, corners)
    mode = primitive.get("mode", TRIANGLES)
    if mode == TRIANGLES:
        return count // 3
    return max(count - 2, 0) if mode in STRIPS else 0


def _copies(root: Entry, extensions: Json) -> int:
    attributes = _dict(_dict(extensions.get(INSTANCING)).get("attributes"))
    counts = [_count(root, accessor) for accessor in attributes.values()]
    return min(counts) if counts else 1


def _count(root: Entry, accessor: object) -> int:
    index = _number(accessor)
    return 0 if index is None else _number(_at(root, "accessors", index).get("count")) or 0


def _at(root: Entry, table: str, index: int) -> Json:
    entries = _list(root.values.get(table))
    return _dict(entries[index]) if index < len(entries) else {}


def _number(value: object) -> int | None:
    return value if isinstance(value, int) and not isinstance(value, bool) and value >= 0 else None


def _dict(value: object) -> Json:
    return value if isinstance(value, dict) else {}


def _list(value: object) -> list[Any]:
    return value if isinstance(value, list) else []
