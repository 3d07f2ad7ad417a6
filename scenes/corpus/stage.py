"""What a family builds, and from what: the plan before, the stage after."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

from scenes.corpus.draws import Draws
from scenes.corpus.spec import Spec
from scenes.scene import Mesh
from scenes.solids import Point


@dataclass(frozen=True)
class Plan:
    """What a family is asked for.

    Attributes:
        spec: The whole spec; families look at `triangles`, `crowding` and `grain`.
    """

    spec: Spec

    @property
    def triangles(self) -> int:
        """How many are wanted."""
        return self.spec.triangles

    def draws(self, *part: str | int) -> Draws:
        """Random numbers for a part of the scene, the same however much other parts draw."""
        return Draws(self.spec.family, self.spec.seed, *part)

    def by_grain(self, coarse: float, fine: float) -> float:
        """From `coarse` for few large casters to `fine` for many small ones, in equal ratios."""
        return _stepped(coarse, fine, self.spec.grain)

    def by_crowding(self, sparse: float, dense: float) -> float:
        """From `sparse` to `dense`, in equal ratios."""
        return _stepped(sparse, dense, self.spec.crowding)


@dataclass(frozen=True)
class Stage:
    """A place, without lights and cameras.

    Attributes:
        meshes: What it is made of.
        start: A point in the free space where people may be; none where that hangs together with the sky.
        room: Lowest and highest corner of where eyes and lamps may be; by default anywhere over the ground.
        lamps: Lowest and highest corner of where lamps and suns stand behind what shades them, such as a
            ceiling of bars; by default lamps are in the room, before what stands between them and the target.
        vistas: Eyes and what they look at, from where the place looks like itself; best first.
    """

    meshes: tuple[Mesh, ...]
    start: Point | None = None
    room: tuple[Point, Point] | None = None
    lamps: tuple[Point, Point] | None = None
    vistas: tuple[tuple[Point, Point], ...] = ()

    @property
    def triangle_count(self) -> int:
        """Triangles drawn."""
        return sum(mesh.triangle_count for mesh in self.meshes)


def _stepped(first: float, last: float, step: int) -> float:
    # Square roots are the same on every machine; powers are not.
    quarter = sqrt(sqrt(last / first))
    value = first
    for _ in range(step):
        value *= quarter
    return value
