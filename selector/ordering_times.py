"""The thesis' orderings O1 to O3: maps against each other, and against volumes (section 7.1)."""

from __future__ import annotations

from renderers.clock import ClockKind
from selector.ordering_contenders import SV
from selector.ordering_reasons import amount_words, why_faster
from selector.ordering_records import Evidence, Finding, settled
from selector.ordering_results import Order, Results, Run, compared, faster, less
from selector.ordering_timed import (
    CHAN,
    ONLY_TIMES,
    PSM,
    SM,
    SM_FIT,
    only_in,
    runs_of,
    texels_of,
    times_words,
    work_of_all,
)


def map_fastest(results: Results) -> Finding:
    """Judge O1."""
    maps = runs_of(results, SM)
    rivals = [runs_of(results, contender) for contender in (PSM, SV, CHAN)]
    places = list(zip(maps, *rivals, strict=True))
    if not results.timed:
        evidence = [Evidence(map_run.where, work_of_all(map_run, *others)) for map_run, *others in places]
        return Finding(None, tuple(evidence), ONLY_TIMES)
    evidence = [Evidence(runs[0].where, times_words(*runs)) for runs in places]
    faults = []
    for map_run, *others in places:
        winners = [other for other in others if faster(other, map_run)]
        if winners:
            faults.append(why_faster(min(winners, key=lambda run: run.ms), map_run))
    return settled(evidence, faults)


def set_up_only(results: Results) -> Finding:
    """Judge O2."""
    evidence, faults = [], []
    for ordinary, fitted, warped in zip(*(runs_of(results, one) for one in (SM, SM_FIT, PSM)), strict=True):
        texels = [f"{run.name} {amount_words(texels_of(run))} texels" for run in (ordinary, fitted, warped)]
        if not results.timed:
            evidence.append(Evidence(ordinary.where, ", ".join(texels)))
            continue
        stages = [
            f"{run.name} {run.ms:.2f} ms (map {run.stage_ms('map'):.2f}, visibility "
            f"{run.stage_ms('visibility'):.2f}; {amount_words(texels_of(run))} texels)"
            for run in (ordinary, fitted, warped)
        ]
        evidence.append(Evidence(ordinary.where, ", ".join(stages)))
        faults += _set_up_faults(ordinary, warped)
    if not results.timed:
        return Finding(None, tuple(evidence), ONLY_TIMES)
    if faults and _clock(results) is ClockKind.QUERY:
        faults.append("Timer queries do not see the set-up, which the processor does.")
    return settled(evidence, faults)


def _set_up_faults(ordinary: Run, warped: Run) -> list[str]:
    order = compared(ordinary.times_ms, warped.times_ms)
    if order is Order.TIE:
        return [f"{warped.where}: both take the same time."]
    if order is Order.MORE:
        return [why_faster(warped, ordinary)]
    dearer = []
    if compared(ordinary.stage_times_ms("visibility"), warped.stage_times_ms("visibility")) is Order.LESS:
        dearer.append("comparing pixels with the map is dearer as well")
    if less(texels_of(ordinary), texels_of(warped)):
        dearer.append(f"its map has {texels_of(warped) / texels_of(ordinary):.2f} times the texels to fill")
    return [f"{warped.where}: not by set-up alone, for {' and '.join(dearer)}."] if dearer else []


def volumes_beat_psm(results: Results) -> Finding:
    """Judge O3."""
    places = list(zip(runs_of(results, SV), runs_of(results, PSM), strict=True))
    if not results.timed:
        evidence = [Evidence(volume.where, work_of_all(volume, warped)) for volume, warped in places]
        return Finding(None, tuple(evidence), ONLY_TIMES)
    evidence = [Evidence(volume.where, times_words(volume, warped)) for volume, warped in places]
    return settled(evidence, only_in("Street", places))


def _clock(results: Results) -> ClockKind:
    return next(iter(results.trials.values())).measurement.clock
