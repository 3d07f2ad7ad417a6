"""Options of the commands that learn and predict; they mean the same in each."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from api.cli import options
from api.cli.failures import UsageError

DEFAULT_OUTPUT = Path("gnomon.model")

Evidence = Annotated[
    Path | None,
    typer.Option(
        "--evidence",
        metavar="FOLDER",
        help="Parquet or CSV files of evidence, in place of a store.",
        show_default=False,
    ),
]
Device = Annotated[
    str | None,
    typer.Option(
        "--device",
        metavar="NAME|KEY",
        help="Whose times: part of a device's name, the beginning of its key, or virtual:fill-bound-2005, "
        "virtual:desktop, virtual:phone.",
        show_default="the first that was timed",
    ),
]
Levels = Annotated[
    Path | None,
    typer.Option(
        "--levels",
        metavar="FOLDER",
        help="Where level files are that evidence comes from, if its features are not kept.",
        show_default=False,
    ),
]
Model = Annotated[
    Path | None,
    typer.Option(
        "--model",
        metavar="FILE",
        help="What `gnomon train` has written.",
        show_default="the one that comes with Gnomon",
    ),
]


@dataclass(frozen=True)
class Source:
    """What is learnt from.

    Attributes:
        store: URL of a store.
        evidence: Folder of files in place of the store.
        device: Whose times.
        levels: Folder of level files.
    """

    store: str
    evidence: Path | None
    device: str | None
    levels: Path | None


def source(store: str, evidence: Path | None, device: str | None, levels: Path | None) -> Source:
    """What these options mean together.

    Raises:
        UsageError: There are both a store and files.
    """
    if evidence is not None and store != options.DEFAULT_STORE:
        raise UsageError("--evidence and --store are two sources.", remedy="Give one of them.")
    return Source(store, evidence, device, levels)
