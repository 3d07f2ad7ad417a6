"""Why one technique is faster than another, from stage times and work counters."""

from __future__ import annotations

import math

from selector.ordering_results import Run

SMALL_PERCENT = 0.01
"""Under this, three digits behind the point are less than two that count."""

_WORK = {
    "map": (("map_texels_cleared", "texels cleared"), ("map_texels_written", "written")),
    "edges": (("cap_triangles", "cap triangles"), ("silhouette_edges", "silhouette edges")),
    "silhouette_pixels": (("silhouette_pixels", "silhouette pixels found"),),
    "computation_mask": (("volume_triangles", "volume triangles kept"),),
    "volumes": (("volume_fragments", "fragments"),),
}
"""The counters behind each stage."""


def why_faster(winner: Run, loser: Run) -> str:
    """What the winner saves, by the dearest stage of each and the work behind it."""
    stage, ms = _dearest(loser)
    other, other_ms = _dearest(winner)
    head = f"{winner.where}: {winner.name} takes {winner.ms:.2f} ms, {loser.name} {loser.ms:.2f}: "
    mine, theirs = _stage_words(loser, stage), _stage_words(winner, other)
    if ms > winner.ms:
        return f"{head}{mine} alone costs {loser.name} {ms:.2f} ms, more than all of {winner.name}."
    return f"{head}most of it is {mine}, {ms:.2f} ms, against {theirs}, {other_ms:.2f} ms."


def work_words(run: Run) -> str:
    """The work that grows with what is filled: texels, pixels, fragments."""
    texels = run.counter("map_texels_cleared") + run.counter("map_texels_written")
    found, fragments = run.counter("silhouette_pixels"), run.counter("volume_fragments")
    words = [
        f"{amount_words(count)} {what}"
        for count, what in ((texels, "texels"), (found, "silhouette pixels"), (fragments, "fragments"))
        if count
    ]
    return ", ".join(words) or "no work counted"


def share_words(share: float) -> str:
    """`1.822 %`, with two digits that count where it is tiny: only nothing is `0 %`."""
    percent = 100 * share
    if not 0 < percent < SMALL_PERCENT:
        return f"{percent:.3f} %" if percent else "0 %"
    return f"{percent:.{1 - math.floor(math.log10(percent))}f} %"


def amount_words(count: int) -> str:
    """Such as `12.3 M`; the exact count is among the measurements."""
    return f"{count / 1e6:.3g} M" if count >= 1_000_000 else f"{count:,}"


def _dearest(run: Run) -> tuple[str, float]:
    """The stage that takes longest, and its milliseconds; surfaces and shading are everybody's."""
    names = {name for sample in run.samples for name in sample.stages_ms} - {"surfaces", "shading"}
    times = {name: run.stage_ms(name) for name in sorted(names)}
    dearest = max(times, key=lambda name: times[name])
    return dearest, times[dearest]


def _stage_words(run: Run, stage: str) -> str:
    work = [
        f"{amount_words(run.counter(name))} {what}"
        for name, what in _WORK.get(stage, ())
        if run.counter(name)
    ]
    plain = stage.replace("_", " ")
    return f"its stage {plain} ({', '.join(work)})" if work else f"its stage {plain}"
