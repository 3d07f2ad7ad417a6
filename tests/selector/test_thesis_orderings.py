from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
import pytest

from renderers.error_figures import ErrorFigures
from renderers.frame import Surfaces
from scenes.scene import Camera, Mobility
from scenes.thesis.set_ups import set_ups
from selector.measurement import LightMeasurement, Measurement, Sample, Status, Truth, ViewRun
from selector.ordering_grades import grades
from selector.ordering_measuring import Thoroughness, near_and_far, trials_of
from selector.ordering_records import Finding, Ordering
from selector.ordering_results import Halves, Order, Results, TrialResult, compared
from selector.ordering_trials import Trial
from selector.thesis_orderings import ORDERINGS, UnknownOrderingError, orderings_named
from selector.truth import Reference, Shown
from tests.selector.measurements import light_measurement

ROUNDS = 3


@dataclass(frozen=True)
class Made:
    """What is made up about one contender in one trial."""

    stages: Mapping[str, float] = field(default_factory=dict)
    counters: Mapping[str, int] = field(default_factory=dict)
    edge: float | None = 0.5
    p95: float = 2.0
    wrong: float = 0.0
    false_lit: float = 0.0
    flicker: float = 0.0
    halves: tuple[float, float] = (0.01, 0.01)
    status: Status = Status.OK


Description = Callable[[Trial, str], Made]


def finding(name: str, describe: Description, *, timed: bool = True) -> Finding:
    """What an ordering says of made-up results; names are techniques with their map's size, if it has one."""
    (ordering,) = orderings_named([name])
    return ordering.finding(made_results([ordering], describe, timed=timed))


def made_results(orderings: list[Ordering], describe: Description, *, timed: bool = True) -> Results:
    trials = {}
    for ask in trials_of(orderings):
        rounds = ROUNDS if timed and ask.trial.timed else 0
        made = [(one.candidate, describe(ask.trial, one.name)) for one in ask.contenders]
        whole = light_measurement(
            *(
                Measurement(candidate, one.status, "made up", 0, (view(one, rounds),))
                for candidate, one in made
            )
        )
        trials[ask.trial] = TrialResult(
            LightMeasurement(
                **{**vars(whole), "canary_ms": ((1.0,) * rounds,), "verified_wrong_share": 1e-5}
            ),
            {candidate: Halves(*one.halves) for candidate, one in made},
        )
    return Results(trials)


def view(made: Made, rounds: int) -> ViewRun:
    total = sum(made.stages.values())
    samples = tuple(
        Sample(
            index, mobility, scale * total, scale * total + 1, {k: scale * v for k, v in made.stages.items()}
        )
        for index in range(rounds)
        for mobility, scale in ((Mobility.DYNAMIC, 1.0), (Mobility.STATIC, 100.0))
    )
    figures = ErrorFigures(1000, made.wrong, made.false_lit, 0.0, 900.0, made.edge, made.p95, 0.0, 0.0)
    return ViewRun("Eye", samples, figures, 0.0, made.counters, flicker=made.flicker)


def by_name(**known: Made) -> Description:
    return lambda _, name: known[name.split()[0].replace("-", "_")]


def changed(describe: Description, where: str, name: str, other: Made) -> Description:
    return lambda trial, one: (
        other if (trial.set_up, one.split()[0]) == (where, name) else describe(trial, one)
    )


def maps(ms: float, texels: int = 1_000_000) -> Made:
    return Made({"map": ms, "visibility": 1.0}, {"map_texels_cleared": texels})


def volumes(ms: float, fragments: int = 5_000_000) -> Made:
    return Made({"edges": 0.5, "volumes": ms, "visibility": 1.0}, {"volume_fragments": fragments})


def hybrid(ms: float, fragments: int = 4_000_000, *, first: float = 4.0) -> Made:
    stages = {"map": first, "silhouette_pixels": 1.0, "edges": 0.5, "volumes": ms, "visibility": 1.0}
    return Made(stages, {"volume_fragments": fragments, "silhouette_pixels": 5000})


USUAL = by_name(SM=maps(2.0), SM_fit=maps(2.0), PSM=maps(3.0), SV=volumes(10.0), Chan=hybrid(9.0))


