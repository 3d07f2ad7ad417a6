"""What can be asked about a level."""

from __future__ import annotations

from dataclasses import dataclass
from urllib.parse import urlencode

from .records import Mobility


@dataclass(frozen=True)
class Ask:
    """What is asked about the lights of a level; what is left out is up to the service.

    Attributes:
        policy: What is good enough: `speed`, `balanced` or `quality`.
        max_edge_error_px: The same as a number.
        mobility: Of all lights; what the level says of each where None.
        techniques: To choose from.
        scene: Which of the file's scenes.
        resolution: Pixels across and down.
        lights: Which, by name, number or `node:NUMBER`.
        cameras: The same.
        name: The level's file name, for display.
        rounds: How often each candidate is measured; for jobs only.
    """

    policy: str | None = None
    max_edge_error_px: float | None = None
    mobility: Mobility | None = None
    techniques: tuple[str, ...] = ()
    scene: str | None = None
    resolution: tuple[int, int] | None = None
    lights: tuple[str, ...] = ()
    cameras: tuple[str, ...] = ()
    name: str | None = None
    rounds: int | None = None

    def query(self, name: str = "") -> str:
        """The query string with its question mark; empty where nothing is asked.

        Args:
            name: The level's file name, where the question has none.
        """
        size = f"{self.resolution[0]}x{self.resolution[1]}" if self.resolution else None
        pairs = [
            ("policy", self.policy),
            ("max_edge_error_px", self.max_edge_error_px),
            ("mobility", self.mobility),
            ("scene", self.scene),
            ("resolution", size),
            ("rounds", self.rounds),
            ("name", self.name or name or None),
            *(("technique", one) for one in self.techniques),
            *(("light", one) for one in self.lights),
            *(("camera", one) for one in self.cameras),
        ]
        # Names in a level may hold halves of surrogate pairs, which have no UTF-8.
        given = [(key, str(value)) for key, value in pairs if value is not None]
        return "?" + urlencode(given, errors="replace") if given else ""
