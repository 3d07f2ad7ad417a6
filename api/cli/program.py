"""The `gnomon` command line: its commands."""

from __future__ import annotations

from importlib.metadata import version
from typing import Annotated

import typer

from api.cli.annotate import annotate
from api.cli.benchmark import benchmark
from api.cli.compare import compare
from api.cli.corpus import corpus
from api.cli.devices import devices
from api.cli.evaluate import evaluate
from api.cli.evidence import evidence
from api.cli.failures import epilog, failing_cleanly
from api.cli.features import features
from api.cli.help_pages import PlainCommand, PlainGroup, help_text
from api.cli.inspect import inspect
from api.cli.rebenchmark import rebenchmark
from api.cli.recommend import recommend
from api.cli.render import render
from api.cli.serve import serve
from api.cli.thesis import thesis
from api.cli.train import train

app = typer.Typer(
    name="gnomon",
    cls=PlainGroup,
    help="Which shadow technique should each light use? Gnomon measures it, and writes it into the level.",
    epilog=epilog(annotates=True),
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
COMMANDS = (
    *(annotate, recommend, compare, inspect, features, render),
    *(thesis, corpus, benchmark, rebenchmark, train, evaluate, serve, devices),
)
for command in COMMANDS:
    annotates = command in (annotate, recommend, compare)
    app.command(cls=PlainCommand, help=help_text(command), epilog=epilog(annotates=annotates))(
        failing_cleanly(command)
    )
app.add_typer(evidence)


def _print_version(value: bool) -> None:  # noqa: FBT001  Typer calls it so
    if value:
        typer.echo(f"gnomon {version('gnomon')}")
        raise typer.Exit


@app.callback()
def _program(
    *,
    version_wanted: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Take the options of the program itself."""
    del version_wanted