@pytest.mark.parametrize(
    ("first", "second", "order"),
    [
        ((1.0, 1.0, 1.0), (1.04, 1.05, 1.05), Order.TIE),
        ((1.0, 1.0, 1.0), (1.06, 1.06, 0.5), Order.LESS),
        ((1.0, 1.0), (1.06, 1.0), Order.TIE),
        ((1.06, 2.0, 1.0), (1.0, 1.0, 1.0), Order.MORE),
        ((0.0,), (0.0,), Order.TIE),
        ((0.0,), (1.0,), Order.LESS),
    ],
)
def test_more_than_half_of_the_rounds_decide(
    first: tuple[float, ...], second: tuple[float, ...], order: Order
) -> None:
    assert compared(first, second) is order


def test_ordinary_maps_are_the_fastest_unless_another_is_faster() -> None:
    assert finding("O1", USUAL).holds is True
    assert finding("O1", changed(USUAL, "Room", "PSM", maps(1.9))).holds is True, "a tie is none"
    cheap = finding("O1", changed(USUAL, "Street", "SV", volumes(0.25, 300_000)))
    assert cheap.holds is False
    assert cheap.reason == (
        "Street: SV takes 1.75 ms, SM 3.00: its stage map (1 M texels cleared) alone costs SM 2.00 ms, "
        "more than all of SV."
    )


def test_a_reason_names_the_dearest_stages_where_no_single_one_decides() -> None:
    close = finding("O1", changed(USUAL, "Street", "SV", volumes(1.1, 300_000)))
    assert close.reason == (
        "Street: SV takes 2.60 ms, SM 3.00: most of it is its stage map (1 M texels cleared), 2.00 ms, "
        "against its stage volumes (300,000 fragments), 1.10 ms."
    )


@pytest.mark.parametrize("name", ["O1", "O2", "O3", "O4", "O6"])
def test_without_times_counters_are_shown_and_nothing_is_claimed(name: str) -> None:
    silent = finding(name, USUAL, timed=False)
    assert silent.holds is None
    assert len(silent.evidence) == 5
    assert silent.reason.startswith("Only times can say this")


@pytest.mark.parametrize("name", [one.id for one in ORDERINGS])
def test_what_was_refused_is_unclear_and_said(name: str) -> None:
    refused = finding(name, lambda *_: Made(status=Status.REFUSED))
    assert refused.holds is None
    assert "refused: made up" in refused.reason


def test_what_was_never_measured_is_unclear() -> None:
    assert ORDERINGS[7].finding(Results({})).reason == "Tower, narrowest cone: SM 256 was not measured."


def test_a_warped_map_costs_its_set_up_alone() -> None:
    assert finding("O2", USUAL).holds is True
    tie = finding("O2", changed(USUAL, "Room", "PSM", maps(2.0)))
    assert (tie.holds, tie.reason) == (False, "Room: both take the same time.")
    faster = finding("O2", changed(USUAL, "Room", "PSM", maps(1.0)))
    assert faster.reason.startswith("Room: PSM takes 2.00 ms, SM 3.00: ")
    fuller = finding("O2", changed(USUAL, "Room", "PSM", maps(3.0, 2_000_000)))
    assert fuller.reason == "Room: not by set-up alone, for its map has 2.00 times the texels to fill."
    slow = Made({"map": 2.5, "visibility": 2.0}, {"map_texels_cleared": 1_000_000})
    assert "comparing pixels" in finding("O2", changed(USUAL, "Room", "PSM", slow)).reason


def test_volumes_beat_warped_maps_on_the_street_alone() -> None:
    street = changed(USUAL, "Street", "SV", volumes(0.5))
    assert finding("O3", street).holds is True
    nowhere = finding("O3", USUAL)
    assert nowhere.holds is False
    assert nowhere.reason.startswith("Street: PSM takes 4.00 ms, SV 11.50: ")
    tie = finding("O3", changed(USUAL, "Street", "SV", volumes(2.5)))
    assert tie.reason == "Street: both take the same time."
    both = finding("O3", changed(street, "Rocks", "SV", volumes(0.5)))
    assert both.reason.startswith("Rocks: SV takes 2.00 ms, PSM 4.00: ")


