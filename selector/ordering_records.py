"""What an ordering of the thesis is: a sentence, what it needs to have measured, and how it is judged."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from selector.ordering_results import Results, UnmeasuredError
from selector.ordering_trials import Ask


@dataclass(frozen=True)
class Evidence:
    """Figures of one place that an ordering was judged by, in words."""

    where: str
    words: str


@dataclass(frozen=True)
class Finding:
    """Whether an ordering holds on a device.

    Attributes:
        holds: None where it cannot be said.
        evidence: The figures behind it.
        reason: Why it does not hold, or cannot be said; what else is worth knowing where it holds.
    """

    holds: bool | None
    evidence: tuple[Evidence, ...] = ()
    reason: str = ""


def settled(evidence: Iterable[Evidence], faults: Iterable[str]) -> Finding:
    """A finding that holds where nothing is at fault; what is at fault is the reason."""
    reasons = tuple(faults)
    return Finding(not reasons, tuple(evidence), " ".join(reasons))


@dataclass(frozen=True)
class Ordering:
    """One statement of the thesis about which technique is faster, or more exact.

    Attributes:
        id: `O1` to `O12`.
        sentence: The statement.
        rule: When it is said to hold, with the margin that is used.
        asks: What has to be measured.
        judge: The rule itself.
    """

    id: str
    sentence: str
    rule: str
    asks: tuple[Ask, ...]
    judge: Callable[[Results], Finding]

    def finding(self, results: Results) -> Finding:
        """Whether it holds by these results; it cannot be said where one that it needs is missing."""
        try:
            return self.judge(results)
        except UnmeasuredError as missing:
            return Finding(None, reason=str(missing))
