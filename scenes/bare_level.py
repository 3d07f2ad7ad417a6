"""A level file out of which everything of ours was taken."""

from __future__ import annotations

from dataclasses import dataclass

from scenes.light_annotation import Cleared

NOTHING = "There was nothing to clear."
RESTORED = "The original is restored byte for byte."


@dataclass(frozen=True)
class Bare:
    """A file without anything of ours.

    Attributes:
        data: The file.
        had_strays: Whether keys of ours without a record were taken out of it, now or earlier.
        note: What happened, for the user.
    """

    data: bytes
    had_strays: bool
    note: str

    def cleared(self) -> Cleared:
        """The same, as far as a user is concerned."""
        return Cleared(self.data, restored=self.note in (NOTHING, RESTORED), note=self.note)
