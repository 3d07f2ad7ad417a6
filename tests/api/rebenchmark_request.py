"""Re-benchmark jobs over recorded runs: what is asked, and where."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from api.rebenchmarking import Machine, Request
from scenes.scene import Light, LightKind, Mobility
from selector.policy import policy
from selector.rebenchmark.remeasuring import Bench
from tests.selector.repeated_runs import codes, repeats

HOSTILE = '</script><script>alert("x")</script>'


def lights(count: int = 12) -> tuple[Light, ...]:
    """Of both kinds, near and far, wide and narrow."""
    found = []
    for index in range(count):
        place = (float(index % 4 - 1.5), 1.5 + index % 5, float(index % 3 - 1))
        reach = 4.0 + 2.5 * index
        mobility = Mobility.STATIC if index % 3 else Mobility.DYNAMIC
        name = f"Lamp {index} {HOSTILE if index == 0 else ''}"
        if index % 2:
            found.append(Light(name, LightKind.POINT, place, range_m=reach, mobility=mobility))
        else:
            cone = 0.4 + 0.08 * index
            found.append(
                Light(
                    name,
                    LightKind.SPOT,
                    place,
                    (0.0, -1.0, 0.0),
                    cone / 2,
                    cone,
                    range_m=reach,
                    mobility=mobility,
                )
            )
    return tuple(found)


def machine(**changed: str) -> Machine:
    return Machine(Bench(codes=codes() | changed), repeats().device)


def request(folder: Path, **more: object) -> Request:
    known = Request(
        store=str(folder / "e.sqlite"),
        model=folder / "town.model",
        report=folder / "night.html",
        levels=(folder / "yard.glb",),
        policy=policy("balanced"),
        size=(160, 128),
        folds=3,
    )
    return replace(known, **more)  # type: ignore[arg-type]
