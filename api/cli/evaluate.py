"""`gnomon evaluate`: how much a model gains on scenes that it has never seen."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from api.cli import learning_options as learning
from api.cli import options
from api.cli.failures import UsageError


def evaluate(
    store: options.StoreUrl = options.DEFAULT_STORE,
    evidence: learning.Evidence = None,
    device: learning.Device = None,
    levels: learning.Levels = None,
    model: Annotated[
        Path | None,
        typer.Option(
            "--model",
            metavar="FILE",
            help="Judge this model on the test data of the evidence, which no model learns from.",
            show_default="judge what can be learnt",
        ),
    ] = None,
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

    With --model a finished model is asked about the test data instead, such as real levels.
    """
    from api.cli.learning_run import run_evaluate, run_test  # noqa: PLC0415

    source = learning.source(store, evidence, device, levels)
    if model is not None:
        if quick:
            raise UsageError("--quick judges no model.", remedy="Leave out --quick or --model.")
        run_test(source, model, as_json=as_json)
        return
    run_evaluate(source, quick=quick, as_json=as_json)