def test_the_hybrid_beats_volumes_on_the_box_grid_alone() -> None:
    grid = changed(USUAL, "Box grid", "Chan", hybrid(1.0))
    assert finding("O4", grid).holds is True
    assert finding("O4", USUAL).reason.startswith("Box grid: SV takes 11.50 ms, Chan 15.50: ")
    more = changed(USUAL, "Box grid", "Chan", hybrid(1.0, 5_000_000))
    counted = finding("O4", more, timed=False)
    assert (counted.holds, "by counters alone" in counted.reason) == (False, True)


@pytest.mark.parametrize("timed", [True, False])
def test_the_hybrid_saves_where_volumes_overlap(timed: bool) -> None:  # noqa: FBT001  a parameter
    about = by_name(SV=volumes(10.0, 5_000_000), Chan=hybrid(9.0, 4_500_000))
    saving = changed(about, "Box grid", "Chan", hybrid(2.0, 1_000_000))
    saving = changed(saving, "Water tower", "Chan", hybrid(2.0, 1_000_000))
    assert finding("O5", saving, timed=timed).holds is True
    dear = finding("O5", changed(saving, "Water tower", "Chan", hybrid(10.0, 5_000_000)), timed=timed)
    assert dear.reason.startswith("Water tower: Chan's volumes do not cost less: ")
    for other in (hybrid(2.0, 1_000_000), hybrid(20.0, 9_000_000)):
        uneven = finding("O5", changed(saving, "Room", "Chan", other), timed=timed)
        assert uneven.reason.startswith("Room: not about equal: ")
        assert ("by counters alone" in uneven.reason) is not timed


def test_the_hybrid_loses_by_its_map_and_silhouette_pixels() -> None:
    assert finding("O6", USUAL).holds is True
    dear = finding("O6", changed(USUAL, "Room", "Chan", hybrid(20.0)))
    assert (dear.holds, dear.reason) == (
        False,
        "Room: without them Chan still takes 21.50 ms, SV 11.50.",
    )
    winning = finding("O6", by_name(SV=volumes(10.0), Chan=hybrid(1.0)))
    assert (winning.holds, "nowhere" in winning.reason) == (None, True)


def growing(by_volume: int, by_hybrid: int, by_map: int) -> Description:
    def describe(trial: Trial, name: str) -> Made:
        grown = 0 if trial.halved else 1
        return {
            "SV": volumes(1.0, 1_000_000 + grown * by_volume),
            "Chan": hybrid(1.0, 1_000_000 + grown * by_hybrid),
        }.get(name, maps(1.0, 1_000_000 + grown * by_map))

    return describe


@pytest.mark.parametrize("timed", [True, False])
def test_what_grows_with_the_resolution(timed: bool) -> None:  # noqa: FBT001  a parameter
    assert finding("O7", growing(3_000_000, 1_000_000, 0), timed=timed).holds is True
    steady = finding("O7", growing(0, -1, 0), timed=timed)
    assert steady.reason.startswith("Box grid: SV's fragments do not grow. ")
    alike = finding("O7", growing(3_000_000, 3_000_000, 0), timed=timed)
    assert alike.reason.startswith("Box grid: Chan's fragments grow by 3 M, SV's by 3 M. ")
    larger = finding("O7", growing(3_000_000, 1_000_000, 1_000_000), timed=timed)
    assert larger.reason.startswith("Box grid: texels SM 1 M to 2 M. ")


def towers(error: Callable[[int, int], float], p95: float = 3.0) -> Description:
    cones = [one.name for one in set_ups() if one.figure in ("52", "53")]
    return lambda trial, name: Made(edge=error(cones.index(trial.set_up), int(name.split()[1])), p95=p95)


def test_errors_fall_with_texels_and_grow_with_the_cone() -> None:
    assert finding("O8", towers(lambda cone, size: (cone + 1) / size)).holds is True
    assert "no smaller at 512" in finding("O8", towers(lambda cone, _: cone + 1.0)).reason
    assert "no larger at 256" in finding("O8", towers(lambda _, size: 1 / size)).reason
    smooth = finding("O8", towers(lambda cone, size: (cone + 1) / size, 1.0))
    assert smooth.reason == "Tower, cut-off of 60 degrees: at 2048 the edge is not jagged any more."


