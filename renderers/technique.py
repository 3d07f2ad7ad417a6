"""What a shadow technique is: settings worth measuring, reasons to refuse, and a pass that fills the mask."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from renderers.clock import StageClock
from renderers.context import DeviceLimits
from renderers.frame import Frame
from renderers.internals import Internals
from renderers.owner import Owner
from renderers.settings import Options, Settings
from scenes.scene import Light, LightKind, Scene

Counters = Mapping[str, int]


@dataclass(frozen=True)
class Outcome:
    """What was really done.

    Attributes:
        technique: The technique that filled the mask; another than asked for where that one fell back.
        rebuilt: Whether the map or the volumes were made anew.
        note: Why, where it is not what was asked for.
    """

    technique: str
    rebuilt: bool = True
    note: str = ""


class ShadowPass(Owner):
    """One technique with its settings, ready to render into one frame."""

    memory_bytes: int

    @abstractmethod
    def render(self, clock: StageClock, *, rebuild: bool) -> Outcome:
        """Fill the frame's mask for the light and camera it is aimed at. The only timed call.

        With `rebuild` off, what the last call made is kept where it does not depend on the camera: the light
        and the scene must not have moved since.
        """

    @abstractmethod
    def count(self) -> Counters:
        """Exact work counters of the frame just rendered. Never timed; may render again."""

    def internals(self) -> Internals:
        """What was made on the way to the mask just rendered, for debug views; nothing unless told."""
        return Internals()


class Technique(Protocol):
    """A shadow technique: stateless, one instance in the registry.

    Attributes:
        name: Its id, which is the name of its module.
        label: How people call it.
        title: Its name in full.
        options: What can be set on it; `candidates` says which settings are worth measuring.
    """

    name: str
    label: str
    title: str
    options: Options

    def candidates(self, kind: LightKind, limits: DeviceLimits) -> Sequence[Settings]:
        """The settings worth measuring for a kind of light on a device, cheapest first."""
        ...

    def refuses(self, light: Light, scene: Scene, limits: DeviceLimits, settings: Settings) -> str | None:
        """Why it cannot render this light, or None. Cheap, no GPU."""
        ...

    def prepare(self, frame: Frame, light: Light, settings: Settings) -> ShadowPass:
        """Allocate and compile for lights like `light`. Never timed.

        Raises:
            DeviceError: The device cannot hold it.
        """
        ...
