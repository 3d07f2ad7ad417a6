"""The thesis' ordering O9: the perspective shadow map against the ordinary one (section 7.2.2)."""

from __future__ import annotations

from dataclasses import replace

from scenes.thesis.set_ups import set_ups
from selector.measurement import Status
from selector.ordering_contenders import psm, psm_unclipped, psm_unslid, sm, sm_fit
from selector.ordering_reasons import amount_words, share_words
from selector.ordering_records import Evidence, Finding, settled
from selector.ordering_results import ABOUT_EQUAL, CLEARLY, Halves, Results, Run, UnmeasuredError, less
from selector.ordering_trials import Contender, Trial

GOOD_PX = 1.0
"""Mean displacement of an edge up to which a shadow is nearly perfect."""

RIGHT, FRONT, BEHIND, CLOSER = (one.name for one in set_ups() if one.figure in ("54", "55"))
SIZE = 512
SM_ROCKS, FIT_ROCKS, WARP, UNSLID, UNCLIPPED = (
    replace(one(SIZE), name=one(SIZE).name.split()[0]) for one in (sm, sm_fit, psm, psm_unslid, psm_unclipped)
)
WARPS = WARP, UNSLID


def warp_quality(results: Results) -> Finding:
    """Judge O9."""
    names = (RIGHT, FRONT, BEHIND, CLOSER)
    evidence = [Evidence(name, _rocks_words(results, name)) for name in names]
    faults = {warp.name: _warp_faults(results, warp) for warp in WARPS}
    kept = [name for name, reasons in faults.items() if not reasons]
    if kept:
        return Finding(holds=True, evidence=tuple(evidence), reason=f"With {' and '.join(kept)}.")
    common = [f"{name}: {' '.join(reasons)}" for name, reasons in faults.items()]
    return settled(evidence, [*common, *_unclipped(results)])


def _rocks_words(results: Results, name: str) -> str:
    runs = [results.run(Trial(name), one) for one in (SM_ROCKS, FIT_ROCKS, *WARPS)]
    return "; ".join(
        f"{run.name} {run.error('edge_error_px'):.2f} px (near {share_words(_halves(run).near)}, "
        f"far {share_words(_halves(run).far)})"
        for run in runs
    )


def _warp_faults(results: Results, warp: Contender) -> list[str]:
    faults = []
    ordinary, warped = (_halves(results.run(Trial(RIGHT), one)) for one in (SM_ROCKS, warp))
    if not less(warped.near, ordinary.near):
        faults.append("Light right: not better near.")
    if not less(ordinary.far, warped.far):
        faults.append("Light right: not worse far.")
    before, after = _errors(results, FRONT, warp)
    if less(before, after, ABOUT_EQUAL) or less(after, before, ABOUT_EQUAL):
        fitted = results.run(Trial(FRONT), FIT_ROCKS).error("edge_error_px")
        faults.append(
            f"Light in front: not equal, {before:.2f} px to {after:.2f}; a fit alone brings {fitted:.2f}."
        )
    faults += [
        f"Light behind: {error:.2f} px is not nearly perfect."
        for error in _errors(results, BEHIND, warp)
        if error > GOOD_PX
    ]
    before, after = _errors(results, CLOSER, warp)
    if not less(before, after, CLEARLY):
        written = [results.run(Trial(CLOSER), one).counter("map_texels_written") for one in (SM_ROCKS, warp)]
        faults.append(
            f"Light closer: not clearly worse, {before:.2f} px to {after:.2f}; what stands there is drawn "
            f"with {amount_words(written[1])} texels, by SM with {amount_words(written[0])}."
        )
    return faults


def _unclipped(results: Results) -> list[str]:
    """What the thesis' worst case is without a fit to the receivers."""
    head = (
        f"{CLOSER}: without a fit to the receivers, which are cut out more closely here than in the thesis, "
    )
    try:
        before, after = _errors(results, CLOSER, UNCLIPPED)
    except UnmeasuredError:
        found = results.measurement(Trial(CLOSER), UNCLIPPED)
        if found is None or found.status is not Status.REFUSED:
            raise
        return [f"{head}there is no warp at all: {found.reason}."]
    return [f"{head}it would be {before:.2f} px to {after:.2f}."]


def _errors(results: Results, name: str, warp: Contender) -> tuple[float, float]:
    ordinary, warped = (results.run(Trial(name), one) for one in (SM_ROCKS, warp))
    return ordinary.error("edge_error_px"), warped.error("edge_error_px")


def _halves(run: Run) -> Halves:
    if run.halves is None:
        raise UnmeasuredError(f"{run.where}: no receiver is in view.")
    return run.halves