def test_a_view_without_an_edge_says_nothing_about_errors() -> None:
    blind = finding("O8", lambda *_: Made(edge=None))
    assert (blind.holds, blind.reason) == (
        None,
        "Tower, narrowest cone: SM 256 has no edge error px in this view.",
    )


def rocks(warped: Mapping[str, Made]) -> Description:
    """The light is told by the last word of the set-up's name but `the viewer`."""

    def describe(trial: Trial, name: str) -> Made:
        if not name.startswith("PSM"):
            return Made(halves=(0.02, 0.02), counters={"map_texels_written": 100_000})
        return next(made for word, made in warped.items() if word in trial.set_up)

    return describe


AS_THE_THESIS = {
    "right": Made(halves=(0.01, 0.04)),
    "front": Made(),
    "behind": Made(),
    "closer": Made(edge=1.5),
}


def test_a_warped_map_against_an_ordinary_one() -> None:
    assert finding("O9", rocks(AS_THE_THESIS)).holds is True


@pytest.mark.parametrize(
    ("word", "made", "said"),
    [
        ("right", Made(halves=(0.02, 0.04)), "Light right: not better near."),
        ("right", Made(halves=(0.01, 0.02)), "Light right: not worse far."),
        ("front", Made(edge=0.2), "Light in front: not equal, 0.50 px to 0.20; a fit alone brings 0.50."),
        ("front", Made(edge=0.7), "Light in front: not equal"),
        ("behind", Made(edge=1.2), "Light behind: 1.20 px is not nearly perfect."),
        ("closer", Made(edge=0.6), "Light closer: not clearly worse, 0.50 px to 0.60;"),
    ],
)
def test_what_is_otherwise_of_a_warped_map_is_said(word: str, made: Made, said: str) -> None:
    other = finding("O9", rocks({**AS_THE_THESIS, word: made}))
    assert other.holds is False
    assert said in other.reason


def test_a_warp_that_is_refused_without_a_fit_is_part_of_the_reason() -> None:
    usual = rocks({**AS_THE_THESIS, "closer": Made()})
    refused = finding(
        "O9",
        lambda trial, name: (
            Made(status=Status.REFUSED) if name.startswith("PSM-unclipped") else usual(trial, name)
        ),
    )
    assert refused.holds is False
    assert refused.reason.endswith("there is no warp at all: made up.")


def test_thin_objects_come_back_as_the_map_grows() -> None:
    def lost(share: Callable[[int], float]) -> Finding:
        return finding("O10", lambda _, name: Made(false_lit=share(int(name.split()[1]))))

    assert lost(lambda size: 5.0 / size).holds is True
    assert lost(lambda _: 0.02).reason.startswith("Chan 512: 2.000 % falsely lit, no less than Chan 256.")
    assert "nothing dropped" in lost(lambda size: 0.1 / size).reason
    assert "Chan 256: 0.00037 % falsely lit is nothing dropped." in lost(lambda _: 3.66e-6).reason
    assert "Chan 256: 0 % falsely lit is nothing dropped." in lost(lambda _: 0.0).reason


def tree(**wrong: float) -> Description:
    shares = {"SM_1024": 0.01, "SM_2048": 0.005, "PSM_1024": 0.01, "PSM_2048": 0.005}
    shares |= {"SV": 0.0, "Crow": 0.05, "Chan_1024": 0.0005} | wrong
    return lambda _, name: Made(wrong=shares[name.replace(" ", "_")])


def test_open_geometry_needs_general_volumes() -> None:
    assert finding("O11", tree()).holds is True
    assert "SM 2048: what is wrong is not for want of texels" in finding("O11", tree(SM_2048=0.009)).reason
    assert "Crow's SV is not clearly worse" in finding("O11", tree(Crow=0.012)).reason
    assert "Chan on general volumes is wrong: 2.000 %." in finding("O11", tree(Chan_1024=0.02)).reason
    assert "general SV against ray casting is wrong" in finding("O11", tree(SV=0.02)).reason


