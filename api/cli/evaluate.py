"""`gnomon evaluate`: how much a model gains on scenes that it has never seen."""

from __future__ import annotations

from typing import Annotated

import typer

from api.cli import learning_options as learning
from api.cli import options


def evaluate(
    store: options.StoreUrl = options.DEFAULT_STORE,
    evidence: learning.Evidence = None,
    device: learning.Device = None,
    levels: learning.Levels = None,
    *,
    quick: Annotated[
        bool,
        typer.Option("--quick", help="Only say who wins and what there is to gain; no model is judged."),
    ] = False,
    as_json: options.AsJson = False,
) -> None:
    """Judge what can be learnt from evidence: the closed gap under each policy, and by family.

    The closed gap is 1 for the best choice for every light, 0 for one choice for all, and below 0 for worse.
    Families of scenes are never parted: those that are asked about were not learnt from.
    """
    from api.cli.learning_run import run_evaluate  # noqa: PLC0415

    run_evaluate(learning.source(store, evidence, device, levels), quick=quick, as_json=as_json)
