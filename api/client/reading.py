"""Turns JSON from outside into typed records, or says where it is not what was promised."""

from __future__ import annotations

import json
import math
import types
from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields, is_dataclass
from functools import cache
from typing import Any, Literal, TypeVar, Union, cast, get_args, get_origin, get_type_hints

from .errors import BadAnswerError

Record = TypeVar("Record")

LONGEST_SHOWN = 60


def parsed(data: bytes) -> object:
    """The JSON value that an answer holds.

    Raises:
        BadAnswerError: It is no JSON, or holds what JSON has no numbers for.
    """
    try:
        # The part before the first fault may be long, and of no use to anybody: only its place is told.
        return json.loads(data.decode(), parse_constant=_no_number)
    except json.JSONDecodeError as error:
        raise BadAnswerError(f"The answer is not JSON: {error.msg} at character {error.pos}.") from None
    except (ValueError, RecursionError) as error:
        raise BadAnswerError(f"The answer is not JSON: {_short(str(error))}.") from None


def record(kind: type[Record], value: object, where: str = "answer") -> Record:
    """A value as a record of this kind; keys that the kind does not know are left out.

    Raises:
        BadAnswerError: A key is missing, or has a value of another type.
    """
    if not isinstance(value, dict):
        raise _unlike(where, "an object", value)
    made = getattr(kind, "from_json", None)
    return cast("Record", made(value, where) if made else kind(**known_fields(kind, value, where)))


def known_fields(kind: type, value: Mapping[str, object], where: str) -> dict[str, Any]:
    """The fields of a record that a JSON object holds, each of its type.

    Raises:
        BadAnswerError: A field without default is missing, or one has a value of another type.
    """
    hints, found = _hints(kind), {}
    for field in fields(kind):
        if field.name in value:
            found[field.name] = _typed(hints[field.name], value[field.name], f"{where}.{field.name}")
        elif field.default is MISSING and field.default_factory is MISSING:
            raise BadAnswerError(f"The {where} has no {field.name}.")
    return found


@cache
def _hints(kind: type) -> dict[str, Any]:
    return get_type_hints(kind)


def _typed(hint: Any, value: object, where: str) -> object:
    origin, arguments = get_origin(hint), get_args(hint)
    if hint is Any:
        return value
    if origin in READERS:
        return READERS[origin](arguments, value, where)
    if is_dataclass(hint):
        return record(cast("type", hint), value, where)
    return _scalar(hint, value, where)


def _mapping(arguments: tuple[Any, ...], value: object, where: str) -> dict[str, object]:
    if not isinstance(value, dict):
        raise _unlike(where, "an object", value)
    return {key: _typed(arguments[1], entry, f"{where}.{_short(key)}") for key, entry in value.items()}


def _literal(arguments: tuple[Any, ...], value: object, where: str) -> object:
    if value not in arguments:
        raise _unlike(where, "one of " + ", ".join(map(str, arguments)), value)
    return value


def _either(choices: tuple[Any, ...], value: object, where: str) -> object:
    wanted = [choice for choice in choices if choice is not types.NoneType]
    if value is None and len(wanted) < len(choices):
        return None
    for choice in wanted[:-1]:
        try:
            return _typed(choice, value, where)
        except BadAnswerError:
            continue
    return _typed(wanted[-1], value, where)


def _sequence(arguments: tuple[Any, ...], value: object, where: str) -> tuple[object, ...]:
    if not isinstance(value, list):
        raise _unlike(where, "a list", value)
    if arguments[-1] is Ellipsis:
        arguments = (arguments[0],) * len(value)
    if len(arguments) != len(value):
        raise BadAnswerError(f"The {where} has {len(value)} entries where {len(arguments)} were expected.")
    pairs = zip(arguments, value, strict=True)
    return tuple(_typed(hint, entry, f"{where}[{index}]") for index, (hint, entry) in enumerate(pairs))


def _scalar(hint: Any, value: object, where: str) -> object:
    names = {str: "a string", int: "an integer", float: "a number", bool: "true or false"}
    # JSON writes 2.0 as 2 where it likes, and Python takes true for 1.
    if hint is float and isinstance(value, int) and not isinstance(value, bool) and abs(value) < 1 << 1023:
        return float(value)
    if type(value) is not hint or (isinstance(value, float) and not math.isfinite(value)):
        raise _unlike(where, names[hint], value)
    return value


READERS: dict[Any, Callable[[tuple[Any, ...], object, str], object]] = {
    Union: _either,
    types.UnionType: _either,
    tuple: _sequence,
    dict: _mapping,
    Literal: _literal,
}


def _unlike(where: str, wanted: str, value: object) -> BadAnswerError:
    return BadAnswerError(f"The {where} is {_short(repr(value))} where {wanted} was expected.")


def _short(text: str) -> str:
    return text if len(text) <= LONGEST_SHOWN else text[:LONGEST_SHOWN] + "..."


def _no_number(name: str) -> float:
    raise ValueError(f"{name} is no JSON number")
