"""What USD has to say while it works: caught, so that nothing is printed, and told as one of our errors."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager

from pxr import Tf, UsdUtils

from scenes.errors import LevelError

# "Error in 'function' at line 7 in file x.cpp : 'what is wrong'": only the last part is for people.
_ERROR = re.compile(r"Error in '.*?' at line \d+ in file \S+ : '(.*?)'\s*(?=\n\s*Error in|\Z)", re.DOTALL)
_LONGEST = 300


@contextmanager
def quiet() -> Iterator[None]:
    """Keeps USD from printing, and turns what it raises into a LevelError.

    Raises:
        LevelError: USD failed, met a text that is none, or ran out of memory.
    """
    # While there is a delegate, USD hands its warnings over instead of writing them to stderr.
    delegate = UsdUtils.CoalescingDiagnosticDelegate()
    try:
        yield
    except Tf.ErrorException as error:
        raise LevelError(
            "USD cannot read this level.",
            known=f"USD says: {said(error)}",
            remedy="Check it with usdchecker, or export it again.",
        ) from error
    except UnicodeDecodeError as error:
        raise LevelError(
            "This level is damaged: a text in it is no UTF-8.",
            known=f"Of {len(error.object)} bytes, number {error.start} is wrong.",
            remedy="Export it again, or copy it again.",
        ) from error
    except MemoryError as error:
        raise LevelError(
            "This level claims more than fits into memory.",
            remedy="Export it again: its numbers are damaged, or it is far too large.",
        ) from error
    finally:
        delegate.TakeUncoalescedDiagnostics()
        del delegate


def said(error: Tf.ErrorException) -> str:
    """The first complaint of an error of USD, on one line, without the places in USD's own source."""
    try:
        text = str(error)
    except UnicodeDecodeError:
        # It quotes the file.
        return "something about a place that is no UTF-8."
    found = _ERROR.search(text)
    words = " ".join((found.group(1) if found else text).split())
    words = words if len(words) <= _LONGEST else f"{words[:_LONGEST]}..."
    return words if words.endswith((".", "...")) else f"{words}."
