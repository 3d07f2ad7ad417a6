"""What is good enough, and what a choice costs: the measure by which selectors are trained and judged."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from scenes.errors import GnomonError
from scenes.scene import Array

MISS = 10.0
"""Cost of a candidate that misses the policy, is refused or fails (the field's PAR10 in spirit)."""


class UnknownPolicyError(GnomonError):
    """No policy has this name."""

    exit_code = 2


@dataclass(frozen=True)
class Policy:
    """What a candidate has to keep; among those that do, the fastest is best.

    Attributes:
        name: How people call it.
        max_edge_error_px: How far a shadow's edge may be off.
        max_shadow_ms: How long it may take; `inf` for no limit.
        max_memory_bytes: How much it may hold on the device; `inf` for no limit.
    """

    name: str
    max_edge_error_px: float
    max_shadow_ms: float = float("inf")
    max_memory_bytes: float = float("inf")

    def exceedances(self, shadow_ms: Array, edge_error_px: Array, memory_bytes: Array | None = None) -> Array:
        """(n, k) float64: by how much each candidate misses, relative to the limits; 0 where it keeps all.

        The largest of error, time and memory over their limits, minus 1; where a limit is 0, the value
        itself. A value that is not known (nan) is taken as missing beyond measure.
        """
        pairs = [(shadow_ms, self.max_shadow_ms), (edge_error_px, self.max_edge_error_px)]
        if memory_bytes is not None:
            pairs.append((memory_bytes, self.max_memory_bytes))
        over = [_over(np.asarray(values, np.float64), limit) for values, limit in pairs]
        found: Array = np.maximum.reduce(over)
        return found

    def costs(
        self,
        shadow_ms: Array,
        edge_error_px: Array,
        ok: npt.NDArray[np.bool_],
        memory_bytes: Array | None = None,
    ) -> Array:
        """(n, k) float64 cost of choosing each of k candidates for each of n instances; relative, at least 1.

        Args:
            shadow_ms: (n, k) time; nan where unknown.
            edge_error_px: (n, k) error; nan where unknown.
            ok: (n, k) whether the candidate was neither refused nor failed.
            memory_bytes: (n, k) what it holds; not asked where None.

        A candidate that keeps the policy costs its time over that of the fastest that keeps it; any other
        costs 10. Where none keeps it, the least exceedance costs 1, and among equals time decides as
        before. Where nothing is ok, all cost 10.
        """
        known = ok & np.isfinite(shadow_ms) & np.isfinite(edge_error_px)
        exceedance = np.where(known, self.exceedances(shadow_ms, edge_error_px, memory_bytes), np.inf)
        least = exceedance.min(axis=1, keepdims=True, initial=np.inf)
        best = known & (exceedance <= least)
        times = np.where(best, shadow_ms, np.inf)
        fastest = times.min(axis=1, keepdims=True, initial=np.inf)
        found: Array = np.full(times.shape, MISS)
        # A candidate that takes no time is as fast as the fastest, and infinitely faster than any that does.
        np.divide(times, fastest, out=found, where=best & (fastest > 0))
        found[best & (times == fastest)] = 1.0
        return found


POLICIES: tuple[Policy, ...] = (Policy("speed", 4.0), Policy("balanced", 1.5), Policy("quality", 0.5))
DEFAULT_POLICY = "balanced"
CUSTOM = "custom"
"""Name of a policy whose limit was given as a number."""


def policy(name: str, max_edge_error_px: float | None = None) -> Policy:
    """The policy of this name; a custom one where another limit is given.

    Raises:
        UnknownPolicyError: There is none; the message lists those there are.
    """
    for known in POLICIES:
        if known.name == name.lower():
            return known if max_edge_error_px is None else Policy(CUSTOM, max_edge_error_px)
    names = ", ".join(one.name for one in POLICIES)
    raise UnknownPolicyError(f'There is no policy "{name}".', known=f"Known: {names}.")


def _over(values: Array, limit: float) -> Array:
    """(n, k) share by which values exceed a limit; `inf` where they are not known."""
    if np.isinf(limit):
        return np.where(np.isnan(values), np.inf, 0.0)
    over = values / limit - 1 if limit > 0 else values
    found: Array = np.where(np.isnan(values), np.inf, np.maximum(over, 0.0))
    return found
