"""Words of the command line that the registry decides: techniques, their settings, and debug views."""

from __future__ import annotations

from collections.abc import Sequence

from api.showing import VIEW_NAMES
from renderers.registry import TECHNIQUES, technique


def labels() -> tuple[str, ...]:
    """Labels of the techniques."""
    return tuple(one.label for one in TECHNIQUES)


def choices(setting: str) -> tuple[str, ...]:
    """What a setting may be in any of the techniques, each word once."""
    found = (one.options[setting].choices for one in TECHNIQUES if setting in one.options)
    return tuple(dict.fromkeys(str(choice) for some in found for choice in some))


def pairs(label: str) -> tuple[str, ...]:
    """Every NAME=VALUE that a technique's settings may have, and NAME= for those that take numbers.

    Raises:
        UnknownTechniqueError: There is no such technique.
    """
    words: list[str] = []
    for name, option in technique(label).options.items():
        words += [f"{name}={str(choice).lower()}" for choice in option.choices]
        words += [f"{name}="] if option.bounds is not None else []
    return tuple(words)


def help_words() -> dict[str, str]:
    """What stands in help texts for `{techniques}`, `{views}`, `{filter}` and `{focus}`."""
    words = {name: listed(choices(name)) for name in ("filter", "focus")}
    return {"techniques": listed(labels()), "views": listed(VIEW_NAMES), **words}


def listed(words: Sequence[str]) -> str:
    """`SM, SV or Chan`."""
    return " or ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)
