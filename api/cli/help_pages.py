"""How commands present themselves under --help: plain flags, plain names, sentences that wrap."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

from typer.core import TyperCommand, TyperGroup


class PlainCommand(TyperCommand):
    """A command whose flags show no type and whose arguments no braces."""

    def get_params(self, ctx: Any) -> list[Any]:
        """Its parameters, flags without a type."""
        return _plain_flags(super().get_params(ctx))

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Its help page; words in braces are filled in from the registry, which only then is loaded."""
        texts = [param for param in self.params if "{" in (getattr(param, "help", None) or "")]
        if texts:
            from api.vocabulary import help_words  # noqa: PLC0415

            words = help_words()
            for param in texts:
                param.help = param.help.format_map(words)  # type: ignore[attr-defined]
        super().format_help(ctx, formatter)

    def collect_usage_pieces(self, ctx: Any) -> list[str]:
        """The usage line: `gnomon inspect [OPTIONS] LEVEL`."""
        return [piece.strip("{}") for piece in super().collect_usage_pieces(ctx)]


class PlainGroup(TyperGroup):
    """The program itself, presented like its commands."""

    def get_params(self, ctx: Any) -> list[Any]:
        """Its parameters, flags without a type."""
        return _plain_flags(super().get_params(ctx))


def help_text(command: Callable[..., object]) -> str:
    """The docstring of a command, each paragraph one line: the terminal wraps it where it is full."""
    paragraphs = (inspect.getdoc(command) or "").split("\n\n")
    return "\n\n".join(paragraph.replace("\n", " ") for paragraph in paragraphs)


def _plain_flags(params: list[Any]) -> list[Any]:
    for param in params:
        if getattr(param, "is_flag", False):
            param.metavar = ""
    return params
