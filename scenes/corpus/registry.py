"""The families of the corpus: every module of `families` is one, and is found by being there."""

from __future__ import annotations

import importlib
import pkgutil
from functools import cache
from typing import Protocol, runtime_checkable

import scenes.corpus.families
from scenes.corpus.spec import SpecError
from scenes.corpus.stage import Plan, Stage
from scenes.scene import LightKind


@runtime_checkable
class Family(Protocol):
    """What a module of that folder holds.

    Attributes:
        SUMMARY: One line that says what it is and what it stretches.
        INDOOR: Whether most of the sky is hidden from where people are.
        TRIANGLES: Fewest and most that it can be built of.
        KINDS: The kinds of light that can light it.
    """

    SUMMARY: str
    INDOOR: bool
    TRIANGLES: tuple[int, int]
    KINDS: tuple[LightKind, ...]

    def build(self, plan: Plan) -> Stage:
        """The place that the plan asks for: at most twice its triangles; fewer are split later."""


@cache
def families() -> dict[str, Family]:
    """Name -> family, in the order of names.

    Raises:
        TypeError: A module is no family.
    """
    return load_families(list(scenes.corpus.families.__path__), scenes.corpus.families.__name__)


def load_families(folders: list[str], package: str) -> dict[str, Family]:
    """Name -> family, for every module in the folders.

    Raises:
        TypeError: A module is no family.
    """
    found: dict[str, Family] = {}
    for info in sorted(pkgutil.iter_modules(folders), key=lambda info: info.name):
        module = importlib.import_module(f"{package}.{info.name}")
        if not isinstance(module, Family):
            raise TypeError(f"{module.__name__} lacks SUMMARY, INDOOR, TRIANGLES, KINDS or build().")
        found[info.name] = module
    return found


def family_named(name: str) -> Family:
    """The family of that name.

    Raises:
        SpecError: There is none.
    """
    found = families().get(name)
    if found is None:
        raise SpecError(f'There is no family "{name}".', known=f"There are {', '.join(families())}.")
    return found