def test_only_warped_maps_flicker() -> None:
    still = Made()
    calm = by_name(SM=still, SM_fit=still, PSM=Made(flicker=0.003), SV=still, Chan=still)
    assert finding("O12", calm).holds is True
    assert finding("O12", calm).reason == ""
    fitted = finding("O12", changed(calm, "Street", "SM-fit", Made(flicker=0.003)))
    assert (fitted.holds, fitted.reason) == (
        True,
        "An SM that is fitted to the view flickers as well (Street).",
    )
    unsteady = finding("O12", changed(calm, "Street", "Chan", Made(flicker=0.003)))
    assert (unsteady.holds, unsteady.reason) == (False, "Street: Chan 1024 flickers as well.")
    assert "Street: PSM does not flicker." in finding("O12", changed(calm, "Street", "PSM", still)).reason


def test_every_trial_is_measured_once_with_all_that_anyone_needs() -> None:
    asks = trials_of(ORDERINGS)
    assert len({ask.trial for ask in asks}) == len(asks)
    merged = {ask.trial: {one.candidate for one in ask.contenders} for ask in asks}
    for ask in (ask for ordering in ORDERINGS for ask in ordering.asks):
        assert {one.candidate for one in ask.contenders} <= merged[ask.trial]
    assert all(len({one.candidate for one in ask.contenders}) == len(ask.contenders) for ask in asks)


def test_trials_are_measured_as_they_ask_for() -> None:
    thoroughness = Thoroughness(64, 48, 2)
    plan = thoroughness.plan(Trial("Street", timed=True, halved=True))
    assert (plan.width, plan.height, plan.rounds, plan.flicker_steps) == (32, 24, 2, 0)
    plan = thoroughness.plan(Trial("Street", moving=True))
    assert (plan.width, plan.rounds, plan.flicker_steps > 0, plan.verify) == (64, 0, True, True)


def test_orderings_are_called_by_id() -> None:
    assert [one.id for one in ORDERINGS] == [f"O{number}" for number in range(1, 13)]
    assert [one.id for one in orderings_named(["o9", "O2"])] == ["O2", "O9"]
    assert orderings_named([]) == ORDERINGS
    with pytest.raises(UnknownOrderingError, match='There is no ordering "O13"'):
        orderings_named(["O1", "O13"])


def test_grades_stand_beside_what_was_measured() -> None:
    found = grades(made_results([ORDERINGS[0]], USUAL))
    assert len(found) == 20
    first = {one.technique: one for one in found[:4]}
    assert (first["SM"].scene, first["SM"].speed, first["SM"].quality) == ("Box grid", 5, 2)
    assert (first["SM"].shadow_ms, first["SM"].relative, first["SM"].edge_error_px) == (3.0, 1.0, 0.5)
    assert first["PSM"].relative == pytest.approx(4 / 3)
    untimed = grades(made_results([ORDERINGS[0]], USUAL, timed=False))
    assert {(one.shadow_ms, one.relative) for one in untimed} == {(None, None)}
    refused = grades(made_results([ORDERINGS[0]], changed(USUAL, "Room", "SM", Made(status=Status.REFUSED))))
    room = {one.technique: one for one in refused if one.scene == "Room"}
    assert room["SM"].shadow_ms is None
    assert room["PSM"].relative == 1.0
    assert grades(made_results([ORDERINGS[7]], lambda *_: Made())) == ()


def test_errors_are_split_at_the_median_distance() -> None:
    positions = np.zeros((1, 5, 3))
    positions[0, :, 2] = [-1.0, -2.0, -3.0, -4.0, -9.0]
    domain = np.array([[True, True, True, True, False]])
    lit = np.ones((1, 5), bool)
    surfaces = Surfaces(positions, np.zeros((1, 5, 3)), np.ones((1, 5), bool))
    none = np.zeros((1, 4), bool), np.zeros((0, 5), bool)
    picture = np.zeros((1, 5, 3), np.uint8)
    truth = Reference(surfaces, domain, lit, picture, none, Truth.SHADOW_VOLUME)
    mask = np.array([[0.0, 0.6, 0.0, 0.0, 0.0]], np.float32)
    eye = Camera("Eye", (0.0, 0.0, 0.0))
    assert near_and_far(eye, Shown(picture, mask, truth)) == Halves(0.5, 1.0)
    dark = Reference(surfaces, np.zeros_like(domain), lit, picture, none, Truth.SHADOW_VOLUME)
    assert near_and_far(eye, Shown(picture, mask, dark)) is None
