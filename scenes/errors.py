"""Errors that a user can act on: what happened, where, what is known, what to do."""

from __future__ import annotations


class GnomonError(Exception):
    """A failure that the user can understand and act on.

    Args:
        what: One sentence that says what is wrong.
        where: The place: file, node, accessor, byte, device.
        known: What was found, as opposed to what was expected.
        remedy: What the user can do about it.
    """

    exit_code = 1

    def __init__(self, what: str, *, where: str = "", known: str = "", remedy: str = "") -> None:
        super().__init__(what)
        self.what = what
        self.where = where
        self.known = known
        self.remedy = remedy

    def __str__(self) -> str:
        parts = [f"{self.where}: {self.what}" if self.where else self.what, self.known, self.remedy]
        return " ".join(part for part in parts if part)


class LevelError(GnomonError):
    """A level file that cannot be read, or that does not hold what was asked for."""

    exit_code = 3


class DeviceError(GnomonError):
    """A GPU, driver or context that cannot do what is needed."""

    exit_code = 4


class OutputError(GnomonError):
    """A result that could not be written; nothing was left half-written."""

    exit_code = 5
