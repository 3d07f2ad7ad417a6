"""`gnomon train`: a model learnt from evidence."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from api.cli import learning_options as learning
from api.cli import options


def train(
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="MODEL", help="The model.")
    ] = learning.DEFAULT_OUTPUT,
    store: options.StoreUrl = options.DEFAULT_STORE,
    evidence: learning.Evidence = None,
    device: learning.Device = None,
    levels: learning.Levels = None,
    *,
    quick: Annotated[
        bool, typer.Option("--quick", help="Do not judge the model: its card then says nothing of its worth.")
    ] = False,
    as_json: options.AsJson = False,
) -> None:
    """Learn from evidence which technique suits which light, and write a model.

    The same evidence gives the same model, bit for bit. How good it is on families of scenes that it has not
    seen is measured first, and stands in its card.
    """
    from api.cli.learning_run import run_train  # noqa: PLC0415

    run_train(output, learning.source(store, evidence, device, levels), quick=quick, as_json=as_json)
