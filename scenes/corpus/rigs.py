"""Which rigs a kind of light can have."""

from __future__ import annotations

from scenes.corpus.spec import Rig
from scenes.scene import LightKind

AT_THE_EYE = (Rig.MINERS_LAMP, Rig.OVER_THE_SHOULDER)
"""Their lamps are placed from the eye, the others from what it looks at."""

SUN_RIGS = (Rig.FAR_LOW_SUN, Rig.OVERHEAD, Rig.FROM_THE_SIDE, Rig.OVER_THE_SHOULDER, Rig.DUELLING_FRUSTA)
"""A sun is nowhere: it cannot be beside the camera, or between it and what it sees."""

RIGS: dict[LightKind, tuple[Rig, ...]] = {
    LightKind.SPOT: tuple(rig for rig in Rig if rig is not Rig.AT_THE_WALL),
    LightKind.POINT: tuple(Rig),
    LightKind.DIRECTIONAL: SUN_RIGS,
}
"""What each kind can have; a spot right at the wall that it is aimed at would light nothing else."""
