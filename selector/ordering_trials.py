"""What the thesis' orderings are tried on: which candidates, in which set-up, looked at in which way."""

from __future__ import annotations

from dataclasses import dataclass

from selector.candidate import Candidate


@dataclass(frozen=True)
class Contender:
    """A candidate under the name that the thesis gives it.

    Attributes:
        name: Such as `SM 512`.
        candidate: What is rendered.
    """

    name: str
    candidate: Candidate


@dataclass(frozen=True)
class Trial:
    """A set-up of the thesis, and how it is looked at.

    Attributes:
        set_up: Its name, as in `scenes.thesis.set_ups`.
        timed: Whether candidates are timed, and not only judged and counted.
        halved: Whether the picture has half the width and half the height.
        moving: Whether the camera moves, so that flicker is measured.
    """

    set_up: str
    timed: bool = False
    halved: bool = False
    moving: bool = False


@dataclass(frozen=True)
class Ask:
    """What an ordering needs of one trial."""

    trial: Trial
    contenders: tuple[Contender, ...]
