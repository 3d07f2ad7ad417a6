"""The thesis' orderings O8 and O10 to O12: what each technique gets wrong (sections 7.2, 7.3 and 8.1)."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

from scenes.thesis.set_ups import SetUp, set_ups
from selector.ordering_contenders import CROW, SV, chan, psm, sm, sm_fit
from selector.ordering_reasons import share_words
from selector.ordering_records import Evidence, Finding, settled
from selector.ordering_results import CLEARLY, Results, UnmeasuredError, less
from selector.ordering_trials import Contender, Trial
from selector.ordering_warps import RIGHT

JAGGED_PX = 1.0
"""95th percentile of an edge's displacement from which on its steps can be seen."""
EXACT = 1e-3
"""Share of wrong pixels that rounding leaves along edges."""
STEADY = 1e-4
"""Share of pixels whose error may change between frames of a technique that does not flicker."""

TOWERS: tuple[SetUp, ...] = tuple(one for one in set_ups() if one.figure in ("52", "53"))
(BRACES,) = (one for one in set_ups() if one.figure == "56")
(TREE,) = (one for one in set_ups() if one.figure == "57")
MOVES = Trial(RIGHT, moving=True), Trial("Street", moving=True)


def texels_and_cones(results: Results) -> Finding:
    """Judge O8."""
    sizes = TOWERS[0].map_sizes
    rows = [[results.run(Trial(set_up.name), sm(size)) for size in sizes] for set_up in TOWERS]
    errors = [[run.error("edge_error_px") for run in row] for row in rows]
    evidence = [
        Evidence(
            set_up.name,
            ", ".join(f"{size} {error:.2f} px" for size, error in zip(sizes, row, strict=True)),
        )
        for set_up, row in zip(TOWERS, errors, strict=True)
    ]
    jagged = rows[-1][-1].error("edge_error_p95_px")
    evidence.append(Evidence(TOWERS[-1].name, f"at {sizes[-1]} 95 % of the edge within {jagged:.1f} px"))
    faults = [
        f"{set_up.name}: no smaller at {size} than at half of that, {there:.2f} px."
        for set_up, row in zip(TOWERS, errors, strict=True)
        for (here, there), size in zip(pairwise(row), sizes[1:], strict=True)
        if not less(there, here)
    ]
    faults += [
        f"{wider.name}: no larger at {size} than in {narrower.name}."
        for (narrower, row), (wider, wide_row) in pairwise(zip(TOWERS, errors, strict=True))
        for size, here, there in zip(sizes, row, wide_row, strict=True)
        if not less(here, there)
    ]
    if jagged <= JAGGED_PX:
        faults.append(f"{TOWERS[-1].name}: at {sizes[-1]} the edge is not jagged any more.")
    return settled(evidence, faults)


def thin_objects(results: Results) -> Finding:
    """Judge O10."""
    runs = [results.run(Trial(BRACES.name), chan(size)) for size in BRACES.map_sizes]
    lit = [run.error("false_lit") for run in runs]
    words = [
        f"{run.name}: {share_words(share)} falsely lit, "
        f"{run.counter('silhouette_pixels'):,} silhouette pixels"
        for run, share in zip(runs, lit, strict=True)
    ]
    faults = [
        f"{large.name}: {share_words(there)} falsely lit, no less than {small.name}."
        for (small, here), (large, there) in pairwise(zip(runs, lit, strict=True))
        if not less(there, here)
    ]
    if lit[0] <= EXACT:
        faults.append(f"{runs[0].name}: {share_words(lit[0])} falsely lit is nothing dropped.")
    return settled([Evidence(BRACES.name, "; ".join(words))], faults)


def open_geometry(results: Results) -> Finding:
    """Judge O11."""
    where = Trial(TREE.name)
    maps = [(results.run(where, kind(1024)), results.run(where, kind(2048))) for kind in (sm, psm)]
    general, crow, hybrid = (results.run(where, one) for one in (SV, CROW, chan()))
    doubt = results.trials[where].measurement.verified_wrong_share
    if doubt is None:
        raise UnmeasuredError(f"{where.set_up}: the truth was not checked.")
    # Where volumes are too slow to be the truth, they are compared with rays like everything else.
    worst = max(doubt, general.error("wrong_share"))
    shares = [(run.name, run.error("wrong_share")) for pair in maps for run in pair]
    shares += [("Crow's SV", crow.error("wrong_share")), ("general SV against ray casting", worst)]
    shares.append(("Chan on general volumes", hybrid.error("wrong_share")))
    words = ", ".join(f"{name} {share_words(share)}" for name, share in shares)
    faults = [
        f"{large.name}: what is wrong is not for want of texels, "
        f"{share_words(large.error('wrong_share'))} after {share_words(small.error('wrong_share'))}."
        for small, large in maps
        if not less(large.error("wrong_share"), small.error("wrong_share"), CLEARLY)
    ]
    worst_map = max(small.error("wrong_share") for small, _ in maps)
    if not less(worst_map, crow.error("wrong_share"), CLEARLY):
        faults.append("Crow's SV is not clearly worse than the maps.")
    faults += [f"{name} is wrong: {share_words(share)}." for name, share in shares[-2:] if share > EXACT]
    found = settled([Evidence(where.set_up, f"wrong pixels: {words}")], faults)
    return replace(found, reason=f"Of Crow's: {crow.view.note}.") if found.holds and crow.view.note else found


def flickering(trial: Trial) -> tuple[Contender, ...]:
    """What O12 needs of a trial: PSM, a fitted SM, and those that should not flicker."""
    size = next(one for one in set_ups() if one.name == trial.set_up).map_sizes[0]
    return psm(size), sm_fit(size), sm(size), SV, chan(size)


def flicker(results: Results) -> Finding:
    """Judge O12."""
    evidence, faults, notes = [], [], []
    for trial in MOVES:
        warped, fitted, *others = (results.run(trial, one) for one in flickering(trial))
        words = [f"{run.name} {share_words(run.error('flicker'))}" for run in (warped, *others, fitted)]
        evidence.append(Evidence(trial.set_up, ", ".join(words)))
        faults += [
            f"{trial.set_up}: {run.name} flickers as well." for run in others if run.error("flicker") > STEADY
        ]
        if warped.error("flicker") <= STEADY:
            faults.append(f"{trial.set_up}: PSM does not flicker.")
        if fitted.error("flicker") > STEADY:
            notes.append(trial.set_up)
    fits = [f"An SM that is fitted to the view flickers as well ({', '.join(notes)})."] if notes else []
    return Finding(not faults, tuple(evidence), " ".join([*faults, *fits]))
