"""What features need to know of a level, looked up once for all of its lights and views."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter

import numpy as np

from scenes.clusters import Clusters
from scenes.ray_caster import RayCaster
from scenes.scene import Array, Positions, Scene, Triangles
from scenes.shells import Shells
from scenes.topology import Topology, weld


@dataclass(frozen=True, eq=False)
class LevelSurvey:
    """A level, ready to be asked about its lights.

    Attributes:
        scene: The scene.
        origin: (3,) float64 world position of the middle of its bounds, metres; scene space starts there.
        extent_m: Diagonal of the bounds; 1 where there is none, so that it can be divided by.
        seen: Rays against all meshes.
        casting: Rays against the meshes that cast.
        corners: (t, 3, 3) float64 corners of the casting triangles, scene space.
        mesh_boxes: (2, m, 3) float64 lowest and highest corners of the casting meshes as drawn, scene space.
        positions: (v, 3) float32 welded corners of the casters, scene space.
        topology: Edges of the casting triangles.
        receivers: (2, c, 3) float64 lowest and highest corners of boxes that hold all triangles, scene space.
        closed_share: Of the casting triangles, those in closed shells; 0 without any.
        seconds: What looking all this up took.
    """

    scene: Scene
    origin: Array
    extent_m: float
    seen: RayCaster
    casting: RayCaster
    corners: Array
    mesh_boxes: Array
    positions: Positions
    topology: Topology
    receivers: Array
    closed_share: float
    seconds: float

    @classmethod
    def of(cls, scene: Scene) -> LevelSurvey:
        """Looks through the level once."""
        start = perf_counter()
        origin = scene.bounds.mean(axis=0)
        extent = float(np.linalg.norm(scene.bounds[1] - scene.bounds[0]))
        positions, triangles, casts, mesh_boxes = _gathered(scene, origin)
        everything = Clusters.of(positions, triangles)
        welded, number = weld(positions)
        casters = number.astype(np.int32)[triangles[casts]]
        shells = Shells.of(scene)
        seen = RayCaster(scene, casters_only=False)
        casting = seen if casts.all() else RayCaster(scene)
        return cls(
            scene=scene,
            origin=origin,
            extent_m=extent if extent > 0 else 1.0,
            seen=seen,
            casting=casting,
            corners=welded.astype(np.float64)[casters],
            mesh_boxes=mesh_boxes,
            positions=welded,
            topology=Topology.of(casters),
            receivers=np.stack([everything.low, everything.high]),
            closed_share=shells.closed / max(shells.triangles, 1),
            seconds=perf_counter() - start,
        )


def _gathered(
    scene: Scene, origin: Array
) -> tuple[Positions, Triangles, np.ndarray[tuple[int], np.dtype[np.bool_]], Array]:
    """Positions, triangles, which of them cast, and the boxes of the meshes as drawn that do."""
    positions, triangles, casts = [np.zeros((0, 3))], [np.zeros((0, 3), np.int32)], [np.zeros(0, bool)]
    lows, highs, start = [np.zeros((0, 3))], [np.zeros((0, 3))], 0
    for mesh in scene.meshes:
        if not mesh.triangle_count:
            continue
        world = mesh.world_positions() - origin
        copies, count = world.shape[:2]
        first = start + count * np.arange(copies)
        positions.append(world.reshape(-1, 3))
        triangles.append((mesh.triangles[None].astype(np.int64) + first[:, None, None]).reshape(-1, 3))
        casts.append(np.full(mesh.triangle_count, mesh.casts))
        if mesh.casts:
            drawn = world[:, np.unique(mesh.triangles)]
            lows.append(drawn.min(axis=1))
            highs.append(drawn.max(axis=1))
        start += copies * count
    boxes = np.stack([np.concatenate(lows), np.concatenate(highs)])
    return (
        np.concatenate(positions).astype(np.float32),
        np.concatenate(triangles).astype(np.int32),
        np.concatenate(casts),
        boxes,
    )
