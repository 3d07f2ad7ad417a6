"""Makes the parts of a comparison's page from what was measured of each light."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from api import comparison_words as words
from api.cli.terminal import printable
from api.comparison_labels import Point
from api.comparison_model import Card, LightPart, Row, Stage, ViewPart
from api.comparison_pictures import Layers, ViewPictures
from api.comparison_plot import Plot, plot
from api.verdicts import shows_shadow_edge
from renderers.registry import TECHNIQUES
from renderers.timing import SHADING, SURFACES
from scenes.scene import Mobility
from selector.candidate import Candidate
from selector.level_measuring import Answer
from selector.measurement import LightMeasurement, Measurement, Status, Truth, ViewRun
from selector.recommendation import Rated, Recommendation

FIGURES = {
    "edge_error_px": ("edge off", words.pixels),
    "wrong_share": ("wrong", words.percent),
    "acne_share": ("acne", words.percent),
    "leak_share": ("leak", words.percent),
    "flip": ("FLIP", words.difference),
    "flicker": ("flicker", words.percent),
}
"""Error figures by their names in a measurement: what a column is called, and how its numbers are said."""
OTHER_STAGES = SURFACES, SHADING
TRUTHS = {Truth.SHADOW_VOLUME: "shadow volumes", Truth.EMBREE: "ray casting (Embree)"}


class LightParts:
    """Makes the parts of a page, one light after the other; a stage has the same colour in all of them."""

    def __init__(self) -> None:
        self._colors: dict[str, int] = {}
        self._count = 0

    def part(self, answer: Answer, mobility: Mobility, pictures: Sequence[ViewPictures]) -> LightPart:
        """What the page says of the next light.

        Args:
            answer: What came out for it.
            mobility: Whether its times are those of a static or a dynamic light.
            pictures: Its views.
        """
        key = f"light-{self._count}"
        self._count += 1
        measurement, recommendation = answer.measurement, answer.recommendation
        rows = self._rows(key, measurement, recommendation, mobility) if measurement else ()
        shown = {stage.name for row in rows for stage in row.stages}
        return LightPart(
            key=key,
            name=printable(answer.light.name),
            facts=tuple(words.light_facts(answer.light)),
            mobility=str(mobility),
            problem=printable(answer.problem),
            recommendation=recommendation,
            confidence=_confidence(recommendation),
            chosen=next((row for row in rows if row.verdict == "chosen"), None),
            rows=rows,
            columns=_columns(rows),
            stage_colors={name: color for name, color in self._colors.items() if name in shown},
            shadowless=recommendation is not None and not shows_shadow_edge(recommendation),
            plot=_plot(rows, recommendation) if recommendation else None,
            views=_views(key, rows, measurement, mobility, pictures) if measurement else (),
            canary=_canary(measurement) if measurement else "",
            truth=_truth(measurement.measurements) if measurement else "",
        )

    def _rows(
        self,
        light_key: str,
        measurement: LightMeasurement,
        recommendation: Recommendation | None,
        mobility: Mobility,
    ) -> tuple[Row, ...]:
        longest = max((_stage_sum(one, mobility) for one in measurement.measurements), default=0.0)
        rated = {one.candidate: one for one in recommendation.rated} if recommendation else {}
        rows = []
        for index, one in enumerate(measurement.measurements):
            known = rated.get(one.candidate)
            rows.append(
                Row(
                    key=f"{light_key}-{index}",
                    label=one.candidate.label,
                    technique=_technique_index(one.candidate),
                    verdict=_verdict(known, recommendation),
                    over_limit=known.exceedance_px > recommendation.max_edge_error_px
                    if known and recommendation
                    else None,
                    failure=_failure(one),
                    dynamic=words.milliseconds(one.shadow_ms(Mobility.DYNAMIC)),
                    static=words.milliseconds(one.shadow_ms(Mobility.STATIC)),
                    frame=words.milliseconds(one.frame_ms(mobility)),
                    stages=self._stages(one, mobility, longest),
                    edge=words.edge_words(one, known),
                    figures=_figures(one),
                    memory=words.memory(one.memory_bytes),
                    counters=_counters(one.views),
                    notes=tuple(dict.fromkeys(printable(view.note) for view in one.views if view.note)),
                )
            )
        return tuple(rows)

    def _stages(self, one: Measurement, mobility: Mobility, longest: float) -> tuple[Stage, ...]:
        return tuple(
            Stage(
                name.replace("_", " "),
                self._colors.setdefault(name.replace("_", " "), len(self._colors)),
                words.milliseconds(time),
                100 * time / longest,
            )
            for name, time in _shadow_stages(one, mobility).items()
        )


def _technique_index(candidate: Candidate) -> int:
    """Place of its technique in the registry: that is its colour and shape on the page."""
    return [known.name for known in TECHNIQUES].index(candidate.technique)


def _shadow_stages(one: Measurement, mobility: Mobility) -> dict[str, float]:
    return {name: time for name, time in one.stages_ms(mobility).items() if name not in OTHER_STAGES}


def _stage_sum(one: Measurement, mobility: Mobility) -> float:
    return sum(_shadow_stages(one, mobility).values())


def _verdict(rated: Rated | None, recommendation: Recommendation | None) -> str:
    if rated is None or recommendation is None:
        return ""
    return (
        "chosen"
        if rated == recommendation.chosen
        else "runner-up"
        if rated == recommendation.runner_up
        else ""
    )


def _failure(one: Measurement) -> str:
    if one.status is Status.OK:
        return ""
    status = str(one.status).replace("_", " ")
    return f"{status}: {printable(one.reason)}" if one.reason else status


def _figures(one: Measurement) -> dict[str, str]:
    values = {title: (one.figure(name), said) for name, (title, said) in FIGURES.items()}
    return {title: said(value) for title, (value, said) in values.items()}


def _columns(rows: Sequence[Row]) -> tuple[str, ...]:
    titles = [title for name, (title, _) in FIGURES.items() if name != "edge_error_px"]
    return tuple(title for title in titles if any(row.figures[title] != words.NOTHING for row in rows))


def _counters(views: Sequence[ViewRun]) -> tuple[tuple[str, tuple[str, ...]], ...]:
    names = dict.fromkeys(name for view in views for name in view.counters)
    return tuple(
        (
            name.replace("_", " "),
            tuple(f"{view.counters[name]:,}" if name in view.counters else words.NOTHING for view in views),
        )
        for name in names
    )


def _plot(rows: Sequence[Row], recommendation: Recommendation) -> Plot | None:
    if not shows_shadow_edge(recommendation) and not any(one.exceedance_px for one in recommendation.rated):
        return None
    of_row = dict(zip((one.candidate for one in recommendation.measurement.measurements), rows, strict=True))
    points = [
        Point(
            of_row[rated.candidate].key,
            of_row[rated.candidate].label,
            of_row[rated.candidate].technique,
            rated.shadow_ms,
            rated.exceedance_px,
            rated == recommendation.chosen,
        )
        for rated in recommendation.rated
    ]
    return plot(points, recommendation.max_edge_error_px)


def _views(
    light_key: str,
    rows: Sequence[Row],
    measurement: LightMeasurement,
    mobility: Mobility,
    pictures: Sequence[ViewPictures],
) -> tuple[ViewPart, ...]:
    return tuple(
        ViewPart(
            f"{light_key}-view-{index}",
            printable(view.camera.name),
            view,
            _truth([_in_view(one, index) for one in measurement.measurements]),
            tuple(
                _card(row, _in_view(one, index), view.layers.get(one.candidate), mobility)
                for row, one in zip(rows, measurement.measurements, strict=True)
            ),
        )
        for index, view in enumerate(pictures)
    )


def _in_view(one: Measurement, index: int) -> Measurement:
    return replace(one, views=one.views[index : index + 1])


def _card(row: Row, one: Measurement, layers: Layers | None, mobility: Mobility) -> Card:
    return Card(row, layers, words.milliseconds(one.shadow_ms(mobility)), _figures(one))


def _truth(measurements: Sequence[Measurement]) -> str:
    sources = dict.fromkeys(TRUTHS[view.truth] for one in measurements for view in one.views)
    return " and ".join(sources)


def _confidence(recommendation: Recommendation | None) -> str:
    if recommendation is None or recommendation.confidence is None:
        return ""
    return f"{100 * recommendation.confidence:.0f} %"


def _canary(measurement: LightMeasurement) -> str:
    times = [time for view in measurement.canary_ms for time in view]
    if not times:
        return ""
    return f"{words.milliseconds(min(times))} to {words.milliseconds(max(times))}"
