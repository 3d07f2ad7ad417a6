"""Which instances are measured again: a sample in which every family and every technique has its share."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Collection, Mapping

from selector.evidence.rows import digest_of
from selector.rebenchmark.drift import FEWEST


def sample(
    techniques: Mapping[str, Collection[str]], families: Mapping[str, str], size: int, seed: int
) -> tuple[str, ...]:
    """Keys of instances, in the order in which they are measured; the same for the same seed.

    Families take turns, in an order that the seed shuffles, as do the instances of each; so wherever a job is
    stopped, families have had the same number, give or take one. More than `size` are taken only where a
    technique would have fewer instances than a test for drift needs.

    Args:
        techniques: Instance's key -> ids of the techniques that were timed on it.
        families: Instance's key -> its family.
        size: How many.
        seed: Another seed gives another sample.
    """
    order = _in_turns(techniques, families, seed)
    chosen, others = order[:size], order[size:]
    covered = Counter(name for key in chosen for name in techniques[key])
    total = Counter(name for key in order for name in techniques[key])
    for key in others:
        lacking = [name for name in techniques[key] if covered[name] < min(FEWEST, total[name])]
        if size >= FEWEST and lacking:
            chosen.append(key)
            covered.update(techniques[key])
    return tuple(chosen)


def _in_turns(instances: Collection[str], families: Mapping[str, str], seed: int) -> list[str]:
    by_family: dict[str, list[str]] = defaultdict(list)
    for key in sorted(instances, key=lambda one: digest_of(seed, one)):
        by_family[families[key]].append(key)
    turns = sorted(by_family, key=lambda name: digest_of(seed, name))
    order = []
    for turn in range(max(map(len, by_family.values()), default=0)):
        order += [by_family[name][turn] for name in turns if turn < len(by_family[name])]
    return order
