"""What the timing orderings share: the five scenes of figure 46, and the runs in them."""

from __future__ import annotations

from dataclasses import replace

from scenes.thesis.set_ups import SetUp, set_ups
from selector.ordering_contenders import chan, psm, sm, sm_fit
from selector.ordering_reasons import why_faster, work_words
from selector.ordering_results import Results, Run, faster
from selector.ordering_trials import Ask, Contender, Trial

# All maps have the size of the thesis' timings, so names go without it.
SM, SM_FIT, PSM, CHAN = (replace(one, name=one.name.split()[0]) for one in (sm(), sm_fit(), psm(), chan()))
TIMED: tuple[SetUp, ...] = tuple(one for one in set_ups() if one.figure.startswith("46"))
ONLY_TIMES = "Only times can say this: counters of different kinds of work have no common unit."


def trial(set_up: SetUp, *, halved: bool = False) -> Trial:
    """A set-up of figure 46 as it is timed."""
    return Trial(set_up.name, timed=True, halved=halved)


def asks(*contenders: Contender) -> tuple[Ask, ...]:
    """The same contenders in all five scenes."""
    return tuple(Ask(trial(set_up), contenders) for set_up in TIMED)


def runs_of(results: Results, contender: Contender) -> list[Run]:
    """One contender in all five scenes."""
    return [results.run(trial(set_up), contender) for set_up in TIMED]


def times_words(*runs: Run) -> str:
    """Names and medians."""
    return ", ".join(f"{run.name} {run.ms:.2f} ms" for run in runs)


def only_in(where: str, places: list[tuple[Run, Run]]) -> list[str]:
    """What is wrong with the first being faster than the second in one scene and in no other."""
    faults = []
    for first, second in places:
        if (first.where == where) is faster(first, second):
            continue
        if first.where != where:
            faults.append(why_faster(first, second))
        elif faster(second, first):
            faults.append(why_faster(second, first))
        else:
            faults.append(f"{where}: both take the same time.")
    return faults


def work_of_all(*runs: Run) -> str:
    """All that was counted of each."""
    return "; ".join(f"{run.name}: {work_words(run)}" for run in runs)


def texels_of(run: Run) -> int:
    """Texels of a map, cleared and written."""
    return run.counter("map_texels_cleared") + run.counter("map_texels_written")


def fragments_of(run: Run) -> int:
    """Fragments of the volumes, counted or not."""
    return run.counter("volume_fragments")
