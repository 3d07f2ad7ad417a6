"""What the page of a comparison says, ready for its template: texts, places and pictures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from api.comparison_pictures import Layers, ViewPictures
from api.comparison_plot import Plot
from selector.recommendation import Recommendation


@dataclass(frozen=True)
class Stage:
    """A part of a bar.

    Attributes:
        name: The stage.
        color: Its place in the palette of stages.
        time: Its milliseconds in words.
        percent: Its length, of the longest bar of the light.
    """

    name: str
    color: int
    time: str
    percent: float


@dataclass(frozen=True)
class Row:
    """One candidate of one light in the table.

    Attributes:
        key: By which plot, table and pictures know it; no other candidate of the page has it.
        label: Its name.
        technique: Place of its technique in the registry, for colour and shape.
        verdict: `chosen`, `runner-up` or nothing.
        over_limit: Whether it is farther off than the limit; None where it is not weighed.
        failure: Status and reason where it could not be measured, else nothing.
        dynamic: Time of a light that moves.
        static: Time of a light that stands still.
        frame: Time of the whole frame.
        stages: The bar.
        edge: How far the edge is off.
        figures: The other error figures, by column.
        memory: On the device.
        counters: Work counts: a name, and the count in each view.
        notes: What the technique had to say, such as a fall-back.
    """

    key: str
    label: str
    technique: int
    verdict: str
    over_limit: bool | None
    failure: str
    dynamic: str
    static: str
    frame: str
    stages: tuple[Stage, ...]
    edge: str
    figures: Mapping[str, str]
    memory: str
    counters: tuple[tuple[str, tuple[str, ...]], ...]
    notes: tuple[str, ...]


@dataclass(frozen=True)
class Card:
    """One candidate in one view.

    Attributes:
        row: The candidate.
        layers: Its pictures; None where it rendered none.
        time: Of its shadow in this view.
        figures: Error figures in this view, by name.
    """

    row: Row
    layers: Layers | None
    time: str
    figures: Mapping[str, str]


@dataclass(frozen=True)
class ViewPart:
    """One view of a light: the truth, and what each candidate makes of it."""

    key: str
    name: str
    pictures: ViewPictures
    truth: str
    cards: tuple[Card, ...]


@dataclass(frozen=True)
class LightPart:
    """One light of the page.

    Attributes:
        key: For links.
        name: What the level calls it.
        facts: Kind, cone, range.
        mobility: Whether times are those of a static or a dynamic light.
        problem: Why there is no recommendation; empty where there is one.
        recommendation: The choice; None where there is none.
        confidence: That the choice is the cheapest, in words.
        chosen: Its row; None where there is none.
        rows: Every candidate.
        columns: The error figures beside the edge that any candidate has.
        stage_colors: Stages that bars show, with their place in the palette.
        shadowless: Whether no view shows an edge of its shadow, so that it may do without.
        plot: Time against error; None where nothing could be weighed, or no error can tell candidates apart.
        views: With their pictures.
        canary: How steady the machine was.
        truth: What the masks were compared with.
    """

    key: str
    name: str
    facts: tuple[str, ...]
    mobility: str
    problem: str
    recommendation: Recommendation | None
    confidence: str
    chosen: Row | None
    rows: tuple[Row, ...]
    columns: tuple[str, ...]
    stage_colors: Mapping[str, int]
    shadowless: bool
    plot: Plot | None
    views: tuple[ViewPart, ...]
    canary: str
    truth: str
