"""A level as it was read from a file: the scene, and what its reader has to say about it."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path

from scenes.scene import Scene


class Severity(StrEnum):
    """How much a note matters."""

    INFO = "info"
    WARNING = "warning"


@dataclass(frozen=True)
class Note:
    """One thing the reader ignored, approximated or found odd.

    Attributes:
        severity: `warning` where the picture or the measurement may be affected.
        where: The place in the file, such as `mesh 3 "Tree", primitive 0`.
        text: One sentence for the level's author.
        lightless: Whether it says that there are no lights, which others may add.
    """

    severity: Severity
    where: str
    text: str
    lightless: bool = False


@dataclass
class NoteBook:
    """The notes of one reading, each said once, in the order in which they came up."""

    notes: dict[Note, None] = field(default_factory=dict)

    def info(self, where: str, text: str) -> None:
        """Notes what changes neither picture nor measurement."""
        self.notes[Note(Severity.INFO, where, text)] = None

    def warning(self, where: str, text: str) -> None:
        """Notes what may change the picture or the measurement."""
        self.notes[Note(Severity.WARNING, where, text)] = None

    def lightless(self, where: str, text: str) -> None:
        """Warns that the file has no lights."""
        self.notes[Note(Severity.WARNING, where, text, lightless=True)] = None


@dataclass(frozen=True)
class Level:
    """A scene with the file it came from."""

    path: Path
    format: str
    scene: Scene
    notes: tuple[Note, ...] = ()
