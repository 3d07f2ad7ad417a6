"""Options that mean the same in every command."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from api.wording import shortened

SMALLEST_SIDE, LARGEST_SIDE = 16, 4096
"""8192x8192 took 12.5 GB of memory; a quarter of its pixels fits common machines."""
MOST_DIGITS = 9
LONGEST_SHOWN = 60
_SECONDS = {"s": 1, "m": 60, "min": 60, "h": 3600, "d": 86_400}


@dataclass(frozen=True)
class Resolution:
    """Pixels across and down."""

    width: int
    height: int

    def __str__(self) -> str:
        return f"{self.width}x{self.height}"


def parse_resolution(text: str | Resolution) -> Resolution:
    """`640x360` as numbers.

    Raises:
        BadParameter: It is none, or a side is too short or too long.
    """
    if isinstance(text, Resolution):
        return text
    match = re.fullmatch(r"(\d{1,6})[xX](\d{1,6})", text)
    if match is None:
        raise typer.BadParameter(f'"{text}" is not a resolution such as 640x360.')
    resolution = Resolution(int(match[1]), int(match[2]))
    if not all(SMALLEST_SIDE <= side <= LARGEST_SIDE for side in (resolution.width, resolution.height)):
        raise typer.BadParameter(f"Both sides must be between {SMALLEST_SIDE} and {LARGEST_SIDE} pixels.")
    return resolution


def parse_time(text: str | float) -> float:
    """`90s`, `20min`, `2h` or `30d` as seconds.

    Raises:
        BadParameter: It is none of these, or no time at all.
    """
    match = re.fullmatch(r"(\d{1,6}(?:\.\d{1,3})?)\s*(s|m|min|h|d)", str(text))
    if match is None or float(match[1]) == 0:
        raise typer.BadParameter(f'"{text}" is not a time such as 90s, 20min, 2h or 30d.')
    return float(match[1]) * _SECONDS[match[2]]


def parse_pixels(text: str | float) -> float:
    """A number of pixels, at least 0.

    Raises:
        BadParameter: It is none, negative or not finite.
    """
    try:
        pixels = float(text)
    except ValueError:
        raise typer.BadParameter(f'"{text}" is not a number of pixels such as 1.5.') from None
    if not math.isfinite(pixels) or pixels < 0:
        raise typer.BadParameter(f'"{text}" is not a finite number of pixels from 0 on, such as 1.5.')
    return pixels


def whole_number(low: int, high: int) -> Callable[[str | int], int]:
    """A parser of whole numbers from `low` to `high`; it raises BadParameter for anything else."""

    def parse(text: str | int) -> int:
        if not re.fullmatch(r"\d{1,9}", str(text)) or not low <= int(text) <= high:
            raise typer.BadParameter(f'"{text}" is not a whole number from {low} to {high}.')
        return int(text)

    return parse


def parse_device(text: str) -> str:
    """A device's name or number.

    Raises:
        BadParameter: It is empty, which would be a part of every name, or longer than any number.
    """
    if not text.strip() or (text.isdecimal() and len(text) > MOST_DIGITS):
        shown = shortened(text, LONGEST_SHOWN)
        raise typer.BadParameter(f'"{shown}" is no device; `gnomon devices` lists them.')
    return text


def one_of(*choices: str) -> Callable[[str], str]:
    """A parser of one of these words; it raises BadParameter for any other."""

    def parse(text: str) -> str:
        if text not in choices:
            known = " or ".join(f'"{choice}"' for choice in choices)
            raise typer.BadParameter(f'"{text}" is not {known}.')
        return text

    return parse


def completing(*choices: str) -> Callable[[], list[str]]:
    """What a shell offers for an option that takes one of these words."""
    return lambda: list(choices)


def known_techniques() -> list[str]:
    """What a shell offers where a technique is asked for."""
    from api.vocabulary import labels  # noqa: PLC0415  OpenGL is loaded only by whoever needs it

    return list(labels())


def known_views() -> list[str]:
    """What a shell offers where a debug view is asked for."""
    from api.showing import VIEW_NAMES  # noqa: PLC0415  as above

    return list(VIEW_NAMES)


def known_choices(setting: str) -> Callable[[], list[str]]:
    """What a shell offers where a setting of techniques is asked for."""

    def words() -> list[str]:
        from api.vocabulary import choices  # noqa: PLC0415  as above

        return list(choices(setting))

    return words


def known_settings(ctx: typer.Context) -> list[str]:
    """What a shell offers where NAME=VALUE is asked for: those of the technique on the same line."""
    from api.vocabulary import pairs  # noqa: PLC0415  as above
    from scenes.errors import GnomonError  # noqa: PLC0415

    try:
        return list(pairs(str(ctx.params.get("technique") or "SM")))
    except GnomonError:
        return []


def parse_settings(shorthands: Mapping[str, str | None], texts: Sequence[str]) -> dict[str, str]:
    """Names and values of settings, from options of their own and from texts such as `depth=kozlov`.

    Raises:
        BadParameter: A text is no such pair, or a name is given twice.
    """
    found = {name: value for name, value in shorthands.items() if value is not None}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals and value):
            shown = shortened(text, LONGEST_SHOWN)
            raise typer.BadParameter(
                f'"{shown}" is not NAME=VALUE, such as map_size=512.', param_hint="--set"
            )
        if name in found:
            raise typer.BadParameter(f'"{shortened(name, LONGEST_SHOWN)}" is set twice.', param_hint="--set")
        found[name] = value
    return found


DEFAULT_RESOLUTION = Resolution(640, 360)

Level = Annotated[
    Path,
    typer.Argument(
        metavar="LEVEL",
        help="The level file: glTF, USD, Quake .map, OBJ, PLY, STL or a lights file.",
        show_default=False,
    ),
]
AddedLights = Annotated[
    list[str] | None,
    typer.Option(
        "--add-light",
        metavar="LIGHT",
        help='One more light, such as "spot position_m=0,3,0 target_m=1,0,2 outer_cone_deg=30 range_m=12". '
        "May be given again.",
        show_default=False,
    ),
]
SceneName = Annotated[
    str | None,
    typer.Option(
        "--scene",
        metavar="NAME|INDEX",
        help="Which scene of the file.",
        show_default="the file's default scene",
    ),
]
Device = Annotated[
    str | None,
    typer.Option(
        "--device",
        metavar="NAME|INDEX",
        parser=parse_device,
        help="Which GPU, as `gnomon devices` lists them.",
        show_default="the first that works",
    ),
]
Size = Annotated[
    Resolution,
    typer.Option(
        "--resolution", metavar="WxH", parser=parse_resolution, help="Pixels across and down of each view."
    ),
]
DEFAULT_STORE = "gnomon-evidence.sqlite"
StoreUrl = Annotated[
    str,
    typer.Option(
        "--store",
        metavar="URL",
        help="The evidence: a SQLite file, or the URL of a PostgreSQL database.",
    ),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print the result as JSON, and nothing else on stdout.")]


def parse_names(text: str | None) -> tuple[str, ...]:
    """`SM,SV` as its names; none where there is nothing.

    Raises:
        BadParameter: There are commas, and no names.
    """
    if text is None:
        return ()
    names = tuple(name.strip() for name in text.split(",") if name.strip())
    if not names:
        raise typer.BadParameter(f'"{text}" names nothing.')
    return names
