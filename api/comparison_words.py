"""Figures of a page in words: with their unit, and with as many digits as they deserve."""

from __future__ import annotations

import math

from api.verdicts import EXACT, is_exact_by_definition, shows_edge
from api.wording import amount, counted
from scenes.scene import Light, LightKind
from selector.measurement import Measurement
from selector.recommendation import SHORT_EDGE_PX, Rated

NOTHING, NO_EDGE = "-", "no edge"


def digits(value: float) -> str:
    """Three significant digits at most, no more than three behind the point, without an exponent."""
    if value == 0:
        return "0"
    if abs(value) < 0.0005:
        return "< 0.001"
    places = min(max(2 - math.floor(math.log10(abs(value))), 0), 3)
    return f"{value:,.{places}f}"


def milliseconds(value: float | None) -> str:
    """`12.3 ms`."""
    return NOTHING if value is None else f"{digits(value)} ms"


def pixels(value: float | None) -> str:
    """`0.52 px`."""
    return NOTHING if value is None else f"{value:,.2f} px" if value >= 0.005 or value == 0 else "< 0.01 px"


def percent(share: float | None) -> str:
    """`2.8 %`."""
    if share is None:
        return NOTHING
    value = 100 * share
    return f"{digits(value)} %" if value == 0 or value >= 0.001 else "< 0.001 %"


def difference(flip: float | None) -> str:
    """FLIP, which has no unit: `0.0051`."""
    return NOTHING if flip is None else f"{flip:.4f}" if flip else "0"


def memory(size: int) -> str:
    """`4.0 MiB`, and a dash for nothing."""
    return amount(size) if size else NOTHING


def edge_words(one: Measurement, rated: Rated | None) -> str:
    """How far the edge is off: `0.52 px`, `exact`, `no edge`, or `17 wrong pixels` where it is short."""
    if rated is None:
        return pixels(one.figure("edge_error_px"))
    if is_exact_by_definition(one) and not rated.exceedance_px:
        return EXACT if shows_edge(one) else NO_EDGE
    if rated.exceedance_px > (rated.edge_error_px or 0.0):
        return counted(round(rated.exceedance_px * SHORT_EDGE_PX), "wrong pixel")
    return NO_EDGE if rated.edge_error_px is None else pixels(rated.edge_error_px)


def light_facts(light: Light) -> list[str]:
    """What a reader needs to know of a light: kind, cone, range, whether it stands still."""
    facts = [f"{light.kind} light"]
    if light.kind is LightKind.SPOT:
        facts.append(f"cone {math.degrees(2 * light.outer_cone_rad):.0f}°")
    if light.kind is not LightKind.DIRECTIONAL:
        facts.append(f"range {light.range_m:,.4g} m" if math.isfinite(light.range_m) else "no range limit")
    if light.node is not None:
        facts.append(f"node {light.node}")
    return facts
