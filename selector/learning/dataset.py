"""Evidence turned into arrays to learn from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import log2

import numpy as np

from features.table import NAMES
from models.examples import Choices, Examples, Floats, Question
from renderers.registry import technique
from renderers.settings import Setting
from scenes.errors import GnomonError
from scenes.scene import Array, Mobility
from selector.evidence.table import UNKNOWN, EvidenceTable
from selector.policy import POLICIES, Policy

FOLLOWS_KIND = ("focus",)
"""Settings that the kind of light decides, so that they tell no choices apart."""

SHRINKS_ERROR = ("map_size",)
"""More of it never makes an edge worse: doc `techniques.md`, errors fall as 1/N."""

NO_SETTING = -1.0

FEWEST_FAMILIES, FEWEST_INSTANCES = 3, 20
"""With one family held out to judge a model, two must be left: one is held out to settle on it."""


class EvidenceError(GnomonError):
    """Evidence from which nothing can be learnt."""

    exit_code = 3


@dataclass(frozen=True)
class Slot:
    """A choice whatever the kind of light: a technique with the settings that the kind does not decide.

    Attributes:
        technique: Its id.
        settings: Names and values, in the technique's order.
    """

    technique: str
    settings: tuple[tuple[str, Setting], ...]

    @classmethod
    def of(cls, name: str, settings: Mapping[str, Setting]) -> Slot:
        """The slot of a candidate."""
        kept = tuple((key, value) for key, value in settings.items() if key not in FOLLOWS_KIND)
        return cls(name, kept)

    @property
    def label(self) -> str:
        """Such as `SM 1024 2x2`."""
        return " ".join([technique(self.technique).label, *(str(value) for _, value in self.settings)])


@dataclass(frozen=True)
class Dataset:
    """Examples, and what their rows and columns stand for.

    Attributes:
        examples: The arrays.
        slots: The choices.
        settings: Names of the numbers that tell variants of a technique apart.
        keys: Keys of the instances.
        left_out: How many instances could not be used, by reason.
    """

    examples: Examples
    slots: tuple[Slot, ...]
    settings: tuple[str, ...]
    keys: tuple[str, ...]
    left_out: Mapping[str, int]


def questions(policies: Sequence[Policy] = POLICIES) -> tuple[Question, ...]:
    """Every policy, for dynamic and for static lights."""
    return tuple(
        Question(one.name, str(mobility), one.max_edge_error_px)
        for mobility in (Mobility.DYNAMIC, Mobility.STATIC)
        for one in policies
    )


def dataset(
    table: EvidenceTable,
    times: Mapping[Mobility, Array],
    features: Mapping[str, Mapping[str, float]],
) -> Dataset:
    """What can be learnt from.

    Args:
        table: The evidence.
        times: (n, k) milliseconds of each candidate; nan where unknown.
        features: Instance key -> name -> value.

    Raises:
        EvidenceError: Too little is left, or it does not differ.
    """
    keys = [one.key for one in table.instances]
    described = np.array([set(NAMES) <= set(features.get(key, ())) for key in keys], bool)
    known = np.all([np.isfinite(times[mobility]).any(axis=1) for mobility in times], axis=0)
    works = table.ok.any(axis=1)
    kept = described & known & works
    left_out = {
        "without features": int((~described).sum()),
        "without times": int((described & ~known).sum()),
        "where no candidate works": int((described & known & ~works).sum()),
    }
    families = np.array([one.family for one in table.instances], dtype=np.str_)[kept]
    _require(families, left_out)
    slots = tuple(dict.fromkeys(Slot.of(one.technique, one.settings) for one in table.candidates))
    columns = [
        [index for index, one in enumerate(table.candidates) if Slot.of(one.technique, one.settings) == slot]
        for slot in slots
    ]
    tried = table.status != UNKNOWN
    values = [
        _merged(one, tried, columns)[kept]
        for one in (tried.astype(float), table.ok.astype(float), table.exceedance_px)
    ]
    offered, ok, error = values[0] == 1, values[1] == 1, values[2]
    of_mobility = {str(name): _merged(one, tried, columns)[kept] for name, one in times.items()}
    asked = questions()
    costs = [Policy(one.name, one.limit).costs(of_mobility[one.time], error, ok) for one in asked]
    rows = np.array([[features[key][name] for name in NAMES] for key in np.array(keys)[kept]])
    choices, names = choices_of(slots)
    examples = Examples(
        rounded(rows), families, choices, offered, ok, of_mobility, error, np.stack(costs), asked
    )
    return Dataset(examples, slots, names, tuple(np.array(keys)[kept].tolist()), left_out)


def rounded(rows: Floats) -> Floats:
    """Values of float32, as every reader of a model takes them, so that thresholds fall alike for all."""
    found: Floats = np.asarray(rows, np.float32).astype(np.float64)
    return found


def choices_of(slots: Sequence[Slot]) -> tuple[Choices, tuple[str, ...]]:
    """The slots as numbers, and the names of the settings among these."""
    techniques = list(dict.fromkeys(one.technique for one in slots))
    names = tuple(dict.fromkeys(name for one in slots for name, _ in one.settings))
    settings = np.full((len(slots), len(names)), NO_SETTING)
    for row, one in enumerate(slots):
        for name, value in one.settings:
            settings[row, names.index(name)] = _number(one.technique, name, value)
    method = np.array([techniques.index(one.technique) for one in slots], np.int64)
    trend = tuple(-1 if name in SHRINKS_ERROR else 0 for name in names)
    return Choices(method, rounded(settings), trend), names


def _number(name: str, setting: str, value: Setting) -> float:
    """Logarithms of what is measured, places of what is named."""
    if isinstance(value, bool | str):
        return float(technique(name).options[setting].choices.index(value))
    return log2(value) if value > 0 else 0.0


def _merged(values: Array, tried: np.ndarray, columns: Sequence[Sequence[int]]) -> Array:
    """(n, slots) the value of whichever of a slot's candidates was tried."""
    rows = np.arange(len(values))
    merged = []
    for of_slot in columns:
        index = np.asarray(of_slot)
        merged.append(values[rows, index[tried[:, index].argmax(axis=1)]])
    found: Array = np.stack(merged, axis=1)
    return found


def _require(families: np.ndarray, left_out: Mapping[str, int]) -> None:
    names = np.unique(families)
    if len(names) >= FEWEST_FAMILIES and len(families) >= FEWEST_INSTANCES:
        return
    why = ", ".join(f"{count} {reason}" for reason, count in left_out.items() if count)
    left = f" Left out: {why}." if why else ""
    raise EvidenceError(
        f"There is too little evidence: {len(families)} instances of {len(names)} "
        f"famil{'y' if len(names) == 1 else 'ies'}.",
        known=f"At least {FEWEST_INSTANCES} of {FEWEST_FAMILIES} families are needed.{left}",
        remedy="Benchmark more: `gnomon benchmark`.",
    )
