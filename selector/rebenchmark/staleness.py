"""What of a device's evidence is stale, and why."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

from selector.evidence.dating import Dated
from selector.evidence.rows import DeviceRow
from selector.evidence.superseding import Marks

Part = tuple[str, str]
"""Key of an instance, and id of a technique: what becomes stale as one."""


class Reason(StrEnum):
    """Why times no longer hold; the first that applies counts."""

    DEVICE = "device"
    CODE = "code"
    DRIFT = "drift"
    AGE = "age"


@dataclass(frozen=True)
class Freshness:
    """How fresh everything is that was ever timed on a device or its predecessor.

    Attributes:
        stale: What is stale -> why.
        fresh: What is not.
        oldest: When the oldest fresh one was timed; UTC, ISO 8601; empty where there is none.
    """

    stale: Mapping[Part, Reason]
    fresh: frozenset[Part]
    oldest: str

    @property
    def parts(self) -> frozenset[Part]:
        """All of it."""
        return self.fresh | self.stale.keys()

    def counts(self) -> dict[str, Counter[str]]:
        """Technique -> reason, or `fresh` -> how many instances."""
        found: dict[str, Counter[str]] = {}
        for (_, technique), reason in self.stale.items():
            found.setdefault(technique, Counter())[str(reason)] += 1
        for _, technique in self.fresh:
            found.setdefault(technique, Counter())["fresh"] += 1
        return dict(sorted(found.items()))


def freshness(
    dated: Iterable[Dated],
    device: str,
    predecessor: str | None,
    codes: Mapping[str, str],
    marks: Marks,
    oldest_allowed: str,
) -> Freshness:
    """Looks at every instance and technique that was ever timed here.

    Args:
        dated: Every timing, the oldest first.
        device: Key of the device.
        predecessor: Key of the same hardware under another driver; None where there is none.
        codes: Technique's id -> hash of its code today; what is of other techniques is left out.
        marks: Which times no longer hold.
        oldest_allowed: What was timed earlier is stale by age; UTC, ISO 8601.
    """
    here = {device, predecessor} - {None}
    newest: dict[tuple[str, str, str], tuple[Reason | None, str]] = {}
    for one in dated:
        if one.device not in here or one.technique not in codes:
            continue
        key = one.instance, one.technique, one.candidate
        if one.device != device:
            reason: Reason | None = Reason.DEVICE
        elif one.code != codes[one.technique]:
            reason = Reason.CODE
        elif one.started < marks.get((device, one.technique), ""):
            reason = Reason.DRIFT
        else:
            reason = Reason.AGE if one.started < oldest_allowed else None
        # A fact of this device and code outweighs any other; among these the newest.
        known = newest.get(key)
        if known is None or _rank(reason) >= _rank(known[0]):
            newest[key] = reason, one.started
    stale: dict[Part, Reason] = {}
    dates: dict[Part, str] = {}
    for (instance, technique, _), (reason, started) in newest.items():
        part = instance, technique
        dates[part] = min(started, dates.get(part, started))
        if reason is not None and (part not in stale or _rank(reason) < _rank(stale[part])):
            stale[part] = reason
    fresh = frozenset(part for part in dates if part not in stale)
    return Freshness(stale, fresh, min((dates[part] for part in fresh), default=""))


def predecessor(device: DeviceRow, known: Sequence[DeviceRow], dated: Sequence[Dated]) -> DeviceRow | None:
    """The same hardware under another driver, as far as the names tell: the one that was timed last.

    A renderer's name begins with the hardware's and goes on, in brackets, with the driver's parts.
    """
    last = {one.device: one.started for one in dated}
    like = [
        one
        for one in known
        if one.key != device.key
        and one.key in last
        and not one.virtual
        and _hardware(one) == _hardware(device)
    ]
    return max(like, key=lambda one: last[one.key], default=None)


def _hardware(device: DeviceRow) -> tuple[str, str, int]:
    return device.renderer.partition("(")[0].strip(), device.processor, device.threads


def _rank(reason: Reason | None) -> int:
    """How near to fresh."""
    return len(Reason) if reason is None else list(Reason).index(reason)
