"""The entry point of the `gnomon` program. It imports nothing large before Ctrl-C is looked after."""

from __future__ import annotations

import sys

EXIT_INTERRUPTED = 130
"""As in `api.cli.failures`, which may not be there yet when it is needed."""


def main() -> None:
    """Run the program."""
    try:
        from api.cli.failures import report  # noqa: PLC0415
        from api.cli.program import app  # noqa: PLC0415
        from api.cli.terminal import StdoutStream, open_missing_streams  # noqa: PLC0415
        from scenes.errors import OutputError  # noqa: PLC0415

        open_missing_streams()
        # What cannot be encoded in the user's locale is escaped.
        for stream in (sys.stdout, sys.stderr):
            if reconfigure := getattr(stream, "reconfigure", None):
                reconfigure(errors="backslashreplace")
        try:
            app(standalone_mode=True)
        except OSError as error:
            # Help and the version are printed by Typer itself.
            failure = StdoutStream(sys.stdout).failure(error)
            if not isinstance(failure, OutputError):
                raise
            report(failure)
            sys.exit(failure.exit_code)
    except KeyboardInterrupt:
        # Before a command has begun, or while the last one is leaving.
        if sys.stderr:
            sys.stderr.write("interrupted: Interrupted.\n  No half-written file is left behind.\n")
        sys.exit(EXIT_INTERRUPTED)


if __name__ == "__main__":
    main()
