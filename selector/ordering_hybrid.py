"""The thesis' orderings O4 to O7: the hybrid against shadow volumes, and how costs grow (section 7.1)."""

from __future__ import annotations

from collections.abc import Iterator
from statistics import median

from selector.ordering_contenders import SV
from selector.ordering_reasons import amount_words
from selector.ordering_records import Evidence, Finding, settled
from selector.ordering_results import ABOUT_EQUAL, Order, Results, Run, compared, faster, less
from selector.ordering_timed import (
    CHAN,
    ONLY_TIMES,
    PSM,
    SM,
    TIMED,
    fragments_of,
    only_in,
    runs_of,
    texels_of,
    times_words,
    trial,
    work_of_all,
)

VOLUME_STAGES = "edges", "computation_mask", "volumes"
MAP_STAGES = "map", "silhouette_pixels"
COMPLEX = "Box grid", "Water tower"
"""The scenes in which volumes overlap much."""


def hybrid_beats_volumes(results: Results) -> Finding:
    """Judge O4."""
    places = list(zip(runs_of(results, CHAN), runs_of(results, SV), strict=True))
    if results.timed:
        evidence = [Evidence(hybrid.where, times_words(hybrid, volume)) for hybrid, volume in places]
        return settled(evidence, only_in("Box grid", places))
    evidence = [_fragments_evidence(hybrid, volume) for hybrid, volume in places]
    hybrid, volume = places[0]
    if fragments_of(hybrid) >= fragments_of(volume):
        fault = f"{hybrid.where}: by counters alone: Chan draws as many fragments, and a map besides."
        return settled(evidence, [fault])
    return Finding(None, tuple(evidence), ONLY_TIMES)


def hybrid_volume_stage(results: Results) -> Finding:
    """Judge O5."""
    evidence, faults = [], []
    for hybrid, volume in zip(runs_of(results, CHAN), runs_of(results, SV), strict=True):
        evidence.append(_fragments_evidence(hybrid, volume))
        saves, about_equal, what = _volume_stages(hybrid, volume, timed=results.timed)
        if hybrid.where in COMPLEX and not saves:
            faults.append(f"{hybrid.where}: Chan's volumes do not cost less: {what}.")
        elif hybrid.where not in COMPLEX and not about_equal:
            faults.append(f"{hybrid.where}: not about equal: {what}.")
    if not results.timed:
        faults = [f"{fault[:-1]}, by counters alone." for fault in faults]
    return settled(evidence, faults)


def _volume_stages(hybrid: Run, volume: Run, *, timed: bool) -> tuple[bool, bool, str]:
    """Whether Chan's volumes cost less, whether they cost about as much, and the figures."""
    if timed:
        mine, theirs = hybrid.stage_times_ms(*VOLUME_STAGES), volume.stage_times_ms(*VOLUME_STAGES)
        ratio = median(one / other for one, other in zip(mine, theirs, strict=True))
        what = f"{median(mine):.2f} ms against {median(theirs):.2f}"
    else:
        mine, theirs = (float(fragments_of(hybrid)),), (float(fragments_of(volume)),)
        ratio = mine[0] / max(theirs[0], 1.0)
        what = f"{amount_words(fragments_of(hybrid))} fragments against {amount_words(fragments_of(volume))}"
    order = compared(mine, theirs)
    return order is Order.LESS, order is not Order.MORE and ratio * ABOUT_EQUAL >= 1, what


def hybrid_loss(results: Results) -> Finding:
    """Judge O6."""
    evidence, faults, losses = [], [], 0
    for hybrid, volume in zip(runs_of(results, CHAN), runs_of(results, SV), strict=True):
        if not results.timed:
            evidence.append(Evidence(hybrid.where, work_of_all(hybrid, volume)))
            continue
        extra = hybrid.stage_times_ms(*MAP_STAGES)
        rest = tuple(whole - part for whole, part in zip(hybrid.times_ms, extra, strict=True))
        lost = faster(volume, hybrid)
        losses += lost
        evidence.append(
            Evidence(
                hybrid.where,
                f"{times_words(hybrid, volume)}; of Chan map {hybrid.stage_ms('map'):.2f}, silhouette "
                f"pixels {hybrid.stage_ms('silhouette_pixels'):.2f}, the rest {median(rest):.2f} ms",
            )
        )
        if lost and compared(volume.times_ms, rest) is Order.LESS:
            faults.append(
                f"{hybrid.where}: without them Chan still takes {median(rest):.2f} ms, SV {volume.ms:.2f}."
            )
    if not results.timed:
        return Finding(None, tuple(evidence), ONLY_TIMES)
    if not losses:
        return Finding(None, tuple(evidence), "Chan is slower than SV nowhere: there is no loss to explain.")
    return settled(evidence, faults)


def growth(results: Results) -> Finding:
    """Judge O7."""
    evidence, faults = [], []
    for set_up in TIMED:
        small, large = trial(set_up, halved=True), trial(set_up)
        pairs = [(results.run(small, one), results.run(large, one)) for one in (SV, CHAN, SM, PSM)]
        evidence.append(Evidence(set_up.name, _growth_words(pairs, timed=results.timed)))
        faults += [f"{set_up.name}: {fault}" for fault in _growth_faults(pairs)]
    return settled(evidence, faults)


def _growth_words(pairs: list[tuple[Run, Run]], *, timed: bool) -> str:
    volumes, maps = pairs[:2], pairs[2:]
    words = [
        f"{what} {', '.join(_from_to(small.name, amount(small), amount(large)) for small, large in some)}"
        for what, some, amount in (("fragments", volumes, fragments_of), ("texels", maps, texels_of))
    ]
    if timed:
        times = [f"{small.name} {small.ms:.2f} to {large.ms:.2f}" for small, large in pairs]
        drawn = [f"{small.stage_ms('map'):.2f} to {large.stage_ms('map'):.2f}" for small, large in maps]
        words.append(f"ms {', '.join(times)}, their maps {' and '.join(drawn)}")
    return "; ".join(words)


def _growth_faults(pairs: list[tuple[Run, Run]]) -> Iterator[str]:
    (few, volume), (fewer, hybrid), *maps = pairs
    by_volume, by_hybrid = (
        fragments_of(volume) - fragments_of(few),
        fragments_of(hybrid) - fragments_of(fewer),
    )
    if not less(fragments_of(few), fragments_of(volume)):
        yield "SV's fragments do not grow."
    if not less(by_hybrid, by_volume):
        yield f"Chan's fragments grow by {amount_words(by_hybrid)}, SV's by {amount_words(by_volume)}."
    for small, large in maps:
        if less(texels_of(small), texels_of(large)):
            yield f"texels {_from_to(large.name, texels_of(small), texels_of(large))}."


def _from_to(name: str, small: int, large: int) -> str:
    return f"{name} {amount_words(small)} to {amount_words(large)}"


def _fragments_evidence(hybrid: Run, volume: Run) -> Evidence:
    mine, theirs = fragments_of(hybrid), fragments_of(volume)
    share = 100 * mine / max(theirs, 1)
    words = f"Chan {amount_words(mine)} of SV's {amount_words(theirs)} volume fragments, {share:.0f} %"
    if hybrid.samples and volume.samples:
        mine_ms, theirs_ms = hybrid.stage_ms(*VOLUME_STAGES), volume.stage_ms(*VOLUME_STAGES)
        words += f"; stages {mine_ms:.2f} against {theirs_ms:.2f} ms"
    return Evidence(hybrid.where, words)
