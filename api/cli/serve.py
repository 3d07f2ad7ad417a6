"""`gnomon serve`: the HTTP service and its page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from api.cli import learning_options as learning
from api.cli import options

DEFAULT_HOST, DEFAULT_PORT = "127.0.0.1", 8420
DEFAULT_READERS, DEFAULT_UPLOAD_MB, DEFAULT_TRIANGLES, DEFAULT_QUEUE = 2, 256, 2_000_000, 32
ACCESS, LIMITS = "Who may ask", "Where it ends"


def serve(  # noqa: PLR0913, PLR0917  the options of the command line are its arguments
    host: Annotated[
        str,
        typer.Option(
            "--host",
            metavar="ADDRESS",
            help="Where it listens. Anything but this machine itself needs a token.",
            rich_help_panel=ACCESS,
        ),
    ] = DEFAULT_HOST,
    port: Annotated[
        int,
        typer.Option(
            "--port",
            metavar="N",
            parser=options.whole_number(0, 65535),
            help="Which port; any free one where 0.",
            rich_help_panel=ACCESS,
        ),
    ] = DEFAULT_PORT,
    token_file: Annotated[
        Path | None,
        typer.Option(
            "--token-file",
            metavar="FILE",
            help="Holds the token that every request has to show; else the variable GNOMON_TOKEN may.",
            show_default="no token",
            rich_help_panel=ACCESS,
        ),
    ] = None,
    allow_host: Annotated[
        list[str] | None,
        typer.Option(
            "--allow-host",
            metavar="NAME",
            help="Another name by which browsers may call it. May be given again.",
            show_default=False,
            rich_help_panel=ACCESS,
        ),
    ] = None,
    state: Annotated[
        Path | None,
        typer.Option(
            "--state",
            metavar="FOLDER",
            help="Where its queue of jobs and their results lie.",
            show_default="~/.local/state/gnomon",
        ),
    ] = None,
    model: learning.Model = None,
    device: options.Device = None,
    readers: Annotated[
        int,
        typer.Option(
            "--readers",
            metavar="N",
            parser=options.whole_number(1, 64),
            help="How many processes read levels and predict.",
            rich_help_panel=LIMITS,
        ),
    ] = DEFAULT_READERS,
    max_upload_mb: Annotated[
        int,
        typer.Option(
            "--max-upload-mb",
            metavar="N",
            parser=options.whole_number(1, 4096),
            help="How large a level with its files may be, in MiB.",
            rich_help_panel=LIMITS,
        ),
    ] = DEFAULT_UPLOAD_MB,
    max_triangles: Annotated[
        int,
        typer.Option(
            "--max-triangles",
            metavar="N",
            parser=options.whole_number(1, 8_000_000),
            help="How many triangles a level may draw.",
            rich_help_panel=LIMITS,
        ),
    ] = DEFAULT_TRIANGLES,
    queue: Annotated[
        int,
        typer.Option(
            "--queue",
            metavar="N",
            parser=options.whole_number(1, 10_000),
            help="How many jobs may wait.",
            rich_help_panel=LIMITS,
        ),
    ] = DEFAULT_QUEUE,
    *,
    quiet: Annotated[bool, typer.Option("--quiet", help="Log only what goes wrong.")] = False,
) -> None:
    """Serve recommendations over HTTP, with a page in the browser, until Ctrl-C.

    Levels come in, and recommendations or annotated levels go out; lights can be measured in the background.
    It listens on this machine only, unless told otherwise. Levels of strangers are read by processes of their
    own, which may die of them.
    """
    # The framework is loaded by this command alone, so that --help is there at once.
    from api.cli.serve_run import run_serve  # noqa: PLC0415
    from api.service.listening import token_of  # noqa: PLC0415
    from api.service.settings import MEBIBYTE, Limits, Settings, default_state  # noqa: PLC0415
    from models.shipped import SHIPPED_MODEL  # noqa: PLC0415

    settings = Settings(
        state=(state or default_state()).absolute(),
        model=(model or SHIPPED_MODEL).absolute(),
        host=host,
        port=port,
        token=token_of(token_file),
        names=tuple(allow_host or ()),
        device=device,
        readers=readers,
        limits=Limits(upload_bytes=max_upload_mb * MEBIBYTE, triangles=max_triangles, queue=queue),
    )
    run_serve(settings, quiet=quiet)
