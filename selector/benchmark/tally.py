"""Who wins, instance by instance, while a benchmark runs and when it is done."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field
from statistics import median

from scenes.scene import Mobility
from selector.benchmark.ranking import stability, winning_share
from selector.evidence.rows import Judgement, Timing
from selector.measurement import Status
from selector.policy import POLICIES, Policy
from selector.recommendation import SHORT_EDGE_PX

Figures = Mapping[str, float | None]


def exceedance_px(figures: Figures) -> float:
    """What a limit is compared with: the edge's displacement, or its stand-in where little edge is seen."""
    edge_error_px = figures.get("edge_error_px")
    if edge_error_px is not None:
        return edge_error_px
    return (figures.get("wrong_share") or 0.0) * (figures.get("pixels") or 0.0) / SHORT_EDGE_PX


@dataclass(frozen=True)
class Winner:
    """Who is best for one instance.

    Attributes:
        technique: Its id.
        share: In how many bootstrap resamples of the rounds it is; None where nobody looked.
    """

    technique: str
    share: float | None = None


@dataclass
class _Sheet:
    """What is known of one instance."""

    errors: dict[str, float] = field(default_factory=dict)
    samples: dict[str, dict[Mobility, list[float]]] = field(default_factory=dict)
    winners: dict[tuple[Mobility, str], Winner] = field(default_factory=dict)
    tau: float | None = None


class Tally:
    """Counts winners.

    Attributes:
        techniques: Candidate's key -> id of its technique, for every candidate that is taken in.
    """

    def __init__(self) -> None:
        self.techniques: dict[str, str] = {}
        self._sheets: dict[str, _Sheet] = defaultdict(_Sheet)

    def judge(self, row: Judgement) -> None:
        """Take in how wrong a candidate is."""
        if row.status is Status.OK:
            self._sheets[row.asked.instance].errors[row.asked.candidate] = exceedance_px(row.figures)

    def time(self, row: Timing) -> None:
        """Take in how long a candidate takes."""
        if row.status is not Status.OK:
            return
        by_mobility: dict[Mobility, list[float]] = defaultdict(list)
        for one in row.samples:
            by_mobility[one.mobility].append(one.shadow_ms / one.canary_ms)
        self._sheets[row.asked.instance].samples[row.asked.candidate] = by_mobility

    def close(self, instance: str, *, surely: bool) -> None:
        """Say who wins for an instance of which all is in; and how surely, which takes some 20 ms."""
        sheet = self._sheets[instance]
        for mobility in Mobility:
            for policy in POLICIES:
                winner = self._winner(sheet, mobility, policy, surely=surely)
                if winner is not None:
                    sheet.winners[mobility, policy.name] = winner
        if surely:
            sheet.tau = stability([one[Mobility.DYNAMIC] for one in sheet.samples.values()])

    def wins(self, mobility: Mobility, policy: str) -> Counter[str]:
        """Technique -> for how many instances it is best."""
        found = (sheet.winners.get((mobility, policy)) for sheet in self._sheets.values())
        return Counter(winner.technique for winner in found if winner)

    def good_enough(self, policy: Policy) -> Counter[str]:
        """Technique -> for how many instances one of its candidates keeps the policy's error."""
        counts: Counter[str] = Counter()
        for sheet in self._sheets.values():
            counts.update(
                {self.techniques[key] for key, px in sheet.errors.items() if px <= policy.max_edge_error_px}
            )
        return counts

    @property
    def judged(self) -> int:
        """Instances of which an error is known."""
        return sum(bool(sheet.errors) for sheet in self._sheets.values())

    def sureness(self, mobility: Mobility, policy: str) -> float | None:
        """Median over instances of the share of resamples in which the winner still wins."""
        found = (sheet.winners.get((mobility, policy)) for sheet in self._sheets.values())
        shares = [winner.share for winner in found if winner and winner.share is not None]
        return median(shares) if shares else None

    def tau(self) -> float | None:
        """Median over instances of Kendall's tau between the rankings by even and by odd rounds."""
        taus = [sheet.tau for sheet in self._sheets.values() if sheet.tau is not None]
        return median(taus) if taus else None

    def _winner(self, sheet: _Sheet, mobility: Mobility, policy: Policy, *, surely: bool) -> Winner | None:
        timed = {
            key: one[mobility] for key, one in sheet.samples.items() if one[mobility] and key in sheet.errors
        }
        if not timed:
            return None
        good = {key: one for key, one in timed.items() if sheet.errors[key] <= policy.max_edge_error_px}
        if not good:
            # Nobody keeps the limit: then who misses it least is best, as in the choice for a level.
            return Winner(
                self.techniques[min(timed, key=lambda key: (sheet.errors[key], median(timed[key])))]
            )
        if not surely:
            return Winner(self.techniques[min(good, key=lambda key: median(good[key]))])
        found = winning_share(good)
        assert found is not None
        return Winner(self.techniques[found[0]], found[1])
